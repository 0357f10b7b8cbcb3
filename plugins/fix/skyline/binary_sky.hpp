// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <numbers>

#include "plugins/fix/skyline/horizon.hpp"

namespace odograph::skyline {

/// The binary image of a skyline, eq. (3) of Gakne & O'Keefe 2018: sky or no sky, over the azimuths of eq. (2) and the
/// elevations from the horizon to the zenith. A picture shows some of the pixels only; a city model all of them.
class BinarySky {
 public:
  static constexpr int kColumns = Horizon::kDirections, kRows = 256;
  static constexpr double kRow_rad = 0.5 * std::numbers::pi / kRows;

  BinarySky() = default;  ///< no pixel is seen
  explicit BinarySky(const std::array<float, kColumns>& elevation_rad);
  /// Fills the column of an azimuth: sky above the elevation. Nothing is seen below an `open` edge, nor above an edge
  /// that the picture begins `below`.
  void add(double azimuth_rad, double elevation_rad, bool open, bool below);
  bool is_sky(size_t column, size_t row) const { return bit(sky_[column], row); }
  bool is_seen(size_t column, size_t row) const { return bit(seen_[column], row); }
  size_t pixels_seen() const;
  size_t columns_seen() const;

  /// CC = 1/n sum of I_cam o I_3D over the n pixels that the camera sees, with I = 1 in the sky and -1 elsewhere, so
  /// that CC is 1 for equal images. With 0 in place of -1 the best place of all would be one without any building.
  friend double cross_correlation(const BinarySky& camera, const BinarySky& model);

 private:
  static constexpr size_t kWords = kRows / 64;
  using Column = std::array<uint64_t, kWords>;
  static bool bit(const Column& column, size_t row) { return (column[row / 64] >> (row % 64) & 1) != 0; }
  static Column rows_above(double elevation_rad);

  std::array<Column, kColumns> sky_{}, seen_{};
};

double cross_correlation(const BinarySky& camera, const BinarySky& model);

}  // namespace odograph::skyline
