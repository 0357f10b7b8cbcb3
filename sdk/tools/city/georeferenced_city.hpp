// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "sdk/host/base/geodesy.hpp"
#include "sdk/host/base/result.hpp"
#include "sdk/tools/city/photograph_localizer.hpp"

namespace odograph {

/// Latitude and longitude in degrees, or easting and northing in a model's own coordinates.
using Coordinates = std::array<double, 2>;

/// A city model in fix/skyline, and the transformation between its n and coordinates. n's origin lies within 5 km of
/// the buildings unless the position of the model's zero was given. Thread: one at a time.
class GeoreferencedCity {
 public:
  /// In latitude and longitude by the model's reference system; `near`: any position near it saves a second reading.
  /// ODO_E_UNSUPPORTED where the reference system alone is missing or not supported.
  static Result<GeoreferencedCity> geodetic(const std::filesystem::path& model, std::optional<Coordinates> near = {});
  /// In latitude and longitude, with the model's zero at a position and its axes to the east and the north.
  static Result<GeoreferencedCity> with_zero_at(const std::filesystem::path& model, const Coordinates& zero_deg);
  /// In the model's own easting and northing.
  static Result<GeoreferencedCity> own(const std::filesystem::path& model, std::optional<Coordinates> near = {});

  PhotographLocalizer& localizer() { return *localizer_; }
  bool is_geodetic() const { return geodesy_ != nullptr; }
  Eigen::Vector3d p_n(const Coordinates& place) const;  ///< at zero height
  Coordinates coordinates(const Eigen::Vector3d& p_n) const;
  size_t edges() const { return edges_; }  ///< of buildings
  /// The model's reference system and its transformation, in words; empty unless is_geodetic() by it.
  const std::string& reference_system() const { return localizer_->reference_system(); }
  /// The range of the buildings' coordinates.
  std::string span() const;
  /// Why no photograph can be taken at a place, if so: the model has no building within 60 m.
  std::optional<std::string> why_not_at(const Coordinates& place) const;

 private:
  static Result<GeoreferencedCity> load(const std::filesystem::path& model, const PhotographOrigin& origin,
                                        std::optional<Coordinates> origin_deg);
  static Result<GeoreferencedCity> load_near(const std::filesystem::path& model, const PhotographOrigin& origin);
  double distance_m(const Coordinates& place) const;

  std::unique_ptr<PhotographLocalizer> localizer_;
  PhotographOrigin origin_;
  std::unique_ptr<Geodesy> geodesy_;
  size_t edges_ = 0;
  Eigen::Vector3d low_n_, high_n_;  ///< of the buildings
};

}  // namespace odograph
