/* SPDX-License-Identifier: Apache-2.0
 *
 * Kind of plugin: camera motion up to scale
 *
 * Given: odo_calibration, odo_frame (borrowed), odo_imu (a phone that has no accelerometer at a gyroscope's time sends the
 *        gyroscope alone: look at the flags), odo_imu_noise and odo_attitude as priors where there are any.
 *        Of one camera, the main one: the config's (source 0) where it has one, otherwise the first that has a calibration or
 *        a frame. With ODO_PLUGIN_SEVERAL_CAMERAS in the table, of all cameras; motions are of the main one all the same.
 * Emits: at most one odo_vo_motion for each frame after the first, in the frames' order, with t_from_ns the t_ns of the last
 *        result (of the first frame, before there is one). It comes within the call of its frame or, where a frame's last rows
 *        need later inertial samples, of one of the next calls. While no motion can be computed, state is ODO_DEGRADED or
 *        ODO_LOST with a reason, and the flags state what is valid: nothing is invented. A new scale_group whenever the scale
 *        may have changed.
 *        A frame's own intrinsics (ODO_FRAME_INTRINSICS) replace its calibration's. A calibration that differs from the one
 *        before in focal length and centre alone is the same camera, focused or stabilised: the track goes on.
 *        A frame whose time is not after the previous one's, or of a format that is not supported: ODO_E_DISCARD.
 * May:   emit an odo_refined, once a second at most.
 * reset: forgets tracks, map and cameras; the calibrations come again, the next frame is a first frame.
 */
#ifndef ODOGRAPH_VO_FRONTEND_H
#define ODOGRAPH_VO_FRONTEND_H

#include <odograph/plugin.h>

#define ODO_INTERFACE_VO_FRONTEND "odo.vo_frontend/draft3"

#endif
