// SPDX-License-Identifier: Apache-2.0
package org.odograph;

import java.nio.ByteBuffer;
import java.nio.ByteOrder;
import java.nio.charset.StandardCharsets;

/** A struct of the C ABI in memory that Java owns; its size comes first. Use one again rather than making one for each sample. */
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

    /** Whether its writer filled that many bytes. */
    public final int size() { return memory.getInt(0); }

    String text(int at, int capacity) {
        byte[] bytes = new byte[capacity];
        int length = 0;
        for (byte b; length < capacity && (b = memory.get(at + length)) != 0; ++length) bytes[length] = b;
        return new String(bytes, 0, length, StandardCharsets.UTF_8);
    }

    /** Bytes in direct memory, with a zero behind them. */
    static ByteBuffer utf8(String text) {
        byte[] bytes = text.getBytes(StandardCharsets.UTF_8);
        ByteBuffer direct = ByteBuffer.allocateDirect(bytes.length + 1);
        direct.put(bytes);
        return direct;
    }
}
