// SPDX-License-Identifier: Apache-2.0
//
// Interpolated poses. Oracle: a motion of constant velocity and rotation in closed form.
// A fix of 3 m through the C API: what happens to poses and anchors of the last seconds.
#include <atomic>
#include <thread>

#include <odograph/anchor.h>

#include "sdk/host/core/pose_stream.hpp"
#include "sdk/host/messages/messages.hpp"
#include "sdk/math/rotation.hpp"
#include "tests/support/session_app.hpp"

using Eigen::Quaterniond;
using Eigen::Vector3d;

TEST_SUITE_BEGIN("pose_between");

namespace {

constexpr int64_t kStep_ns = 100'000'000;

struct ConstantMotion {
  Vector3d velocity{1.2, -0.4, 0.3}, rate_n{0.1, 0.7, -0.5};
  Vector3d p(int64_t t_ns) const { return Vector3d(5, 2, -1) + velocity * (static_cast<double>(t_ns) * 1e-9); }
  Quaterniond q(int64_t t_ns) const {
    return exp_rotation(rate_n * (static_cast<double>(t_ns) * 1e-9)) * Quaterniond(0.8, 0.2, -0.4, 0.4).normalized();
  }
};

odo_pose pose_of(const ConstantMotion& motion, int64_t t_ns) {
  auto pose = make_message<odo_pose>(ODO_TYPE_POSE, t_ns);
  const Quaterniond q = motion.q(t_ns);
  pose.q_n[0] = q.w(), pose.q_n[1] = q.x(), pose.q_n[2] = q.y(), pose.q_n[3] = q.z();
  Vector3d::Map(pose.p_n) = motion.p(t_ns);
  Vector3d::Map(pose.velocity_n) = motion.velocity;
  pose.distance_m = motion.velocity.norm() * static_cast<double>(t_ns) * 1e-9;
  return pose;
}

}  // namespace

TEST_CASE("between published poses position, orientation and distance are interpolated linearly") {
  const ConstantMotion motion;
  PoseHistory history;
  for (int64_t k = -1024; k <= 3; ++k) history.push(pose_of(motion, k * kStep_ns), {});
  for (int64_t ns = -1020 * kStep_ns; ns <= 3 * kStep_ns; ns += 13'000'000) {
    CAPTURE(ns);
    odo_pose at{};
    REQUIRE(history.at(ns, false, at) == ODO_OK);
    const odo_pose expected = pose_of(motion, ns);
    CHECK(at.header.t_ns == ns);
    CHECK((Vector3d(at.p_n) - Vector3d(expected.p_n)).norm() < 1e-9);
    CHECK(quaternion(at.q_n).angularDistance(motion.q(ns)) < 1e-7);
    CHECK(at.distance_m == doctest::Approx(expected.distance_m).epsilon(1e-9));
  }
  odo_pose at{};
  CHECK(history.at(-1020 * kStep_ns - 1, false, at) == ODO_E_NOT_FOUND);  // 1024 are kept
  CHECK(history.at(3 * kStep_ns + 1, false, at) == ODO_E_NOT_FOUND);
}

TEST_CASE("the body's axes and the camera's are never mixed") {
  PoseHistory history;
  auto body = make_message<odo_pose>(ODO_TYPE_POSE, 0), camera = make_message<odo_pose>(ODO_TYPE_POSE, kStep_ns);
  body.q_n[0] = 1;
  camera.header.flags = ODO_POSE_CAMERA;
  put_quaternion(rear_camera_mount(), camera.q_n);
  camera.p_n[2] = 0.2;
  history.push(body, {});
  history.push(camera, {});
  for (const int64_t t_ns : {kStep_ns / 4, 3 * kStep_ns / 4}) {
    odo_pose at{};
    REQUIRE(history.at(t_ns, false, at) == ODO_OK);
    const odo_pose& nearer = t_ns < kStep_ns / 2 ? body : camera;
    CHECK(at.header.flags == nearer.header.flags);
    CHECK(quaternion(at.q_n).angularDistance(quaternion(nearer.q_n)) < 1e-12);
    CHECK(at.p_n[2] == nearer.p_n[2]);
  }
}

TEST_CASE("a correction moves every stored pose, with velocity and covariance, and no smooth pose") {
  const Rigid correction{exp_rotation({0, 0, EIGEN_PI / 2}), {3, -1, 0.5}};
  PoseHistory history;
  for (int64_t k = 0; k < 3; ++k) {
    auto pose = pose_of(ConstantMotion(), k * kStep_ns);
    pose.covariance[0] = 1, pose.covariance[21] = 4, pose.covariance[3] = 0.5;  // north
    pose.velocity_covariance[0] = 9;
    history.push(pose, {quaternion(pose.q_n), Vector3d(pose.p_n)});
  }
  odo_pose before{}, after{}, smooth{};
  REQUIRE(history.at(kStep_ns / 3, false, before) == ODO_OK);
  history.correct(correction);
  REQUIRE(history.at(kStep_ns / 3, false, after) == ODO_OK);
  REQUIRE(history.at(kStep_ns / 3, true, smooth) == ODO_OK);
  CHECK((Vector3d(after.p_n) - (correction.q * Vector3d(before.p_n) + correction.p)).norm() < 1e-12);
  CHECK(quaternion(after.q_n).angularDistance(correction.q * quaternion(before.q_n)) < 1e-7);
  CHECK((Vector3d(after.velocity_n) - correction.q * Vector3d(before.velocity_n)).norm() < 1e-12);
  CHECK(after.covariance[7] == doctest::Approx(1));  // east
  CHECK(after.covariance[28] == doctest::Approx(4));
  CHECK(after.covariance[10] == doctest::Approx(0.5));
  CHECK(after.velocity_covariance[4] == doctest::Approx(9));
  CHECK((Vector3d(smooth.p_n) - Vector3d(before.p_n)).norm() < 1e-12);
  CHECK(quaternion(smooth.q_n).angularDistance(quaternion(before.q_n)) < 1e-7);
}

TEST_CASE("a half-written pose is never visible") {
  PoseStream poses;
  const auto filled = [](int64_t k) {  // the same number everywhere
    auto pose = make_message<odo_pose>(ODO_TYPE_POSE, 1);
    const auto value = static_cast<double>(k);
    std::fill(std::begin(pose.p_n), std::end(pose.p_n), value);
    std::fill(std::begin(pose.covariance), std::end(pose.covariance), value);
    std::fill(std::begin(pose.velocity_covariance), std::end(pose.velocity_covariance), value);
    return pose;
  };
  poses.add_pose(filled(1), {});
  std::atomic<bool> done{false};
  std::thread writer([&] {
    for (int64_t k = 2; k < 50'000; ++k) poses.add_pose(filled(k), {});
    done = true;
  });
  int torn = 0;
  while (!done) {
    odo_pose pose{};
    poses.at(1, false, pose);
    const double value = pose.p_n[0];
    bool same = true;
    for (const double x : pose.p_n) same = same && x == value;
    for (const double x : pose.covariance) same = same && x == value;
    for (const double x : pose.velocity_covariance) same = same && x == value;
    torn += !same;
  }
  writer.join();
  CHECK(torn == 0);
}

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
  app.run(3000, kEnd + 1);
  std::array<std::array<Seen, 2>, 3> before{}, after{};
  for (size_t i = 0; i < times.size(); ++i) before[i] = see(app, anchor, times[i]);

  auto waypoint = make_message<odo_waypoint>(ODO_TYPE_WAYPOINT, ns(kEnd));
  Vector3d::Map(waypoint.p_n) = Vector3d(before[2][0].pose.p_n) + Vector3d(2, -2, 1);
  waypoint.sigma_m = 0.02;
  REQUIRE(app.push(waypoint) == ODO_OK);
  app.flush();
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

TEST_CASE(
    "between steps the pose goes on at the walker's velocity; when no step comes it returns to the last one's end") {
  App app(kWalk);
  app.walk(0, 1500);
  std::vector<odo_pose> drawn;
  for (int i = 1500; i < 3000; i += 2) {  // 50 times a second
    app.walk(i, i + 2);
    drawn.push_back(app.pose(ODO_TIME_LATEST, true));
  }
  const double speed_mps = apart_m(drawn.front().p_n, drawn.back().p_n) / 15;
  REQUIRE(speed_mps > 0.8);
  for (size_t i = 1; i < drawn.size(); ++i) {
    CAPTURE(i);
    CHECK(apart_m(drawn[i - 1].p_n, drawn[i].p_n) == Between{0.2 * speed_mps / 50, 2 * speed_mps / 50});
    REQUIRE((drawn[i].header.flags & ODO_POSE_VELOCITY) != 0);
    CHECK(Vector3d(drawn[i].velocity_n).norm() == Between{0.8 * speed_mps, 1.2 * speed_mps});
  }
  const double still[3] = {0, 0, 0}, gravity[3] = {0, 9.81, 0};
  for (int i = 3000; i < 3400; ++i) odo_session_push_imu(app.session, ns(i), still, gravity);
  const odo_pose standing = app.pose(ODO_TIME_LATEST), last = app.all<odo_pose>(ODO_TYPE_POSE).back();
  CHECK((standing.header.flags & ODO_POSE_POSITION) != 0);
  CHECK((standing.header.flags & ODO_POSE_VELOCITY) == 0);
  CHECK(apart_m(standing.p_n, last.p_n) < 1e-9);
}
