/* SPDX-License-Identifier: Apache-2.0
 *
 * Plugin kind: absolute position and orientation
 *
 * Input:  odo_gnss, odo_barometer, odo_waypoint, odo_range, odo_earth_field, odo_frame, odo_calibration, and each
 *         published odo_pose as a prior: of the camera (ODO_POSE_CAMERA) if there is a front-end, otherwise of the
 *         body.
 * Output: odo_fix at any time, with any subset of position and orientation, their covariance and integrity; and
 *         odo_relative_pose. A fix must contain new information only: the host would count the prior twice if the fix
 *         were a posterior that contains it.
 */
#ifndef ODOGRAPH_ABSOLUTE_FIXER_H
#define ODOGRAPH_ABSOLUTE_FIXER_H

#include <odograph/plugin.h>

#define ODO_INTERFACE_ABSOLUTE_FIXER "odo.absolute_fixer/1"

#endif
