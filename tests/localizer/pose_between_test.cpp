// SPDX-License-Identifier: Apache-2.0
//
// Interpolated poses. Oracle: a motion of constant velocity and rotation in closed form.
#include <doctest/doctest.h>

#include <atomic>
#include <thread>

#include "sdk/host/core/pose_history.hpp"
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
  for (int64_t k = -1024; k <= 3; ++k) history.push(pose_of(motion, k * kStep_ns));
  for (int64_t ns = -1020 * kStep_ns; ns <= 3 * kStep_ns; ns += 13'000'000) {
    CAPTURE(ns);
    odo_pose at{};
    REQUIRE(history.at(ns, at) == ODO_OK);
    const odo_pose expected = pose_of(motion, ns);
    CHECK(at.header.t_ns == ns);
    CHECK((Vector3d(at.p_n) - Vector3d(expected.p_n)).norm() < 1e-9);
    CHECK(quaternion(at.q_n).angularDistance(motion.q(ns)) < 1e-7);
    CHECK(at.distance_m == doctest::Approx(expected.distance_m).epsilon(1e-9));
  }
  odo_pose at{};
  CHECK(history.at(-1020 * kStep_ns - 1, at) == ODO_E_NOT_FOUND);  // 1024 are kept
  CHECK(history.at(3 * kStep_ns + 1, at) == ODO_E_NOT_FOUND);
}

TEST_CASE("a half-written pose is never visible") {
  PoseHistory history;
  const auto filled = [](int64_t k) {  // the same number everywhere
    auto pose = make_message<odo_pose>(ODO_TYPE_POSE, 1);
    const auto value = static_cast<double>(k);
    std::fill(std::begin(pose.p_n), std::end(pose.p_n), value);
    std::fill(std::begin(pose.covariance), std::end(pose.covariance), value);
    std::fill(std::begin(pose.velocity_covariance), std::end(pose.velocity_covariance), value);
    return pose;
  };
  history.push(filled(1));
  std::atomic<bool> done{false};
  std::thread writer([&] {
    for (int64_t k = 2; k < 400'000; ++k) history.push(filled(k));
    done = true;
  });
  int torn = 0;
  while (!done) {
    odo_pose pose{};
    history.at(1, pose);
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
