// SPDX-License-Identifier: Apache-2.0
//
// Projections of city and terrain models, without PROJ in a plugin.
#pragma once

#include <optional>
#include <string>

namespace odograph {

/// Degrees on WGS 84; ETRS89 is treated as equal (they differ by half a metre).
struct Geodetic {
  double latitude_deg = 0, longitude_deg = 0;
};

/// Grid coordinates of a projection, m.
struct GridPoint {
  double easting_m = 0, northing_m = 0;
};

/// RD New (EPSG 28992) to WGS 84: the oblique stereographic projection of the Netherlands (EPSG method 9809, IOGP
/// Guidance Note 7-2, Bessel 1841) and the seven parameters of "Amersfoort to WGS 84 (4)" (EPSG 15934), accurate to a
/// metre.
Geodetic rd_new_to_wgs84(const GridPoint& place);
/// The inverse, to a micrometre.
GridPoint wgs84_to_rd_new(const Geodetic& place);

/// Projection of a model's coordinates. Immutable.
class Projection {
 public:
  /// From an EPSG code: geographic coordinates (4326, 4258, 4979, 4937, Japan's 6668 and 6697; easting is the longitude
  /// in degrees), UTM on WGS 84 (326xx, 327xx) and ETRS89 (258xx, with German heights 5554 to 5556), RD New with or
  /// without heights (28992, 7415). None for any other code.
  static std::optional<Projection> of(int epsg);

  Geodetic geodetic(const GridPoint& place) const;
  /// None outside the domain of the projection.
  std::optional<GridPoint> grid(const Geodetic& place) const;

 private:
  enum class Kind { geographic, utm, rd_new };
  Projection(Kind kind, int zone, bool northern) : kind_(kind), zone_(zone), northern_(northern) {}

  Kind kind_;
  int zone_;
  bool northern_;
};

/// True for the geographic codes above.
bool is_geographic(int epsg);

/// EPSG code from a reference system's name as in CityJSON and CityGML
/// (`https://www.opengis.net/def/crs/EPSG/0/7415`, `urn:ogc:def:crs:EPSG::7415`; of two the first, horizontal one:
/// `urn:ogc:def:crs,crs:EPSG::25832,crs:EPSG::7837`), or of the German surveys
/// (`urn:adv:crs:ETRS89_UTM32*DE_DHHN2016_NH`); 0 if there is none.
int epsg_of(const std::string& reference_system);

}  // namespace odograph
