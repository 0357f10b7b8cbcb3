// SPDX-License-Identifier: Apache-2.0
#include <fstream>
#include <string>

#include <doctest/doctest.h>
#include <opencv2/imgcodecs.hpp>

#include "plugins/fix/known_object/read_objects.hpp"
#include "sdk/host/base/geodesy.hpp"
#include "sdk/tools/simulation/poster.hpp"
#include "tests/support/support.hpp"

using namespace odograph;
using namespace odograph::known_object;
using Eigen::Matrix3d;
using Eigen::Vector3d;

TEST_SUITE_BEGIN("known_object");

namespace {

constexpr double kDegree = EIGEN_PI / 180;

std::string why(const std::filesystem::path& file) {
  try {
    read_objects(file);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("YAML and GeoJSON give the same object, by its corners and by its centre") {
  const TemporaryFolder folder;
  cv::imwrite((folder / "p.png").string(), poster_picture(1, 1, {60, 90}));
  const double latitude = 47.2, longitude = -1.55, height = 20;
  Geodesy earth;
  earth.set_origin({latitude * kDegree, longitude * kDegree, height});
  // It faces east: the reader looks west, right is north.
  const Vector3d corners[] = {{-0.6, 0, 0.9}, {0.6, 0, 0.9}, {0.6, 0, -0.9}, {-0.6, 0, -0.9}};
  std::string yaml = "odograph_objects: 1\nobjects:\n  - id: p\n    picture: p.png\n    corners:\n", ring;
  for (int k = 0; k < 5; ++k) {
    const Vector3d& c = corners[k % 4];
    const auto g = earth.to_geodetic({c.x(), c.y(), c.z()});
    char text[200];
    std::snprintf(text, sizeof text, "%.10f, %.10f", g[0] / kDegree, g[1] / kDegree);
    if (k < 4) yaml += std::string("      - [") + text + ", " + std::to_string(g[2]) + "]\n";
    std::snprintf(text, sizeof text, "%s[%.10f, %.10f, %.5f]", k ? ", " : "", g[1] / kDegree, g[0] / kDegree, g[2]);
    ring += text;
  }
  const std::string feature = "{\"type\": \"FeatureCollection\", \"features\": [{\"type\": \"Feature\", ";
  write_text(folder / "o.yaml", yaml);
  write_text(folder / "o.geojson", feature +
                                       "\"properties\": {\"id\": \"p\", \"picture\": \"p.png\"}, \"geometry\": "
                                       "{\"type\": \"Polygon\", \"coordinates\": [[" +
                                       ring + "]]}}]}");
  write_text(folder / "point.json",
             feature +
                 "\"properties\": {\"id\": \"p\", \"picture\": \"p.png\", \"facing_deg\": 90, \"width\": 1.2, "
                 "\"height\": 1.8}, \"geometry\": {\"type\": \"Point\", \"coordinates\": [-1.55, 47.2, 20]}}]}");
  Matrix3d axes;
  axes << 1, 0, 0, 0, 0, -1, 0, 1, 0;  // right is north, down is down, into the wall is west
  for (const char* name : {"o.yaml", "o.geojson", "point.json"}) {
    CAPTURE(name);
    const auto objects = read_objects(folder / name);
    REQUIRE(objects.size() == 1);
    const PlaneObject& o = objects.front();
    CHECK(o.place.geodetic);
    CHECK((o.place.R_n_o - axes).norm() < 1e-3);
    CHECK(o.width_m == doctest::Approx(1.2).epsilon(1e-4));
    CHECK(o.height_m == doctest::Approx(1.8).epsilon(1e-4));
    CHECK(std::abs(o.place.latitude_rad / kDegree - latitude) < 1e-8);
    CHECK(std::abs(o.place.longitude_rad / kDegree - longitude) < 1e-8);
    CHECK(std::abs(o.place.height_m - height) < 1e-3);
    CHECK(o.picture.cols == 60);
  }
}

TEST_CASE("an error in a file of objects is reported with the object") {
  const TemporaryFolder folder;
  const std::string head = "odograph_objects: 1\nobjects:\n  - ";
  const auto says = [&](const std::string& text, const std::string& expected) {
    write_text(folder / "o.yaml", text);
    const std::string said = why(folder / "o.yaml");
    CHECK_MESSAGE(said.find(expected) != std::string::npos, said);
  };
  const std::string square = "corners_n: [[5, 0, 0], [5, 1, 0], [5, 1, -1], [5, 0, -1]]";
  says("", "empty or unreadable");
  says("objects: []", "expected 'odograph_objects: 1'");
  says("odograph_objects: 1\nobjects: []", "expected 1 to 1000 objects");
  says(head + "{tag: 3, " + square + "}", "object 1: id: expected a name");
  says(head + "{id: a, " + square + "}", "expected either picture or tag");
  says(head + "{id: a, tag: 3, family: 12h1, " + square + "}", "family '12h1' is unknown");
  says(head + "{id: a, tag: 100000, " + square + "}", "has no tag 100000");
  says(head + "{id: a, picture: none.png, " + square + "}", "none.png");
  says(head + "{id: a, tag: 3, corners_n: [[5, 0, 0], [5, 1, 0], [5, 2, -1], [5, 0, -1]]}", "do not form a rectangle");
  says(head + "{id: a, tag: 3, corners_n: [[5, 0, 0], [5, 1, 0], [5, 1, -1]]}", "corners: expected four");
  says(head + "{id: a, tag: 3, " + square + "}\n  - {id: a, tag: 4, " + square + "}", "the id 'a' occurs twice");
  says("a: &x [1]\nb: *x", "line 2, column 4: aliases are not supported");
  says("a: 1\na: 2", "the key 'a' occurs twice");
  const std::string deep = std::string(100, '[') + std::string(100, ']');
  says("a: " + deep, "more than 64 levels");
  write_text(folder / "o.json", "{\"type\": \"FeatureCollection\", \"features\": [{\"properties\": {}}]}");
  CHECK(why(folder / "o.json").find("object 1: expected a geometry") != std::string::npos);
  CHECK(why(source("tests/data/objects.yaml")).empty());
}

TEST_SUITE_END();
