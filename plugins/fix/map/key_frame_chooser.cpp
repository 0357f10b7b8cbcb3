// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/map/key_frame_chooser.hpp"

#include <algorithm>

namespace odograph::place_map {

bool KeyFrameChooser::choose(int64_t t_ns, const Rigid& T_w_c, std::span<const Landmark> landmarks) {
  if (landmarks.size() < p_.fewest) return false;
  if (last_) {
    if (static_cast<double>(t_ns - last_->t_ns) < 1e9 * p_.shortest_s && t_ns >= last_->t_ns) return false;
    std::vector<double> distances;
    size_t known = 0;
    for (const Landmark& landmark : landmarks) {
      distances.push_back(landmark.p_c.norm());
      known += std::binary_search(last_->ids.begin(), last_->ids.end(), landmark.id) ? 1 : 0;
    }
    const auto middle = distances.begin() + static_cast<ptrdiff_t>(distances.size() / 2);
    std::nth_element(distances.begin(), middle, distances.end());
    const bool moved = (T_w_c.p - last_->T_w_c.p).norm() > p_.parallax_rad * *middle;
    const bool turned = T_w_c.q.angularDistance(last_->T_w_c.q) > p_.rotation_rad;
    const bool is_new = static_cast<double>(known) < (1 - p_.new_share) * static_cast<double>(landmarks.size());
    if (!moved && !turned && !is_new) return false;
  }
  last_ = Last{t_ns, T_w_c, {}};
  for (const Landmark& landmark : landmarks) last_->ids.push_back(landmark.id);
  std::sort(last_->ids.begin(), last_->ids.end());
  return true;
}

}  // namespace odograph::place_map
