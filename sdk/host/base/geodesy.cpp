// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/base/geodesy.hpp"

#include <GeographicLib/Geocentric.hpp>

#include "sdk/math/scalar.hpp"

namespace odograph {
bool Geodesy::has_origin() const {
  const std::lock_guard lock(mutex_);
  return local_.has_value();
}

void Geodesy::set_origin(const std::array<double, 3>& g) {
  const std::lock_guard lock(mutex_);
  local_.emplace(g[0] / kRad_per_deg, g[1] / kRad_per_deg, g[2], GeographicLib::Geocentric::WGS84());
}

std::array<double, 3> Geodesy::to_geodetic(const std::array<double, 3>& p_n) const {
  const std::lock_guard lock(mutex_);
  double latitude = 0, longitude = 0, height = 0;
  local_->Reverse(p_n[1], p_n[0], -p_n[2], latitude, longitude, height);  // GeographicLib's frame is East-North-Up
  return {latitude * kRad_per_deg, longitude * kRad_per_deg, height};
}

std::array<double, 3> Geodesy::from_geodetic(const std::array<double, 3>& g) const {
  const std::lock_guard lock(mutex_);
  double east = 0, north = 0, up = 0;
  local_->Forward(g[0] / kRad_per_deg, g[1] / kRad_per_deg, g[2], east, north, up);
  return {north, east, -up};
}

void Geodesy::resolve(odo_fix& fix) {
  if ((fix.header.flags & ODO_FIX_GEODETIC) == 0) return;
  const std::array<double, 3> geodetic{fix.latitude_rad, fix.longitude_rad, fix.height_m};
  if (!has_origin()) set_origin(geodetic);
  const auto p_n = from_geodetic(geodetic);
  std::copy(p_n.begin(), p_n.end(), fix.p_n);
  fix.header.flags |= ODO_FIX_NORTH | ODO_FIX_EAST;
}

}  // namespace odograph
