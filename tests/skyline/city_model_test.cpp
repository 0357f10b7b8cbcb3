// SPDX-License-Identifier: Apache-2.0
//
// What fix/skyline derives from a city model: ground, buildings' feet, edges of CityGML.

#include "plugins/fix/skyline/city_gml.hpp"
#include "plugins/fix/skyline/ground.hpp"
#include "tests/support/reason_of.hpp"
#include "tests/support/support.hpp"

using namespace odograph::skyline;
using Eigen::Vector3d;

TEST_SUITE_BEGIN("city_model");

TEST_CASE("a place in a building is told from one in its yard and in the street") {
  std::vector<Edge> edges;
  const auto ring = [&](double side) {
    const Vector3d c[] = {{-side, -side, 0}, {side, -side, 0}, {side, side, 0}, {-side, side, 0}};
    for (int i = 0; i < 4; ++i) {
      edges.push_back({c[i], c[(i + 1) % 4], 0});
      edges.push_back({c[i] - Vector3d(0, 0, 9), c[(i + 1) % 4] - Vector3d(0, 0, 9), 0});
    }
  };
  ring(12), ring(6);
  const Ground ground(edges);
  CHECK(ground.is_built({9, 1}));
  CHECK_FALSE(ground.is_built({2, 1}));
  CHECK_FALSE(ground.is_built({14, 1}));
  CHECK_FALSE(ground.is_built({200, 1}));
}

TEST_CASE("houses that share a wall each have an inside, and the street before them is none") {
  std::vector<std::vector<Vector3d>> rings;
  std::vector<int> objects;
  const auto house = [&](double north, double height, int object) {
    const Vector3d c[] = {{north, 0, 0}, {north + 10, 0, 0}, {north + 10, 10, 0}, {north, 10, 0}};
    const Vector3d up(0, 0, -height);
    rings.push_back({c[0], c[1], c[2], c[3]});
    for (int i = 0; i < 4; ++i) {
      const Vector3d &a = c[i], &b = c[(i + 1) % 4];
      rings.push_back({a, b, b + up, a + up});
    }
    objects.insert(objects.end(), 5, object);
  };
  house(0, 9, 0), house(10, 12, 1);
  auto edges = edges_of(rings, objects);
  const Ground ground(edges);
  CHECK(ground.is_built({5, 5}));
  CHECK(ground.is_built({15, 5}));
  CHECK_FALSE(ground.is_built({-5, 5}));
  CHECK_FALSE(ground.is_built({25, 5}));
  // A foot with a gap has no inside, and the street is not classified as built.
  for (Edge& e : edges) e.also = Edge::kUnknown;
  const Ground open(edges);
  CHECK_FALSE(open.is_built({15, 5}));
  CHECK_FALSE(open.is_built({-5, 5}));
}

TEST_CASE("ground under buildings lies between their feet, and is the terrain's where there is some") {
  std::vector<Edge> edges;
  const auto house = [&](double north, double foot_up, int object) {
    const Vector3d a(north, 0, -foot_up), b(north, 8, -foot_up), up(0, 0, -9);
    edges.push_back({a, b, object}), edges.push_back({a + up, b + up, object}), edges.push_back({a, a + up, object});
  };
  house(0, 400, 0), house(40, 410, 1);
  const auto between = required(Ground(edges).at({20, 4}));
  CHECK_FALSE(between->terrain);
  CHECK(between->down_m == doctest::Approx(-405).epsilon(0.002));
  CHECK(Ground(edges).at({2, 4})->down_m == doctest::Approx(-400).epsilon(0.005));
  CHECK_FALSE(Ground(edges).at({300, 4}));
  edges.push_back({{18, 4, -403}, {22, 4, -403}, Edge::kGround});
  const auto terrain = required(Ground(edges).at({20, 4}));
  CHECK(terrain->terrain);
  CHECK(terrain->down_m == doctest::Approx(-403));
  // Trees that are part of the terrain do not raise it.
  for (int k = 0; k < 3; ++k) edges.push_back({{17.0 + k, 5, -403.2}, {18.0 + k, 5, -411}, Edge::kGround});
  CHECK(Ground(edges).at({20, 4})->down_m > -403.5);
}

namespace {

std::string gml(const std::string& inside, const std::string& system = "urn:adv:crs:ETRS89_UTM32*DE_DHHN2016_NH") {
  return "<?xml version=\"1.0\"?>\n<core:CityModel xmlns:core=\"http://www.opengis.net/citygml/2.0\" "
         "xmlns:bldg=\"http://www.opengis.net/citygml/building/2.0\" xmlns:gml=\"http://www.opengis.net/gml\">\n"
         "<gml:boundedBy><gml:Envelope srsName=\"" +
         system + "\"/></gml:boundedBy>\n" + inside + "</core:CityModel>\n";
}

std::string polygon(const std::string& positions) {
  return "<gml:surfaceMember><gml:Polygon><gml:exterior><gml:LinearRing><gml:posList srsDimension=\"3\">" + positions +
         "</gml:posList></gml:LinearRing></gml:exterior></gml:Polygon></gml:surfaceMember>";
}

const std::string kBuilding =
    "<core:cityObjectMember><bldg:Building gml:id=\"a\"><bldg:lod1Solid>" + polygon("0 0 400 9 0 400 9 9 400 0 0 400") +
    "</bldg:lod1Solid><bldg:boundedBy><bldg:RoofSurface><bldg:lod2MultiSurface>" +
    polygon("10 20 410\n20 20 410 20 30 412.5 10 20 410") +
    "</bldg:lod2MultiSurface></bldg:RoofSurface></bldg:boundedBy></bldg:Building></core:cityObjectMember>\n";

}  // namespace

TEST_CASE("CityGML is read as CityJSON is: the finest level, each object's edges, in n") {
  const auto edges = parse_city_outline(gml(kBuilding), "town.gml", {.model_origin = {10, 20, 400}});
  REQUIRE(edges.size() == 3);
  CHECK(edges[0].from.isApprox(Vector3d(0, 0, -10)));
  CHECK(edges[1].object == 0);
  const auto two = parse_city_outline(
      gml(kBuilding + kBuilding +
          "<core:cityObjectMember><dem:ReliefFeature xmlns:dem=\"d\"><dem:lod>2</dem:lod>"
          "<dem:reliefComponent><dem:TINRelief><dem:tin><gml:Triangle><gml:exterior><gml:LinearRing>"
          "<gml:pos>0 0 399</gml:pos><gml:pos>5 0 399</gml:pos><gml:pos>5 5 399</gml:pos><gml:pos>0 0 399</gml:pos>"
          "</gml:LinearRing></gml:exterior></gml:Triangle></dem:tin></dem:TINRelief></dem:reliefComponent>"
          "</dem:ReliefFeature></core:cityObjectMember>"),
      "town.gml", {});
  CHECK(std::count_if(two.begin(), two.end(), [](const Edge& e) { return e.object == Edge::kGround; }) == 3);
  std::set<int> objects;  // the second building stands where the first does
  for (const Edge& e : two) objects.insert(e.object), objects.insert(e.also);
  CHECK(objects == std::set<int>{Edge::kGround, Edge::kUnknown, 0, 1});
  // A German survey's reference system, transformed to n by a geodetic origin: 9 degrees east is the central meridian
  // of zone 32.
  const auto placed =
      parse_city_outline(gml("<core:cityObjectMember><bldg:Building><bldg:lod2Solid>" +
                             polygon("500000 5400000 100 500010 5400000 100 500010 5400010 110 500000 5400000 100") +
                             "</bldg:lod2Solid></bldg:Building></core:cityObjectMember>"),
                         "town.gml", {.geodetic = true, .geodetic_origin = {48.7530, 9, 100}});
  CHECK(placed.size() == 3);
  double nearest_m = 1e9, farthest_m = 0;
  for (const Edge& e : placed)
    nearest_m = std::min(nearest_m, std::abs(e.from.y())), farthest_m = std::max(farthest_m, std::abs(e.to.y()));
  CHECK(nearest_m < 0.01);
  CHECK(farthest_m == doctest::Approx(10 / 0.9996).epsilon(1e-4));  // UTM's scale
}

TEST_CASE("what is no CityGML is refused with its line") {
  const auto why = [](const std::string& text) { return reason_of([&] { parse_city_outline(text, "town.gml", {}); }); };
  CHECK(contains(why("<html></html>"), "no CityModel"));
  CHECK(contains(why(gml("")), "no building"));
  CHECK(contains(why("<core:CityModel>"), "town.gml:1: not XML"));
  const auto with = [&](const std::string& positions) {
    return why(gml("<b:Building xmlns:b=\"b\"><b:lod2Solid>" + polygon(positions) + "</b:lod2Solid></b:Building>"));
  };
  CHECK(contains(with("0 0 0 1 0"), "three numbers each"));
  CHECK(contains(with("0 0 zero"), "no numbers"));
  CHECK(contains(with("0 0 1e300 1 1 1 2 2 2"), "farther"));
  std::string deep;
  for (int i = 0; i < 300; ++i) deep += "<a>";
  CHECK(contains(why(gml(deep)), "deep"));
  CHECK(why("<!DOCTYPE a [<!ENTITY a \"aaaaaaaaaa\"><!ENTITY b "
            "\"&a;&a;&a;&a;&a;&a;&a;&a;&a;&a;\">]><CityModel>&b;</CityModel>") != "");
}
