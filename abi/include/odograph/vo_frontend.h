/* SPDX-License-Identifier: Apache-2.0
 *
 * Plugin kind: camera motion up to scale (visual odometry)
 *
 * Input:  odo_calibration, odo_frame (borrowed), odo_imu (may have the gyroscope only: check the flags), and
 *         odo_imu_noise and odo_attitude as priors, if available. Frames and calibrations are those of the main camera:
 *         the config's (source 0) if it has one, otherwise the first with a calibration or a frame. With
 *         ODO_PLUGIN_SEVERAL_CAMERAS they are those of all cameras; motions still describe the main one.
 * Output: at most one odo_vo_motion for each frame after the first, in frame order. t_from_ns is the t_ns of the
 *         previous result, or of the first frame if there is none. It is emitted in the call with its frame, or in a
 *         later call if the last rows of the frame need later inertial samples. If no motion can be computed, state is
 *         ODO_DEGRADED or ODO_LOST with a reason, and the flags mark the valid fields. scale_group changes whenever the
 *         scale may have changed. Optionally an odo_refined, at most once per second; and since 1.1, by a plugin whose
 *         table declares it, an odo_points immediately before each odo_vo_motion. An older host answers its emission
 *         with ODO_E_UNSUPPORTED: the plugin goes on without.
 * Intrinsics of a frame (ODO_FRAME_INTRINSICS) replace those of the calibration. A calibration that differs from its
 * predecessor only in focal length and principal point describes the same camera (focus, stabilisation): the track
 * continues. A frame that is not later than its predecessor or has an unsupported format: ODO_E_DISCARD. A camera model
 * that the plugin does not know: ODO_E_UNSUPPORTED, and the frames of that camera are discarded. reset discards tracks,
 * map and cameras. The calibrations are sent again, and the next frame is a first frame.
 */
#ifndef ODOGRAPH_VO_FRONTEND_H
#define ODOGRAPH_VO_FRONTEND_H

#include <odograph/plugin.h>

#define ODO_INTERFACE_VO_FRONTEND "odo.vo_frontend/1"

#endif
