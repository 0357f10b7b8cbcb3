// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <GeographicLib/LocalCartesian.hpp>

#include "plugins/fix/skyline/city_outline.hpp"
#include "plugins/shared/reference_system.hpp"

namespace odograph::skyline {

/// Transformation from a model's coordinates to n.
class ModelToNavigation {
 public:
  /// `system`: name of the reference system, empty where the file states none; `points` of the model: its middle
  /// chooses the order of axes and the transformation. Throws std::runtime_error, beginning with the file's name, where
  /// the coordinates cannot be transformed.
  ModelToNavigation(const CityPlacement& placement, const std::string& system,
                    const std::vector<Eigen::Vector3d>& points, const std::string& file);

  Eigen::Vector3d operator()(const Eigen::Vector3d& at) const;
  /// A point of an implicit geometry: its offset from the reference point, in the model's coordinates, or in metres to
  /// the east and the north and upwards where those are degrees.
  Eigen::Vector3d operator()(const Eigen::Vector3d& reference_point, const Eigen::Vector3d& offset) const;
  Georeference georeference() const;

 private:
  CityPlacement p_;
  std::optional<ReferenceSystem> system_;
  GeographicLib::LocalCartesian local_;
};

}  // namespace odograph::skyline
