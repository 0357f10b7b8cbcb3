/* SPDX-License-Identifier: Apache-2.0
 *
 * Kind of plugin: steps and how the device is carried
 *
 * Given: odo_imu, odo_attitude (of the same times), odo_barometer, odo_system_step, odo_fix (accepted ones, whose p_n is metric;
 *        and displacements of a camera whose scale does not depend on steps).
 * Emits: one odo_step for each step, in order of t_end_ns, never overlapping, at most 0.5 s after the foot's contact
 *        (the first ones of a walk, after a pause of 1.5 s, may be held back until it is certain that it is one: 4 s at
 *        most, and they come in the same call as one that is in time);
 *        one odo_motion_mode whenever the mode changes.
 *        sigma_m is the standard deviation of length_m and must be consistent: tests normalise errors by it.
 */
#ifndef ODOGRAPH_STEP_ESTIMATOR_H
#define ODOGRAPH_STEP_ESTIMATOR_H

#include <odograph/plugin.h>

#define ODO_INTERFACE_STEP_ESTIMATOR "odo.step_estimator/draft3"

#endif
