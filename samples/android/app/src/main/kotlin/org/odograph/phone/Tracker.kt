// SPDX-License-Identifier: Apache-2.0
package org.odograph.phone

/** Odograph with this phone's camera and sensors: tracker_jni.cpp. */
object Tracker {
    init { System.loadLibrary("odograph_phone") }

    /**
     * Starts with a pipeline's YAML and a file for the map of the place, which stop() writes; the app needs the
     * permission CAMERA. Returns an error text, empty on success.
     */
    external fun start(config: String, map: String): String

    external fun stop()

    /** The newest mark of the last run; 0 if there is none. It has no place until the phone recognises where it is. */
    external fun mark(): Long

    /** North, east, down in m, state, 1 where metric, distance in m; null before the first pose. */
    external fun pose(): DoubleArray?

    /**
     * As ARCore's hitTest and createAnchor: an anchor where a point of the newest picture lies on a surface, a landmark
     * or the floor; 0 if nothing is known there. 0 to 1 of the picture in sensor orientation: undo the preview's
     * rotation and crop.
     */
    external fun place(column: Double, row: Double): Long

    /** For drawing it: in the axes of the camera (x, y and z of its picture in sensor orientation), m; null while it is not placed. */
    external fun anchor(id: Long): DoubleArray?

    external fun stateText(state: Int): String
}
