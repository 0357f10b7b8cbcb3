// SPDX-License-Identifier: Apache-2.0
//
// Anchors through the C API.
#include <Eigen/Geometry>
#include <odograph/anchor.h>
#include <odograph/odograph.hpp>

#include "tests/support/session_app.hpp"

using Eigen::Quaterniond;
using Eigen::Vector3d;

TEST_SUITE_BEGIN("anchors");

namespace {

const std::string kStart = "navigation: {start: {position: [0 m, 0 m, 0 m], heading: 0 rad}}\n";
const std::string kOnEarth =
    "navigation: {origin: {latitude: 0.8 rad, longitude: 0.1 rad, height: 300 m}, start: {position: [0 m, 0 m, 0 m], "
    "heading: 0 rad}}\n";
const std::string kMarks =
    "absolute_fixers:\n  - plugin: fix/waypoint\n    parameters: {use: all, min_sigma: 0.02 m}\n";
const std::string kInertial = "coupling: {type: localizer}\n", kPaper = "coupling: {type: paper}\n";

odo_anchor_place place(uint32_t kind, const Vector3d& p = Vector3d::Zero()) {
  odo_anchor_place out{.struct_size = sizeof out, .kind = kind, .t_ns = ODO_TIME_LATEST};
  Vector3d::Map(out.p) = p;
  return out;
}

odo_anchor_place on_earth(const App& app, const Vector3d& p_n, uint32_t above = ODO_HEIGHT_ELLIPSOID) {
  double geodetic[3];
  CHECK(odo_session_to_geodetic(app.session, p_n.data(), geodetic) == ODO_OK);
  odo_anchor_place out = place(ODO_ANCHOR_GEODETIC);
  out.latitude_rad = geodetic[0], out.longitude_rad = geodetic[1], out.height_m = geodetic[2];
  out.height_above = above;
  return out;
}

uint64_t make(const App& app, const odo_anchor_place& at) {
  uint64_t id = 0;
  REQUIRE(odo_anchor_create(app.session, &at, &id) == ODO_OK);
  return id;
}

odo_anchor get(const App& app, uint64_t id, uint32_t world = ODO_WORLD_CORRECTED, int64_t t_ns = ODO_TIME_LATEST) {
  odo_anchor anchor{};
  anchor.struct_size = sizeof anchor;
  REQUIRE(odo_anchor_get(app.session, id, world, t_ns, &anchor) == ODO_OK);
  return anchor;
}

Vector3d where(const App& app, uint64_t id) { return Vector3d(get(app, id).p_n); }
Vector3d phone(const App& app) { return Vector3d(app.pose(ODO_TIME_LATEST).p_n); }

int64_t ns(int sample) { return static_cast<int64_t>(sample / 100.0 * 1e9) + 1'000'000'000; }

/// A waypoint with a sigma of a few centimetres.
void mark(const App& app, int sample, const Vector3d& p_n, double sigma_m = 0.02) {
  auto waypoint = make_message<odo_waypoint>(ODO_TYPE_WAYPOINT, ns(sample));
  Vector3d::Map(waypoint.p_n) = p_n;
  waypoint.sigma_m = sigma_m;
  CHECK(app.push(waypoint) == ODO_OK);
}

}  // namespace

TEST_CASE("an anchor is seen where it was placed, in n and in the view, at the requested time") {
  App app(kWalk + kInertial + kStart);
  app.walk(0, 1000);
  const odo_pose then = app.pose(ODO_TIME_LATEST);
  const Quaterniond q(then.q_n[0], then.q_n[1], then.q_n[2], then.q_n[3]);
  const Vector3d ahead(0.2, 0.1, 3);
  odo_anchor_place seen = place(ODO_ANCHOR_VIEW, ahead);
  seen.q[0] = std::sqrt(0.5), seen.q[3] = std::sqrt(0.5);
  const char* name = "the door";
  seen.name = {name, 8};
  const uint64_t id = make(app, seen);
  const odo_anchor a = get(app, id);
  CHECK(a.id == id);
  CHECK(a.kind == ODO_ANCHOR_VIEW);
  CHECK(std::string(a.name) == "the door");
  CHECK(a.flags == (ODO_ANCHOR_PLACED | ODO_ANCHOR_VIEW_POSE));
  CHECK(a.state == ODO_TRACKING);
  CHECK((Vector3d(a.p_view) - ahead).norm() < 1e-9);
  CHECK(std::abs(a.q_view[0] - std::sqrt(0.5)) < 1e-9);
  CHECK((Vector3d(a.p_n) - (Vector3d(then.p_n) + q * ahead)).norm() < 1e-9);
  // At the same position of n it is the same; the view at another time differs.
  const uint64_t other = make(app, place(ODO_ANCHOR_POSE, Vector3d(a.p_n)));
  odo_anchor_place before = place(ODO_ANCHOR_POSE, Vector3d(a.p_n));
  before.t_ns = ns(800);
  const uint64_t earlier = make(app, before);
  CHECK(get(app, earlier).view_sigma_m == 0);  // not known yet
  app.walk(1000, 1050);
  CHECK(get(app, earlier).view_sigma_m > 1e-3);
  app.walk(1050, 1600);
  CHECK((where(app, other) - where(app, id)).norm() < 1e-3);
  CHECK((where(app, id) - Vector3d(a.p_n)).norm() < 0.75);  // the step in progress
  const int64_t t_ns = ns(1400);
  const odo_anchor later = get(app, id, ODO_WORLD_CORRECTED, t_ns);
  CHECK(later.t_ns == t_ns);
  const odo_pose pose = app.pose(t_ns);
  const Quaterniond q_later(pose.q_n[0], pose.q_n[1], pose.q_n[2], pose.q_n[3]);
  CHECK((Vector3d(pose.p_n) + q_later * Vector3d(later.p_view) - Vector3d(later.p_n)).norm() < 1e-9);
  CHECK(later.view_sigma_m > get(app, make(app, place(ODO_ANCHOR_VIEW, ahead))).view_sigma_m);
}

TEST_CASE("in C++ an anchor before the first pose is an empty optional, and no id") {
  odo::Session session(odo::Options().text("odograph: 1\n"));
  CHECK_FALSE(session.try_create_anchor(place(ODO_ANCHOR_VIEW)));
  CHECK(session.create_anchor(place(ODO_ANCHOR_VIEW)) == 0);
  CHECK(session.anchors().empty());
  CHECK_THROWS_AS(session.try_create_anchor(place(99)), odo::Error);
  odo_anchor_place north = place(ODO_ANCHOR_GEODETIC);
  north.height_above = ODO_HEIGHT_ELLIPSOID;
  CHECK(session.try_create_anchor(north) == std::optional<uint64_t>(1));  // it waits for n's origin
}

TEST_CASE("a fix at the end of a walk moves each anchor by its own share, not by the newest correction") {
  for (const auto& row : {std::pair(kInertial, 0), {kInertial, 40}, {kPaper, 0}}) {
    const std::string& coupling = row.first;
    const int crowd = row.second;
    CAPTURE(coupling);
    CAPTURE(crowd);  // further anchors on the way, which need more kept poses than there are
    App app(kWalk + coupling + kStart + kMarks);
    const auto walk = [&app, crowd](int from, int to) {
      for (int sample = from; sample < to; sample += crowd ? crowd : to - from) {
        app.walk(sample, std::min(to, sample + (crowd ? crowd : to - from)));
        for (int i = 0; i < crowd / 8; ++i) make(app, place(ODO_ANCHOR_VIEW, {0.1 * i, 0, 1}));
      }
    };
    app.walk(0, 300);
    const uint64_t start = make(app, place(ODO_ANCHOR_VIEW, {0, 0, 1}));
    walk(300, 3000);
    const uint64_t middle = make(app, place(ODO_ANCHOR_VIEW, {0, 0, 1}));
    walk(3000, 6000);
    const uint64_t end = make(app, place(ODO_ANCHOR_VIEW, {0, 0, 1}));
    app.walk(6000, 6010);
    const Vector3d p0 = where(app, start), p1 = where(app, middle), p2 = where(app, end), at = phone(app);
    const Vector3d off(0.02 * at.x(), 0.02 * at.y(), 0);
    REQUIRE(at.norm() > 20);
    mark(app, 6005, at + off);
    app.run(6010, 6020);
    REQUIRE(app.statistics().fixes_accepted == 1);
    const double moved = off.norm();
    CHECK((where(app, start) - p0).norm() < 0.15 * moved);
    CHECK((where(app, middle) - p1).norm() == Between{0.25 * moved, 0.75 * moved});
    CHECK((where(app, end) - p2 - off).norm() < 0.15 * moved);
    if (coupling == kInertial) CHECK(get(app, start).position_sigma_m < get(app, middle).position_sigma_m);
  }
}

TEST_CASE("the first fix of a walk with unknown start moves every anchor with the world") {
  for (const std::string& coupling : {kInertial, kPaper}) {
    CAPTURE(coupling);
    App app(kWalk + coupling + kMarks);
    app.walk(0, 300);
    const uint64_t start = make(app, place(ODO_ANCHOR_VIEW, {0, 0, 1}));
    app.walk(300, 2000);
    const Vector3d p0 = where(app, start), at = phone(app), to(100, -50, 0);
    const odo_anchor seen = get(app, start);
    mark(app, 1999, at + to);
    app.run(2000, 2010);
    REQUIRE(app.statistics().fixes_accepted == 1);
    CHECK((where(app, start) - p0 - to).norm() < 1.5);
    CHECK((Vector3d(get(app, start, ODO_WORLD_CORRECTED, ns(1999)).p_view) - Vector3d(seen.p_view)).norm() < 1.5);
  }
}

TEST_CASE("a geodetic anchor stays at its geodetic position, and waits until n has an origin") {
  App app(kWalk + kInertial + kMarks +
          "navigation: {origin: {latitude: 0.8 rad, longitude: 0.1 rad, height: 300 m}}\n");
  odo_anchor_place at = on_earth(app, {10, 20, -2});
  const uint64_t id = make(app, at);
  at.height_above = ODO_HEIGHT_GEOID, at.height_m -= 47.5, at.geoid_height_m = 47.5;
  const uint64_t above_sea = make(app, at);
  app.walk(0, 1000);
  CHECK(get(app, id).state == ODO_LOST);
  CHECK(get(app, id).reason == ODO_REASON_NO_FIX);
  CHECK(std::string(odo_reason_text(ODO_REASON_NO_FIX)) == "no start position and no position fix yet");
  CHECK(get(app, id).flags == ODO_ANCHOR_ON_EARTH);
  mark(app, 999, {0, 0, 0});
  app.walk(1000, 2000);
  const odo_anchor placed = get(app, id);
  CHECK(placed.state != ODO_LOST);
  CHECK((Vector3d(placed.p_n) - Vector3d(10, 20, -2)).norm() < 1e-6);
  CHECK(std::abs(placed.q_n[0]) > 0.999999);
  CHECK((where(app, above_sea) - Vector3d(10, 20, -2)).norm() < 1e-6);
  CHECK(std::abs(placed.latitude_rad - at.latitude_rad) < 1e-12);
  mark(app, 1999, phone(app) + Vector3d(0.5, 0.3, 0));
  app.run(2000, 2100);
  CHECK((where(app, id) - Vector3d(10, 20, -2)).norm() < 1e-6);
  // A local anchor has a geodetic position, too.
  const odo_anchor local = get(app, make(app, place(ODO_ANCHOR_POSE, {1, 2, 3})));
  double back[3];
  const double geodetic[3] = {local.latitude_rad, local.longitude_rad, local.height_m};
  REQUIRE((local.flags & ODO_ANCHOR_ON_EARTH) != 0);
  CHECK(odo_session_from_geodetic(app.session, geodetic, back) == ODO_OK);
  CHECK((Vector3d(back) - Vector3d(1, 2, 3)).norm() < 1e-6);
}

TEST_CASE("the axes of a geodetic anchor are north, east and down on either hemisphere and on the equator") {
  for (const std::string latitude : {"0.8", "0", "-0.8"}) {
    CAPTURE(latitude);
    App app(kWalk + kInertial + "navigation: {origin: {latitude: " + latitude +
            " rad, longitude: 0.1 rad, height: 300 m}, start: {position: [0 m, 0 m, 0 m], heading: 0 rad}}\n");
    odo_anchor_place at = on_earth(app, {0, 0, 0});
    at.latitude_rad = std::stod(latitude);
    const uint64_t id = make(app, at);
    app.walk(0, 300);
    CHECK(std::abs(get(app, id).q_n[0]) > 0.999999);
  }
}

TEST_CASE("an anchor above terrain stands on the ground of the fixer's model" * doctest::skip(!kCameraPlugins)) {
  const std::string slope = source("tests/data/slope.obj").string();
  App app(kWalk + kInertial + kOnEarth + "absolute_fixers:\n  - plugin: fix/terrain\n    parameters: {model: " + slope +
          ", interval: 1000 s}\n");
  REQUIRE_MESSAGE(app.session != nullptr, app.message);
  odo_anchor_place above = on_earth(app, {5, 2, 0}, ODO_HEIGHT_TERRAIN),
                   nowhere = on_earth(app, {500, 2, 0}, ODO_HEIGHT_TERRAIN);
  above.height_m = nowhere.height_m = 1.5;
  const uint64_t id = make(app, above), off = make(app, nowhere);
  CHECK(get(app, id).state == ODO_LOST);
  app.walk(0, 500);
  CHECK(get(app, id).state != ODO_LOST);
  CHECK((where(app, id) - Vector3d(5, 2, -0.5 - 1.5)).norm() <
        1e-3);  // the ground rises by 0.1 m per metre to the north
  CHECK(get(app, off).reason == ODO_REASON_NO_GROUND);
}

TEST_CASE("in the smooth world no anchor jumps in the picture, and in the corrected world it is corrected at once") {
  App app(kWalk + kInertial + kOnEarth + kMarks);
  app.walk(0, 300);
  const uint64_t start = make(app, place(ODO_ANCHOR_VIEW, {0, 0, 3})), earth = make(app, on_earth(app, {10, 5, 0}));
  app.walk(300, 3000);
  const uint64_t near = make(app, place(ODO_ANCHOR_VIEW, {0, 0, 3}));
  const uint64_t all[] = {start, earth, near};
  const uint32_t worlds[] = {ODO_WORLD_CORRECTED, ODO_WORLD_SMOOTH};
  double jump[2][3] = {}, left[3] = {}, near_jump = 0;
  Vector3d last[2][3];
  for (int sample = 3000; sample < 3600; ++sample) {
    if (sample == 3050) mark(app, 3049, phone(app) + Vector3d(0.5, 0.5, 0));
    app.walk(sample, sample + 1);
    const int64_t t_ns = ns(sample) - 50'000'000;
    for (const uint32_t world : worlds) {
      const odo_pose pose = app.pose(t_ns, world == ODO_WORLD_SMOOTH);
      const Quaterniond q(pose.q_n[0], pose.q_n[1], pose.q_n[2], pose.q_n[3]);
      Vector3d seen[3];  // from the phone, in n: excludes the phone's own rotation
      for (int i = 0; i < 3; ++i) {
        const odo_anchor a = get(app, all[i], world, t_ns);
        seen[i] = q * Vector3d(a.p_view);
        CHECK((Vector3d(pose.p_n) + seen[i] - Vector3d(a.p_n)).norm() < 1e-9);
      }
      // Steps move all of them equally; the near anchor moves with the phone through the correction.
      for (int i = 0; sample > 3000 && i < 3; ++i)
        jump[world][i] = std::max(jump[world][i], (seen[i] - last[world][i] - (seen[2] - last[world][2])).norm());
      if (sample > 3000) near_jump = std::max(near_jump, (seen[2] - last[world][2]).norm());
      std::copy(seen, seen + 3, last[world]);
    }
    for (int i = 0; i < 3; ++i) left[i] = (last[0][i] - last[1][i]).norm();
  }
  REQUIRE(app.statistics().fixes_accepted == 1);
  CHECK(jump[0][0] > 0.4);
  CHECK(jump[0][1] > 0.4);
  CHECK(near_jump < 0.75);  // a step, without a camera
  // 0.5 m/s between two samples is 0.5 cm; the rest is the motion by each step, which is not announced.
  CHECK(jump[1][0] < 0.05);
  CHECK(jump[1][1] < 0.05);
  for (const double m : left) CHECK(m < 0.02);
}

TEST_CASE("anchors are saved with the session and restored at their positions") {
  App app(kWalk + kInertial + kOnEarth);
  app.walk(0, 500);
  odo_anchor_place cafe = on_earth(app, {30, 5, -1});
  cafe.name = {"caf\xc3\xa9", 5};
  make(app, cafe);
  odo_anchor_place local = place(ODO_ANCHOR_POSE, {2, 3, -1});
  local.q[0] = 0.6, local.q[3] = 0.8;
  make(app, local);
  app.walk(500, 600);
  const auto blob = app.saved();

  // Another origin, 400 m away.
  App later(
      kWalk + kInertial +
      "navigation: {origin: {latitude: 0.80005 rad, longitude: 0.10005 rad, height: 310 m}, start: {position: [0 m, "
      "0 m, 0 m], heading: 0 rad}}\n");
  REQUIRE(later.load(blob) == ODO_OK);
  later.walk(0, 500);
  uint64_t ids[3] = {};
  REQUIRE(odo_anchor_list(later.session, ids, 3) == 2);
  for (int i = 0; i < 2; ++i) {
    const odo_anchor before = get(app, static_cast<uint64_t>(i + 1)), after = get(later, ids[i]);
    CHECK(std::string(after.name) == before.name);
    CHECK(after.state == ODO_TRACKING);
    CHECK(std::abs(after.latitude_rad - before.latitude_rad) < 1e-11);
    CHECK(std::abs(after.longitude_rad - before.longitude_rad) < 1e-11);
    CHECK(std::abs(after.height_m - before.height_m) < 1e-5);
    CHECK(std::abs(std::abs(after.q_n[3]) - std::abs(before.q_n[3])) < 1e-4);
    CHECK((Vector3d(after.p_n) - Vector3d(before.p_n)).norm() > 300);
  }

  // Without a geodetic position: restored in the same n if the start is given; not restored if n was arbitrary.
  App here(kWalk + kInertial + kStart);
  here.walk(0, 500);
  make(here, place(ODO_ANCHOR_POSE, {2, 3, -1}));
  here.walk(500, 510);
  const auto same_n = here.saved();
  App again(kWalk + kInertial + kStart), elsewhere(kWalk + kInertial);
  CHECK(again.load(same_n) == ODO_OK);
  CHECK(elsewhere.load(same_n) == ODO_OK);
  again.walk(0, 500), elsewhere.walk(0, 500);
  CHECK((where(again, 1) - where(here, 1)).norm() < 1e-9);
  CHECK(get(elsewhere, 1).state == ODO_LOST);
  CHECK(get(elsewhere, 1).reason == ODO_REASON_NO_FIX);
  make(elsewhere, place(ODO_ANCHOR_POSE, {2, 3, -1}));
  App nowhere(kWalk + kInertial);
  nowhere.walk(0, 500);
  const size_t none = nowhere.saved().size();
  make(nowhere, place(ODO_ANCHOR_POSE, {2, 3, -1}));
  CHECK(nowhere.saved().size() == none);

  auto damaged = blob;
  damaged[blob.size() / 2] ^= 1;
  App untouched(kWalk + kInertial + kStart);
  CHECK(untouched.load(damaged) == ODO_E_DATA);
  CHECK(odo_anchor_list(untouched.session, nullptr, 0) == 0);
}

TEST_CASE("a sensor clock that is set back moves the anchors with the phone") {
  App app(kWalk + kInertial + kStart);
  app.walk(5000, 6000);
  const uint64_t id = make(app, place(ODO_ANCHOR_VIEW, {0, 0, 2}));
  app.walk(6000, 6001);
  const odo_pose before = app.all<odo_pose>(ODO_TYPE_POSE).back();
  app.run(0, 1000);
  const auto corrections = app.all<odo_correction>(ODO_TYPE_CORRECTION);
  REQUIRE(!corrections.empty());
  const odo_correction& restart = corrections.back();
  CHECK(restart.reason == ODO_CORRECTION_RESTART);
  // The phone has not moved: its old pose, transformed, is the first one in the new n.
  const Quaterniond q(restart.q_n[0], restart.q_n[1], restart.q_n[2], restart.q_n[3]);
  const auto poses = app.all<odo_pose>(ODO_TYPE_POSE);
  const auto after =
      std::find_if(poses.begin(), poses.end(), [&](const odo_pose& x) { return x.header.t_ns == restart.header.t_ns; });
  REQUIRE(after != poses.end());
  CHECK(Quaterniond::Identity().angularDistance(q) * Vector3d(before.p_n).norm() >
        0.2);  // otherwise the test shows nothing
  CHECK((q * Vector3d(before.p_n) + Vector3d(restart.p_n) - Vector3d(after->p_n)).norm() < 1e-6);
  CHECK(get(app, id).state != ODO_LOST);
  CHECK((where(app, id) - phone(app)).norm() < 15);  // ten seconds of walking in between
}

TEST_CASE("an anchor in neither world, farther away than any place or with a name of more than 63 bytes is rejected") {
  App app(kWalk + kInertial + kStart);
  app.walk(0, 500);
  odo_anchor_place at = place(ODO_ANCHOR_POSE);
  at.world = 2;
  uint64_t id = 7;
  CHECK(odo_anchor_create(app.session, &at, &id) == ODO_E_ARGUMENT);
  at.world = ODO_WORLD_CORRECTED;
  for (const double far : {1.1e9, -1e154, 1e308}) {
    odo_anchor_place away = at, above = place(ODO_ANCHOR_GEODETIC), vague = above;
    away.p[1] = far, above.height_m = far, vague.sigma_m = std::abs(far);
    for (const odo_anchor_place& each : {away, above, vague})
      CHECK(odo_anchor_create(app.session, &each, &id) == ODO_E_ARGUMENT);
  }
  std::string name;
  for (int i = 0; i < 32; ++i) name += "\xc3\xbc";
  at.name = {name.data(), 64};
  CHECK(odo_anchor_create(app.session, &at, &id) == ODO_E_ARGUMENT);
  at.name = {nullptr, 3};
  CHECK(odo_anchor_create(app.session, &at, &id) == ODO_E_ARGUMENT);
  at.name = {name.data(), 62};
  const uint64_t first = make(app, at);
  CHECK(std::string(get(app, first).name) == name.substr(0, 62));
  odo_anchor anchor{};
  anchor.struct_size = sizeof anchor;
  CHECK(odo_anchor_get(app.session, first, 2, ODO_TIME_LATEST, &anchor) == ODO_E_ARGUMENT);
}
