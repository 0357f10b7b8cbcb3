// SPDX-License-Identifier: Apache-2.0
#include <GeographicLib/Geodesic.hpp>
#include <GeographicLib/LocalCartesian.hpp>

#include "plugins/fix/skyline/city_outline.hpp"
#include "plugins/shared/projection.hpp"
#include "tests/support/support.hpp"

TEST_SUITE_BEGIN("projection");

namespace {

struct Known {
  const char* name;
  GridPoint rd;
  Geodetic wgs84;
};

/// Three corners of Delft's model and a tower in Amsterdam by PROJ 9.1.1 without grids:
/// `cs2cs -f %.9f EPSG:28992 EPSG:4326`.
constexpr std::array<Known, 4> kByProj = {{{"south-west", {84616.468, 447422.999}, {52.010702065, 4.362011356}},
                                           {"south-east", {85140.839, 447422.999}, {52.010768333, 4.369648078}},
                                           {"north", {84942.468, 447750.636}, {52.013687788, 4.366692039}},
                                           {"Westertoren", {120700.723, 487525.502}, {52.374530434, 4.883522915}}}};

double apart_m(const Geodetic& a, const Geodetic& b) {
  double metres = 0;
  GeographicLib::Geodesic::WGS84().Inverse(a.latitude_deg, a.longitude_deg, b.latitude_deg, b.longitude_deg, metres);
  return metres;
}

}  // namespace

TEST_CASE("RD New agrees with PROJ to a millimetre") {
  for (const Known& k : kByProj) {
    CAPTURE(k.name);
    CHECK(apart_m(rd_new_to_wgs84(k.rd), k.wgs84) < 1e-3);
    const GridPoint back = wgs84_to_rd_new(rd_new_to_wgs84(k.rd));
    CHECK(std::hypot(back.easting_m - k.rd.easting_m, back.northing_m - k.rd.northing_m) < 1e-6);
  }
}

TEST_CASE("RD New agrees with this machine's PROJ over the whole of the Netherlands" *
          doctest::test_suite("projection_proj")) {
  if (std::system("command -v cs2cs > /dev/null 2>&1") != 0) return skip("no cs2cs (PROJ)");
  const TemporaryFolder folder;
  std::vector<GridPoint> places;
  for (const Known& k : kByProj) places.push_back(k.rd);
  for (double e = 20'000; e < 290'000; e += 45'000)
    for (double n = 320'000; n < 620'000; n += 60'000) places.push_back({e, n});
  {
    std::ofstream out(folder / "rd.txt");
    out.precision(12);
    for (const GridPoint& p : places) out << p.easting_m << ' ' << p.northing_m << " 0\n";
  }
  const std::string command =
      "PROJ_NETWORK=OFF cs2cs -f %.10f EPSG:28992 EPSG:4326 < " + (folder / "rd.txt").string() + " 2> /dev/null";
  FILE* pipe = popen(command.c_str(), "r");
  REQUIRE(pipe != nullptr);
  double worst_m = 0;
  for (const GridPoint& p : places) {
    Geodetic theirs;
    double height = 0;
    const int read = std::fscanf(pipe, "%lf %lf %lf", &theirs.latitude_deg, &theirs.longitude_deg, &height);
    CHECK(read == 3);
    if (read != 3) break;
    worst_m = std::max(worst_m, apart_m(rd_new_to_wgs84(p), theirs));
  }
  pclose(pipe);
  MESSAGE(places.size() << " places, at most " << 1000 * worst_m << " mm apart");
  CHECK(worst_m < 0.5);  // with its correction grid, if installed, PROJ differs by up to 0.25 m
}

TEST_CASE("the corners of Delft's model are in n at their latitude and longitude, not along the grid") {
  const std::string text =
      R"({"type":"CityJSON","version":"2.0","metadata":{"referenceSystem":"https://www.opengis.net/def/crs/EPSG/0/7415"},
          "transform":{"scale":[0.001,0.001,0.001],"translate":[84616.468,447422.999,0]},
          "CityObjects":{"a":{"type":"Building","geometry":[{"type":"MultiSurface","lod":"1","boundaries":[[[0,1,2]]]}]}},
          "vertices":[[0,0,0],[524371,0,0],[326000,327637,12000]]})";
  const Geodetic& o = kByProj[0].wgs84;
  const auto edges = skyline::parse_city_outline(
      text, "delft",
      {.geodetic = true, .geodetic_origin = {o.latitude_deg, o.longitude_deg, 43.5}, .geoid_height_m = 43.5});
  REQUIRE(edges.size() == 3);
  const GeographicLib::LocalCartesian local(o.latitude_deg, o.longitude_deg, 43.5);
  for (int i = 0; i < 3; ++i) {
    CAPTURE(i);
    double east = 0, north = 0, up = 0;
    const Geodetic& g = kByProj[static_cast<size_t>(i)].wgs84;
    local.Forward(g.latitude_deg, g.longitude_deg, 43.5 + (i == 2 ? 12 : 0), east, north, up);
    double nearest_m = 1e9;
    for (const auto& edge : edges)
      for (const auto& p : {edge.from, edge.to})
        nearest_m = std::min(nearest_m, (p - Eigen::Vector3d(north, east, -up)).norm());
    CHECK(nearest_m < 2e-3);
    // Grid north is 0.8 degrees off true north there: metres over the width of the model.
    if (i == 1) CHECK(north == doctest::Approx(7.37).epsilon(0.01));
  }
}

TEST_CASE(
    "reference systems are recognised by the code at the end of their name, and others are rejected with a reason") {
  CHECK(epsg_of("https://www.opengis.net/def/crs/EPSG/0/7415") == 7415);
  CHECK(epsg_of("urn:ogc:def:crs:EPSG::28992") == 28992);
  CHECK(epsg_of("https://www.opengis.net/def/crs/EPSG/0/") == 0);
  CHECK(epsg_of("my own 12") == 0);
  CHECK_FALSE(Projection::of(31255));
  CHECK_FALSE(Projection::of(32661));
  const auto utm = required(Projection::of(25832));
  const auto at = required(utm->grid({48.7758, 9.1829}));
  CHECK(apart_m(utm->geodetic(*at), {48.7758, 9.1829}) < 1e-6);
  const std::string text =
      R"({"type":"CityJSON","version":"2.0","metadata":{"referenceSystem":"https://www.opengis.net/def/crs/EPSG/0/31255"},
          "CityObjects":{},"vertices":[]})";
  CHECK_THROWS_WITH_AS(skyline::parse_city_outline(text, "linz", {.geodetic = true}),
                       doctest::Contains("linz: the model's reference system (EPSG 31255) is not supported"),
                       std::runtime_error);
}
