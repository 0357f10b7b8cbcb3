// SPDX-License-Identifier: Apache-2.0
//
// Poses between those that are kept: the oracle is a motion of constant velocity and rotation, known in closed form.
#include <doctest/doctest.h>

#include <atomic>
#include <thread>

#include "sdk/host/estimator/pose_history.hpp"
#include "sdk/host/estimator/pose_track.hpp"
#include "sdk/host/messages/messages.hpp"
#include "sdk/math/rotation.hpp"

using namespace odograph;
using namespace odograph::inertial;
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

/// Clones every 0.1 s, moments every 0.01 s.
struct Tracked {
  ConstantMotion motion;
  ErrorState e;
  PoseTrack track;
  int64_t now_ns = 0;
  Tracked() {
    e.x.p_n = motion.p(0), e.x.q_n_b = motion.q(0);
    e.clone(0), track.begin_segment();
    while (now_ns < 4 * kStep_ns + kStep_ns / 2) {
      now_ns += kStep_ns / 10;
      e.x.p_n = motion.p(now_ns), e.x.q_n_b = motion.q(now_ns);
      track.add(now_ns, e.clone_back(0), e.x);
      if (now_ns % kStep_ns == 0) e.clone(now_ns), track.begin_segment();
    }
  }
};

}  // namespace

TEST_CASE("between clones the body is where a constant motion has it, at any fraction") {
  const Tracked t;
  for (int64_t ns = kStep_ns; ns <= t.now_ns; ns += 7'000'000) {
    CAPTURE(ns);
    const auto at = t.track.at(ns, t.now_ns, t.e);
    REQUIRE(at);
    CHECK((at->p_n - t.motion.p(ns)).norm() < 1e-9);
    CHECK(at->q_n_b.angularDistance(t.motion.q(ns)) < 1e-7);
  }
  CHECK_FALSE(t.track.at(-1, t.now_ns, t.e));
}

TEST_CASE("what a correction moved at the end of a stretch has moved its middle by its share") {
  Tracked t;
  const Vector3d moved(0.3, -0.2, 0.1);
  t.e.x.p_n += moved;  // the newest clone, half a step before, stays
  const int64_t from_ns = 4 * kStep_ns;
  for (const double share : {0.2, 0.4, 0.8}) {
    const int64_t ns = from_ns + static_cast<int64_t>(share * static_cast<double>(t.now_ns - from_ns));
    const auto at = t.track.at(ns, t.now_ns, t.e);
    REQUIRE(at);
    CHECK((at->p_n - t.motion.p(ns) - share * moved).norm() < 1e-9);
    CHECK(at->w == doctest::Approx(share).epsilon(1e-6));
  }
}

TEST_CASE("between published poses position, orientation and distance go evenly") {
  const ConstantMotion motion;
  PoseHistory history(4);
  for (int64_t k = 0; k < 7; ++k) history.push(pose_of(motion, k * kStep_ns));
  for (int64_t ns = 3 * kStep_ns; ns <= 6 * kStep_ns; ns += 13'000'000) {
    CAPTURE(ns);
    odo_pose at{};
    REQUIRE(history.at(ns, at) == ODO_OK);
    const odo_pose expected = pose_of(motion, ns);
    CHECK(at.header.t_ns == ns);
    CHECK((Vector3d(at.p_n) - Vector3d(expected.p_n)).norm() < 1e-9);
    CHECK(quaternion(at.q_n).angularDistance(motion.q(ns)) < 1e-7);
    CHECK(at.distance_m == doctest::Approx(expected.distance_m).epsilon(1e-9));
    CHECK((at.header.flags & ODO_POSE_EXTRAPOLATED) == 0);
  }
  odo_pose at{};
  CHECK(history.at(3 * kStep_ns - 1, at) == ODO_E_NOT_FOUND);  // four are kept
  REQUIRE(history.at(6 * kStep_ns + 250'000'000, at) == ODO_OK);
  CHECK((at.header.flags & ODO_POSE_EXTRAPOLATED) != 0);
  CHECK((Vector3d(at.p_n) - motion.p(at.header.t_ns)).norm() < 1e-9);
  CHECK(history.at(6 * kStep_ns + 500'000'001, at) == ODO_E_NOT_FOUND);
}

TEST_CASE("nobody sees a pose that is half written") {
  PoseHistory history(8);
  const auto filled = [](int64_t k) {  // one number everywhere
    auto pose = make_message<odo_pose>(ODO_TYPE_POSE, 1 + k % 2);
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
    history.at(INT64_MIN, pose);
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
