// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/checks/profiles.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace odograph {

using Eigen::Vector2d;

std::pair<size_t, size_t> brightness(uint32_t format) {
  switch (format) {
    case ODO_FORMAT_GREY8:
    case ODO_FORMAT_NV12:
    case ODO_FORMAT_NV21:
    case ODO_FORMAT_YUV420: return {0, 1};
    case ODO_FORMAT_RGB8: return {1, 3};  // green
    case ODO_FORMAT_RGBA8:
    case ODO_FORMAT_BGRA8: return {1, 4};
    default: return {0, 0};
  }
}

namespace {

/// Removes the slow part and scales to unit power. Returns the root mean square before.
double normalise(Profiles::Profile& p) {
  constexpr size_t kHalf = 8;
  std::array<float, Profiles::kMost + 1> sums{};
  std::partial_sum(p.value.begin(), p.value.begin() + p.count, sums.begin() + 1);
  double power = 0;
  for (size_t i = 0; i < p.count; ++i) {
    const size_t low = i < kHalf ? 0 : i - kHalf, high = std::min(p.count, i + kHalf + 1);
    p.value[i] -= (sums[high] - sums[low]) / static_cast<float>(high - low);
  }
  for (size_t i = 0; i < p.count; ++i) power += double(p.value[i]) * p.value[i];
  const double rms = std::sqrt(power / static_cast<double>(std::max<size_t>(p.count, 1)));
  if (rms > 0)
    for (size_t i = 0; i < p.count; ++i) p.value[i] /= static_cast<float>(rms);
  return rms;
}

/// Sums of the squares before each value.
using Squares = std::array<float, Profiles::kMost + 1>;

Squares squares(const Profiles::Profile& p) {
  Squares sums{};
  for (size_t i = 0; i < p.count; ++i) sums[i + 1] = sums[i] + p.value[i] * p.value[i];
  return sums;
}

/// Mean product of b, shifted, with a: 1 if they are the same.
double likeness(const Profiles::Profile& a, const Profiles::Profile& b, int shift, const Squares& aa,
                const Squares& bb) {
  const int n = static_cast<int>(a.count), from = std::max(0, -shift), to = std::min(n, n - shift);
  float sum = 0;
  for (int i = from; i < to; ++i) sum += a.value[static_cast<size_t>(i)] * b.value[static_cast<size_t>(i + shift)];
  const auto between = [](const Squares& sums, int first, int end) {
    return double(sums[static_cast<size_t>(end)]) - double(sums[static_cast<size_t>(first)]);
  };
  const double power = between(aa, from, to) * between(bb, from + shift, to + shift);
  return power > 0 ? double(sum) / std::sqrt(power) : 0;
}

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

double shift_between(const Profiles::Profile& a, const Profiles::Profile& b, double min_likeness) {
  if (a.count != b.count || a.count < 32) return kUnknown;
  const int most = static_cast<int>(a.count / 4);
  int best = 0;
  double max_likeness = -1;
  const Squares aa = squares(a), bb = squares(b);
  for (int shift = -most; shift <= most; ++shift)
    if (const double like = likeness(a, b, shift, aa, bb); like > max_likeness) max_likeness = like, best = shift;
  if (max_likeness < min_likeness || std::abs(best) == most) return kUnknown;
  const double before = likeness(a, b, best - 1, aa, bb), after = likeness(a, b, best + 1, aa, bb);
  const double bend = before - 2 * max_likeness + after, part = bend < 0 ? 0.5 * (before - after) / bend : 0;
  return (best + std::clamp(part, -0.5, 0.5)) * a.pixels;
}

}  // namespace

bool Profiles::take(const odo_frame& frame, double min_contrast) {
  const auto [offset, stride] = brightness(frame.format);
  const odo_plane& plane = frame.planes[0];
  if (stride == 0 || !plane.data || frame.width < kSmallest || frame.height < kSmallest) return false;
  const size_t step = std::max<size_t>(1, std::max(frame.width, frame.height) / kMost + 1);
  x_.count = std::min<size_t>(kMost, frame.width / step), y_.count = std::min<size_t>(kMost, frame.height / step);
  x_.pixels = y_.pixels = static_cast<double>(step);
  x_.value.fill(0), y_.value.fill(0);
  for (size_t r = 0; r < y_.count; ++r) {
    const uint8_t* row = plane.data + static_cast<int64_t>(r * step) * plane.row_stride + offset;
    uint32_t sum = 0;
    for (size_t c = 0; c < x_.count; ++c) {
      const uint32_t value = row[c * step * stride];
      sum += value, x_.value[c] += static_cast<float>(value);
    }
    y_.value[r] = static_cast<float>(sum) / static_cast<float>(x_.count);
  }
  for (size_t c = 0; c < x_.count; ++c) x_.value[c] /= static_cast<float>(y_.count);
  const double contrast_x = normalise(x_), contrast_y = normalise(y_);
  return std::min(contrast_x, contrast_y) >= min_contrast;
}

Vector2d Profiles::shift_since(const Profiles& earlier, double min_likeness) const {
  return {shift_between(earlier.x_, x_, min_likeness), shift_between(earlier.y_, y_, min_likeness)};
}

}  // namespace odograph
