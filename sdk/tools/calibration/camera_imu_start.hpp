// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sdk/tools/calibration/camera_imu.hpp"
#include "sdk/tools/calibration/lens_model.hpp"

namespace odograph {

/// Rays (x/z, y/z) of pixels through a calibration's lens, with derivatives by the lens parameters.
struct LensRay {
  Eigen::Vector2d ray;
  Eigen::Matrix<double, 2, 4> by_lens;  ///< by relative focal length, cx, cy (px), k1
};
LensRay ray_of(const odo_calibration& lens, const cv::Point2f& pixel);

/// Two frames and the indices of their common corners.
struct FramePair {
  size_t first, second;
  std::vector<std::pair<size_t, size_t>> corners;
};
/// Pairs of frames about `apart_s` apart, at most `most` of them, with at least `fewest` common corners.
std::vector<FramePair> pairs_of(const std::vector<TrackedFrame>& frames, double apart_s, size_t most, size_t fewest);

/// Initial estimate of mount, time offset and gyroscope bias.
struct CameraImuStart {
  Eigen::Quaterniond q_b_c;
  double time_offset_s;
  Eigen::Vector3d bias_b;  ///< rad/s
  double correlation;      ///< of the rotation rates, camera against gyroscope
  double across_rps;       ///< rms rotation rate about the camera's x and y, by the gyroscope
};

/// Estimates the rotation between two frames that explains most of their corners' motion (least squares on rays with
/// Cauchy weights), and compares it with the gyroscope's over the same time: for every offset within `search_s` of the
/// given one, the best mount (Wahba's problem by SVD: Kabsch 1976, Markley 1988), down-weighting pairs whose
/// translation disturbs the rotation; then the best offset. Needs no initial mount. ODO_E_DATA with the reason.
Result<CameraImuStart> find_camera_imu_start(const CameraImuData& data, const GyroOrientation& gyro,
                                             const CameraImuOptions& options);

}  // namespace odograph
