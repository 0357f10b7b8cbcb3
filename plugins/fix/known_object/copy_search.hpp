// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "plugins/fix/known_object/plane_object.hpp"
#include "plugins/fix/known_object/rolling_lens.hpp"

namespace odograph::known_object {

/// Sides of an object for a reader, as steps in units of its width and height.
inline constexpr int kSides = 4;
inline constexpr double kSideOffsets[kSides][2] = {{-1, 0}, {1, 0}, {0, -1}, {0, 1}};

/// Searches for further copies of a planar object in its own plane. The pose of the object gives the plane, so that
/// only a shift is unknown: half of a copy is enough, also in shadow and with much less detail than the general search
/// needs. Thread-safe.
class CopySearch {
 public:
  struct Parameters {
    double object_cells = 24;  ///< along the object's shorter side, of the rectified picture; bench
    double flatten = 0.2;   ///< of the shorter side: scale above which brightness and contrast are removed; empirical
    double max_gap = 0.25;  ///< of the object's width (height): copies at up to this gap count as neighbours
    double min_part = 0.3;  ///< share of a copy that must be in the frame; bench
    double copy_likeness = 0.7;     ///< correlation of a copy relative to the object's own; bench
    double unclear_likeness = 0.5;  ///< the same: above it the side is not clear; bench
    double min_likeness = 0.5;      ///< min correlation of the object itself for the comparison; bench
    double overlap = 0.9;           ///< of width or height: smaller shifts show the object itself
    double align = 0.2;             ///< of height or width: alignment of a neighbouring copy; empirical
    double contrast_grey = 2;       ///< lower contrast is noise; empirical
    double reach = 0.25;            ///< of the object's width (height), rectified beyond max_gap; empirical
    double blur = 0.5;              ///< of a cell's size in the frame
  };
  explicit CopySearch(const Parameters& parameters, const std::vector<PlaneObject>& objects);

  struct Result {
    bool has_copy = false;             ///< there is a second copy
    std::array<bool, kSides> clear{};  ///< a copy on this side would have been seen
    double self = 0, second = 0;       ///< correlations: of the object, of the best other position
    Eigen::Vector2d offset_m{0, 0};    ///< of the latter, in o
  };
  /// `pose`: of the object as found; `mask` may be empty.
  Result search(size_t object, const cv::Mat& grey, const cv::Mat& mask, const RollingLens& lens,
                const Pose& pose) const;

 private:
  struct Template {
    cv::Mat flat;  ///< the object alone, float
    double cell_x_m, cell_y_m;
  };
  /// A frame rectified to the plane of the object, the object in the middle.
  struct Rectified {
    cv::Mat picture, valid;  ///< float; valid: 1 inside the frame
    cv::Point object;        ///< the object's corner
  };
  std::optional<Rectified> rectify(const Template& known, const cv::Mat& grey, const cv::Mat& mask,
                                   const RollingLens& lens, const Pose& pose) const;
  /// Sides with something that resembles the object; the best other position is stored in `result`.
  std::array<bool, kSides> search_sides(const Template& known, const Rectified& flat, Result& result) const;
  /// Mean removed and divided by the local contrast, if `valid`.
  cv::Mat normalised(const cv::Mat& values, const cv::Mat& valid, double sigma_cells) const;

  Parameters p_;
  std::vector<Template> templates_;
};

}  // namespace odograph::known_object
