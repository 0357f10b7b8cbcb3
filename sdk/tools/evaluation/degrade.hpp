// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "sdk/tools/recording/recording.hpp"

namespace odograph {

/// White noise of a phone IMU; "indoors" set: 0.007 deg/s/sqrt(Hz), 160 ug/sqrt(Hz) (BMI270, BMI160, ICM-20602 data
/// sheets: 0.004 to 0.008 and 100 to 160).
constexpr double kPhoneGyroNoise = 1.22e-4;   ///< rad/s/sqrt(Hz)
constexpr double kPhoneAccelNoise = 1.57e-3;  ///< m/s^2/sqrt(Hz)

/// Degradation of a recording's sensors, and parts to leave out. The stated noise, time offset and calibration are
/// unchanged: the odometry is not informed.
struct Degradation {
  std::string name{};
  /// Target white noise in multiples of a phone's (kPhone...), which is assumed to be present already.
  double imu_noise_factor = 1;
  double accel_bias_mps2 = 0;  ///< m/s^2, on each axis of the accelerometer
  double imu_scale_error = 0;  ///< relative, of gyroscope and accelerometer, all axes
  double imu_rate_hz = 0;      ///< Hz, IMU samples are decimated without a filter; 0: all
  bool accelerometer = true;   ///< if false, samples have only their gyroscope flag
  double time_offset_s = 0;    ///< s, by which the camera's true time offset exceeds the stated one
  double line_time_factor = 1;
  double stamp_jitter_s = 0;               ///< s, standard deviation of IMU time stamps; their order is kept
  double outliers_per_minute = 0;          ///< IMU samples per minute with a full-scale reading of both sensors
  double lost_frames = 0;                  ///< fraction of frames missing at random
  double gamma = 1;                        ///< of the pictures: 255 (g / 255)^gamma
  double flicker = 0, flicker_hz = 0.5;    ///< relative amplitude and rate of a brightness oscillation
  double cut_s = 0;                        ///< s after the first frame, start of the recording
  double length_s = 0;                     ///< s after that, end of the recording; 0: unchanged
  double gap_from_s = 0, gap_for_s = 0;    ///< s after the (new) first frame, frames are missing
  double dark_from_s = 0, dark_for_s = 0;  ///< the same, frames are black
};

/// Parses "FROM:FOR" in s; an empty text sets nothing. `option` names the option in failures.
Result<bool> parse_interval(const std::string& given, const char* option, double& from_s, double& for_s);

/// Full scale of a phone's IMU, the reading of an outlier (data sheets: 16 g, 2000 deg/s).
constexpr double kOutlierAccel_mps2 = 156.9;
constexpr double kOutlierGyro_radps = 34.9;

/// The degraded recording. Reproducible for the same recording, degradation and seed. The truth is unchanged.
Recording degraded(const Recording& recording, const Degradation& degradation, uint64_t seed);

/// The sensor-quality table: no degradation, then one fault each.
std::vector<Degradation> sensor_qualities();
std::vector<std::string> names_of(const std::vector<Degradation>& degradations);

/// Shifts GNSS positions to the east between two times (s after the first true state) without a change of their stated
/// covariance.
void shift_gnss(Recording& recording, double from_s, double to_s, double east_m);

/// Adds GNSS velocities as from Doppler shifts, which wall reflections hardly affect: the mean over a second, with an
/// error in each component that is constant for two seconds.
void add_gnss_velocities(Recording& recording, double sigma_mps, uint64_t seed);

}  // namespace odograph
