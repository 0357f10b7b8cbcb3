// SPDX-License-Identifier: Apache-2.0
//
// Camera and inertial sensor models of phones. Sources: docs/simulator.md, "Phones".
#include "sdk/math/scalar.hpp"
#include "sdk/tools/simulation/scenario.hpp"

#include "sdk/math/gravity.hpp"

namespace odograph {
namespace {

constexpr double kMilliG = 1e-3 * kStandardGravity_mps2;

struct CameraFigures {
  double readout_s, exposure_s, exposure_longest_s, time_offset_s, jitter_s, travel_deg, breathing, focus_interval_s,
      bit_rate;
};
/// Noise in deg/s/sqrt(Hz) and ug/sqrt(Hz), biases in deg/s, deg/s/K and mg.
struct ImuFigures {
  double gyro_noise_deg, accel_noise_ug, gyro_bias_deg, gyro_warming_deg, accel_bias_mg;
  double gyro_scale, accel_scale, cross_axis, gyro_by_g_deg, jitter_s, gap_s;
};

constexpr CameraFigures kGoodLight = {8e-3, 2e-3, 0, 5e-3, 0.2e-3, 0.9, 0.005, 10, 0};
constexpr CameraFigures kIndoors = {15e-3, 10e-3, 20e-3, 15e-3, 1e-3, 0.9, 0.012, 1.5, 5e6};
constexpr CameraFigures kOld = {31e-3, 20e-3, 33e-3, 30e-3, 3e-3, 0, 0, 4, 2e6};
constexpr ImuFigures kImuGoodLight = {0.005, 100, 0.1, 0.01, 10, 0.004, 0.004, 0.002, 0.02, 0.05e-3, 0};
constexpr ImuFigures kImuIndoors = {0.007, 160, 0.5, 0.015, 20, 0.01, 0.005, 0.005, 0.05, 0.3e-3, 0};
constexpr ImuFigures kImuOld = {0.014, 400, 3, 0.08, 50, 0.03, 0.01, 0.02, 0.1, 1.4e-3, 35e-3};

struct Phone {
  const char* name;
  const CameraFigures& camera;
  const ImuFigures& imu;
  bool reported;
};

constexpr Phone kPhones[] = {{"phone", kGoodLight, kImuGoodLight, false},
                             {"phone_reported", kGoodLight, kImuGoodLight, true},
                             {"phone_indoors", kIndoors, kImuIndoors, false},
                             {"phone_old", kOld, kImuOld, false}};

const Phone* phone_of(const std::string& name) {
  for (const Phone& phone : kPhones)
    if (name == phone.name) return &phone;
  return nullptr;
}

}  // namespace

const char* const kPhoneProfiles = "clean|phone|phone_reported|phone_indoors|phone_old";

void take_camera_of(const std::string& profile, Scenario::Camera& c) {
  const Phone* phone = phone_of(profile);
  if (!phone) return;
  const CameraFigures& p = phone->camera;
  c.row_time_s = p.readout_s / c.height;
  c.exposure_s = p.exposure_s, c.exposure_longest_s = p.exposure_longest_s;
  c.unknown_time_offset_s = p.time_offset_s, c.jitter_s = p.jitter_s;
  c.stabiliser.travel_rad = p.travel_deg * kRad_per_deg, c.stabiliser.reported = phone->reported;
  c.focus.breathing = p.breathing, c.focus.interval_s = p.focus_interval_s;
  c.bit_rate = p.bit_rate;
  c.jpeg_quality = 95;  // the codec's output is stored almost losslessly
}

void take_imu_of(const std::string& profile, Scenario::Imu& i) {
  const Phone* phone = phone_of(profile);
  if (!phone) return;
  const ImuFigures& p = phone->imu;
  i.gyro_noise = p.gyro_noise_deg * kRad_per_deg, i.accel_noise = p.accel_noise_ug * 1e-3 * kMilliG;
  i.gyro_bias = p.gyro_bias_deg * kRad_per_deg, i.gyro_warming = p.gyro_warming_deg * kRad_per_deg;
  i.accel_bias = p.accel_bias_mg * kMilliG;
  i.scale_error = p.gyro_scale, i.accel_scale_error = p.accel_scale, i.misalignment_rad = p.cross_axis;
  i.gyro_by_g = p.gyro_by_g_deg * kRad_per_deg;
  i.jitter_s = p.jitter_s, i.gap_s = p.gap_s;
}

}  // namespace odograph
