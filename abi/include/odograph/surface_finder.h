/* SPDX-License-Identifier: Apache-2.0
 *
 * Plugin kind: planes around the phone, since 1.1
 *
 * Input:  odo_points of the main front-end, odo_pose, odo_correction. The pose of a frame follows its points; positions
 *         in metres are odo_pose.scale times those of odo_points without ODO_POINTS_METRIC, in the same scale group.
 * Output: odo_surface. A finder moves what it keeps with each correction, as the host does; a surface is expressed in n
 *         after the newest correction that it was given. Nothing where there is nothing: a surface that turns out wrong is
 *         withdrawn, one that is part of another is merged.
 */
#ifndef ODOGRAPH_SURFACE_FINDER_H
#define ODOGRAPH_SURFACE_FINDER_H

#include <odograph/plugin.h>

#define ODO_INTERFACE_SURFACE_FINDER "odo.surface_finder/1"

#endif
