// SPDX-License-Identifier: Apache-2.0
//
// Interpolated poses. Oracle: a motion of constant velocity and rotation in closed form.
#include <doctest/doctest.h>

#include <atomic>
#include <thread>

#include "sdk/host/core/pose_stream.hpp"
#include "sdk/host/messages/messages.hpp"
#include "sdk/math/rotation.hpp"

using namespace odograph;
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

TEST_SUITE_END();
