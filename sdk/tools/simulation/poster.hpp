// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Geometry>
#include <opencv2/core.hpp>

#include <odograph/types.h>

namespace odograph {

/// Picture of a notice board (8-bit grey): a header, a plan, a photograph and columns of text. `layout` determines
/// positions and header text, `content` everything else: boards of one layout look alike.
cv::Mat poster_picture(uint64_t layout, uint64_t content, cv::Size size_px);

/// The poster beside a simulated walk; its longer side has 1024 pixels.
cv::Mat poster_on_wall(uint64_t number, double aspect);

/// The tag on a board of the size of its black border (8-bit grey).
cv::Mat tag_board_picture(uint32_t tag, int side_px);

/// A flat picture in front of a camera: x right, y down, origin at its centre.
struct FlatPicture {
  cv::Mat grey;
  double width_m = 0, height_m = 0;
  Eigen::Isometry3d T_c_o;
};

/// A camera facing flat pictures on a wall: lens, rolling shutter, motion blur, uneven light, vignetting, noise.
/// Without ray casting, so that ten thousand frames are cheap.
class PosterCamera {
 public:
  explicit PosterCamera(const odo_calibration& lens);

  struct Shot {
    Eigen::Vector3d rate_c = Eigen::Vector3d::Zero();      ///< of the camera, rad/s
    Eigen::Vector3d velocity_c = Eigen::Vector3d::Zero();  ///< m/s
    double line_time_s = 30e-6, exposure_s = 8e-3;
    double light = 0.8, slope = 0.2, shadow = 1;  ///< gain, its gradient over the picture, gain beyond a slanting edge
    double noise = 2;                             ///< grey values
    uint64_t seed = 1;
  };
  /// The first picture is behind the others. `T_c_o` is valid at the middle row.
  cv::Mat take(const std::vector<FlatPicture>& pictures, const Shot& shot) const;
  /// Whether the whole picture is in the frame, with a margin.
  bool sees(const FlatPicture& picture, double margin_px) const;
  Eigen::Vector2d project(const Eigen::Vector3d& p_c) const;

 private:
  cv::Rect reach(const FlatPicture& picture) const;
  void look_up(const FlatPicture& picture, const Shot& shot, int samples, const cv::Rect& box, const cv::Size& texture,
               cv::Mat& map_x, cv::Mat& map_y) const;
  void paint(const FlatPicture& picture, const Shot& shot, int samples, cv::Mat& light) const;
  odo_calibration lens_;
  cv::Mat rays_;  // two floats per pixel: x/z, y/z
};

}  // namespace odograph
