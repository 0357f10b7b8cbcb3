/* SPDX-License-Identifier: Apache-2.0
 *
 * Kind of plugin: camera motion up to scale
 *
 * Given: odo_calibration, odo_frame (borrowed), odo_imu, odo_imu_noise and odo_attitude as priors where there are any.
 * Emits: exactly one odo_vo_motion for each frame after the first, in the frames' order, with t_from_ns the t_ns of the
 *        previous frame. It comes with the frame's call, or, since a frame's last rows need inertial samples that are
 *        later than its time, with a later one, at the latest that of the next frame. When
 *        the motion cannot be told, state is ODO_DEGRADED or ODO_LOST with a reason and the flags say what is valid:
 *        nothing is invented. A new scale_group whenever the scale may have changed.
 *        A frame's own intrinsics (ODO_FRAME_INTRINSICS) stand above its calibration's. A calibration that differs from the
 *        one before in focal length and centre alone is the same camera, focused or stabilised: the track goes on.
 *        A frame whose time is not after the previous one's is none: ODO_E_DISCARD.
 * May:   give an odo_calibration with ODO_CALIBRATION_REFINED, once a second at most: what it found the camera to be.
 * reset: forgets tracks, map and cameras; the calibrations come anew, the next frame is a first frame.
 */
#ifndef ODOGRAPH_VO_FRONTEND_H
#define ODOGRAPH_VO_FRONTEND_H

#include <odograph/plugin.h>

#define ODO_INTERFACE_VO_FRONTEND "odo.vo_frontend/draft2"

#endif
