// SPDX-License-Identifier: Apache-2.0
#include <complex>

#include "sdk/tools/simulation/camera.hpp"
#include "sdk/tools/simulation/drive.hpp"
#include "sdk/tools/simulation/walker.hpp"
#include "tests/tools/tags.hpp"

using Eigen::Vector3d;

TEST_SUITE_BEGIN("world");

namespace {

/// A house of 10 x 8 x 6 m on a lawn with a hole under it.
const std::string kHouse = R"({"type": "CityJSON", "version": "2.0",
  "transform": {"scale": [0.001, 0.001, 0.001], "translate": [1000, 2000, 5]},
  "CityObjects": {
    "house": {"type": "Building", "geometry": [{"type": "Solid", "lod": "1", "boundaries": [[
      [[3, 2, 1, 0]], [[4, 5, 6, 7]], [[0, 1, 5, 4]], [[1, 2, 6, 5]], [[2, 3, 7, 6]], [[3, 0, 4, 7]]]]}]},
    "lawn": {"type": "PlantCover", "geometry": [{"type": "MultiSurface", "lod": "1",
      "boundaries": [[[8, 9, 10, 11], [0, 3, 2, 1]]]}]}},
  "vertices": [[5000,5000,0],[15000,5000,0],[15000,13000,0],[5000,13000,0],
               [5000,5000,6000],[15000,5000,6000],[15000,13000,6000],[5000,13000,6000],
               [0,0,0],[30000,0,0],[30000,20000,0],[0,20000,0]]})";

std::string replaced(std::string text, const std::string& what, const std::string& with) {
  text.replace(text.find(what), what.size(), with);
  return text;
}

double area_of(const CityModel& city, CityModel::Kind kind) {
  double area = 0;
  for (const auto& f : city.faces)
    if (f.kind == kind) area += 0.5 * (f.corners[1] - f.corners[0]).cross(f.corners[2] - f.corners[0]).norm();
  return area;
}

}  // namespace

TEST_CASE("a CityJSON model becomes faces with a meaning, without holes, about its south-west corner") {
  const auto city = required(parse_city_json(kHouse, "house.city.json"));
  CHECK(city->origin == Vector3d(1000, 2000, 5));
  CHECK(area_of(*city, CityModel::Kind::wall) == doctest::Approx(2 * (10 + 8) * 6));
  CHECK(area_of(*city, CityModel::Kind::roof) == doctest::Approx(80));
  CHECK(area_of(*city, CityModel::Kind::green) == doctest::Approx(30 * 20 - 80));
  CHECK((city->high - Vector3d(20, 30, 0)).norm() < 1e-9);  // north, east, down
  CHECK(city->low.z() == doctest::Approx(-6));
  for (const auto& f : city->faces)
    if (f.kind == CityModel::Kind::wall) {  // out of the house, whose middle is at north 9, east 10
      const Vector3d out = (f.corners[0] + f.corners[1] + f.corners[2]) / 3 - Vector3d(9, 10, 0);
      CHECK(f.normal.dot(out) > 0);
    }
}

TEST_CASE("a broken city model is rejected with its name, the object and the expected content") {
  const auto why = [](const std::string& text) {
    const auto city = parse_city_json(text, "house.city.json");
    REQUIRE_FALSE(city.ok());
    CHECK(city.failure().text.starts_with("house.city.json: "));
    return city.failure().text;
  };
  CHECK(contains(why("{"), "not JSON"));
  CHECK(contains(why("[]"), "CityJSON"));
  CHECK(contains(why(replaced(kHouse, "\"2.0\"", "\"3.0\"")), "reads CityJSON 1.0 to 2.0"));
  CHECK(contains(why(replaced(kHouse, "[3, 2, 1, 0]", "[3, 2, 1, 12]")), "house: no vertex 12; there are 12"));
  CHECK(contains(why(replaced(kHouse, "[[3, 2, 1, 0]]", "7")), "house: a surface is not a list"));
  CHECK(contains(why(replaced(kHouse, "[0.001, 0.001, 0.001]", "[0.001]")), "transform"));
  CHECK(contains(why(replaced(kHouse, "[5000,5000,0]", "[5000,5000]")), "vertex 0"));
  CHECK(contains(why(replaced(kHouse, "[30000,20000,0]", "[2e8,20000,0]")), "metres"));
  CHECK(contains(why(replaced(kHouse, "[30000,20000,0]", "[3e11,20000,0]")), "farther than"));
}

TEST_CASE("an OBJ model is read as a city with its ground separate") {
  const TemporaryFolder folder;
  const auto file = write_text(folder / "town.obj",
                               "v 0 0 0\nv 10 0 0\nv 10 10 0\nv 0 10 0\nv 0 0 7\nv 10 0 7\nv 10 10 7\nv 0 10 7\n"
                               "g house\nf 1 2 6 5\nf 5 6 7 8\ng terrain\nf 1 2 3 4\n");
  const auto city = required(read_city_model(file));
  CHECK(area_of(*city, CityModel::Kind::wall) == doctest::Approx(70));
  CHECK(area_of(*city, CityModel::Kind::roof) == doctest::Approx(100));
  CHECK(area_of(*city, CityModel::Kind::paved) == doctest::Approx(100));
  CHECK_FALSE(read_city_model(folder / "nothing.obj").ok());
}

TEST_CASE("a generated town's model is read back, without buildings newer than the model") {
  const TemporaryFolder folder;
  Scenario s;
  s.world.type = "downtown", s.world.street_width_m = 26, s.world.house_height_m = 50;
  s.route = {{0, 0, 0}, {120, 0, 0}};
  s.world.unmapped = {{40, 80}};
  s.objects = {{60, 5, 2, 1}};
  const World world(s, 3);
  size_t surveyed = 0, newer = 0;
  for (const Building& b : world.buildings()) (b.surveyed ? surveyed : newer) += 1;
  CHECK(newer > 0);
  REQUIRE(write_city_json(folder / "t.city.json", world.buildings(), world.known_objects()).ok());
  const auto city = required(read_city_model(folder / "t.city.json", Vector3d(0, 0, 0)));
  size_t read = 0;
  for (const auto& o : city->objects) read += o.is_building;
  CHECK(read == surveyed);
  CHECK(city->objects.size() == surveyed + 1);
  double area = 0;
  for (const Building& b : world.buildings())
    if (b.surveyed) area += 2 * b.height_m * ((b.foot[1] - b.foot[0]).norm() + (b.foot[2] - b.foot[1]).norm());
  CHECK(area_of(*city, CityModel::Kind::wall) == doctest::Approx(area).epsilon(1e-4));
}

TEST_CASE("the model of a real town loads, and a route follows its terrain" * doctest::test_suite("world_data")) {
  const auto folder = data_or_skip("city");
  if (folder.empty()) return;
  Scenario s;
  s.world.type = "city", s.world.model = (folder / "delft.city.json").string();
  const auto city = required(read_city_model(s.world.model));
  size_t buildings = 0;
  double highest = 0;
  for (const auto& o : city->objects)
    if (o.is_building) ++buildings, highest = std::max(highest, o.top_up_m - 0.452);
  CHECK(buildings == 160);
  CHECK(highest == doctest::Approx(8.57).epsilon(0.001));
  CHECK((city->high - city->low).head<2>().norm() == doctest::Approx(std::hypot(524.4, 327.6)).epsilon(1e-3));
  s.route = {{152, 152, 0}, {92, 255, 0}};
  const World world(s, 1, &*city);
  CHECK_FALSE(world.route_blocked_at_m());
  double low = 1e9, high = -1e9;
  for (double d = 0; d <= world.route().length(); d += 1) {
    low = std::min(low, world.route().at(d).up), high = std::max(high, world.route().at(d).up);
  }
  CHECK(low >
        0.2);  // its streets are 0.0 to 0.6 m above the zero of the heights, the model's lowest corner 0.45 m below
  CHECK(high < 1.5);
  CHECK(high - low > 0.01);
  s.route = {{84, 366, 0}, {40, 440, 0}};
  CHECK(World(s, 1, &*city).route_blocked_at_m());
}

TEST_CASE("no walk of the samples leads through a house") {
  std::vector<std::vector<Vector3d>> routes;
  for (const auto& file : std::filesystem::directory_iterator(source("samples/scenarios"))) {
    const Scenario scenario = *required(read_scenario(file.path().string()));
    if (scenario.world.type == "city" || scenario.route.size() < 3) continue;  // a straight street has none across
    if (std::find(routes.begin(), routes.end(), scenario.route) != routes.end()) continue;
    routes.push_back(scenario.route);
    const World world(scenario, 41);
    double nearest = 1e9;
    for (const Building& b : world.buildings())
      for (double d = 0; d <= world.route().length(); d += 1) {
        const Eigen::Vector2d p = world.route().at(d).north_east;
        double outside = -1e9;  // of the four sides of the parallelogram
        for (size_t i = 0; i < 4; ++i) {
          const Eigen::Vector2d from = b.foot[i].head<2>(), side = b.foot[(i + 1) % 4].head<2>() - from;
          const Eigen::Vector2d middle = 0.5 * (b.foot[0] + b.foot[2]).head<2>();
          const Eigen::Vector2d normal = Eigen::Vector2d(side.y(), -side.x()).normalized();
          const double inwards = normal.dot(middle - from) < 0 ? 1 : -1;
          outside = std::max(outside, inwards * normal.dot(p - from));
        }
        nearest = std::min(nearest, outside);
      }
    CAPTURE(file.path().string());
    CHECK(nearest > 2);
  }
}

TEST_CASE("AprilTag's own detector finds a tag in a frame at its true position") {
  const TemporaryFolder folder;
  const Recording recording = recorded(past_a_tag(), 2, folder / "tag.odo");
  REQUIRE(recording.true_sightings.size() > 5);
  check_tags(recording, 0.6, [](auto...) {});
}

TEST_CASE("the skyline is that of the buildings along a street") {
  Scenario s;
  s.world.type = "downtown", s.world.street_width_m = 30, s.world.house_height_m = 60, s.world.trees = 0;
  s.route = {{0, 0, 0}, {200, 0, 0}};
  const World world(s, 5);
  const Vector3d eye(100, 0, -1.5);
  const auto line = world.skyline(eye, 360);
  REQUIRE(line.size() == 360);
  size_t checked = 0, agrees = 0;
  for (size_t k = 0; k < line.size(); ++k) {
    // Against the highest edge of all generated walls, computed in the plane.
    const double azimuth = 2 * EIGEN_PI * static_cast<double>(k) / 360;
    const Eigen::Vector2d ray(std::cos(azimuth), std::sin(azimuth));
    double highest = 0;
    for (const Building& b : world.buildings())
      for (size_t i = 0; i < 4; ++i) {
        const Eigen::Vector2d p = b.foot[i].head<2>() - eye.head<2>(),
                              q = b.foot[(i + 1) % 4].head<2>() - eye.head<2>();
        Eigen::Matrix2d A;
        A.col(0) = ray, A.col(1) = p - q;
        if (std::abs(A.determinant()) < 1e-9) continue;
        const Eigen::Vector2d x = A.inverse() * p;
        if (x[0] > 0 && x[1] >= 0 && x[1] <= 1) highest = std::max(highest, std::atan2(b.height_m - 1.5, x[0]));
      }
    if (highest < 0.2) continue;  // lamp posts are there too
    ++checked;
    agrees += std::abs(static_cast<double>(line[k].elevation_rad) - highest) < 0.003;
  }
  CHECK(checked > 250);
  CHECK(agrees >= checked - 2);  // a ray may pass a corner on either side
}

TEST_CASE("a car observes its limits, stops, dives and shakes, and its camera looks up") {
  auto s = required(read_scenario(source("samples/scenarios/drive_short.yaml").string()));
  const Route route(s->route, s->corner_m);
  const Journey drive = make_drive(*s, route, 4);
  const SimCamera camera(s->camera, 1, 1);
  double fastest = 0, sideways = 0, pull = 0, worst_tilt = 0, stopped_s = 0, path = 0;
  const double dt = 0.01;
  for (double t = 0.5; t < drive.phone.duration_s() - 0.5; t += dt) {
    const auto k = drive.phone.at(t);
    const double speed = k.velocity_n.head<2>().norm();
    fastest = std::max(fastest, speed);
    path += speed * dt;
    stopped_s += speed < 0.05 ? dt : 0;
    if (speed > 1) {
      const Eigen::Vector2d v = k.velocity_n.head<2>() / speed, a = k.acceleration_n.head<2>();
      pull = std::max(pull, std::abs(a.dot(v))), sideways = std::max(sideways, std::abs(v.x() * a.y() - v.y() * a.x()));
    }
    const Vector3d looks = camera.pose(drive.phone, t).linear().col(2);
    worst_tilt = std::max(worst_tilt, std::acos(std::min(1.0, -looks.z())));
  }
  CHECK(fastest == Between{7, 10.2});
  CHECK(path == doctest::Approx(route.length()).epsilon(0.01));
  CHECK(stopped_s > 3.0);
  CHECK(pull == Between{1.2, 6.0});  // the roof swings over the bump
  CHECK(sideways == Between{1.2, 4.0});
  CHECK(worst_tilt < 0.12);
  // While standing the engine shakes it at twice its revolutions: 800 per minute.
  double power = 0, other = 0;
  for (const double hz :
       {20.0, 26.0 + 2.0 / 3, 33.0 + 1.0 / 3}) {  // whole periods in 1.2 s, so that gravity averages out
    std::complex<double> sum = 0;
    for (double t = 0.3; t < 1.5; t += 1.0 / 400)
      sum += drive.phone.at(t).specific_force_b().z() * std::polar(1.0, static_cast<double>(-2 * EIGEN_PI * hz * t));
    (std::abs(hz - 26.667) < 1 ? power : other) += std::norm(sum);
  }
  CHECK(power > 3 * other);
}

TEST_CASE("in the pocket the lens sees nothing, and a crowd fills the picture") {
  const TemporaryFolder folder;
  Scenario s;
  s.camera.width = 96, s.camera.height = 72, s.camera.focal_px = 75;
  s.route = {{0, 0, 0}, {20, 0, 0}};
  s.events = {{5, "pocket"}, {12, "texting"}};
  s.world.street_width_m = 7, s.world.pedestrians = 200, s.world.cars = 0;
  const auto made = required(simulate(s, 3, folder / "p.odo"));
  size_t dark = 0, bright = 0;
  for_each_picture(recorded(folder / "p.odo"), [&](const odo_frame& frame) {
    double sum = 0;
    for (int i = 0; i < 96; ++i) sum += frame.planes[0].data[36 * frame.planes[0].row_stride + i];
    (sum / 96 < 25 ? dark : bright) += 1;
  });
  CHECK(dark > 35);
  CHECK(bright > 70);
  double most = 0;
  for (const float part : made->moving_parts) most = std::max(most, static_cast<double>(part));
  CHECK(most == Between{0.15, 0.7});
}

TEST_CASE("between the kerbs the walker is lower by a kerb") {
  Scenario s;
  s.route = {{0, 0, 0}, {30, 0, 0}};
  const Journey level = make_walk(s, 3);
  s.events = {{8, "cross", 6}};
  const Journey crossing = make_walk(s, 3);
  double lower = 0;
  size_t n = 0;
  const double from = 2 + 8 / 1.35;
  for (double t = from + 1.5; t < from + 4.5; t += 0.01, ++n)
    lower += crossing.phone.pose(t).translation().z() - level.phone.pose(t).translation().z();
  CHECK(std::abs(lower / static_cast<double>(n) - 0.12) < 0.012);
}

TEST_CASE("a drive's scenario rejects a walker's actions, and vice versa") {
  const TemporaryFolder folder;
  const auto why = [&](const std::string& text) {
    const auto s = read_scenario(write_text(folder / "s.yaml", "odograph_scenario: 1\n" + text).string());
    REQUIRE_FALSE(s.ok());
    return s.failure().text;
  };
  CHECK(contains(why("carrier: car\nroute:\n  events:\n    - {at: 3 m, do: evade}\n"), "s.yaml:5:"));
  CHECK(contains(why("route:\n  events:\n    - {at: 3 m, do: bump}\n"), "a walker does"));
  CHECK(contains(why("world: {type: city}\n"), "world.model: missing"));
  CHECK(contains(why("world: {model: a.city.json}\n"), "only `type: city`"));
}
