// SPDX-License-Identifier: Apache-2.0
//
// Mount, time offset, row time and lens of a camera, from the rotation of its pictures and a gyroscope.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <odograph/types.h>

#include "sdk/host/base/result.hpp"
#include "sdk/tools/calibration/corner_tracks.hpp"
#include "sdk/tools/calibration/gyro_orientation.hpp"

namespace odograph {

/// Input of the calibration.
struct CameraImuData {
  std::vector<TrackedFrame> frames;  ///< in time order, on the camera's clock
  std::vector<GyroSample> gyro;      ///< in strictly ascending order, on the IMU's clock
  odo_calibration given{};           ///< initial lens; mount and time offset if their flags are set
  double given_row_time_s = 0;       ///< of the frames; 0: global shutter or unknown
};

struct CameraImuOptions {
  /// Also estimate focal length, principal point and the first distortion coefficient. A lens from a board is more
  /// accurate.
  bool refine_lens = true;

  // Selection of the data.
  double window_s = 0.4;     ///< s, length of a window of five frames: long enough for rotation and translation, short
                             ///< enough to keep corners
  size_t max_windows = 150;  ///< spread evenly over the recording; a minute of it
  size_t corners_of_window = 60;  ///< maximum
  size_t min_corners = 20;        ///< of a window, whose path has 11 unknowns
  double gap_s = 0.05;            ///< s between IMU samples; windows with a longer gap are skipped

  // Minimum requirements.
  double search_s = 0.2;  ///< half-width of the search for the time offset around the given one
  double min_rate_rps =
      0.05;  ///< rad/s rms about the second most excited axis: 3 deg/s, ten times a phone's bias drift
  size_t min_windows = 10;
  /// Rms about the axes across the optical axis, required to estimate the lens: at 15 deg/s a window rotates by 0.1
  /// rad, whose flow shows 1 % of focal length against corner errors of some tenths of a pixel.
  double min_lens_rate_rps = 0.26;

  // Standard deviations above which a quantity counts as unobservable and keeps its given value.
  double max_rotation_sigma_rad = 0.0087;  ///< 0.5 degrees
  double max_time_sigma_s = 2e-3;          ///< of the time offset
  double max_readout_sigma_s = 4e-3;       ///< of the whole frame's readout: phones take 5 to 33 ms
  double max_focal_sigma = 0.01;           ///< relative; focus breathing is 0.02 to 0.04 (docs/recording.md)
  double max_centre_sigma = 0.006;         ///< of the picture's width
  double max_distortion_sigma = 0.02;      ///< of k1

  // Priors of any lens: one standard deviation around the given values.
  double focal_prior = 0.2;        ///< relative
  double centre_prior = 0.01;      ///< of the picture's width: assembly tolerance of phone modules
  double distortion_prior = 0.15;  ///< of k1
  /// Of the gyroscope's scale and cross-axis terms. Tighter than the 0.4 to 1 % of data sheets, because rotation
  /// against scale is what determines the focal length: correlated corner errors would bias the scale by a percent and
  /// more.
  double gyro_scale_prior = 0.002;
};

/// An estimate, its standard deviation, and the given value.
struct Estimate {
  double value = 0, sigma = 0, given = 0;
  bool observable = false;  ///< otherwise `value` is the given one, and `sigma` the uncertainty of an estimate
};

struct CameraImuCalibration {
  Eigen::Quaterniond q_b_c = Eigen::Quaterniond::Identity(), given_q_b_c = Eigen::Quaterniond::Identity();
  Eigen::Vector3d rotation_sigma_rad = Eigen::Vector3d::Zero();  ///< about the camera's axes
  bool rotation_observable = false;
  Estimate time_offset_s;  ///< IMU time minus camera time
  Estimate row_time_s;     ///< negative if the picture's last row is read first
  Estimate focal_px;       ///< fx; fy keeps its given ratio to it
  Estimate cx, cy, k1;
  Eigen::Matrix3d gyro_scale = Eigen::Matrix3d::Identity();  ///< true rate = gyro_scale (measured - bias), symmetric
  Eigen::Vector3d gyro_bias_b = Eigen::Vector3d::Zero(), gyro_bias_sigma_b = Eigen::Vector3d::Zero();  ///< rad/s
  bool lens_refined = false;
  odo_calibration lens{};  ///< the given one with the estimates filled in, including flags

  size_t frames = 0, windows = 0, corners = 0;
  double rms_px = 0, median_px = 0;  ///< of the inliers against the fit, px; median of the residual norm
  Eigen::Vector3d rate_rms_rps = Eigen::Vector3d::Zero();  ///< of the gyroscope, by principal axis, largest first
  double correlation = 0;  ///< between the rotations of pictures and gyroscope, at the start
};

using ProgressCallback = std::function<void(size_t done, size_t all)>;

/// Estimates the rotation from camera to body, the time offset, the row time, and the lens parameters that rotation
/// makes observable, without a known scene.
///
/// Batch least squares in continuous time over windows of five frames. The ray of each corner is rotated by the
/// gyroscope's orientation at the exposure of its row, t_frame + offset + (row - middle row) * row time; the rays of
/// one corner meet in a point. Each window's path and points are unknown up to scale and eliminated (Schur); all
/// windows share mount, times, gyroscope bias and lens. It therefore works both while walking and on the spot. Cauchy
/// loss. No initial guess is needed: the start compares pure rotations between frames with the gyroscope's over all
/// offsets (find_camera_imu_start), and takes each window's direction of motion from the normals of its corners' planes
/// (Kneip & Lynen, ICCV 2013). Standard deviations come from the scores summed over each second (a sandwich estimate,
/// so that correlated corner errors count once). Unobservable quantities keep their given values. A constant scale
/// error of the gyroscope is absorbed by the focal length, its misalignment by q_b_c.
///
/// ODO_E_DATA with the reason: no frames, no gyroscope, too little rotation, or pictures whose rotation does not match
/// the gyroscope. [any]
Result<CameraImuCalibration> calibrate_camera_imu(const CameraImuData& data, const CameraImuOptions& options,
                                                  const ProgressCallback& progress = {});

/// Classifies the row time at three standard deviations; rolling_up: the last row is read first.
enum class Shutter { unknown, global, rolling, rolling_up };
Shutter shutter_of(const CameraImuCalibration& calibration);

/// Warnings about the result.
std::vector<std::string> warnings_about(const CameraImuCalibration& calibration);

/// Formats camera.yaml (docs/recording.md), with standard deviations as comments.
std::string camera_yaml(const CameraImuCalibration& calibration);

}  // namespace odograph
