// SPDX-License-Identifier: Apache-2.0
package org.odograph;

import java.nio.ByteBuffer;
import java.nio.ByteOrder;

/** A borrowed message of any type: an event is valid during its call, a recorded message until the next one. `new Pose(event)` copies it. */
public final class Event {
    final long address;
    private final ByteBuffer head;

    Event(long address) {
        this.address = address;
        head = Native.view(address, 32).order(ByteOrder.LITTLE_ENDIAN);
    }

    /** ODO_TYPE_* */
    public int type() { return head.getInt(4); }
    public long t_ns() { return head.getLong(8); }
    public boolean isInput() { return type() >>> 12 != 1; }
    ByteBuffer memory() { return Native.view(address, head.getInt(0)); }
}
