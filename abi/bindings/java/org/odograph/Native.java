// SPDX-License-Identifier: Apache-2.0
package org.odograph;

import java.nio.ByteBuffer;

/** Native functions, implemented in odograph_jni.c. */
final class Native {
    private Native() {}
    static {
        System.loadLibrary("odograph_jni");
        int abi = Abi.odo_abi_version();
        if (abi >>> 16 != Abi.ODO_ABI_MAJOR)
            throw new UnsatisfiedLinkError("the library has ABI " + (abi >>> 16) + "." + (abi & 0xFFFF) + ", this package " + Abi.ODO_ABI_MAJOR + "." + Abi.ODO_ABI_MINOR);
    }

    static native long address(ByteBuffer buffer);
    static native ByteBuffer view(long address, long size);
    static native long listen(long session, int[] types, Object listener);
    static native void unlisten(long listener);
    static native int borrowed();
    static native int pushFrame(long session, long frame, ByteBuffer pixels, int begin);
}
