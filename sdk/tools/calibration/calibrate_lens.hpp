// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "sdk/host/base/result.hpp"
#include "sdk/tools/calibration/board.hpp"
#include "sdk/tools/calibration/lens_model.hpp"

namespace odograph {

struct LensOptions {
  Lens lens = Lens::pinhole;
  int coefficients = 5;  ///< of the pinhole's distortion: 0, 4, 5 or 8; Kannala-Brandt has 4
  /// A picture is rejected if its rms residual exceeds that of the median picture by this factor (and 0.5 px).
  double reject = 3;
};

/// Intrinsics of a camera, their standard deviations, and the residuals of each picture.
struct LensCalibration {
  Lens lens = Lens::pinhole;
  cv::Size size;
  double fx = 0, fy = 0, cx = 0, cy = 0;                          ///< px; the first pixel's centre is (0, 0)
  std::vector<double> distortion;                                 ///< OpenCV's order
  double sigma_fx = 0, sigma_fy = 0, sigma_cx = 0, sigma_cy = 0;  ///< px, one standard deviation
  double rms_px = 0;                                              ///< over all corners of the pictures used

  struct Picture {
    std::string name;
    bool used = true;
    double rms_px = 0;
    double tilt_rad = 0;  ///< between the board's normal and the optical axis
    std::vector<cv::Point2f> pixels;
    std::vector<cv::Point2d> residuals_px;  ///< measured minus modelled
  };
  std::vector<Picture> pictures;

  double covered() const;          ///< fraction of the cells of an 8 x 6 grid over the picture that contain a corner
  double widest_tilt_rad() const;  ///< among the pictures used
};

/// Joint least-squares estimate of the intrinsics and the board poses (Zhang, PAMI 2000, section 3.3) with Ceres and a
/// Huber loss, initialised with the undistorted lens for which the boards are most planar. Models as in OpenCV: pinhole
/// with radial-tangential distortion, and Kannala & Brandt 2006. Requires three views. Failures state what is missing
/// (ODO_E_DATA).
Result<LensCalibration> calibrate_lens(const std::vector<BoardView>& views, cv::Size size, const LensOptions& options);

/// Warnings about the result: too few pictures, edges not covered, no tilt, large residuals.
std::vector<std::string> warnings_about(const LensCalibration& calibration);

/// Formats camera.yaml (docs/recording.md).
std::string camera_yaml(const LensCalibration& calibration);

}  // namespace odograph
