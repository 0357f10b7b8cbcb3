/* SPDX-License-Identifier: Apache-2.0
 *
 * Kind of plugin: positions and orientations from outside
 *
 * Given: odo_gnss, odo_barometer, odo_waypoint, odo_range, odo_earth_field, odo_frame, odo_calibration, and odo_pose as a prior.
 * Emits: odo_fix whenever it has one: any subset of position and orientation with covariance and integrity; odo_relative_pose.
 */
#ifndef ODOGRAPH_ABSOLUTE_FIXER_H
#define ODOGRAPH_ABSOLUTE_FIXER_H

#include <odograph/plugin.h>

#define ODO_INTERFACE_ABSOLUTE_FIXER "odo.absolute_fixer/draft3"

#endif
