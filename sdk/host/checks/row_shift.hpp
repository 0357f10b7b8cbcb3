// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include <Eigen/Core>
#include <odograph/samples.h>

namespace odograph {

/// Finds pictures that are read with a wrong distance from row to row: each row continues the one above displaced by
/// the same number of pixels, and what leaves on one side comes in on the other. No allocation. Not thread-safe.
class RowShift {
 public:
  struct Parameters {
    int each = 10;        ///< one of so many pictures is looked at
    int agreeing = 6;     ///< of the eight pairs of rows; the others may show plain walls or sky
    int min_px = 8;       ///< alignments are multiples of 8 or more; slanted parallel lines have less
    double contrast = 3;  ///< grey levels by which neighbours differ at least, in the mean
    double unlike_fraction =
        0.3;                  ///< of the difference to a row an eighth of the picture below; less in a right picture
    double explained = 0.35;  ///< of the difference that the displacement leaves; judgement
    int in_a_row = 3;         ///< pictures with the same displacement ...
    double turned_rad = 0.2;  ///< ... while the phone turns by this, rad, which changes what slanted lines show ...
    double within_s = 5;      ///< ... in this time, s: no bias of a phone at rest
    int searches = 2;         ///< of a displacement in a picture, at most: one of 1920 pixels takes 1 ms
  };

  /// `turned_c`: integral of the camera's rate, rad. Returns the displacement in pixels once it is sure, 0 where there
  /// is none; nothing while neither is known.
  std::optional<int> add(const odo_frame& frame, const Eigen::Vector3d& turned_c);

 private:
  std::optional<int> shift(const odo_frame& frame) const;

  Parameters p_;
  int until_next_ = 0, last_px_ = 0, same_ = 0;
  int64_t since_ns_ = 0;
  Eigen::Vector3d since_c_ = Eigen::Vector3d::Zero();
};

}  // namespace odograph
