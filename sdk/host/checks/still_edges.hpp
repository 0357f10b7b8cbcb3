// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include <Eigen/Core>
#include <odograph/samples.h>

namespace odograph {

/// Finds what is drawn over a camera's pictures: edges that keep their place and, to the last bit, their brightness
/// while the camera turns about both axes of the picture. The scene's edges move then, and what moves with the camera
/// (a dashboard, a finger, dirt) has the sensor's noise. No allocation. Not thread-safe.
class StillEdges {
 public:
  struct Parameters {
    double turned_rad = 0.1;  ///< rad about each axis: 10 pixels of the smallest pictures; no car pitches as far
    double window_s = 10;     ///< s for this rotation, at most
    int pictures = 20;        ///< at which noise of 0.5 grey levels leaves one edge of 500,000 as it is
    int edge = 20;            ///< grey levels to the next sample; judgement
    double lasting = 0.8;     ///< share of the pictures that have the edge; judgement
    int black = 24;           ///< grey levels: a border without a picture is darker
    int least = 10;           ///< samples that stay still: more than a sensor has defective ones
    double moving = 0.5;      ///< share of the samples that change, otherwise the camera rests or is covered; judgement
  };

  /// Share of the picture's edges that stay still, once the camera has turned far enough; `turned_c` is its rotation
  /// since any fixed time, rad about its axes.
  std::optional<double> add(const odo_frame& frame, const Eigen::Vector3d& turned_c);
  void reset() { pictures_ = 0; }

 private:
  static constexpr size_t kColumns = 256, kRows = 64;
  /// A sample of the grid: its brightness in the first picture, and in how many pictures it had an edge; kChanged once
  /// its brightness has been another.
  struct Sample {
    uint8_t value, edges;
  };
  static constexpr uint8_t kChanged = 255;

  Parameters p_;
  std::array<Sample, kColumns * kRows> samples_{};
  uint32_t width_ = 0, height_ = 0;
  int pictures_ = 0;
  int64_t begun_ns_ = 0;
  Eigen::Vector3d low_c_ = Eigen::Vector3d::Zero(), high_c_ = Eigen::Vector3d::Zero();
};

}  // namespace odograph
