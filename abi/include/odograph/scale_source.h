/* SPDX-License-Identifier: Apache-2.0
 *
 * Plugin kind: metric scale of the displacements of a front-end
 *
 * Input:  odo_vo_motion (with q_n_c0), odo_step, odo_motion_mode, odo_fix; and since 1.1, for a plugin whose table
 *         declares it, the odo_points of a frame, before its odo_vo_motion.
 * Output: an odo_scale for each motion whose scale it can compute, before process returns, because the motion is scaled
 *         immediately afterwards. valid_from_ns and valid_to_ns select the motions. A scale that is emitted in response
 *         to another message (a step, a fix) may apply to later motions. A scale that applies only to past motions is
 *         too late: it has no effect, is published without ODO_FLAG_ACCEPTED and is reported ("late_scale").
 *         ODO_SCALE_HORIZONTAL is set if it applies only to the horizontal displacement.
 */
#ifndef ODOGRAPH_SCALE_SOURCE_H
#define ODOGRAPH_SCALE_SOURCE_H

#include <odograph/plugin.h>

#define ODO_INTERFACE_SCALE_SOURCE "odo.scale_source/1"

#endif
