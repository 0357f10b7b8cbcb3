// SPDX-License-Identifier: Apache-2.0
//
// Reference systems of city and terrain models, by PROJ and its copy of the EPSG dataset.
#pragma once

#include <memory>
#include <optional>
#include <string>

namespace odograph {

/// Degrees on WGS 84.
struct Geodetic {
  double latitude_deg = 0, longitude_deg = 0;
};

/// The first two coordinates of a model's point, in the model's own order and unit.
struct ModelPoint {
  double first = 0, second = 0;
};

/// EPSG codes and order of axes that the name of a reference system stands for.
struct SystemName {
  int epsg = 0;                  ///< of the horizontal or the compound system; 0: none
  int vertical_epsg = 0;         ///< of the heights; 0: none is named
  bool authority_order = false;  ///< axes in EPSG's order; otherwise easting or longitude first
};

/// Codes from a name as in CityJSON and CityGML. URNs and OGC's URLs (`urn:ogc:def:crs:EPSG::7415`,
/// `https://www.opengis.net/def/crs/EPSG/0/7415`, compound ones with two codes too) have EPSG's order of axes, short
/// names
/// (`EPSG:25832`, `EPSG:25832+7837`), `http://www.opengis.net/gml/srs/epsg.xml#25832`, CRS84 and those of the German
/// surveys (`urn:adv:crs:ETRS89_UTM32*DE_DHHN2016_NH`) have easting or longitude first.
SystemName parse_system_name(const std::string& name);

/// A horizontal reference system with the unit of its heights, and its transformation to WGS 84. Transformations: any
/// thread, one at a time.
class ReferenceSystem {
 public:
  /// Throws std::runtime_error, with a sentence without the file's name, where the codes are unknown or not those of a
  /// horizontal system on the Earth.
  explicit ReferenceSystem(const SystemName& name);
  ~ReferenceSystem();
  ReferenceSystem(ReferenceSystem&&) noexcept;
  ReferenceSystem& operator=(ReferenceSystem&&) noexcept;

  /// Of easting and northing, m; 0: they are longitude and latitude.
  double unit_m() const;
  /// Of heights, m; negative: they are depths. Without a vertical system that of easting and northing, or the metre.
  double height_unit_m() const;
  const std::string& unit() const;  ///< its name

  /// The order of axes that puts a place into the system's area of use: the name's, the other, or both do or none does.
  enum class Order { named, exchanged, either };
  /// Chooses the order (the name's where it decides nothing) and the transformation for a place and its surroundings.
  /// Throws std::runtime_error where neither order puts it within 5 degrees of the area of use, or where EPSG has no
  /// transformation to WGS 84.
  Order choose_around(const ModelPoint& place);
  bool northing_first() const;  ///< northing or latitude
  /// After choose_around. Not finite where the point is outside the projection's domain.
  Geodetic geodetic(const ModelPoint& point) const;
  /// None outside the projection's domain.
  std::optional<ModelPoint> model(const Geodetic& point) const;
  /// Of the transformation to WGS 84, m, as EPSG states it; 0 where it states none, and where the transformation leaves
  /// latitudes and longitudes as they are (ETRS89, NAD83): what such systems differ by is one offset for all.
  double accuracy_m() const;
  /// System, order of axes, transformation and accuracy, in words.
  std::string description() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace odograph
