/* SPDX-License-Identifier: Apache-2.0
 *
 * Plugin kind: steps and motion modes
 *
 * Input:  odo_imu, odo_attitude (at the same times), odo_barometer, odo_system_step, and odo_fix: accepted ones, with
 *         metric p_n, and displacements of a camera whose scale does not depend on steps.
 * Output: one odo_step for each step, in order of t_end_ns, without overlap, at most 0.5 s after foot contact; and one
 *         odo_motion_mode whenever the mode changes. After a pause of 1.5 s, the first steps may be withheld for at
 *         most 4 s until walking is certain; they are then emitted in the same call as a step that is in time. sigma_m,
 *         the standard deviation of length_m, must be consistent: tests normalise errors by it.
 */
#ifndef ODOGRAPH_STEP_ESTIMATOR_H
#define ODOGRAPH_STEP_ESTIMATOR_H

#include <odograph/plugin.h>

#define ODO_INTERFACE_STEP_ESTIMATOR "odo.step_estimator/1"

#endif
