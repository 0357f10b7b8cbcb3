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

/// A short stretch of a recording: some frames, evenly apart, and the corners that all of them have.
struct FrameWindow {
  std::array<size_t, kWindowFrames> frames;
  std::vector<std::array<size_t, kWindowFrames>> corners;  ///< places in each frame
};
/// Windows of about `length_s`, one after the other, at most `most` spread evenly, each with at least `fewest` corners.
std::vector<FrameWindow> windows_of(const std::vector<TrackedFrame>& frames, double length_s, size_t most,
                                    size_t fewest);

/// Where things stand in the vector of what all windows share. Changes of the mount (rotation vector about the camera's
/// axes, rad), bias (rad/s), lens (relative focal length; cx, cy in px; k1) and gyroscope scale (symmetric: xx yy zz
/// xy xz yz) are from what the problem was made with; time offset and row time (s) are whole.
namespace shared {
constexpr Eigen::Index mount = 0, time_offset = 3, row_time = 4, bias = 5, lens = 8, gyro_scale = 12, count = 18;
}
using SharedUnknowns = Eigen::Matrix<double, shared::count, 1>;

/// What a problem is made around.
struct CameraImuLinearization {
  Eigen::Quaterniond q_b_c = Eigen::Quaterniond::Identity();
  odo_calibration lens{};
  const GyroOrientation* gyro = nullptr;
  /// One standard deviation of what is known beforehand around `prior`; 0: nothing is.
  SharedUnknowns prior = SharedUnknowns::Zero(), prior_sigma = SharedUnknowns::Zero();
};

/// The least-squares problem: in every window the corners' rays, turned by the gyroscope, meet in points that stand
/// still. Each window has a path (positions of its later frames from the first, the last at distance 1) and its points;
/// all share mount, times, bias, lens and the gyroscope's scale.
class CameraImuProblem {
 public:
  CameraImuProblem(const CameraImuData& data, const std::vector<FrameWindow>& windows, const CameraImuLinearization& at,
                   const CameraImuOptions& options);
  ~CameraImuProblem();

  /// Makes it anew around something else; paths and points stay as they are.
  void relinearize(const CameraImuLinearization& at);

  /// Solves from `unknowns`; the first time paths and points start from what fits best there. Residuals beyond
  /// `scale_px` count less (Cauchy). False when the solver fails.
  bool solve(SharedUnknowns& unknowns, const std::array<bool, shared::count>& fixed, double scale_px);

  /// Covariance of the shared unknowns, zero where fixed; after solve(). From the scores of the windows.
  Eigen::MatrixXd covariance() const;

  const std::vector<CameraImuCalibration::Residual>& residuals() const { return residuals_; }
  /// For tests of its derivatives; after solve(). Its first blocks are corners: shared unknowns, path, point.
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
  /// All that Ceres moves, in one piece: it orders by address, and the order decides the last bits.
  std::vector<double> numbers_;
  double scale_px_ = 1;
  std::array<bool, shared::count> fixed_{};
  std::unique_ptr<ceres::Problem> problem_;
  std::vector<ceres::ResidualBlockId> blocks_;  ///< by window, corner, frame; then each window's path
  std::vector<CameraImuCalibration::Residual> residuals_;
};

}  // namespace odograph
