/* SPDX-License-Identifier: Apache-2.0
 *
 * Kind of plugin: the scale of a front-end's displacements, which makes them metres
 *
 * Given: odo_vo_motion (with q_n_c0), odo_step, odo_motion_mode, odo_fix.
 * Emits: an odo_scale for each motion whose scale it can compute, before process returns: the motion is scaled right then.
 *        valid_from_ns and valid_to_ns state for which motions; a scale that is emitted outside of a motion (on a step, on a
 *        fix) may hold for motions to come. A scale that holds for past motions alone comes too late: it changes nothing, is
 *        published without ODO_FLAG_ACCEPTED and reported ("late_scale"). ODO_SCALE_HORIZONTAL when it applies to the
 *        horizontal displacement only.
 */
#ifndef ODOGRAPH_SCALE_SOURCE_H
#define ODOGRAPH_SCALE_SOURCE_H

#include <odograph/plugin.h>

#define ODO_INTERFACE_SCALE_SOURCE "odo.scale_source/draft3"

#endif
