// SPDX-License-Identifier: Apache-2.0
//
// Where a camera looks, when it looks and how it bends, from its pictures' rotation against a gyroscope.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <odograph/types.h>

#include "sdk/host/base/result.hpp"
#include "sdk/tools/calibration/corner_tracks.hpp"
#include "sdk/tools/calibration/gyro_orientation.hpp"

namespace odograph {

/// A recording as the calibration takes it.
struct CameraImuData {
  std::vector<TrackedFrame> frames;  ///< in order of time, on the camera's clock
  std::vector<GyroSample> gyro;      ///< in strictly ascending order, on the IMU's clock
  odo_calibration given{};           ///< lens to start from; mount and time offset as far as its flags say
  double given_row_time_s = 0;       ///< of the frames; 0 = global shutter, or unknown
};

struct CameraImuOptions {
  /// Refine focal length, principal point and the first distortion coefficient too. A lens from a board is better.
  bool refine_lens = true;

  // What is looked at.
  double window_s = 0.4;          ///< of five frames; long enough to turn and to move, short enough to keep corners
  size_t max_windows = 150;       ///< spread evenly over the recording: a minute of it
  size_t corners_of_window = 60;  ///< at most
  size_t min_corners = 20;        ///< of a window, whose path has 11 unknowns
  double gap_s = 0.05;            ///< between IMU samples; windows over a longer one are left out

  // What must be there.
  double search_s = 0.2;  ///< the time offset is looked for this far around the given one
  double min_rate_rps =
      0.05;  ///< rotation about the second liveliest axis, rms: 3 deg/s, ten times a phone's bias drift
  size_t min_windows = 10;
  /// Across the optical axis, rms, before the lens is touched: 15 deg/s turn 0.1 rad in a window, whose flow shows 1 %
  /// of focal length against corners that err by some tenths of a pixel together.
  double min_lens_rate_rps = 0.26;

  // From which standard deviation on a quantity counts as not observable, and keeps its given value.
  double max_rotation_sigma_rad = 0.0087;  ///< 0.5 degrees
  double max_time_sigma_s = 2e-3;          ///< of the time offset
  double max_readout_sigma_s = 4e-3;       ///< of the whole frame's readout: phones take 5 to 33 ms
  double max_focal_sigma = 0.01;           ///< relative; focus breathing is 0.02 to 0.04 (docs/recording.md)
  double max_centre_sigma = 0.006;         ///< of the picture's width
  double max_distortion_sigma = 0.02;      ///< of k1

  // What is known of any lens beforehand, one standard deviation around the given values.
  double focal_prior = 0.2;        ///< relative
  double centre_prior = 0.01;      ///< of the picture's width: assembly of phones' modules
  double distortion_prior = 0.15;  ///< of k1
  /// Of the gyroscope's scale and cross axes. Tighter than data sheets' 0.4 to 1 %, since rotation against scale is
  /// what tells the focal length: the scene's own evidence pulls it up by a percent and more where corners err
  /// together.
  double gyro_scale_prior = 0.002;
};

/// A number, how sure it is, and what was given instead.
struct Estimate {
  double value = 0, sigma = 0, given = 0;
  bool observable = false;  ///< otherwise `value` is the given one, and `sigma` says how badly it would be known
};

struct CameraImuCalibration {
  Eigen::Quaterniond q_b_c = Eigen::Quaterniond::Identity(), given_q_b_c = Eigen::Quaterniond::Identity();
  Eigen::Vector3d rotation_sigma_rad = Eigen::Vector3d::Zero();  ///< about the camera's axes
  bool rotation_observable = false;
  Estimate time_offset_s;  ///< IMU time minus camera time
  Estimate row_time_s;     ///< negative where the picture's last row is read first
  Estimate focal_px;       ///< fx; fy keeps its given ratio to it
  Estimate cx, cy, k1;
  Eigen::Matrix3d gyro_scale = Eigen::Matrix3d::Identity();  ///< true rate = gyro_scale (measured - bias), symmetric
  Eigen::Vector3d gyro_bias_b = Eigen::Vector3d::Zero(), gyro_bias_sigma_b = Eigen::Vector3d::Zero();  ///< rad/s
  bool lens_refined = false;
  odo_calibration lens{};  ///< the given one with what was found, flags and all

  size_t frames = 0, windows = 0, corners = 0;
  double rms_px = 0, median_px = 0;  ///< of corners against the fit, outliers left out; median of their size
  Eigen::Vector3d rate_rms_rps = Eigen::Vector3d::Zero();  ///< of the gyroscope, by principal axis, largest first
  double correlation = 0;  ///< of the pictures' rotation with the gyroscope's, at the start

  /// For plots.
  std::vector<std::pair<double, double>> offset_cost;  ///< time offset (s), part of the rotation left unexplained
  struct Rotation {
    double t_s;
    Eigen::Vector3d gyro_rps, camera_rps;  ///< in the camera's axes
  };
  std::vector<Rotation> rotations;
  struct Residual {
    double t_s, x_px, y_px, dx_px, dy_px;  ///< measured minus modelled
  };
  std::vector<Residual> residuals;
};

using ProgressCallback = std::function<void(size_t done, size_t all)>;

/// Rotation camera to body, time offset, row time, and the lens as far as rotation shows it, without knowing the scene.
///
/// Batch least squares in continuous time over windows of five frames. Every corner's ray is turned by the gyroscope's
/// orientation at its own row's moment, t_frame + offset + (row - middle row) * row time, and rays of one corner meet
/// in a point; the window's path and points are unknown up to scale and eliminated (Schur), mount, times, gyroscope
/// bias and lens are shared by all windows. So it works while walking as well as on the spot. Cauchy's loss. It starts
/// from nothing: pure rotations between frames against the gyroscope's over all offsets (find_camera_imu_start), and
/// each window's direction of motion from the normals of its corners' planes (Kneip & Lynen, ICCV 2013). Standard
/// deviations come from the scores of whole seconds (a sandwich, so that corners that err together count once). What
/// turns out not to be observable keeps its given value. A constant scale error of the gyroscope goes into the focal
/// length, its misalignment into q_b_c.
///
/// ODO_E_DATA, in words: no frames, no gyroscope, too little rotation, pictures that do not follow the gyroscope.
/// [any]
Result<CameraImuCalibration> calibrate_camera_imu(const CameraImuData& data, const CameraImuOptions& options,
                                                  const ProgressCallback& progress = {});

/// What the row time says, three standard deviations being certain; rolling_up: the last row is read first.
enum class Shutter { unknown, global, rolling, rolling_up };
Shutter shutter_of(const CameraImuCalibration& calibration);

/// What a person should know before using it.
std::vector<std::string> doubts_about(const CameraImuCalibration& calibration);

/// As camera.yaml (docs/recording.md), with how sure each number is as comments.
std::string camera_yaml(const CameraImuCalibration& calibration);

}  // namespace odograph
