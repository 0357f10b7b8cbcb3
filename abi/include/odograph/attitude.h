/* SPDX-License-Identifier: Apache-2.0
 *
 * Kind of plugin: orientation of the body
 *
 * Given: odo_imu (both sensors in every sample, in time order), odo_magnetometer, odo_imu_noise.
 * Emits: one odo_attitude for each odo_imu once it has started (ODO_NOT_READY before), at the sample's time.
 *        The heading refers to any direction unless ODO_ATTITUDE_MAGNETIC_NORTH or ODO_ATTITUDE_TRUE_NORTH is set; covariance_n
 *        is its uncertainty (ODO_ATTITUDE_COVARIANCE). ODO_ATTITUDE_MAG_DISTURBED while the magnetometer is unreliable.
 */
#ifndef ODOGRAPH_ATTITUDE_H
#define ODOGRAPH_ATTITUDE_H

#include <odograph/plugin.h>

#define ODO_INTERFACE_ATTITUDE "odo.attitude/draft3"

#endif
