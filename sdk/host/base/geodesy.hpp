// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <mutex>
#include <optional>

#include <GeographicLib/LocalCartesian.hpp>
#include <odograph/types.h>

namespace odograph {

/// The local frame n (North-East-Down), georeferenced. Accurate to nanometres (GeographicLib::LocalCartesian, WGS 84;
/// Karney 2011). Angles in rad, heights in m above the ellipsoid. Thread-safe.
class Geodesy {
 public:
  bool has_origin() const;
  void set_origin(const std::array<double, 3>& latitude_longitude_height);
  /// Both require an origin.
  std::array<double, 3> to_geodetic(const std::array<double, 3>& p_n) const;
  std::array<double, 3> from_geodetic(const std::array<double, 3>& latitude_longitude_height) const;
  /// Computes p_n of a geodetic fix. Without an origin, the first such fix sets it.
  void resolve(odo_fix& fix);

 private:
  mutable std::mutex mutex_;
  std::optional<GeographicLib::LocalCartesian> local_;
};

}  // namespace odograph
