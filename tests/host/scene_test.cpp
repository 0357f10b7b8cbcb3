// SPDX-License-Identifier: Apache-2.0
//
// Landmarks, surfaces and hit tests: the scene alone, and through the C API.
#include <Eigen/Geometry>
#include <odograph/anchor.h>
#include <odograph/plugin_messages.hpp>
#include <odograph/scene.h>

#include "sdk/host/core/scene.hpp"
#include "sdk/math/rotation.hpp"
#include "tests/support/session_app.hpp"
#include "tests/support/test_plugins.hpp"

using Eigen::Quaterniond;
using Eigen::Vector3d;

TEST_SUITE_BEGIN("scene");

namespace {

/// A pose of a camera that looks north.
odo_pose camera_at(const Vector3d& p_n, int64_t t_ns, double scale_sigma = 0.01) {
  auto pose = make_message<odo_pose>(ODO_TYPE_POSE, t_ns);
  pose.header.flags = ODO_POSE_POSITION | ODO_POSE_ORIENTATION | ODO_POSE_METRIC | ODO_POSE_CAMERA;
  Eigen::Matrix3d R_n_c;  // x east, y down, z north
  R_n_c << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  put_quaternion(Quaterniond(R_n_c), pose.q_n);
  Vector3d::Map(pose.p_n) = p_n;
  pose.scale = 1, pose.scale_sigma = scale_sigma;
  return pose;
}

void show(Scene& scene, const Vector3d& p_c, float variance, int64_t t_ns, uint32_t age = 5, double scale = 1,
          double scale_sigma = 0.01) {
  static odo::PointsWriter writer;
  writer.begin(t_ns, 0, 0, true);
  odo_point point{};
  point.id = 1, point.age = age;
  Eigen::Vector3f::Map(point.p_c) = p_c.cast<float>();
  point.covariance[0] = point.covariance[3] = point.covariance[5] = variance;
  writer.add(point);
  scene.hold(writer.message());
  odo_pose pose = camera_at(Vector3d::Zero(), t_ns);
  pose.scale = scale, pose.scale_sigma = scale_sigma * scale;
  scene.see(pose);
}

/// A square of 2 m, whose normal points towards the viewer in the south or upwards.
odo_surface& square(odo::SurfaceWriter& writer, uint64_t id, const Vector3d& p_n, bool floor) {
  writer.begin(1000, id);
  odo_surface& surface = writer.message();
  surface.header.source = 3;
  surface.kind = floor ? ODO_SURFACE_FLOOR : ODO_SURFACE_VERTICAL;
  const Vector3d z = floor ? Vector3d(0, 0, -1) : Vector3d(-1, 0, 0), x(0, 1, 0);
  Eigen::Matrix3d axes;
  axes << x, z.cross(x), z;
  put_quaternion(Quaterniond(axes), surface.q_n);
  Vector3d::Map(surface.p_n) = p_n;
  surface.sigma_m = 0.02, surface.tilt_sigma_rad = 0.01;
  for (const auto& [u, v] : {std::pair(-1.0f, -1.0f), {1.0f, -1.0f}, {1.0f, 1.0f}, {-1.0f, 1.0f}}) writer.add(u, v);
  return surface;
}

std::vector<Scene::Hit> cast(const Scene& scene, const Vector3d& direction, uint32_t wanted = 7) {
  std::vector<Scene::Hit> hits(8);
  hits.resize(scene.cast({Vector3d::Zero(), direction.normalized(), 100, wanted}, Vector3d::Zero(), hits.data(), 8));
  return hits;
}

}  // namespace

TEST_CASE("a landmark is kept if it is known to 5 %, seen three times and in metres, and hit within half a degree") {
  Scene scene;
  const auto count = [&scene] {
    size_t n = 0;
    scene.visit_points([&n](const Vector3d&, double, int64_t) { ++n; });
    return n;
  };
  scene.see(camera_at(Vector3d::Zero(), 1, 0.05));
  show(scene, {0, 0, 2}, 0.01f, 10);  // sqrt(0.03) m is 9 % of 2 m
  CHECK(count() == 0);
  show(scene, {0, 0, 2}, 1e-4f, 20, 2);
  CHECK(count() == 0);
  show(scene, {0, 0, 1}, 2.5e-5f, 30, 5, 2);  // of a front-end with a scale of 2
  CHECK(count() == 1);
  const auto hits = cast(scene, {1, 0.008, 0});
  REQUIRE(hits.size() == 1);
  CHECK(hits[0].what == ODO_HIT_POINT);
  CHECK(hits[0].distance_m == doctest::Approx(2).epsilon(1e-3));
  // 1 cm of its own, 1.6 cm off the ray, and 1 % of scale at 2 m
  CHECK(hits[0].sigma_m == doctest::Approx(std::hypot(0.01, 0.016, 0.02)).epsilon(0.02));
  Scene::Hit later;  // after 3 m with 1 % of drift and of scale, and as near again
  REQUIRE(scene.cast({Vector3d(0, 3, 0), Vector3d(2, -3, 0).normalized(), 100, 7}, Vector3d(0, 3, 0), &later, 1) == 1);
  CHECK(later.sigma_m > std::hypot(0.03, 0.03, 0.036));
  CHECK(cast(scene, {1, 0.01, 0}).empty());
  CHECK(cast(scene, {-1, 0, 0}).empty());
  scene.correct({Quaterniond(Eigen::AngleAxisd(0.5 * EIGEN_PI, Vector3d::UnitZ())), Vector3d(0, 1, 0)});
  REQUIRE(cast(scene, {0, 1, 0}).size() == 1);  // the landmark has moved with the track
  CHECK(cast(scene, {0, 1, 0})[0].distance_m == doctest::Approx(3));
}

TEST_CASE("beside landmarks at other distances a landmark's sigma is that of the edge, and old scales give way") {
  Scene scene;
  show(scene, {0, 0, 2}, 1e-4f, 10);
  const double alone = cast(scene, {1, 0.006, 0})[0].sigma_m;
  show(scene, {0.06, 0, 4}, 1e-4f, 20);  // 0.86 degrees beside it
  const auto hits = cast(scene, {1, 0.006, 0});
  REQUIRE(hits.size() == 1);
  CHECK(hits[0].distance_m == doctest::Approx(2).epsilon(1e-3));
  const double slope = std::sqrt((4 + std::pow(2 / 0.015, 2)) / 2);  // m/rad, with the 45 degrees of one alone
  CHECK(hits[0].sigma_m == doctest::Approx(std::hypot(0.006 * slope, alone)).epsilon(0.03));
  CHECK(hits[0].scale_sigma == doctest::Approx(0.01));
  scene.see(camera_at(Vector3d::Zero(), 30, 0.05));
  show(scene, {0, 0, 2}, 1e-4f, 40, 5, 1, 0.05);
  REQUIRE(cast(scene, {1, 0, 0}).size() == 1);
  scene.see(camera_at(Vector3d::Zero(), 50, 0.04));  // the metre may have changed by 3 %
  CHECK(cast(scene, {1, 0, 0}).size() == 1);
  scene.see(camera_at(Vector3d::Zero(), 60, 0.02));  // by 4.6 %
  CHECK(cast(scene, {1, 0, 0}).empty());
}

TEST_CASE("a ray hits surfaces within their outlines, nearest first, and landmarks that are not part of them") {
  Scene scene;
  scene.see(camera_at(Vector3d::Zero(), 1));
  odo::SurfaceWriter writer;
  scene.take(square(writer, 5, {3, 0, 0}, false), 0);
  scene.take(square(writer, 6, {5, 0, 0}, false), 0);
  auto hits = cast(scene, {1, 0, 0});
  REQUIRE(hits.size() == 2);
  CHECK(hits[0].distance_m == doctest::Approx(3));
  CHECK(hits[1].distance_m == doctest::Approx(5));
  CHECK(hits[0].surface->id == 1);
  Scene::Hit later;  // from 4 m away, with 1 % of drift and of scale
  REQUIRE(scene.cast({Vector3d(-4, 0, 0), Vector3d::UnitX(), 100, 7}, Vector3d(-4, 0, 0), &later, 1) == 1);
  CHECK(later.sigma_m == doctest::Approx(std::hypot(std::hypot(0.02, 0.07), std::hypot(0.04, 0.04), 0.07)));
  CHECK((hits[0].normal_n - Vector3d(-1, 0, 0)).norm() < 1e-9);
  CHECK(cast(scene, {3, 0.9, 0}).size() == 1);  // beside the farther one, which ends a metre to the right
  CHECK(cast(scene, {3, 1.05, 0}).empty());
  CHECK(cast(scene, {3, 0, 2}).empty());
  show(scene, {0, 0, 3.02}, 1e-4f, 10);
  CHECK(cast(scene, {1, 0, 0}).size() == 2);  // the landmark is on the surface
  CHECK(cast(scene, {1, 0, 0}, ODO_HIT_POINT).empty());
  show(scene, {0, 0, 1.5}, 1e-4f, 20);
  hits = cast(scene, {1, 0, 0});
  REQUIRE(hits.size() == 3);
  CHECK(hits[0].what == ODO_HIT_POINT);
}

TEST_CASE("the floor is assumed below a walker's hand until one is found, and goes on beyond what was seen of it") {
  Scene scene(1.7), without;
  for (Scene* each : {&scene, &without}) each->see(camera_at(Vector3d::Zero(), 1));
  CHECK(cast(without, {1, 0, 1}).empty());
  auto hits = cast(scene, {1, 0, 1});
  REQUIRE(hits.size() == 1);
  CHECK(hits[0].what == ODO_HIT_FLOOR);
  CHECK(hits[0].surface == nullptr);
  CHECK(hits[0].p_n.z() == doctest::Approx(0.8 * 1.7));
  CHECK(hits[0].sigma_m > 0.08 * 1.7);
  CHECK(cast(scene, {1, 0, -1}).empty());
  odo::SurfaceWriter writer;
  scene.take(square(writer, 5, {1, 0, 1.3}, true), 0);
  hits = cast(scene, {4, 0, 1.3});
  REQUIRE(hits.size() == 1);
  CHECK(hits[0].what == ODO_HIT_FLOOR);
  CHECK(hits[0].surface->id == 1);
  CHECK(hits[0].p_n.x() == doctest::Approx(4));
  hits = cast(scene, {1.5, 0, 1.3});
  REQUIRE(hits.size() == 1);
  CHECK(hits[0].what == ODO_HIT_SURFACE);
}

TEST_CASE("surfaces have ids of the session; those of a finder that was reset are orphans") {
  Scene scene;
  odo::SurfaceWriter writer;
  CHECK(scene.take(square(writer, 5, {3, 0, 0}, false), 0)->id == 1);
  CHECK(writer.message().id == 1);
  CHECK(scene.take(square(writer, 9, {5, 0, 0}, false), 0)->id == 2);
  CHECK(scene.take(square(writer, 5, {3.5, 0, 0}, false), 0)->id == 1);
  CHECK(scene.surfaces().size() == 2);
  odo_surface& merged = square(writer, 9, {5, 0, 0}, false);
  merged.state = ODO_SURFACE_MERGED, merged.merged_into = 5, merged.count = 0;
  CHECK(scene.take(merged, 0) == nullptr);
  CHECK(merged.id == 2);
  CHECK(merged.merged_into == 1);
  CHECK(scene.surfaces().size() == 1);
  CHECK(scene.take_orphans(3, 0).empty());
  CHECK(scene.take(square(writer, 5, {3, 0, 0}, false), 1)->id == 3);  // after a reset, it counts anew
  const auto orphans = scene.take_orphans(3, 1);
  REQUIRE(orphans.size() == 1);
  CHECK(orphans[0].id == 1);
}

namespace {

const std::string kScene = kWalk + "vo_frontend: {plugin: test/wall_vo}\ncoupling: {type: localizer}\n";

/// Walks with a phone held upright, its camera facing the wall.
void walk_past_wall(App& app, int from, int frames) {
  for (int i = from; i < from + frames; ++i) {
    app.walk(10 * i, 10 * i + 10);
    app.frame(1'000'000'000 + i * int64_t{100'000'000});
  }
  app.flush();
}

int32_t test(const App& app, odo_ray ray, std::vector<odo_hit>& hits, uint32_t capacity = 8) {
  ray.struct_size = sizeof ray;
  hits.assign(std::max(1u, capacity), {});
  hits[0].struct_size = sizeof(odo_hit);
  uint32_t count = 0;
  const int32_t status = odo_session_hit_test(app.session, &ray, hits.data(), capacity, &count);
  hits.resize(count);
  return status;
}

odo_ray through(double column, double row) {
  odo_ray ray{};
  ray.kind = ODO_RAY_PIXEL, ray.t_ns = ODO_TIME_LATEST, ray.pixel[0] = column, ray.pixel[1] = row;
  return ray;
}

}  // namespace

TEST_CASE("C API: a pixel, a ray of the view and one of the world hit the wall that the finder found") {
  const TestPlugins plugins{"wall_vo"};
  RunningApp app(kScene + "surface_finder: {plugin: surface/planes}\n", ODO_RUN_REPLAY, plugins.path());
  std::vector<odo_hit> hits;
  app.push(calibration(64, 48));
  CHECK(test(app, through(32, 24), hits) == ODO_NOT_READY);
  CHECK(hits.empty());
  walk_past_wall(app, 0, 40);
  REQUIRE(test(app, through(32, 24), hits) == ODO_OK);
  REQUIRE(!hits.empty());
  CHECK(hits[0].what == ODO_HIT_SURFACE);
  CHECK(hits[0].surface_kind == ODO_SURFACE_VERTICAL);
  CHECK(hits[0].distance_m == doctest::Approx(1.4).epsilon(0.05));
  CHECK(hits[0].sigma_m < 0.1);
  CHECK(std::abs(hits[0].normal_n[2]) < 0.1);
  CHECK((quaternion(hits[0].q_n) * Vector3d::UnitZ() - Vector3d(hits[0].normal_n)).norm() < 1e-9);
  const odo_pose pose = app.pose(ODO_TIME_LATEST);
  odo_ray ray = through(0, 0);
  ray.kind = ODO_RAY_VIEW, ray.t_ns = pose.header.t_ns, ray.direction[2] = 5;
  std::vector<odo_hit> of_view;
  REQUIRE(test(app, ray, of_view) == ODO_OK);
  REQUIRE(!of_view.empty());
  CHECK(of_view[0].surface == hits[0].surface);
  ray.kind = ODO_RAY_WORLD;
  Vector3d::Map(ray.origin) = Vector3d(pose.p_n);
  Vector3d::Map(ray.direction) = quaternion(pose.q_n) * Vector3d::UnitZ();
  for (ray.world = ODO_WORLD_CORRECTED; ray.world <= ODO_WORLD_SMOOTH; ++ray.world) {
    REQUIRE(test(app, ray, hits) == ODO_OK);
    REQUIRE(!hits.empty());
    CHECK(hits[0].distance_m == doctest::Approx(of_view[0].distance_m).epsilon(1e-3));
  }
  ray.world = ODO_WORLD_CORRECTED, ray.wanted = ODO_HIT_POINT;
  REQUIRE(test(app, ray, hits) == ODO_OK);
  CHECK(hits.empty());  // each landmark is part of the wall
  CHECK(test(app, through(32, 24), hits, 0) == ODO_OK);
  CHECK(hits.empty());
  ray.wanted = 0, ray.max_distance_m = 0.5;
  REQUIRE(test(app, ray, hits) == ODO_OK);
  CHECK(hits.empty());

  // Points and surfaces, as a list and one by one.
  const int64_t number = odo_session_get_points(app.session, ODO_WORLD_CORRECTED, nullptr, 0);
  CHECK(number > 100);
  CHECK(number <= ODO_MOST_MAP_POINTS);
  std::vector<odo_map_point> points(50);
  points[0].struct_size = sizeof(odo_map_point);
  CHECK(odo_session_get_points(app.session, ODO_WORLD_CORRECTED, points.data(), 50) == number);
  for (const odo_map_point& point : points) {
    CHECK(point.struct_size == sizeof point);
    CHECK(point.sigma_m > 0);
    const Vector3d p_c = quaternion(pose.q_n).conjugate() * (Vector3d(point.p_n) - Vector3d(pose.p_n));
    CHECK(p_c.z() == doctest::Approx(1.4).epsilon(0.1));
  }
  uint64_t id = 0;
  CHECK(odo_surface_list(app.session, &id, 1) >= 1);
  alignas(8) char bytes[ODO_LARGEST_SURFACE];
  auto& surface = *reinterpret_cast<odo_surface*>(bytes);
  surface.header.struct_size = sizeof bytes;
  REQUIRE(odo_surface_get(app.session, id, ODO_WORLD_CORRECTED, &surface) == ODO_OK);
  CHECK(message_fault(surface.header) == "");
  CHECK(ODO_VERTEX_AT(&surface, surface.count - 1) != nullptr);
  surface.header.struct_size = sizeof surface;
  CHECK(odo_surface_get(app.session, id, ODO_WORLD_CORRECTED, &surface) == ODO_E_STRUCT_SIZE);
  surface.header.struct_size = sizeof bytes;
  CHECK(odo_surface_get(app.session, 99, ODO_WORLD_CORRECTED, &surface) == ODO_E_NOT_FOUND);
  CHECK(app.all<odo_surface>(ODO_TYPE_SURFACE).front().id == id);
}

TEST_CASE("C API: a hit test refuses what it cannot answer") {
  const TestPlugins plugins{"wall_vo"};
  RunningApp app(kScene, ODO_RUN_REPLAY, plugins.path());
  walk_past_wall(app, 0, 20);
  std::vector<odo_hit> hits;
  const auto status = [&](auto&& change) {
    odo_ray ray = through(32, 24);
    change(ray);
    return test(app, ray, hits);
  };
  CHECK(status([](odo_ray&) {}) == ODO_E_NOT_FOUND);  // no calibration
  app.push(calibration(64, 48));
  walk_past_wall(app, 20, 1);
  CHECK(status([](odo_ray&) {}) == ODO_OK);
  CHECK(status([](odo_ray& r) { r.t_ns = 5; }) == ODO_E_NOT_FOUND);
  CHECK(status([](odo_ray& r) { r.camera = 7; }) == ODO_E_ARGUMENT);
  CHECK(status([](odo_ray& r) { r.kind = 4; }) == ODO_E_ARGUMENT);
  CHECK(status([](odo_ray& r) { r.world = 2; }) == ODO_E_ARGUMENT);
  CHECK(status([](odo_ray& r) { r.pixel[0] = std::nan(""); }) == ODO_E_ARGUMENT);
  CHECK(status([](odo_ray& r) { r.pixel[1] = 1e6; }) == ODO_E_ARGUMENT);
  CHECK(status([](odo_ray& r) { r.pixel[0] = 66; }) == ODO_E_ARGUMENT);  // of 64: a place on the screen
  CHECK(status([](odo_ray& r) { r.max_distance_m = -1; }) == ODO_E_ARGUMENT);
  CHECK(status([](odo_ray& r) { r.kind = ODO_RAY_VIEW; }) == ODO_E_ARGUMENT);  // no direction
  odo_ray ray = through(32, 24);
  odo_hit hit{};
  uint32_t count = 3;
  ray.struct_size = sizeof ray - 8, hit.struct_size = sizeof hit;
  CHECK(odo_session_hit_test(app.session, &ray, &hit, 1, &count) == ODO_E_STRUCT_SIZE);
  CHECK(count == 0);
  ray.struct_size = sizeof ray, hit.struct_size = sizeof hit - 8;
  CHECK(odo_session_hit_test(app.session, &ray, &hit, 1, &count) == ODO_E_STRUCT_SIZE);
  CHECK(odo_session_hit_test(app.session, &ray, nullptr, 1, &count) == ODO_E_ARGUMENT);
  CHECK(odo_session_get_points(app.session, 2, nullptr, 0) == ODO_E_ARGUMENT);
}

TEST_CASE("an anchor on a surface follows it, moves to the one it becomes part of, and stays when it is withdrawn") {
  const TestPlugins plugins{"wall_vo", "scripted_surfaces"};
  RunningApp app(kScene + "surface_finder: {plugin: test/scripted_surfaces}\n", ODO_RUN_REPLAY, plugins.path());
  app.push(calibration(64, 48));
  const auto surfaces = [&app] { return app.all<odo_surface>(ODO_TYPE_SURFACE); };
  int frames = 0;
  const auto until = [&](size_t events) {
    for (; surfaces().size() < events && frames < 200; ++frames) walk_past_wall(app, frames, 1);
    REQUIRE(surfaces().size() == events);
  };
  until(2);
  odo_anchor_place nowhere{.struct_size = sizeof nowhere, .kind = ODO_ANCHOR_HIT, .t_ns = ODO_TIME_LATEST};
  nowhere.surface = surfaces()[1].id + 1;
  uint64_t none = 7;
  CHECK(odo_anchor_create(app.session, &nowhere, &none) == ODO_E_NOT_FOUND);
  CHECK(none == 0);
  const auto place = [&](const odo_surface& on, double sigma_m = 0) {
    odo_anchor_place at{.struct_size = sizeof at, .kind = ODO_ANCHOR_HIT, .t_ns = ODO_TIME_LATEST, .sigma_m = sigma_m};
    std::copy(on.p_n, on.p_n + 3, at.p);
    at.surface = on.id;
    uint64_t id = 0;
    REQUIRE(odo_anchor_create(app.session, &at, &id) == ODO_OK);
    return id;
  };
  const auto get = [&](uint64_t id) {
    odo_anchor anchor{};
    anchor.struct_size = sizeof anchor;
    REQUIRE(odo_anchor_get(app.session, id, ODO_WORLD_CORRECTED, ODO_TIME_LATEST, &anchor) == ODO_OK);
    return anchor;
  };
  const uint64_t first = place(surfaces()[0]), second = place(surfaces()[1]);
  const double down_m = get(first).p_n[2], other_m = get(second).p_n[2];
  CHECK(get(first).kind == ODO_ANCHOR_HIT);
  CHECK(get(first).view_sigma_m < 0.1);
  const odo_anchor vague = get(place(surfaces()[0], 3));  // as of a hit that is known to 3 m
  CHECK(vague.view_sigma_m > 3);
  CHECK(vague.position_sigma_m > 3);
  CHECK(vague.state != ODO_TRACKING);
  until(3);
  CHECK(get(first).p_n[2] - down_m == doctest::Approx(0.1));
  CHECK(get(second).p_n[2] == doctest::Approx(other_m));
  until(4);
  CHECK(surfaces()[3].state == ODO_SURFACE_MERGED);
  CHECK(surfaces()[3].merged_into == surfaces()[0].id);
  CHECK(get(second).kind == ODO_ANCHOR_HIT);
  until(5);
  const odo_anchor left = get(first);
  CHECK(left.kind == ODO_ANCHOR_POSE);
  CHECK((left.flags & ODO_ANCHOR_PLACED) != 0);
  CHECK(left.p_n[2] - down_m == doctest::Approx(0.1));
  CHECK(get(second).kind == ODO_ANCHOR_POSE);
  CHECK(odo_surface_list(app.session, nullptr, 0) == 0);
  CHECK((get(place(surfaces()[0])).flags & ODO_ANCHOR_PLACED) != 0);  // withdrawn since the hit test
  walk_past_wall(app, frames, 30);
  CHECK((Vector3d(get(first).p_n) - Vector3d(left.p_n)).norm() < 0.05);
}

TEST_CASE("a surface finder without a front-end is refused by its place in the config") {
  const App app(kWalk + "surface_finder: {plugin: surface/planes}\n");
  CHECK(app.status == ODO_E_CONFIG);
  CHECK(contains(app.message, "surface_finder: no landmarks; expected a 'vo_frontend' plugin beside it"));
}
