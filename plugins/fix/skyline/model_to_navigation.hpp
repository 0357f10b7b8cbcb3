// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <stdexcept>
#include <string>

#include <GeographicLib/LocalCartesian.hpp>

#include "plugins/fix/skyline/city_outline.hpp"
#include "plugins/shared/projection.hpp"

namespace odograph::skyline {

/// Transformation from a model's easting, northing and height to n.
class ModelToNavigation {
 public:
  /// Throws std::runtime_error where a geodetic origin needs an unsupported reference system. `epsg` 0: the file names
  /// none.
  ModelToNavigation(const CityPlacement& placement, int epsg, const std::string& name) : p_(placement) {
    if (!p_.geodetic) return;
    projection_ = Projection::of(epsg);
    if (!projection_)
      throw std::runtime_error(
          name +
          (epsg == 0 ? std::string(": the model states no reference system with an EPSG code")
                     : ": the model's reference system (EPSG " + std::to_string(epsg) + ") is not supported") +
          ", so that latitude and longitude cannot be converted to its coordinates");
    local_.Reset(p_.geodetic_origin[0], p_.geodetic_origin[1], p_.geodetic_origin[2]);
  }

  Eigen::Vector3d operator()(const Eigen::Vector3d& at) const {
    if (!projection_) {
      const Eigen::Vector3d d = at - Eigen::Vector3d(p_.model_origin.data());
      return {d.y(), d.x(), -d.z()};
    }
    const Geodetic g = projection_->geodetic({at.x(), at.y()});
    double east = 0, north = 0, up = 0;
    local_.Forward(g.latitude_deg, g.longitude_deg, at.z() + p_.geoid_height_m, east, north, up);
    return {north, east, -up};
  }

 private:
  CityPlacement p_;
  std::optional<Projection> projection_;
  GeographicLib::LocalCartesian local_;
};

}  // namespace odograph::skyline
