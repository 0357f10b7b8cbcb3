// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/checks/still_edges.hpp"

#include <algorithm>
#include <cstdlib>

#include "sdk/host/base/saturating.hpp"
#include "sdk/host/checks/profiles.hpp"
#include "sdk/math/time.hpp"

namespace odograph {

std::optional<double> StillEdges::add(const odo_frame& frame, const Eigen::Vector3d& turned_c) {
  const auto [offset, stride] = brightness(frame.format);
  const odo_plane& plane = frame.planes[0];
  if (stride == 0 || !plane.data || frame.width < kSmallest || frame.height < kSmallest) return std::nullopt;
  const bool same_size = frame.width == width_ && frame.height == height_;
  const double age_s = seconds(saturating_difference(frame.header.t_ns, begun_ns_));
  if (pictures_ == 0 || pictures_ == kChanged - 1 || !same_size || age_s < 0 || age_s > p_.window_s) {
    pictures_ = 0, begun_ns_ = frame.header.t_ns, width_ = frame.width, height_ = frame.height;
    low_c_ = high_c_ = turned_c;
  }
  low_c_ = low_c_.cwiseMin(turned_c), high_c_ = high_c_.cwiseMax(turned_c);
  const bool first = pictures_++ == 0;
  const size_t across = width_ / kColumns + 1, down = height_ / kRows + 1;
  const size_t columns = width_ / across - 1, rows = height_ / down - 1;
  int edges = 0, still = 0, changed = 0;
  for (size_t r = 0; r < rows; ++r) {
    const uint8_t* row = plane.data + static_cast<int64_t>(r * down) * plane.row_stride + offset;
    const uint8_t* below = row + static_cast<int64_t>(down) * plane.row_stride;
    Sample* samples = &samples_[r * columns];
    for (size_t c = 0; c < columns; ++c) {
      const size_t at = c * across * stride;
      const int value = row[at];
      const bool edge =
          std::abs(value - row[at + across * stride]) >= p_.edge || std::abs(value - below[at]) >= p_.edge;
      Sample& sample = samples[c];
      if (first) sample = {row[at], 0};
      if (sample.value != value) sample.edges = kChanged;
      if (sample.edges != kChanged) sample.edges = static_cast<uint8_t>(sample.edges + edge);
      edges += edge, changed += sample.edges == kChanged;
      still += sample.edges != kChanged && sample.edges >= p_.lasting * pictures_ && value > p_.black;
    }
  }
  const Eigen::Vector3d turned = high_c_ - low_c_;
  if (pictures_ < p_.pictures || std::min(turned.x(), turned.y()) < p_.turned_rad) return std::nullopt;
  pictures_ = 0;
  const double all = static_cast<double>(columns * rows);
  if (changed < p_.moving * all || edges == 0) return std::nullopt;
  return still < p_.least ? 0 : static_cast<double>(still) / edges;
}

}  // namespace odograph
