// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "sdk/host/config/spec.hpp"

namespace odograph {

/// Input of `odograph sim`. Every number is a key of the scenario file; scenario_spec explains them.
struct Scenario {
  struct World {
    std::string type = "street";
    double street_width_m = 16, house_height_m = 12;
    std::string model;                            // path of a city model, for the type city
    std::optional<Eigen::Vector3d> model_origin;  // easting, northing, height of the route's origin
    std::optional<Eigen::Vector2d> sun;           // azimuth, height, rad
    std::vector<Eigen::Vector2d> unmapped;        // ranges of the route whose buildings are in no model, m
    std::vector<Eigen::Vector2d> open, river;     // ranges of the route across a square, along a river, m
    double open_width_m = 160;                    // between the fronts there
    double glass_fronts = 0;                      // fraction of the houses
    bool glass = true, shadows = true;
    int64_t trees = 12, parked_cars = 8, pedestrians = 6, cars = 2;  // per 100 m of route
    double light = 1.0;
    struct Planted {
      Eigen::Vector3d foot_n;
      double height_m;  // of a tree; 0: a parked car
    };
    std::vector<Planted> planted;  // not a key: simulated photographs plant objects in a city model
  } world;
  struct Vehicle {
    double speed_mps = 11.0, camera_height_m = 1.55;
  } vehicle;
  std::string carrier = "walker";
  struct Walker {
    double height_m = 1.70, speed_mps = 1.35;
    std::string carry = "texting";
    std::string gait = "brisk";                           // or viewing: a user who looks through the phone
    double stand_s = 2.0;                                 // before and after the walk
    double bounce = 1, sway = 1, weave = 1, rocking = 1;  // relative to the usual
  } walker;
  struct Event {
    double at_m = 0;
    std::string what;  // stand, look_around, handle, turn, evade, cross, shuffle, sidestep, backwards, speed, bump,
                       // texting, swinging, pocket, leg, bag, dark, lift
    double for_s = 0;
    double speed_mps = 0;
    bool waypoint = false;
  };
  std::vector<Eigen::Vector3d> route = {{0, 0, 0}, {18, 0, 0}, {24, 16, 0}};  // north, east, up
  double corner_m = 3.0;
  double record_from_s = 0;  // recording starts at this time
  double walk_m = 1e9;       // end of the walk if the route is longer; not a key: benchmarks shorten walks with it
  std::vector<Event> events;
  struct Object {
    double at_m = 0, right_m = 4, up_m = 1.8, side_m = 0.8;
    std::string kind = "tag";   // or poster
    double aspect = 2.0 / 3.0;  // of a poster: width over height, which is side_m
  };
  std::vector<Object> objects;
  struct Camera {
    int width = 640, height = 480;
    std::string model = "pinhole";
    double focal_px = 500;
    std::vector<double> distortion = {0, 0, 0, 0};  // k1 k2 p1 p2, or Kannala-Brandt's k1 k2 k3 k4
    double rate_hz = 10, pitch_rad = -0.2, tilt_rad = 0, facing_rad = 0;
    double row_time_s = 30e-6, exposure_s = 8e-3;
    double exposure_longest_s = 0, exposure_interval_s = 3;  // 0: always exposure_s
    double exposure_steps = 0.03, vignetting = 0.25, shot_noise = 0.35, read_noise = 1.2;
    double drop = 0, jitter_s = 0, time_offset_s = 0;
    int jpeg_quality = 90;
    // Errors unknown to the recording.
    double unknown_time_offset_s = 0, row_time_error = 0, focal_error = 0;
    struct Stabiliser {
      double travel_rad = 0;  // 0: none
      double high_pass_hz = 0.9, end_pass_hz = 13, gain = 0.95, settling_s = 0.02, residual_px = 0.33;
      bool reported = false;  // the recording has a calibration for each frame
      double report_error_px = 0.4;
    } stabiliser;
    struct Focus {
      double breathing = 0, interval_s = 4, move_s = 0.3;
    } focus;
    double bit_rate = 0;  // of the video; 0: no compression except jpeg_quality
    bool colour = false;  // not a key: `odograph sim --colour`
  } camera;
  struct Imu {
    double rate_hz = 200;
    double gyro_noise = 1e-3, gyro_walk = 1e-5, accel_noise = 1e-2, accel_walk = 1e-4;
    double gyro_bias = 5e-3, accel_bias = 5e-2, scale_error = 3e-3, misalignment_rad = 3e-3;
    double gyro_range = 34.9, accel_range = 78.5, gyro_step = 1.07e-3, accel_step = 2.4e-3;
    double drop = 0;
    double accel_scale_error = -1;  // negative: scale_error
    double gyro_warming = 0, gyro_by_g = 0;
    double jitter_s = 0, gap_s = 0, gap_interval_s = 5;
    double outlier_interval_s = 0;  // 0: never
    bool accelerometer = true;
  } imu;
  struct Magnetometer {
    double rate_hz = 50, noise = 0.4e-6, hard_iron = 3e-6, soft_iron = 0.02, disturbance = 5e-6;
  } magnetometer;
  struct Barometer {
    double noise_pa = 3.0, drift_pa = 20.0, wind_pa = 4.0;
  } barometer;
  struct Gnss {
    double sigma_m = 4, canyon_sigma_m = 12, correlation_s = 20, availability = 0.9;
  } gnss;

  bool is_indoors() const { return world.type == "room" || world.type == "corridor"; }
  bool drives() const { return carrier == "car"; }
};

/// Names of the phones whose camera and IMU a scenario can use, separated by '|', starting with `clean`; data and
/// sources in docs/simulator.md.
extern const char* const kPhoneProfiles;
/// Sets the values in which the named phone differs from the defaults. The row time is the readout over the camera's
/// height.
void take_camera_of(const std::string& profile, Scenario::Camera& camera);
void take_imu_of(const std::string& profile, Scenario::Imu& imu);

/// Schema of scenario files.
const Spec& scenario_spec();
/// Reads a scenario. A file may extend another (`base`), whose keys it replaces individually, lists as a whole.
/// `camera_profile`, if not empty, replaces `camera: {profile: ...}`; explicit keys of the file take precedence.
/// Failures state file, line and column, and the nearest valid key.
Result<Scenario> read_scenario(const std::string& path, const std::string& camera_profile = "");
/// The texts of the scenario file and its bases, for checksums.
Result<std::string> scenario_text(const std::string& path);

}  // namespace odograph
