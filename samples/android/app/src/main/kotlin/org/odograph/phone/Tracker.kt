// SPDX-License-Identifier: Apache-2.0
package org.odograph.phone

/** Odograph on this phone's camera and sensors: tracker_jni.cpp. */
object Tracker {
    init { System.loadLibrary("odograph_phone") }

    /** Starts with a pipeline's YAML; the app has the permission CAMERA. Returns what went wrong, empty when nothing did. */
    external fun start(config: String): String

    external fun stop()

    /** North, east, down in m, state, 1 where metric, distance in m; null before the first pose. */
    external fun pose(): DoubleArray?

    external fun stateText(state: Int): String
}
