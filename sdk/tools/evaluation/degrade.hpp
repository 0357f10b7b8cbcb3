// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "sdk/tools/recording/recording.hpp"

namespace odograph {

/// White noise of a phone's IMU, "indoors" set: 0.007 deg/s/sqrt(Hz), 160 ug/sqrt(Hz) (BMI270, BMI160, ICM-20602 data
/// sheets: 0.004 to 0.008 and 100 to 160).
constexpr double kPhoneGyroNoise = 1.22e-4;   ///< rad/s/sqrt(Hz)
constexpr double kPhoneAccelNoise = 1.57e-3;  ///< m/s^2/sqrt(Hz)

/// How a recording's sensors are made worse, or parts of it left out. What the recording says of its sensors (noise,
/// time offset, calibration) stays as it is: the odometry is told of none of it.
struct Degradation {
  std::string name{};
  /// White noise is added until there is so many times a phone's (kPhone...), a phone's being taken as there already.
  double imu_noise_factor = 1;
  double accel_bias_mps2 = 0;  ///< m/s^2, on each axis of the accelerometer
  double imu_scale_error = 0;  ///< relative, of gyroscope and accelerometer, all axes
  double imu_rate_hz = 0;      ///< Hz, IMU samples are picked so far apart, unfiltered; 0: all
  bool accelerometer = true;   ///< without it samples have their gyroscope's bit alone
  double time_offset_s = 0;    ///< s, the true time offset of the camera is larger by it than the recording says
  double line_time_factor = 1;
  double stamp_jitter_s = 0;               ///< s, standard deviation of IMU time stamps; their order stays
  double wild_per_minute = 0;              ///< IMU samples a minute that are a full scale reading of both sensors
  double lost_frames = 0;                  ///< share of the frames that are missing, at random
  double gamma = 1;                        ///< of the pictures: 255 (g / 255)^gamma
  double flicker = 0, flicker_hz = 0.5;    ///< brightness goes up and down by that share, so many times a second
  double cut_s = 0;                        ///< s, it begins so long after its first frame
  double length_s = 0;                     ///< s, and ends so long after that; 0: as recorded
  double gap_from_s = 0, gap_for_s = 0;    ///< s after its (new) first frame, frames are missing
  double dark_from_s = 0, dark_for_s = 0;  ///< the same, frames are black
};

/// Reads "FROM:FOR" in s, nothing of nothing; `option` is named where it is something else.
Result<bool> parse_interval(const std::string& given, const char* option, double& from_s, double& for_s);

/// Full scale of a phone's IMU, what a wild sample reads (data sheets: 16 g, 2000 deg/s).
constexpr double kWildAccel_mps2 = 156.9;
constexpr double kWildGyro_radps = 34.9;

/// The recording made worse. The same for the same recording, degradation and seed. Truth stays whole.
Recording degraded(const Recording& recording, const Degradation& degradation, uint64_t seed);

/// The sensor-quality table: as it is, then one fault after the other.
std::vector<Degradation> sensor_qualities();
std::vector<std::string> names_of(const std::vector<Degradation>& degradations);

/// Satellite positions between two times (s after the first true state) are so far off to the east, and the receiver
/// does not know it.
void shift_gnss(Recording& recording, double from_s, double to_s, double east_m);

/// Velocities as receivers have them from Doppler shifts, which reflections off walls hardly touch: the mean over a
/// second, with an error in each component that is alike for two.
void add_gnss_velocities(Recording& recording, double sigma_mps, uint64_t seed);

}  // namespace odograph
