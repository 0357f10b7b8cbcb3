// SPDX-License-Identifier: Apache-2.0
//
// Corners of a picture in several octaves and their descriptors: BRIEF (Calonder et al. 2010) on the tangent plane of
// each ray, upright by gravity. Scales are angular, so that lens, size and rotation of the picture do not matter.
#pragma once

#include <optional>
#include <vector>

#include "plugins/fix/map/place_types.hpp"

namespace odograph::place_map {

struct FeatureParameters {
  double finest_focal_px = 400;  ///< focal length of the finest level: 0.14 degrees a pixel; VGA phones have 500
  double ratio = 1.26;           ///< of one level to the next, three to an octave; BRIEF tolerates 15 % (Calonder 2010)
  int levels = 6;                ///< of a query: closer by up to 3.2
  int second_level = 3;          ///< of a landmark's second descriptor: one octave, for views from farther away
  int max_corners = 500;         ///< at the finest level; fewer at the others by their area
  double quality = 0.005;        ///< min response relative to the best corner, half of the front-end's
  double min_distance_px = 8;    ///< between corners of a level
  double min_vertical_sine =
      0.25;                        ///< of ray and gravity: nearer than 15 degrees to it there is no "up" in the picture
  double max_off_axis_rad = 1.05;  ///< 60 degrees, where lens models end to be calibrated
};

struct Feature {
  Eigen::Vector3d ray_c;  ///< unit vector
  Eigen::Vector2d pixel;
  Descriptor descriptor;
  int level;
  double sigma_rad;  ///< of the ray, one pixel of its level
};

/// The levels of one picture, blurred, ready to be described.
class PictureLevels {
 public:
  PictureLevels(const Picture& picture, const FeatureParameters& parameters);

  /// Corners of all levels, the finest first.
  std::vector<Feature> features() const;
  /// Descriptor of a pixel of the picture at a level; nothing where patch or gravity do not allow one.
  std::optional<Descriptor> describe(const Eigen::Vector2d& pixel, int level) const;

 private:
  struct Level {
    cv::Mat grey, blurred;
    double scale = 0;     ///< pixels of this level per pixel of the picture; 0: finer than the picture
    double focal_px = 0;  ///< nominal, of the pattern
  };
  Eigen::Vector2d at_level(const Eigen::Vector2d& pixel, const Level& level) const {
    return (pixel.array() + 0.5) * level.scale - 0.5;
  }
  std::optional<Descriptor> describe(const Eigen::Vector3d& ray, const Eigen::Vector2d& pixel,
                                     const Level& level) const;
  void add_corners(int index, std::vector<Feature>& features) const;

  const Picture& picture_;
  FeatureParameters p_;
  std::vector<Level> levels_;
};

/// Unit rays of pixels; a ray too far off the axis is zero.
std::vector<Eigen::Vector3d> rays_of(const CameraModel& lens, const std::vector<cv::Point2f>& pixels,
                                     double max_off_axis_rad);

}  // namespace odograph::place_map
