// SPDX-License-Identifier: Apache-2.0
package org.odograph;

import java.nio.ByteBuffer;
import java.nio.ByteOrder;
import java.util.Iterator;
import java.util.NoSuchElementException;

/** A recording, which is read once. A message and its picture are valid until the next call. */
public final class Recording implements java.io.Closeable, Iterable<Recording.Recorded> {
    /** `picture`: the encoded picture of a frame; null for other messages. */
    public static final class Recorded {
        public final Event message;
        public final ByteBuffer picture;

        private Recorded(Event message, ByteBuffer picture) {
            this.message = message;
            this.picture = picture;
        }
    }

    private long recording;
    private final ByteBuffer out = ByteBuffer.allocateDirect(24).order(ByteOrder.LITTLE_ENDIAN);

    public Recording(String path) {
        ByteBuffer name = Struct.utf8(path), string = ByteBuffer.allocateDirect(16).order(ByteOrder.LITTLE_ENDIAN);
        string.putLong(0, Native.address(name)).putLong(8, name.capacity() - 1);
        OdographException.Text error = new OdographException.Text();
        OdographException.check(Abi.odo_recording_open(Native.address(string), Native.address(out), error.address), error);
        Session.stays(name, string);
        recording = out.getLong(0);
    }

    /** Returns the next message in time order; null at the end. Records that cannot be read are skipped; loss() counts them. */
    public Recorded next() {
        if (recording == 0) return null;
        long at = Native.address(out);
        int status;
        do {
            status = Abi.odo_recording_next(recording, at, at + 8, at + 16);
        } while (status == Abi.ODO_E_DATA);
        OdographException.check(status);
        if (status != Abi.ODO_OK) return null;
        long picture = out.getLong(8);
        return new Recorded(new Event(out.getLong(0)), picture == 0 ? null : Native.view(picture, out.getLong(16)));
    }

    /** Describes missing data; empty if the recording is complete. */
    public String loss() {
        OdographException.Text loss = new OdographException.Text();
        OdographException.check(Abi.odo_recording_loss(recording, loss.address));
        return loss.message();
    }

    @Override
    public Iterator<Recorded> iterator() {
        return new Iterator<Recorded>() {
            private Recorded following; // read only on demand, because reading invalidates the previous message

            @Override
            public boolean hasNext() {
                if (following == null) following = Recording.this.next();
                return following != null;
            }
            @Override
            public Recorded next() {
                if (!hasNext()) throw new NoSuchElementException();
                Recorded recorded = following;
                following = null;
                return recorded;
            }
        };
    }

    @Override
    public void close() {
        Abi.odo_recording_close(recording);
        recording = 0;
    }
}
