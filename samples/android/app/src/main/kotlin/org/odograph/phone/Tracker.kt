// SPDX-License-Identifier: Apache-2.0
package org.odograph.phone

/** Odograph with this phone's camera and sensors: tracker_jni.cpp. */
object Tracker {
    init { System.loadLibrary("odograph_phone") }

    /** Starts with a pipeline's YAML; the app needs the permission CAMERA. Returns an error text, empty on success. */
    external fun start(config: String): String

    external fun stop()

    /** North, east, down in m, state, 1 where metric, distance in m; null before the first pose. */
    external fun pose(): DoubleArray?

    external fun stateText(state: Int): String
}
