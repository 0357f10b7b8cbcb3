// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "plugins/fix/map/place_types.hpp"

namespace odograph::place_map {

/// Whether a frame is worth a key frame: by motion since the last one, relative to the distance of what is seen, and by
/// the share of landmarks that the last one does not have.
class KeyFrameChooser {
 public:
  struct Parameters {
    double shortest_s = 0.5;    ///< between two key frames
    double parallax_rad = 0.2;  ///< motion over the landmarks' median distance: 11 degrees, within BRIEF's tolerance
    double rotation_rad = 0.3;  ///< rotation: a quarter of a phone's picture
    double new_share = 0.5;     ///< of the landmarks
    size_t fewest = 20;         ///< landmarks of a key frame
  };

  KeyFrameChooser() = default;
  explicit KeyFrameChooser(const Parameters& parameters) : p_(parameters) {}

  /// Whether to add this frame, which is then the last one. `T_w_c`: in any frame that is smooth since the last one.
  bool choose(int64_t t_ns, const Rigid& T_w_c, std::span<const Landmark> landmarks);
  void forget() { last_.reset(); }

 private:
  struct Last {
    int64_t t_ns;
    Rigid T_w_c;
    std::vector<uint64_t> ids;  // sorted
  };
  Parameters p_;
  std::optional<Last> last_;
};

}  // namespace odograph::place_map
