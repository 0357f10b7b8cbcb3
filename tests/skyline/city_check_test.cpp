// SPDX-License-Identifier: Apache-2.0
#include <random>

#include "plugins/fix/skyline/matcher.hpp"
#include "sdk/tools/city/city_check.hpp"
#include "sdk/tools/city/model_errors.hpp"
#include "sdk/tools/city/street_route.hpp"
#include "sdk/tools/simulation/city_model.hpp"
#include "tests/support/reason_of.hpp"
#include "tests/support/support.hpp"

using namespace odograph::skyline;
using Eigen::Vector3d;

TEST_SUITE_BEGIN("city");

namespace {

std::string refusal(const std::string& text) {
  const auto done = check_city_text(text, "town.json");
  return done ? std::string() : done.failure().text;
}

std::string town(const std::string& vertices, const std::string& boundaries, const std::string& more = "") {
  return R"({"type":"CityJSON","version":"2.0",)" + more + R"("vertices":)" + vertices +
         R"(,"CityObjects":{"a":{"type":"Building","geometry":[{"type":"MultiSurface","lod":"1","boundaries":)" +
         boundaries + "}]}}}";
}

const std::string kTriangle = "[[0,0,0],[10,0,0],[0,10,0]]";

}  // namespace

TEST_CASE("a city model's check counts what is in it") {
  const auto one = required(check_city_text(town(kTriangle, "[[[0,1,2]]]"), "town.json"));
  CHECK(one->format == "CityJSON");
  CHECK(one->objects == 1);
  CHECK(one->surfaces == 1);
  const auto lines = required(check_city_text(
      R"({"type":"CityJSON","version":"2.0","CityObjects":{},"vertices":[],"transform":{"scale":[0.1,0.1,0.1],"translate":[0,0,0]}})"
      "\n"
      R"({"type":"CityJSONFeature","id":"b","CityObjects":{"b":{"type":"Building"}},"vertices":[[1,2,3]]})"
      "\n",
      "town.jsonl"));
  CHECK(lines->format == "CityJSONSeq");
  CHECK(lines->objects == 1);
  const auto outside = required(check_city_text(
      town(kTriangle, "[[[0,1,2]]]", R"("metadata":{"geographicalExtent":[0,0,0,5,5,5]},)"), "town.json"));
  REQUIRE(outside->warnings.size() == 1);
  CHECK(outside->warnings[0].find("geographicalExtent") != std::string::npos);
}

TEST_CASE("a damaged city model is refused in words that name the place") {
  CHECK(refusal("{").find("town.json: not JSON at 1:2") == 0);
  CHECK(contains(refusal("[]"), "expected an object"));
  CHECK(contains(refusal(R"({"version":"2.0"})"), "no \"type\""));
  CHECK(contains(refusal(R"({"type":"CityJSON","version":"0.8"})"), "CityJSON 1.0 to 2.0"));
  CHECK(contains(refusal(town(kTriangle, "[[[0,1,9]]]")), "a: no vertex 9; there are 3"));
  CHECK(contains(refusal(town(kTriangle, "[[0,1,2]]")), "not nested"));
  CHECK(contains(refusal(town("[[18446744073709551616,0,0],[1,0,0],[0,1,0]]", "[[[0,1,2]]]")), "vertex 0"));
  CHECK(contains(refusal(town("[[1e400,0,0]]", "[]")), "beyond all measure"));
  CHECK(refusal(town(kTriangle, "[]", R"("transform":{"scale":[1,1,1],"translate":[1e300,0,0]},)"))
            .find("\"translate\"") != std::string::npos);
  CHECK(refusal(R"({"type":"CityJSONFeature","id":"x","CityObjects":{"b":{"type":"Building"}},"vertices":[]})")
            .find("no city object of that id") != std::string::npos);
  std::string holes = "[[[0,1,2]";
  for (int i = 0; i < 200; ++i) holes += ",[0,1,2]";
  CHECK(contains(refusal(town(kTriangle, holes + "]]")), "cross each other"));
}

TEST_CASE("a wall with a thousand windows is cut; edges that cross each other take of a budget") {
  using Eigen::Vector3d;
  std::vector<std::vector<Vector3d>> wall = {{{0, 0, 0}, {100, 0, 0}, {100, 0, 100}, {0, 0, 100}}};
  for (int i = 0; i < 1000; ++i) {
    const int column = i % 32, storey = i / 32;
    const double x = 1 + 3 * column, z = 1 + 3 * storey;
    wall.push_back({{x, 0, z}, {x, 0, z + 1}, {x + 1, 0, z + 1}, {x + 1, 0, z}});
  }
  CrossingBudget budget;
  CHECK(spend_crossings(wall, budget));
  CHECK(budget.crossings == CrossingBudget{}.crossings);
  double area = 0;
  for (const auto& t : triangulate(wall)) area += 0.5 * (t[1] - t[0]).cross(t[2] - t[0]).norm();
  CHECK(area == doctest::Approx(100 * 100 - 1000));
  // A bow tie has one crossing; a ring of 2,000 random corners has some 600,000.
  budget = {.crossings = 5};
  CHECK(spend_crossings({{{0, 0, 0}, {3, 3, 0}, {3, 0, 0}, {0, 2, 0}}}, budget));
  CHECK(budget.crossings == 4);
  std::mt19937 random(1);
  std::vector<std::vector<Vector3d>> scribble(1);
  for (int i = 0; i < 2000; ++i)
    scribble[0].push_back({static_cast<double>(random() % 10007), static_cast<double>(random() % 10007), 0});
  budget = {};
  CHECK_FALSE(spend_crossings(scribble, budget));
}

TEST_CASE(
    "a thinned model lacks about that part of its buildings, the same ones each time, and their parts with them") {
  const TemporaryFolder folder;
  std::string objects = R"("ground":{"type":"TINRelief"})";
  for (int i = 0; i < 200; ++i) {
    const std::string id = "b" + std::to_string(i);
    objects +=
        ",\"" + id + R"(":{"type":"Building"},")" + id + R"(p":{"type":"BuildingPart","parents":[")" + id + "\"]}";
  }
  std::ofstream(folder / "city.json") << R"({"type":"CityJSON","version":"2.0","vertices":[],"CityObjects":{)" +
                                             objects + "}}";
  const auto left =
      required(write_model_with_errors(folder / "city.json", folder / "less.json", {.missing = 0.2, .seed = 7}));
  CHECK(*left == Between{140, 180});
  CHECK(*write_model_with_errors(folder / "city.json", folder / "again.json", {.missing = 0.2, .seed = 7}) == *left);
  const auto checked = required(check_city_model((folder / "less.json").string()));
  CHECK(checked->objects == 1 + 2 * *left);
  CHECK_FALSE(write_model_with_errors(folder / "none.json", folder / "less.json", {.missing = 0.2, .seed = 7}));
}

TEST_CASE("a model's roofs are off by one height for each building, its foot and its neighbours' roofs are not") {
  const TemporaryFolder folder;
  // Two houses of 10 m that share the corner 3, in centimetres; the second is a part of a building.
  std::ofstream(folder / "city.json")
      << R"({"type":"CityJSON","version":"2.0","transform":{"scale":[0.01,0.01,0.01],"translate":[0,0,0]},)"
      << R"("vertices":[[0,0,0],[500,0,0],[0,0,1000],[500,0,1000],[900,0,0],[900,0,1000]],"CityObjects":{)"
      << R"("a":{"type":"Building","geometry":[{"type":"MultiSurface","lod":"1","boundaries":[[[0,1,3,2]]]}]},)"
      << R"("b":{"type":"Building"},"c":{"type":"BuildingPart","parents":["b"],)"
      << R"("geometry":[{"type":"MultiSurface","lod":"1","boundaries":[[[1,4,5,3]]]}]}}})";
  REQUIRE(write_model_with_errors(folder / "city.json", folder / "off.json", {.roof_sigma_m = 1.5, .seed = 3}));
  const auto off = required(read_city_model(folder / "off.json", Vector3d(0, 0, 0)));
  std::map<std::string, std::set<double>> heights;
  for (const auto& face : off->faces)
    for (const Vector3d& corner : face.corners) heights[off->objects[face.object].id].insert(-corner.z());
  REQUIRE(heights.size() == 2);
  std::vector<double> roofs;
  for (const auto& [id, at] : heights) {
    CHECK(at.size() == 2);
    CHECK(*at.begin() == 0);
    CHECK(std::abs(*at.rbegin() - 10) == Between{0.05, 6});
    roofs.push_back(*at.rbegin());
  }
  CHECK(std::abs(roofs[0] - roofs[1]) > 0.05);
}

TEST_CASE("what is no regular file, or too large, is not read") {
  CHECK(contains(check_city_model("/dev/zero").failure().text, "a device"));
  const TemporaryFolder folder;
  CHECK(check_city_model(folder / "none.json").failure().status == ODO_E_NOT_FOUND);
  const auto file = write_text(folder / "town.json", town(kTriangle, "[[[0,1,2]]]"));
  CHECK(check_city_model(file));
  CityCheckLimits limits;
  limits.file_bytes = 10;
  CHECK(contains(check_city_model(file, limits).failure().text, "at most"));
}

TEST_CASE("an OBJ model's faces are checked against its vertices") {
  const TemporaryFolder folder;
  const auto good =
      required(check_city_model(write_text(folder / "a.obj", "o a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 -1\n")));
  CHECK(good->surfaces == 1);
  const auto bad = check_city_model(write_text(folder / "b.obj", "v 0 0 0\nf 1 2 3\n"));
  REQUIRE_FALSE(bad);
  CHECK(contains(bad.failure().text, "b.obj:2: no vertex 2; there are 1"));
  // The reader of OBJ files does not parse this to a finite number.
  const auto wild = read_city_model(write_text(folder / "c.obj", "v 0 0 0\nv 0e9010 3 0\nv 0 1 0\nf 1 2 2 1 2 3\n"));
  REQUIRE_FALSE(wild);
  CHECK(contains(wild.failure().text, "vertex 2 is no three numbers"));
}

TEST_CASE("a route drawn through a model's streets keeps clear of its houses") {
  // Four by four blocks of 30 m, separated by streets of 14 m.
  std::vector<Building> blocks;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) {
      const Vector3d at(44.0 * i, 44.0 * j, 0);
      blocks.push_back({{at, at + Vector3d(30, 0, 0), at + Vector3d(30, 30, 0), at + Vector3d(0, 30, 0)}, 12, true});
    }
  const TemporaryFolder folder;
  REQUIRE(write_city_json(folder / "city.json", blocks, {}));
  const auto city = required(read_city_model(folder / "city.json", Vector3d(0, 0, 0)));
  StreetRouteParameters p;
  p.length_m = 150;
  const auto route = required(draw_street_route(*city, 3, p));
  double length = 0;
  for (size_t i = 1; i < route->size(); ++i) {
    const Vector3d a = (*route)[i - 1], b = (*route)[i];
    length += (b - a).norm();
    for (double t = 0; t <= 1; t += 0.05) {
      const Vector3d at = a + t * (b - a);
      for (const Building& block : blocks) {
        const Vector3d in = at - block.foot[0];
        CHECK_FALSE((in.x() > -1 && in.x() < 31 && in.y() > -1 && in.y() < 31));
      }
    }
  }
  CHECK(length > 130);
  const auto again = draw_street_route(*city, 3, p), other = draw_street_route(*city, 4, p);
  REQUIRE(again);
  REQUIRE(other);
  CHECK(*again == *route);
  CHECK(*other != *route);
}

TEST_CASE("a generated town's model is read back; damaged models are refused by name") {
  const TemporaryFolder folder;
  const std::string file = (folder / "city.json").string();
  Building house{{Vector3d(0, 0, 0), Vector3d(10, 0, 0), Vector3d(10, 8, 0), Vector3d(0, 8, 0)}, 30, true};
  REQUIRE(write_city_json(file, {house}, {}));
  const auto edges = read_city_outline(file, {});
  CHECK(edges.size() == 12);
  double top = 0;
  for (const Edge& e : edges) top = std::min(top, std::min(e.from.z(), e.to.z()));
  CHECK(top == doctest::Approx(-30));
  CHECK(read_city_outline(file, {.model_origin = {0, 0, 5}})[0].from.z() ==
        doctest::Approx(read_city_outline(file, {})[0].from.z() + 5));
  const auto refusal = [](const std::string& text) {
    return reason_of([&] { parse_city_outline(text, "town.json", {}); });
  };
  CHECK(refusal("{").find("town.json: not CityJSON") == 0);
  CHECK(
      refusal(
          R"({"type":"CityJSON","vertices":[[0,0,0]],"CityObjects":{"a":{"type":"Building","geometry":[{"boundaries":[[0,1,7]]}]}}})")
          .find("a: no vertex 1; there are 1") != std::string::npos);
  CHECK(contains(refusal(R"({"type":"CityJSON","vertices":[],"CityObjects":{}})"), "no building"));
  CHECK(contains(refusal(R"({"type":"CityJSON","vertices":[[1,2]],"CityObjects":{}})"), "vertex 0"));
}
