// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "sdk/tools/calibration/camera_imu_problem.hpp"

namespace odograph {

inline constexpr int kPath = 3 * (kWindowFrames - 1);  ///< number of parameters of a window's path
/// Sigma of the deviation from a straight uniform path, in path lengths: a weak regularisation.
inline constexpr double kBend = 1;

/// A corner in a frame, with the weights of the path: its position is linear in the path's parameters.
struct CameraImuProblem::Sight {
  LensRay ray;
  cv::Point2f pixel;
  double t_s = 0;   ///< of the frame, on the camera's clock, after the first IMU sample
  double rows = 0;  ///< below the middle row
  size_t frame = 0;
};

struct CameraImuProblem::Window {
  std::array<double, kWindowFrames> t_s{};  ///< camera's clock
  std::vector<std::array<Sight, kWindowFrames>> corners;
  Eigen::Map<Eigen::Matrix<double, kPath, 1>> path{nullptr};  ///< in body axes at the reference time
  /// Three numbers per point: x/z, y/z, 1/z in camera axes at the reference time, relative to the first frame.
  double* points = nullptr;
  bool started = false;
  double reference_s = 0;            ///< IMU's clock
  Eigen::Quaterniond q_reference_g;  ///< from the gyroscope's frame to the body at the reference time
  Eigen::Matrix3d R_reference_c;     ///< from the camera to the body at the reference time

  Eigen::Vector3d place(size_t frame) const {
    return frame == 0 ? Eigen::Vector3d::Zero().eval()
                      : path.segment<3>(3 * static_cast<Eigen::Index>(frame - 1)).eval();
  }
  /// Weights of the frames' positions in the position at dt after a frame, and in its derivative.
  void passing(size_t frame, double dt, std::array<double, kWindowFrames>& weight,
               std::array<double, kWindowFrames>& rate) const {
    const size_t before = frame == 0 ? 0 : frame - 1, after = std::min(frame + 1, kWindowFrames - 1);
    const double slope = 1 / (t_s[after] - t_s[before]);
    weight.fill(0), rate.fill(0);
    rate[after] += slope, rate[before] -= slope;
    for (size_t k = 0; k < kWindowFrames; ++k) weight[k] = dt * rate[k];
    weight[frame] += 1;
  }
};

}  // namespace odograph
