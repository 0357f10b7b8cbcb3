// SPDX-License-Identifier: Apache-2.0
package org.odograph;

import java.nio.ByteBuffer;
import java.nio.ByteOrder;
import java.nio.charset.StandardCharsets;

/** A struct of the C ABI in memory owned by Java; its first member is its size. Reuse it instead of creating one per sample. */
public abstract class Struct {
    final ByteBuffer memory;
    final long address;

    Struct(int size) {
        memory = ByteBuffer.allocateDirect(size).order(ByteOrder.LITTLE_ENDIAN);
        address = Native.address(memory);
        memory.putInt(0, size);
    }

    void copy(Event event, int type) {
        if (event.type() != type) throw new IllegalArgumentException("an event of type " + event.type() + "; expected " + type);
        ByteBuffer from = event.memory();
        from.limit(Math.min(from.limit(), memory.capacity()));
        memory.clear();
        memory.put(from).putInt(0, from.limit());
    }

    /** Copies an element at that byte of a message. */
    void copyElement(Event event, int at) {
        ByteBuffer from = event.memory();
        from.limit(at + memory.capacity()).position(at);
        memory.clear();
        memory.put(from);
    }

    /** Whether the struct has at least that many bytes. */
    public final int size() { return memory.getInt(0); }

    String text(int at, int capacity) {
        byte[] bytes = new byte[capacity];
        int length = 0;
        for (byte b; length < capacity && (b = memory.get(at + length)) != 0; ++length) bytes[length] = b;
        return new String(bytes, 0, length, StandardCharsets.UTF_8);
    }

    /** Copies bytes to direct memory, followed by a zero. */
    static ByteBuffer utf8(String text) {
        byte[] bytes = text.getBytes(StandardCharsets.UTF_8);
        ByteBuffer direct = ByteBuffer.allocateDirect(bytes.length + 1);
        direct.put(bytes);
        return direct;
    }
}
