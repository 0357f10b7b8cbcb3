/* SPDX-License-Identifier: Apache-2.0
 *
 * Kind of plugin: positions and orientations from outside
 *
 * Given: odo_gnss, odo_barometer, odo_waypoint, odo_range, odo_earth_field, odo_frame, odo_calibration, and odo_pose as a prior: of the
 *        camera (ODO_POSE_CAMERA) where there is a front-end, otherwise of the body, as each is published.
 * Emits: odo_fix whenever it has one: any subset of position and orientation with covariance and integrity; odo_relative_pose.
 *        A fix has its own information alone: a posterior that contains the prior would count it twice.
 */
#ifndef ODOGRAPH_ABSOLUTE_FIXER_H
#define ODOGRAPH_ABSOLUTE_FIXER_H

#include <odograph/plugin.h>

#define ODO_INTERFACE_ABSOLUTE_FIXER "odo.absolute_fixer/draft3"

#endif
