// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/skyline/binary_sky.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace odograph::skyline {

/// The rows whose middle lies above an elevation.
BinarySky::Column BinarySky::rows_above(double elevation_rad) {
  const auto first = static_cast<size_t>(std::clamp(std::floor(elevation_rad / kRow_rad + 0.5), 0.0, double(kRows)));
  Column rows{};
  for (size_t w = 0; w < kWords; ++w) {
    const size_t from = std::clamp<size_t>(first, 64 * w, 64 * (w + 1)) - 64 * w;
    rows[w] = from == 64 ? 0 : ~uint64_t{0} << from;
  }
  return rows;
}

BinarySky::BinarySky(const std::array<float, kColumns>& elevation_rad) {
  for (size_t j = 0; j < elevation_rad.size(); ++j) {
    sky_[j] = rows_above(static_cast<double>(elevation_rad[j]));
    seen_[j].fill(~uint64_t{0});
  }
}

void BinarySky::add(double azimuth_rad, double elevation_rad, bool open, bool below) {
  const double turns = azimuth_rad / (2 * std::numbers::pi);
  const auto column = static_cast<size_t>((turns - std::floor(turns)) * kColumns) % kColumns;
  sky_[column] = rows_above(elevation_rad);
  for (size_t w = 0; w < kWords; ++w) seen_[column][w] = (open ? 0 : ~sky_[column][w]) | (below ? 0 : sky_[column][w]);
}

size_t BinarySky::pixels_seen() const {
  size_t n = 0;
  for (const Column& column : seen_)
    for (const uint64_t word : column) n += static_cast<size_t>(std::popcount(word));
  return n;
}

size_t BinarySky::columns_seen() const {
  return static_cast<size_t>(std::count_if(seen_.begin(), seen_.end(), [](const Column& c) { return c != Column{}; }));
}

double cross_correlation(const BinarySky& camera, const BinarySky& model) {
  int64_t n = 0, equal = 0;
  for (size_t j = 0; j < camera.sky_.size(); ++j)
    for (size_t w = 0; w < BinarySky::kWords; ++w) {
      const uint64_t seen = camera.seen_[j][w];
      n += std::popcount(seen);
      equal += std::popcount(~(camera.sky_[j][w] ^ model.sky_[j][w]) & seen);
    }
  return n > 0 ? static_cast<double>(2 * equal - n) / static_cast<double>(n) : 0.0;
}

}  // namespace odograph::skyline
