// SPDX-License-Identifier: Apache-2.0
//
// Small city models in many reference systems. No expected place is PROJ's: agencies publish them for named points, or
// they follow from the definitions by GeographicLib.
#include <GeographicLib/CassiniSoldner.hpp>
#include <GeographicLib/Geocentric.hpp>
#include <GeographicLib/LambertConformalConic.hpp>
#include <GeographicLib/LocalCartesian.hpp>
#include <GeographicLib/TransverseMercator.hpp>
#include <GeographicLib/UTMUPS.hpp>
#include <Eigen/Geometry>

#include "plugins/fix/skyline/city_outline.hpp"
#include "plugins/shared/reference_system.hpp"
#include "tests/support/reason_of.hpp"
#include "tests/support/support.hpp"

TEST_SUITE_BEGIN("reference_systems");

namespace {

using Eigen::Vector3d;

constexpr double kDms = 1.0 / 60;
constexpr double kUsFoot_m = 1200.0 / 3937;
constexpr double degrees(double d, double minutes, double seconds) { return d + (minutes + seconds * kDms) * kDms; }

std::string url(int epsg) { return "https://www.opengis.net/def/crs/EPSG/0/" + std::to_string(epsg); }
std::string urn(int epsg) { return "urn:ogc:def:crs:EPSG::" + std::to_string(epsg); }
std::string short_name(int epsg) { return "EPSG:" + std::to_string(epsg); }

/// A house of 10 by 8 units, its first corner at a place of the model.
std::vector<Vector3d> house(double first, double second, double height, double unit) {
  const Vector3d corner(first, second, 0);
  return {corner, corner + Vector3d(10 * unit, 0, height), corner + Vector3d(10 * unit, 8 * unit, height)};
}

std::string numbers(const std::vector<Vector3d>& points, const char* between, const char* open, const char* close) {
  std::string text;
  char row[120];
  for (const Vector3d& p : points) {
    std::snprintf(row, sizeof row, "%s%s%.12g%s%.12g%s%.12g%s", text.empty() || !*open ? "" : ",", open, p.x(), between,
                  p.y(), between, p.z(), close);
    text += row;
  }
  return text;
}

std::string city_json(const std::string& system, const std::vector<Vector3d>& points) {
  return R"({"type":"CityJSON","version":"2.0","metadata":{"referenceSystem":")" + system +
         R"("},"CityObjects":{"a":{"type":"Building","geometry":[{"type":"MultiSurface","lod":"1","boundaries":[[[0,1,2]]]}]}},
            "vertices":[)" +
         numbers(points, ",", "[", "]") + "]}";
}

std::string city_gml(const std::string& system, const std::string& inside) {
  return "<CityModel xmlns:gml='g' xmlns:b='b' xmlns:xlink='x'><gml:boundedBy><gml:Envelope srsName='" + system +
         "' srsDimension='3'/></gml:boundedBy><cityObjectMember>" + inside + "</cityObjectMember></CityModel>";
}
std::string polygon(const std::string& positions, const std::string& attributes = "") {
  return "<gml:surfaceMember><gml:Polygon><gml:exterior><gml:LinearRing><gml:posList" + attributes + ">" + positions +
         "</gml:posList></gml:LinearRing></gml:exterior></gml:Polygon></gml:surfaceMember>";
}
std::string building(const std::string& positions) {
  return "<b:Building><b:lod1MultiSurface>" + polygon(positions) + "</b:lod1MultiSurface></b:Building>";
}
std::string city_gml(const std::string& system, const std::vector<Vector3d>& points) {
  return city_gml(system, building(numbers(points, " ", "", " ")));
}

Geodetic transverse_mercator(double a, double f, double longitude0, double k0, double easting, double northing,
                             double latitude0 = 0) {
  const GeographicLib::TransverseMercator projection(a, f, k0);
  double x = 0, y0 = 0;
  projection.Forward(longitude0, latitude0, longitude0, x, y0);
  Geodetic g;
  projection.Reverse(longitude0, easting, northing + y0, g.latitude_deg, g.longitude_deg);
  return g;
}

/// Lambert's conic on GRS 80 by its two parallels and its false origin.
Geodetic lambert(double parallel1, double parallel2, double latitude0, double longitude0, double easting,
                 double northing) {
  const GeographicLib::LambertConformalConic projection(6378137, 1 / 298.257222101, parallel1, parallel2, 1);
  double x = 0, y0 = 0;
  projection.Forward(longitude0, latitude0, longitude0, x, y0);
  Geodetic g;
  projection.Reverse(longitude0, easting, northing + y0, g.latitude_deg, g.longitude_deg);
  return g;
}

constexpr double kBessel_m = 6377397.155, kBesselFlattening = 1 / 299.1528128;
constexpr double kGrs80_m = 6378137, kGrs80Flattening = 1 / 298.257222101;

/// From a Bessel datum to WGS 84 by seven parameters (position vector; m, seconds of arc, ppm).
Geodetic shifted(const Geodetic& bessel, const std::array<double, 7>& p) {
  Vector3d x;
  GeographicLib::Geocentric(kBessel_m, kBesselFlattening)
      .Forward(bessel.latitude_deg, bessel.longitude_deg, 0, x.x(), x.y(), x.z());
  constexpr double kSecond = std::numbers::pi / 180 / 3600;
  const Vector3d rotation = kSecond * Vector3d(p[3], p[4], p[5]);
  const Vector3d y = Vector3d(p[0], p[1], p[2]) + (1 + p[6] * 1e-6) * (x + rotation.cross(x));
  Geodetic g;
  double height = 0;
  GeographicLib::Geocentric::WGS84().Reverse(y.x(), y.y(), y.z(), g.latitude_deg, g.longitude_deg, height);
  return g;
}

/// Austria's parameters of the BEV, and Germany's of the BKG for the whole country (accurate to 3 m).
constexpr std::array<double, 7> kMgi = {577.326, 90.129, 463.919, 5.137, 1.474, 5.297, 2.4232};
constexpr std::array<double, 7> kDhdn = {598.1, 73.7, 418.2, 0.202, 0.045, -2.455, 6.7};

Geodetic gauss_krueger(double longitude0, double easting, double northing, const std::array<double, 7>& datum) {
  return shifted(transverse_mercator(kBessel_m, kBesselFlattening, longitude0, 1, easting, northing), datum);
}
Geodetic soldner_berlin(double easting, double northing) {
  const GeographicLib::CassiniSoldner projection(degrees(52, 25, 7.1338), degrees(13, 37, 37.9332),
                                                 GeographicLib::Geodesic(kBessel_m, kBesselFlattening));
  Geodetic g;
  projection.Reverse(easting - 40000, northing - 10000, g.latitude_deg, g.longitude_deg);
  return shifted(g, kDhdn);
}

struct Case {
  std::string name, system;
  bool gml;
  double first, second;  ///< in the file
  Geodetic place;
  double tolerance_m, accuracy_m;
  double unit_m = 1;
};

/// Points with coordinates that agencies publish.
std::vector<Case> published_cases() {
  // swisstopo, "Formulas and constants for the calculation of the Swiss conformal cylindrical projection", 2016, page
  // 19 (https://www.swisstopo.admin.ch), as quoted in https://github.com/rkaravia/swissgrid, tests/data/index.js.
  const Geodetic zimmerwald{degrees(46, 52, 37.540562), degrees(7, 27, 54.983506)};
  // NGS, data sheet of DI0446 (as quoted in public repositories): NAD 83(2011).
  const Geodetic central_islip{degrees(40, 45, 38.23676), -degrees(73, 11, 51.78749)};
  // https://www.geocaching.com/mark/datasheet.aspx?PID=KU4063, of the NGS: NAD 83(1996), in metres.
  const Geodetic roon{degrees(40, 59, 9.55699), -degrees(73, 54, 23.37124)};
  // https://app1.sla.gov.sg/SIRENT/About/PlaneCoordinateSystem: the origin of projection.
  const Geodetic singapore{degrees(1, 22, 0), degrees(103, 50, 0)};
  // http://docs.jhs-suositukset.fi/jhs-suositukset/JHS197_liite3/JHS197_liite3.html: point G4 (Geta).
  const Geodetic geta{60.3851068722, 19.84813676944};
  // Kadaster and Rijkswaterstaat, points of validation of RDNAPTRANS(TM)2008, as in
  // https://github.com/PDOK/rdnaptrans-java, EtrsToNap.java.
  const Geodetic texel{53.160753042, 4.824761912}, amersfoort{52.155172897, 5.387203657};
  const double feet = 1 / kUsFoot_m;
  return {
      {"2056, Zimmerwald", url(2056), false, 2602030.74, 1191775.03, zimmerwald, 0.1, 1},
      {"2056 with heights", "EPSG:2056+5729", true, 2602030.74, 1191775.03, zimmerwald, 0.1, 1},
      {"6539, Central Islip", url(6539), false, 1206501.82, 217409.36, central_islip, 0.1, 0, kUsFoot_m},
      {"6539 with heights", "urn:ogc:def:crs,crs:EPSG::6539,crs:EPSG::6360", true, 1206501.82, 217409.36, central_islip,
       0.1, 0, kUsFoot_m},
      {"2263, Roon", short_name(2263), true, 307868.958 * feet, 90987.680 * feet, roon, 0.1, 0, kUsFoot_m},
      {"32118, Roon", url(32118), false, 307868.958, 90987.680, roon, 0.1, 0},
      {"3414, origin", url(3414), false, 38744.572, 28001.642, singapore, 0.1, 0},
      {"3414, easting first", short_name(3414), true, 28001.642, 38744.572, singapore, 0.1, 0},
      {"3067, Geta", urn(3067), true, 106256.35961, 6715706.37708, geta, 0.1, 0},
      {"28992, Texel", urn(28992), true, 117380.12, 575040.34, texel, 1, 1},
      {"7415, Amersfoort", url(7415), false, 155000, 463000, amersfoort, 1, 1},
  };
}

/// Points whose places follow from the definitions.
std::vector<Case> computed_cases() {
  const Geodetic helsinki = transverse_mercator(kGrs80_m, kGrs80Flattening, 25, 1, -4000, 6672000);
  const Geodetic paris = lambert(44, 49, 46.5, 3, 652469 - 700000.0, 6862035 - 6600000.0);
  const Geodetic paris49 = lambert(48.25, 49.75, 49, 3, 1652469 - 1700000.0, 8162035 - 8200000.0);
  const Geodetic nice = lambert(43.25, 44.75, 44, 3, 2043000 - 1700000.0, 3180000 - 3200000.0);
  const Geodetic queens =
      lambert(40 + 40 * kDms, 41 + 2 * kDms, 40 + 10 * kDms, -74, 1010000 * kUsFoot_m - 300000, 210000 * kUsFoot_m);
  Geodetic heilbronn;
  GeographicLib::UTMUPS::Reverse(32, true, 515000, 5443000, heilbronn.latitude_deg, heilbronn.longitude_deg);
  return {
      {"2263", url(2263), false, 1010000, 210000, queens, 0.1, 0, kUsFoot_m},
      {"3879", urn(3879), true, 6672000, 25496000, helsinki, 0.1, 0},
      {"3879 with its axes exchanged", url(3879), false, 25496000, 6672000, helsinki, 0.1, 0},
      {"3879 with heights", "urn:ogc:def:crs,crs:EPSG:6.12:3879,crs:EPSG:6.12:3900", true, 6672000, 25496000, helsinki,
       0.1, 0},
      {"2154", url(2154), false, 652469, 6862035, paris, 0.1, 0},
      {"2154 with heights",
       "http://www.opengis.net/def/crs-compound?1=http://www.opengis.net/def/crs/EPSG/0/2154&amp;2=http://"
       "www.opengis.net/def/crs/EPSG/0/5720",
       true, 652469, 6862035, paris, 0.1, 0},
      {"3949", short_name(3949), true, 1652469, 8162035, paris49, 0.1, 0},
      {"3944", url(3944), false, 2043000, 3180000, nice, 0.1, 0},
      {"25832", "urn:adv:crs:ETRS89_UTM32*DE_DHHN2016_NH", true, 515000, 5443000, heilbronn, 0.1, 0},
      {"25832 by GML 2's name", "http://www.opengis.net/gml/srs/epsg.xml#25832", true, 515000, 5443000, heilbronn, 0.1,
       0},
      {"5555", url(5555), false, 515000, 5443000, heilbronn, 0.1, 0},
      {"32632", short_name(32632), true, 515000, 5443000, heilbronn, 0.1, 0},
      {"31254", urn(31254), true, 237000, 79000, gauss_krueger(10 + 20 * kDms, 79000, 5237000, kMgi), 1.5, 1.5},
      {"31255", url(31255), false, 351000, 71000, gauss_krueger(13 + 20 * kDms, 71000, 5351000, kMgi), 1.5, 1.5},
      {"31256", short_name(31256), true, 1000, 341000, gauss_krueger(16 + 20 * kDms, 1000, 5341000, kMgi), 1.5, 1.5},
      {"31256 with its axes exchanged", url(31256), false, 1000, 341000,
       gauss_krueger(16 + 20 * kDms, 1000, 5341000, kMgi), 1.5, 1.5},
      {"31466", short_name(31466), true, 2566000, 5645000, gauss_krueger(6, 66000, 5645000, kDhdn), 3, 1},
      {"31467", urn(31467), true, 5404000, 3513000, gauss_krueger(9, 13000, 5404000, kDhdn), 3, 1},
      {"31468", "urn:adv:crs:DE_DHDN_3GK4*DE_DHHN12_NOH", true, 4468000, 5333000,
       gauss_krueger(12, -32000, 5333000, kDhdn), 3, 1},
      {"31469", url(31469), false, 5657000, 5412000, gauss_krueger(15, -88000, 5657000, kDhdn), 3, 1},
      {"3068", urn(3068), true, 19978, 24480, soldner_berlin(24480, 19978), 3, 1},
      {"4979", urn(4979), true, 48.1351, 11.582, {48.1351, 11.582}, 0.1, 0},
      {"4326, longitude first", short_name(4326), true, 11.582, 48.1351, {48.1351, 11.582}, 0.1, 0},
      {"CRS84", "urn:ogc:def:crs:OGC:1.3:CRS84", true, 11.582, 48.1351, {48.1351, 11.582}, 0.1, 0},
      {"6697", url(6697), false, 35.6586, 139.7454, {35.6586, 139.7454}, 0.1, 0},
  };
}

/// Reads a model with n's origin at a place.
std::vector<skyline::Edge> read(const std::string& text, const Geodetic& origin,
                                skyline::Georeference* georeference = nullptr) {
  return skyline::parse_city_outline(
      text, "model", {.geodetic = true, .geodetic_origin = {origin.latitude_deg, origin.longitude_deg, 0}},
      georeference);
}

double nearest_m(const std::vector<skyline::Edge>& edges, const Vector3d& to) {
  double nearest = 1e9;
  for (const auto& edge : edges)
    for (const Vector3d& p : {edge.from, edge.to}) nearest = std::min(nearest, (p - to).norm());
  return nearest;
}

std::string why(const std::string& text, const skyline::CityPlacement& placement) {
  return reason_of([&] { skyline::parse_city_outline(text, "model", placement); });
}

}  // namespace

TEST_CASE("small city models of many reference systems are at their latitude and longitude, with their accuracy") {
  std::vector<Case> all = published_cases();
  for (Case& c : computed_cases()) all.push_back(std::move(c));
  for (const Case& c : all) {
    CAPTURE(c.name);
    const bool geographic = std::abs(c.first) < 181;
    const auto corners = house(c.first, c.second, 7 / c.unit_m, geographic ? 1e-5 : 1 / c.unit_m);
    skyline::Georeference found;
    const auto edges = read(c.gml ? city_gml(c.system, corners) : city_json(c.system, corners), c.place, &found);
    CHECK(edges.size() == 3);
    const double off_m = nearest_m(edges, Vector3d::Zero());
    MESSAGE(c.name << ": " << off_m << " m off; " << found.description);
    CHECK(off_m < c.tolerance_m);
    CHECK(found.accuracy_m == doctest::Approx(c.accuracy_m));
    double highest_m = 0, longest_m = 0;
    for (const auto& edge : edges) {
      highest_m = std::max({highest_m, -edge.from.z(), -edge.to.z()});
      longest_m = std::max(longest_m, (edge.from - edge.to).head<2>().norm());
    }
    CHECK(highest_m == doctest::Approx(7).epsilon(0.001));  // feet are metres here
    if (!geographic)
      CHECK(longest_m == doctest::Approx(std::hypot(10, 8)).epsilon(0.002));  // of the projection's scale
  }
}

TEST_CASE("a geodetic transformation is inverted, and n's axes are not the grid's") {
  ReferenceSystem rd(parse_system_name("EPSG:7415"));
  rd.choose_around({84616.468, 447422.999});
  const Geodetic a = rd.geodetic({84616.468, 447422.999}), b = rd.geodetic({85140.839, 447422.999});
  const auto back = required(rd.model(a));
  CHECK(std::hypot(back->first - 84616.468, back->second - 447422.999) < 0.002);
  // Grid north is 0.8 degrees off true north in Delft: metres over the width of the model.
  const GeographicLib::LocalCartesian local(a.latitude_deg, a.longitude_deg, 43.5);
  double east = 0, north = 0, up = 0;
  local.Forward(b.latitude_deg, b.longitude_deg, 43.5, east, north, up);
  CHECK(north == doctest::Approx(7.37).epsilon(0.01));
}

TEST_CASE("names of reference systems give codes and the order of their axes") {
  const auto codes = [](const std::string& name) {
    const SystemName system = parse_system_name(name);
    return std::array<int, 3>{system.epsg, system.vertical_epsg, system.authority_order};
  };
  using Codes = std::array<int, 3>;
  CHECK(codes("https://www.opengis.net/def/crs/EPSG/0/7415") == Codes{7415, 0, 1});
  CHECK(codes("http://www.opengis.net/def/crs/EPSG/0/7415/") == Codes{7415, 0, 1});
  CHECK(codes("urn:ogc:def:crs:EPSG::28992") == Codes{28992, 0, 1});
  CHECK(codes("urn:ogc:def:crs,crs:EPSG:6.12:25832,crs:EPSG:6.12:7837") == Codes{25832, 7837, 1});
  CHECK(codes("EPSG:25832+7837") == Codes{25832, 7837, 0});
  CHECK(codes("epsg:25832 + EPSG:7837") == Codes{25832, 7837, 0});
  CHECK(codes("http://www.opengis.net/gml/srs/epsg.xml#25832") == Codes{25832, 0, 0});
  CHECK(codes("urn:adv:crs:ETRS89_UTM32*DE_DHHN2016_NH") == Codes{25832, 0, 0});
  CHECK(codes("urn:ogc:def:crs:OGC::CRS84h") == Codes{4326, 0, 0});
  for (const char* none : {"", "my own 12", "DB_REF", "https://www.opengis.net/def/crs/EPSG/0/", "EPSG:99999999999999"})
    CHECK(parse_system_name(none).epsg == 0);
}

TEST_CASE("a model without a place is refused with the mistake and the remedy") {
  const skyline::CityPlacement geodetic{.geodetic = true, .geodetic_origin = {48, 9, 0}};
  const auto at = [](const std::string& system, double first, double second) {
    return city_json(system, house(first, second, 7, 1));
  };
  CHECK(contains(why(at("", 0, 0), geodetic), "model: the model states no reference system with an EPSG code"));
  CHECK(contains(why(at(url(99999), 0, 0), geodetic), "its reference system (EPSG 99999) is unknown to PROJ"));
  CHECK(contains(why(at(url(4978), 4e6, 7e5), geodetic), "is neither projected nor geographic"));
  CHECK(contains(why(at("EPSG:25832+25833", 5e5, 5e6), geodetic), "its heights (EPSG 25833) is no vertical one"));
  CHECK(contains(why(at(url(2263), 1922921.197, 14801498.074), geodetic),
                 "lie outside the area of its reference system EPSG:2263 (NAD83 / New York Long Island (ftUS))"));
  // In the model's own coordinates: easting, northing and height in metres.
  const skyline::CityPlacement own{.model_origin = {0, 0, 0}};
  CHECK(contains(why(at(url(2263), 1010000, 210000), own), "its coordinates are in the unit US survey foot"));
  CHECK(contains(why(at("EPSG:25832+6360", 5e5, 5e6), own), "its coordinates are in the unit US survey foot"));
  CHECK(contains(why(at(url(4979), 48, 9), own), "its coordinates are degrees"));
  CHECK(contains(why(city_gml(urn(31256), house(341000, 1000, 7, 1)), own), "its coordinates have northing first"));
  CHECK(why(at(url(31256), 1000, 341000), own).empty());
  CHECK(why(at(url(31256), 10, 20), own).empty());  // shifted to its own zero
}

TEST_CASE("implicit geometries are at their reference points, turned and scaled by their matrices") {
  const Geodetic origin = transverse_mercator(kGrs80_m, kGrs80Flattening, 9, 0.9996, 0, 5400000);
  const std::string matrix = "0 -2 0 0 2 0 0 0 0 0 2 1 0 0 0 1", shape = polygon("0 0 0 1 0 0 1 0 1 0 0 0");
  const auto implicit = [&](const std::string& geometry, const std::string& place) {
    return "<b:outerBuildingInstallation><b:BuildingInstallation><b:lod3ImplicitRepresentation><ImplicitGeometry>"
           "<transformationMatrix>" +
           matrix + "</transformationMatrix>" + geometry + place +
           "</ImplicitGeometry></b:lod3ImplicitRepresentation></b:BuildingInstallation></b:outerBuildingInstallation>";
  };
  const std::string place =
      "<referencePoint><gml:Point><gml:pos>500020 5400030 7</gml:pos></gml:Point></referencePoint>";
  const std::string here =
      "<relativeGMLGeometry><gml:MultiSurface gml:id='dormer'>" + shape + "</gml:MultiSurface></relativeGMLGeometry>";
  const std::string elsewhere = "<relativeGMLGeometry xlink:href='#dormer'/>";
  const std::string walls = "<b:lod1MultiSurface>" +
                            polygon("500000 5400000 0 500010 5400000 0 500010 5400008 7 500000 5400000 0") +
                            "</b:lod1MultiSurface>";
  const auto model = [&](const std::string& inside) {
    return city_gml("EPSG:25832", "<b:Building>" + walls + inside + "</b:Building>");
  };
  // The local x axis points north after the turn, and 1 m stands for 2.
  const Vector3d foot(30, 20, -8), top(32, 20, -10);
  for (const std::string& inside :
       {implicit(here, place),
        implicit(elsewhere, place) + implicit(here,
                                              "<referencePoint><gml:Point><gml:pos>500100 5400000 0"
                                              "</gml:pos></gml:Point></referencePoint>")}) {
    const auto edges = read(model(inside), origin);
    CHECK(nearest_m(edges, foot) < 0.02);
    CHECK(nearest_m(edges, top) < 0.02);
    for (const auto& edge : edges) CHECK(edge.from.norm() < 150);
  }
  const skyline::CityPlacement own{.model_origin = {500000, 5400000, 0}};
  CHECK(contains(why(model(implicit(here, "")), own), "an implicit geometry without a reference point"));
  CHECK(contains(why(model(implicit(elsewhere, place)), own), "no implicit geometry has the identifier 'dormer'"));
  // CityJSON's templates.
  const std::string json =
      R"({"type":"CityJSON","version":"2.0","metadata":{"referenceSystem":"EPSG:25832"},
          "geometry-templates":{"templates":[{"type":"MultiSurface","lod":"3","boundaries":[[[0,1,2]]]}],
                                "vertices-templates":[[0,0,0],[1,0,0],[1,0,1]]},
          "CityObjects":{"a":{"type":"BuildingInstallation","geometry":[{"type":"GeometryInstance","template":0,"boundaries":[0],
             "transformationMatrix":[0,-2,0,0,2,0,0,0,0,0,2,1,0,0,0,1]}]}},"vertices":[[500020,5400030,7]]})";
  CHECK(nearest_m(read(json, origin), foot) < 0.02);
  CHECK(nearest_m(read(json, origin), top) < 0.02);
}

TEST_CASE("attributes hold within their elements, and what has two dimensions is passed over") {
  const std::string walls = building("500000 5400000 0 500010 5400000 0 500010 5400008 7 500000 5400000 0");
  const std::string address =
      "<b:Building><address><gml:Point srsDimension='2' srsName='EPSG:31467'><gml:pos>3500000 "
      "5400000</gml:pos></gml:Point>"
      "</address>";
  const std::string flat = "<b:lod0FootPrint>" + polygon("0 0 9 0 9 9 0 0", " srsDimension='2'") + "</b:lod0FootPrint>";
  const skyline::CityPlacement own{.model_origin = {500000, 5400000, 0}};
  const auto edges =
      skyline::parse_city_outline(city_gml("EPSG:25832", address + flat + walls.substr(12)), "model", own);
  CHECK(edges.size() == 3);
  CHECK(nearest_m(edges, Vector3d::Zero()) < 1e-6);
  CHECK(contains(why(city_gml("EPSG:25832", "<b:Building>" + flat + "</b:Building>"), own), "two dimensions alone"));
  // Two zones of UTM in one document: 3 degrees east of the one's meridian, 3 west of the other's.
  const auto both =
      read(city_gml("EPSG:25832", walls + "<b:Building><b:lod1MultiSurface srsName='EPSG:25833'>" +
                                      polygon("500000 5400000 0 500010 5400000 0 500010 5400008 7 500000 5400000 0") +
                                      "</b:lod1MultiSurface></b:Building>"),
           transverse_mercator(kGrs80_m, kGrs80Flattening, 15, 0.9996, 0, 5400000));
  CHECK(nearest_m(both, Vector3d::Zero()) < 0.1);
}

TEST_CASE("CityJSONSeq is read feature by feature") {
  const std::string head =
      R"({"type":"CityJSON","version":"2.0","transform":{"scale":[0.001,0.001,0.001],"translate":[500000,5400000,0]},"metadata":{"referenceSystem":"https://www.opengis.net/def/crs/EPSG/0/25832"},"CityObjects":{},"vertices":[]})";
  const auto feature = [](const std::string& id, int east_mm) {
    const std::string x = std::to_string(east_mm);
    return R"({"type":"CityJSONFeature","id":")" + id + R"(","CityObjects":{")" + id +
           R"(":{"type":"Building","geometry":[{"type":"MultiSurface","lod":"1","boundaries":[[[0,1,2]]]}]}},"vertices":[[)" +
           x + ",0,0],[" + x + ",8000,0],[" + x + ",8000,7000]]}";
  };
  const Geodetic origin = transverse_mercator(kGrs80_m, kGrs80Flattening, 9, 0.9996, 0, 5400000);
  const auto edges = read(head + "\n" + feature("a", 0) + "\n\n" + feature("b", 20000) + "\n", origin);
  CHECK(edges.size() == 6);
  CHECK(nearest_m(edges, Vector3d(0, 20, 0)) < 0.02);
  CHECK(edges[0].object != edges[3].object);
  CHECK(contains(why(head + "\n" + head, {}), "line 2 is not a CityJSONFeature"));
  CHECK(contains(why(head + "\n{", {}), "line 2 is not a CityJSONFeature"));
  CHECK(contains(why(feature("a", 0), {}), "expected an object with \"type\": \"CityJSON\""));
}
