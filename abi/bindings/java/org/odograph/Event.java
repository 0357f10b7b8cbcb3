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
    /** Number of landmarks of an odo_points; 0 of another type. */
    public int points() {
        if (type() != Abi.ODO_TYPE_POINTS) return 0;
        Abi.Points message = new Abi.Points(this);
        long behind = (long) head.getInt(0) - message.offset();
        return message.stride() < Abi.Point.SIZE || behind < 0 ? 0 : (int) Math.min(message.count(), behind / message.stride());
    }
    /** Copies a landmark of an odo_points; `i` below points(). */
    public Abi.Point point(int i) {
        if (i < 0 || i >= points()) throw new IndexOutOfBoundsException("landmark " + i + " of " + points());
        Abi.Points message = new Abi.Points(this);
        return new Abi.Point(this, message.offset() + i * message.stride());
    }
    /** Number of vertices in the outline of an odo_surface; 0 of another type. */
    public int vertices() {
        if (type() != Abi.ODO_TYPE_SURFACE) return 0;
        Abi.Surface message = new Abi.Surface(this);
        long behind = (long) head.getInt(0) - message.offset();
        return message.stride() < Abi.Vertex.SIZE || behind < 0 ? 0 : (int) Math.min(message.count(), behind / message.stride());
    }
    /** Copies a vertex of an odo_surface; `i` below vertices(). */
    public Abi.Vertex vertex(int i) {
        if (i < 0 || i >= vertices()) throw new IndexOutOfBoundsException("vertex " + i + " of " + vertices());
        Abi.Surface message = new Abi.Surface(this);
        return new Abi.Vertex(this, message.offset() + i * message.stride());
    }
    ByteBuffer memory() { return Native.view(address, head.getInt(0)); }
}
