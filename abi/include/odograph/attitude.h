/* SPDX-License-Identifier: Apache-2.0
 *
 * Plugin kind: orientation of the body
 *
 * Input:  odo_imu (both sensors in every sample, in time order), odo_magnetometer, odo_imu_noise.
 * Output: one odo_attitude for each odo_imu, at the time of the sample, after initialisation (before: ODO_NOT_READY or
 *         ODO_OK). The heading is relative to an arbitrary direction unless ODO_ATTITUDE_MAGNETIC_NORTH or
 *         ODO_ATTITUDE_TRUE_NORTH is set. covariance_n is the uncertainty (ODO_ATTITUDE_COVARIANCE).
 *         ODO_ATTITUDE_MAG_DISTURBED is set while the magnetometer is unreliable.
 */
#ifndef ODOGRAPH_ATTITUDE_H
#define ODOGRAPH_ATTITUDE_H

#include <odograph/plugin.h>

#define ODO_INTERFACE_ATTITUDE "odo.attitude/1"

#endif
