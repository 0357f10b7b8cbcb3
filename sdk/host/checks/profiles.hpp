// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>

#include <Eigen/Core>
#include <odograph/samples.h>

namespace odograph {

/// Width and height of the smallest picture that checks look at, pixels.
constexpr uint32_t kSmallest = 64;

/// Offset and stride of a brightness in a row; stride 0 if the format has none.
std::pair<size_t, size_t> brightness(uint32_t format);

/// Row and column sums of a picture's brightness, without their slow part: enough for the shift between two pictures.
class Profiles {
 public:
  static constexpr size_t kMost = 256;
  struct Profile {
    std::array<float, kMost> value{};
    size_t count = 0;
    double pixels = 1;  ///< of one value
  };
  /// False without brightness in memory, or with hardly any contrast.
  bool take(const odo_frame& frame, double min_contrast);
  /// Shift of the content from an earlier picture to this one, pixels of the picture; NaN along an axis where they do
  /// not resemble each other.
  Eigen::Vector2d shift_since(const Profiles& earlier, double min_likeness) const;

 private:
  Profile x_, y_;
};

}  // namespace odograph
