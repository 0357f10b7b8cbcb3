// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/checks/row_shift.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>

#include "sdk/host/base/saturating.hpp"
#include "sdk/host/checks/profiles.hpp"
#include "sdk/math/time.hpp"

namespace odograph {
namespace {

constexpr size_t kLongestRow = 4096;  ///< pixels of a row
constexpr size_t kRowPairs = 8;       ///< of rows below each other

using RowPixels = std::array<uint8_t, kLongestRow>;

/// Mean difference of two rows, the lower one displaced to the right and continued on the other side; more than `limit`
/// if it is.
double difference(const RowPixels& above, const RowPixels& below, size_t width, size_t displaced, double limit = 256) {
  constexpr size_t kPart = 64;
  const double most = limit * static_cast<double>(width);
  uint32_t sum = 0;
  for (size_t from = 0; from < width && sum <= most; from += kPart)
    for (size_t x = from; x < std::min(width, from + kPart); ++x) {
      const size_t at = x + displaced < width ? x + displaced : x + displaced - width;
      sum += static_cast<uint32_t>(std::abs(above[x] - below[at]));
    }
  return static_cast<double>(sum) / static_cast<double>(width);
}

/// The displacement that leaves least of a difference, below a limit; 0 if none does.
size_t best_displacement(const RowPixels& above, const RowPixels& below, size_t width, double limit) {
  size_t best = 0;
  for (size_t displaced = 1; displaced < width; ++displaced)
    if (const double left = difference(above, below, width, displaced, limit); left < limit)
      limit = left, best = displaced;
  return best;
}

}  // namespace

std::optional<int> RowShift::add(const odo_frame& frame, const Eigen::Vector3d& turned_c) {
  if (until_next_-- > 0) return std::nullopt;
  until_next_ = p_.each - 1;
  const auto px = shift(frame);
  if (!px) return std::nullopt;
  const bool expired = seconds(saturating_difference(frame.header.t_ns, since_ns_)) > p_.within_s;
  if (*px != last_px_ || same_ == 0 || expired)
    same_ = 0, since_c_ = turned_c, since_ns_ = frame.header.t_ns, last_px_ = *px;
  ++same_;
  const bool sure = *px == 0 || (turned_c - since_c_).norm() > p_.turned_rad;
  return same_ >= p_.in_a_row && sure ? px : std::nullopt;
}

/// The displacement on which most pairs of rows agree.
std::optional<int> RowShift::shift(const odo_frame& frame) const {
  const auto [offset, stride] = brightness(frame.format);
  const odo_plane& plane = frame.planes[0];
  const size_t width = frame.width;
  if (stride == 0 || !plane.data || width < kSmallest || width > kLongestRow || frame.height < kSmallest)
    return std::nullopt;
  const auto read = [&, offset = offset, stride = stride](uint32_t y, RowPixels& row) {
    const uint8_t* from = plane.data + static_cast<int64_t>(y) * plane.row_stride + static_cast<int64_t>(offset);
    for (size_t x = 0; x < width; ++x) row[x] = from[x * stride];
  };
  RowPixels above, below, far;
  size_t displaced = 0;
  int right = 0, agreeing = 0, searches = 0;
  for (uint32_t k = 0; k < kRowPairs; ++k) {
    const uint32_t y = (2 * k + 1) * frame.height / (2 * kRowPairs + 2);
    read(y, above), read(y + 1, below), read(y + frame.height / 8, far);
    const double stated = difference(above, below, width, 0);
    if (stated < p_.contrast) continue;  // a wall, or the sky
    if (stated < p_.unlike_fraction * difference(above, far, width, 0)) {
      ++right;
    } else if (displaced == 0 && searches < p_.searches) {
      displaced = best_displacement(above, below, width, p_.explained * stated), ++searches;
      agreeing = displaced != 0;
    } else if (displaced != 0) {
      agreeing += difference(above, below, width, displaced) < p_.explained * stated;
    }
  }
  const int px = static_cast<int>(displaced) - (displaced > width / 2 ? static_cast<int>(width) : 0);
  if (right >= p_.agreeing) return 0;
  return agreeing >= p_.agreeing && std::abs(px) >= p_.min_px ? std::optional(px) : std::nullopt;
}

}  // namespace odograph
