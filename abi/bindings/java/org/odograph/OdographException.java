// SPDX-License-Identifier: Apache-2.0
package org.odograph;

import java.nio.ByteBuffer;
import java.nio.ByteOrder;
import java.nio.charset.StandardCharsets;

/** An error of the library: `status` is ODO_E_*, the message states the reason. */
public final class OdographException extends RuntimeException {
    private static final long serialVersionUID = 1;
    public final int status;

    OdographException(int status, String text) {
        super(text);
        this.status = status;
    }

    /** An odo_error to be filled by a call. */
    static final class Text {
        private static final int SIZE = 2048;
        private final ByteBuffer memory = ByteBuffer.allocateDirect(SIZE).order(ByteOrder.LITTLE_ENDIAN).putInt(0, SIZE);
        final long address = Native.address(memory);

        int status() { return memory.getInt(4); }
        String message() {
            byte[] bytes = new byte[SIZE - 8];
            int length = 0;
            for (byte b; length < bytes.length && (b = memory.get(8 + length)) != 0; ++length) bytes[length] = b;
            return new String(bytes, 0, length, StandardCharsets.UTF_8);
        }
    }

    static void check(int status) {
        if (status < 0) throw new OdographException(status, Abi.odo_status_text(status));
    }
    static void check(int status, Text error) {
        if (status < 0) throw new OdographException(status, error.message().isEmpty() ? Abi.odo_status_text(status) : error.message());
    }
}
