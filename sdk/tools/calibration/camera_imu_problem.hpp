// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>

#include <Eigen/Dense>
#include <ceres/ceres.h>

#include "sdk/tools/calibration/camera_imu_start.hpp"

namespace odograph {

/// Frames of a window.
constexpr size_t kWindowFrames = 5;

/// A short part of a recording: evenly spaced frames and the corners that all of them share.
struct FrameWindow {
  std::array<size_t, kWindowFrames> frames;
  std::vector<std::array<size_t, kWindowFrames>> corners;  ///< indices in each frame
};
/// Consecutive windows of about `length_s`, at most `most`, spread evenly, each with at least `fewest` corners.
std::vector<FrameWindow> windows_of(const std::vector<TrackedFrame>& frames, double length_s, size_t most,
                                    size_t fewest);

/// Indices of the unknowns shared by all windows. Mount (rotation vector about camera axes, rad), bias (rad/s), lens
/// (relative focal length; cx, cy in px; k1) and gyroscope scale (symmetric: xx yy zz xy xz yz) are changes from the
/// linearisation point; time offset and row time (s) are absolute.
namespace shared {
constexpr Eigen::Index mount = 0, time_offset = 3, row_time = 4, bias = 5, lens = 8, gyro_scale = 12, count = 18;
}
using SharedUnknowns = Eigen::Matrix<double, shared::count, 1>;

/// Linearisation point of a problem.
struct CameraImuLinearization {
  Eigen::Quaterniond q_b_c = Eigen::Quaterniond::Identity();
  odo_calibration lens{};
  const GyroOrientation* gyro = nullptr;
  /// Prior of the unknowns, one standard deviation; 0: no prior.
  SharedUnknowns prior = SharedUnknowns::Zero(), prior_sigma = SharedUnknowns::Zero();
};

/// Least-squares problem: in each window, the rays of a corner, rotated by the gyroscope, meet in a static point. Each
/// window has a path (positions of its later frames relative to the first, the last at distance 1) and points; all
/// windows share mount, times, bias, lens and gyroscope scale.
class CameraImuProblem {
 public:
  CameraImuProblem(const CameraImuData& data, const std::vector<FrameWindow>& windows, const CameraImuLinearization& at,
                   const CameraImuOptions& options);
  ~CameraImuProblem();

  /// Rebuilds the problem at another linearisation point; paths and points are retained.
  void relinearize(const CameraImuLinearization& at);

  /// Solves from `unknowns`; the first call initialises paths and points. Cauchy loss of `scale_px`. False if the
  /// solver fails.
  bool solve(SharedUnknowns& unknowns, const std::array<bool, shared::count>& fixed, double scale_px);

  /// Covariance of the shared unknowns from the windows' scores, zero where fixed. Call after solve().
  Eigen::MatrixXd covariance() const;

  /// Of each sight of a corner, measured minus modelled, px.
  const std::vector<Eigen::Vector2d>& residuals() const { return residuals_; }
  /// For tests of its derivatives, after solve(). The first parameter blocks of a corner are shared unknowns, path,
  /// point.
  const ceres::Problem& problem() const { return *problem_; }

 private:
  struct Sight;
  struct Window;
  class Reprojection;
  void start(Window& window, const SharedUnknowns& x, double scale_px) const;
  void measure();
  void rows_of(const Window& window, const std::vector<Eigen::Index>& free, size_t& block, Eigen::MatrixXd& rows,
               Eigen::VectorXd& values) const;

  CameraImuLinearization at_;
  std::vector<std::unique_ptr<Window>> windows_;
  SharedUnknowns x_;
  /// All parameters in one block: Ceres orders by address, and the order affects the last bits.
  std::vector<double> numbers_;
  double scale_px_ = 1;
  std::array<bool, shared::count> fixed_{};
  std::unique_ptr<ceres::LossFunction> loss_;  // outlives the problem
  std::unique_ptr<ceres::Problem> problem_;
  std::vector<ceres::ResidualBlockId> blocks_;  ///< by window, corner, frame; then each window's path
  std::vector<Eigen::Vector2d> residuals_;
};

}  // namespace odograph
