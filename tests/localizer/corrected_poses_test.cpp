// SPDX-License-Identifier: Apache-2.0
//
// A fix of 3 m through the C API: what happens to poses and anchors of the last seconds.
#include <doctest/doctest.h>

#include <array>
#include <string>
#include <vector>

#include <odograph/anchor.h>

#include "sdk/math/rotation.hpp"
#include "tests/support/session_app.hpp"

using namespace odograph;
using Eigen::Quaterniond;
using Eigen::Vector3d;

TEST_SUITE_BEGIN("corrected_poses");

namespace {

const std::string kWaypoints =
    "coupling: {type: localizer}\nabsolute_fixers:\n  - plugin: fix/waypoint\n    parameters: {use: all, min_sigma: "
    "0.02 m}\n";

int64_t ns(int sample) { return static_cast<int64_t>(sample / 100.0 * 1e9) + 1'000'000'000; }

struct Seen {
  odo_pose pose;
  odo_anchor anchor;
};

/// Pose and anchor at a time, in both worlds.
std::array<Seen, 2> see(const App& app, uint64_t anchor, int64_t t_ns) {
  std::array<Seen, 2> seen{};
  for (const uint32_t world : {ODO_WORLD_CORRECTED, ODO_WORLD_SMOOTH}) {
    Seen& now = seen[world];
    now.pose.header.struct_size = sizeof now.pose, now.anchor.struct_size = sizeof now.anchor;
    REQUIRE(odo_session_get_pose_of(app.session, ODO_OF_PIPELINE, world, t_ns, &now.pose) == ODO_OK);
    REQUIRE(odo_anchor_get(app.session, anchor, world, t_ns, &now.anchor) == ODO_OK);
    const Vector3d in_n = quaternion(now.pose.q_n) * Vector3d(now.anchor.p_view) + Vector3d(now.pose.p_n);
    CHECK((in_n - Vector3d(now.anchor.p_n)).norm() < 1e-9);
  }
  return seen;
}

double apart_m(const double* a, const double* b) { return (Vector3d(a) - Vector3d(b)).norm(); }

}  // namespace

TEST_CASE("after a fix of 3 m the poses of the last seconds are in the new n, and the smooth ones where they were") {
  constexpr int kEnd = 3009;
  const std::array<int64_t, 3> times = {ns(kEnd) - 2'000'000'000, ns(kEnd) - 1'000'000'000, ns(kEnd)};
  App app(kWalk + kWaypoints);
  app.walk(0, 3000);
  odo_anchor_place place{};
  place.struct_size = sizeof place;
  place.kind = ODO_ANCHOR_VIEW, place.t_ns = times[1], place.p[2] = -2;
  uint64_t anchor = 0;
  REQUIRE(odo_anchor_create(app.session, &place, &anchor) == ODO_OK);
  app.walk(3000, kEnd + 1);
  odo_session_flush(app.session);
  std::array<std::array<Seen, 2>, 3> before{}, after{};
  for (size_t i = 0; i < times.size(); ++i) before[i] = see(app, anchor, times[i]);

  auto waypoint = make_message<odo_waypoint>(ODO_TYPE_WAYPOINT, ns(kEnd));
  Vector3d::Map(waypoint.p_n) = Vector3d(before[2][0].pose.p_n) + Vector3d(2, -2, 1);
  waypoint.sigma_m = 0.02;
  REQUIRE(odo_session_push(app.session, &waypoint.header) == ODO_OK);
  odo_session_flush(app.session);
  const auto corrections = app.all<odo_correction>(ODO_TYPE_CORRECTION);
  REQUIRE(corrections.size() == 1);
  const Quaterniond q = quaternion(corrections[0].q_n);
  const Vector3d p(corrections[0].p_n);
  for (size_t i = 0; i < times.size(); ++i) {
    CAPTURE(i);
    after[i] = see(app, anchor, times[i]);
    const odo_pose &was = before[i][0].pose, &is = after[i][0].pose;
    CHECK(apart_m(was.p_n, is.p_n) > 2.5);
    CHECK((Vector3d(is.p_n) - (q * Vector3d(was.p_n) + p)).norm() < 1e-9);
    // Near the newest time the attitude is aligned anew with the corrected pose, by a milliradian.
    CHECK(quaternion(is.q_n).angularDistance(q * quaternion(was.q_n)) < 0.002);
    CHECK(apart_m(before[i][1].pose.p_n, after[i][1].pose.p_n) < 1e-9);
    CHECK(quaternion(after[i][1].pose.q_n).angularDistance(quaternion(before[i][1].pose.q_n)) < 0.002);
    // The anchor is in the same place in the view: it has moved once, with the phone.
    for (const size_t world : {0, 1})
      CHECK(apart_m(before[i][world].anchor.p_view, after[i][world].anchor.p_view) < 0.05);
  }
}

TEST_SUITE_END();
