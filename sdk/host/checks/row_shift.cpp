// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/checks/row_shift.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>

#include "sdk/host/checks/profiles.hpp"

namespace odograph {
namespace {

constexpr size_t kMost = 4096;  ///< pixels of a row
constexpr size_t kPairs = 8;    ///< of rows below each other

/// Mean difference of two rows, the lower one displaced to the right and continued on the other side.
double difference(const std::array<uint8_t, kMost>& above, const std::array<uint8_t, kMost>& below, size_t width,
                  size_t shift) {
  uint32_t sum = 0;
  for (size_t x = 0; x + shift < width; ++x) sum += static_cast<uint32_t>(std::abs(above[x] - below[x + shift]));
  for (size_t x = width - shift; x < width; ++x)
    sum += static_cast<uint32_t>(std::abs(above[x] - below[x + shift - width]));
  return static_cast<double>(sum) / static_cast<double>(width);
}

}  // namespace

std::optional<int> RowShift::add(const odo_frame& frame, const Eigen::Vector3d& turned_c) {
  if (until_next_-- > 0) return std::nullopt;
  until_next_ = p_.each - 1;
  const auto px = shift(frame);
  if (!px) return std::nullopt;
  if (*px != last_px_ || same_ == 0) same_ = 0, since_c_ = turned_c, last_px_ = *px;
  ++same_;
  const bool sure = *px == 0 || (turned_c - since_c_).norm() > p_.turned_rad;
  return same_ >= p_.in_a_row && sure ? px : std::nullopt;
}

/// The displacement on which most pairs of rows agree.
std::optional<int> RowShift::shift(const odo_frame& frame) const {
  const auto [offset, stride] = brightness(frame.format);
  const odo_plane& plane = frame.planes[0];
  const size_t width = frame.width;
  if (stride == 0 || !plane.data || width < kSmallest || width > kMost || frame.height < kSmallest) return std::nullopt;
  using Row = std::array<uint8_t, kMost>;
  const auto read = [&, offset = offset, stride = stride](uint32_t y, Row& row) {
    const uint8_t* from = plane.data + static_cast<int64_t>(y) * plane.row_stride + static_cast<int64_t>(offset);
    for (size_t x = 0; x < width; ++x) row[x] = from[x * stride];
  };
  Row above, below, far;
  std::array<int, kPairs> found{};
  for (uint32_t k = 0; k < kPairs; ++k) {
    const uint32_t y = (2 * k + 1) * frame.height / (2 * kPairs + 2);
    read(y, above), read(y + 1, below), read(y + frame.height / 8, far);
    const double stated = difference(above, below, width, 0);
    if (stated < p_.contrast || stated < p_.unlike_fraction * difference(above, far, width, 0)) continue;
    double least = p_.explained * stated;
    for (size_t displaced = 1; displaced < width; ++displaced)
      if (const double left = difference(above, below, width, displaced); left < least)
        least = left, found[k] = static_cast<int>(displaced > width / 2 ? displaced - width : displaced);
  }
  std::array<int, kPairs> sorted = found;
  std::ranges::nth_element(sorted, sorted.begin() + kPairs / 2);
  const int middle = sorted[kPairs / 2];
  if (std::ranges::count(found, middle) < p_.agreeing) return std::nullopt;
  return std::abs(middle) >= p_.min_px ? middle : 0;
}

}  // namespace odograph
