// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "plugins/fix/known_object/plane_object.hpp"
#include "plugins/fix/known_object/rolling_lens.hpp"

namespace odograph::known_object {

/// Sides of an object as one reads it, and the path there in units of its width and height.
inline constexpr int kSides = 4;
inline constexpr double kSideways[kSides][2] = {{-1, 0}, {1, 0}, {0, -1}, {0, 1}};

/// Looks for further copies of a flat object in its own plane. Who has found one copy knows the plane: a second one has
/// only to be shifted, and is recognised by the half of it, in a shadow and by far fewer details than the search for
/// any pose needs. Pure; any thread.
class Surroundings {
 public:
  struct Parameters {
    double object_cells = 24;    ///< along the object's shorter side, of the picture laid flat; bench
    double flatten = 0.2;        ///< of the shorter side: light and contrast wider than that are taken off; judgement
    double max_gap = 0.25;       ///< of the object's width (height): copies that hang so near count as beside it
    double min_part = 0.3;       ///< of a copy that must be in the picture; bench
    double twin_likeness = 0.7;  ///< of a copy, against that of the object itself; bench
    double doubtful = 0.5;       ///< likewise: what resembles it so far leaves its side open; bench
    double min_likeness = 0.5;   ///< of the object itself, to recognise others by; bench
    double overlap = 0.9;        ///< of width or height: nearer places show the object itself
    double align = 0.2;          ///< of height or width: what hangs beside hangs at its height; judgement
    double contrast_grey = 2;    ///< noise is no pattern; judgement
    double reach = 0.25;         ///< of the object's width (height), beyond max_gap: how far is laid flat; judgement
    double blur = 0.5;           ///< of what a cell covers in the frame
  };
  explicit Surroundings(const Parameters& parameters, const std::vector<PlaneObject>& objects);

  struct Seen {
    bool twin = false;                 ///< a second copy is there
    std::array<bool, kSides> clear{};  ///< a copy beside it, on this side, would have been seen
    double self = 0, second = 0;       ///< correlations: of the object, of the best other place
    Eigen::Vector2d offset_m{0, 0};    ///< of the latter, in o
  };
  /// `pose` is the object's as it was found; `mask` may be empty.
  Seen look(size_t object, const cv::Mat& grey, const cv::Mat& mask, const RollingLens& lens, const Pose& pose) const;

 private:
  struct Known {
    cv::Mat flat;  ///< the object by itself, float
    double cell_x_m, cell_y_m;
  };
  /// A frame laid flat in the object's plane, the object in the middle.
  struct Flat {
    cv::Mat picture, valid;  ///< float; valid: 1 where the frame shows it
    cv::Point object;        ///< the object's corner
  };
  std::optional<Flat> lay_flat(const Known& known, const cv::Mat& grey, const cv::Mat& mask, const RollingLens& lens,
                               const Pose& pose) const;
  /// Sides on which something resembles the object; the best other place goes into `result`.
  std::array<bool, kSides> look_beside(const Known& known, const Flat& flat, Seen& result) const;
  /// Less its mean and over its contrast round about, where `valid`.
  cv::Mat flattened(const cv::Mat& values, const cv::Mat& valid, double sigma_cells) const;

  Parameters p_;
  std::vector<Known> known_;
};

}  // namespace odograph::known_object
