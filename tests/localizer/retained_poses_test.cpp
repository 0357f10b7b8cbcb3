// SPDX-License-Identifier: Apache-2.0
//
// Held poses of the past. The oracle is the present pose, which equals a pose held now.
#include <Eigen/LU>

#include "tests/support/measured_walk.hpp"
#include "tests/support/support.hpp"

using Eigen::Quaterniond;
using Eigen::Vector3d;

TEST_SUITE_BEGIN("retained_poses");

TEST_CASE("holding a pose does not change the filter, bit for bit") {
  const auto run = [](bool holds) {
    WalkMeasurements what{.fix_every_s = 5};
    MeasuredWalk walk(walk_scenario(25), what, 3);
    Composer composer({.type = CouplingType::localizer}, {}, {true, false});
    std::vector<odo_pose> poses;
    walk.run(composer, [&](double, const odo_pose& pose) {
      if (holds && poses.size() % 20 == 0) composer.retain_pose(pose.header.t_ns);
      poses.push_back(pose);
    });
    return poses;
  };
  const auto with = run(true), without = run(false);
  REQUIRE(with.size() == without.size());
  CHECK(std::memcmp(with.data(), without.data(), with.size() * sizeof(odo_pose)) == 0);
}

TEST_CASE("later fixes improve a held pose, consistently with its covariance") {
  double squares = 0, before_m = 0, after_m = 0;
  int count = 0;
  for (uint64_t seed = 1; seed <= 12; ++seed) {
    WalkMeasurements what{.fix_every_s = 12, .fix_sigma_m = 0.1};
    MeasuredWalk walk(walk_scenario(60), what, seed);
    Composer composer({.type = CouplingType::localizer}, {}, {true, false});
    struct Kept {
      uint64_t id;
      double t_s, error_m;
    };
    std::vector<Kept> kept;
    double next_s = 20;
    const auto error_of = [&](const Kept& k, RetainedPose& held) {
      REQUIRE(composer.retained_pose(k.id, held));
      const auto truth = walk.truth(k.t_s);
      return Vector3d(truth.p_n_c - (held.p_n_b + held.q_n_b * walk.p_b_c()));
    };
    walk.run(composer, [&](double t_s, const odo_pose& pose) {
      if (t_s < next_s) return;
      next_s += 4;
      RetainedPose held;
      kept.push_back({composer.retain_pose(pose.header.t_ns), t_s, 0});
      kept.back().error_m = error_of(kept.back(), held).head<2>().norm();
    });
    for (const Kept& k : kept) {
      RetainedPose held;
      const Vector3d error = error_of(k, held);
      const Eigen::Matrix2d P = held.own.block<2, 2>(3, 3);
      squares += error.head<2>().dot(P.inverse() * error.head<2>()) / 2;
      before_m += k.error_m, after_m += error.head<2>().norm();
      ++count;
    }
  }
  MESSAGE(count << " held poses: " << before_m / count << " m off when held, " << after_m / count
                << " m at the end, NEES " << squares / count);
  CHECK(after_m < before_m);
  CHECK(squares / count == Between{0.2, 3});
}

TEST_CASE("updates that consider the pose leave held poses unchanged, and those that move the pose move them equally") {
  Localizer localizer;
  for (const StateIndex i : {kNorth, kEast, kHeading, kStepHeading}) localizer.set(i, 0, 0.04);
  localizer.add_covariance(kHeading, kStepHeading, 0.03);
  const TrackPoint here;
  const uint64_t id = localizer.retain_pose(here, here);
  Innovation seen(1);
  seen.residual[0] = 0.2, seen.noise(0, 0) = 0.01;
  seen.H(0, kStepHeading) = 1;
  REQUIRE(localizer.update(seen, 0, all_but({kStepHeading})).accepted);
  RetainedPose held;
  REQUIRE(localizer.retained_pose(id, 0, held));
  CHECK(held.q_n_b.angularDistance(Quaterniond::Identity()) < 1e-12);
  CHECK(std::abs(held.own(2, 2) - 0.04) < 1e-12);
  REQUIRE(localizer.update(seen, 0).accepted);
  REQUIRE(localizer.retained_pose(id, 0, held));
  CHECK(std::abs(localizer.x()[kHeading]) > 0.01);
  CHECK(std::abs(held.q_n_b.angularDistance(localizer.q_n_o())) < 1e-9);
  CHECK(std::abs(held.own(2, 2) - localizer.P()(kHeading, kHeading)) < 1e-12);
  CHECK(std::abs(held.cross(2, 2) - localizer.P()(kHeading, kHeading)) < 1e-12);
}

TEST_CASE("a shift of the position moves held poses linearly in the path since the last fixed position") {
  struct Case {
    double fixed_m;
    std::array<double, 4> shares;
  };
  for (const Case& c : {Case{-1, {1, 1, 1, 1}}, Case{0, {0, 0.2, 0.6, 1}}, Case{2, {0, 0, 0.5, 1}}}) {
    CAPTURE(c.fixed_m);
    Localizer localizer;
    const double paths_m[] = {0, 2, 6, 10};
    uint64_t ids[4];
    TrackPoint here;
    for (size_t i = 0; i < 4; ++i) here.path_m = paths_m[i], ids[i] = localizer.retain_pose(here, here);
    const Vector3d by_n(1, -2, 0.5);
    localizer.shift(by_n, 0.09 * Eigen::Matrix3d::Identity(), c.fixed_m, 10);
    for (size_t i = 0; i < 4; ++i) {
      RetainedPose held;
      REQUIRE(localizer.retained_pose(ids[i], 0, held));
      CHECK((held.p_n_b - c.shares[i] * by_n).norm() < 1e-12);
      CHECK(held.own(3, 3) == doctest::Approx(0.09 * c.shares[i] * c.shares[i]));
    }
  }
}
