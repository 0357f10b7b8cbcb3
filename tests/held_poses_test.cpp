// SPDX-License-Identifier: Apache-2.0
//
// Poses of the past that are held: the oracle is a clone, which is the same pose among the filter's own states.
#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "tests/estimator_walk.hpp"

using namespace odograph;
using namespace odograph::inertial;
using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

TEST_SUITE_BEGIN("held_poses");

namespace {

constexpr int64_t kStep_ns = 100'000'000;  // between clones

struct Numbers {
  std::mt19937 generator{5};
  double operator()() { return static_cast<double>(generator()) / 2147483648.0 - 1; }
  Vector3d vector() { return Vector3d((*this)(), (*this)(), (*this)()); }
};

/// Time passes: 0.1 s of samples.
void propagate(ErrorState& e, Numbers& number) {
  ImuTransition transition;
  for (int i = 0; i < 10; ++i) transition.add(e.x.q_n_b.toRotationMatrix(), number.vector() * 3, 0.01);
  e.propagate(transition, {1e-4, 1e-6, 1e-3, 1e-5, 1e-3});
}

template <int D>
Innovation<D> seen(const ErrorState& e, Numbers& number, double sigma) {
  Innovation<D> out;
  for (int i = 0; i < D; ++i) out.residual[i] = 0.01 * number();
  Eigen::Matrix<double, D, 3> a, b;
  for (int i = 0; i < D; ++i) a.row(i) = number.vector().transpose(), b.row(i) = number.vector().transpose();
  out.by_pose({e.x.q_n_b, e.x.p_n, e.column_back(1), e.column_back(0), 0.3}, a, b);
  out.by(kVoPosition, a);
  out.by_one(kLogScale, Innovation<D>::Vector::Constant(0.5));
  out.noise = Eigen::Matrix<double, D, D>::Identity() * sigma * sigma;
  return out;
}

/// The largest difference between a held pose's covariance and its clone's after a measurement of each single error,
/// on copies: only where the two share the same with all of them it is none.
double worst_after_each(const ErrorState& e, uint64_t id, int clone) {
  double worst = 0;
  for (int i = 0; i < kSize; ++i) {
    if (e.P(i, i) < 1e-12) continue;
    ErrorState measured = e;
    Innovation<1> z;
    z.by_one(i, Innovation<1>::Vector::Ones());
    z.noise(0, 0) = 0.1 * e.P(i, i);
    HeldPose held;
    CHECK(measured.update(z, 0).accepted);
    CHECK(measured.held(id, held));
    worst = std::max(worst, (held.own - measured.P.block<6, 6>(clone, clone)).norm());
  }
  return worst;
}

}  // namespace

TEST_CASE("a held pose is moved by every kind of update as the clone of its time is") {
  ErrorState e;
  Numbers number;
  for (int i = 0; i < kSize; ++i) e.P(i, i) = i < kFirstClone ? 0.01 + 0.001 * i : 0.0;
  e.x.p_n = Vector3d(3, -2, 1), e.x.v_n = Vector3d(1.2, 0.1, 0);
  e.clone(0);
  for (int i = 1; i < 4; ++i) propagate(e, number), e.clone(i * kStep_ns);
  e.attach_vo({e.x.q_n_b, e.x.p_n, kTheta, kTheta, 1.0}, Quaterniond(0, 1, 0, 0), Vector3d(0.03, 0.05, 0), 1e-4, 1e-5);
  const int clone = e.column_back(0);
  const Clone& twin = e.clone_back(0);
  const uint64_t id = e.hold({twin.q_n_b, twin.p_n, clone, clone, 1.0}, twin.t_ns, 0);
  const auto same = [&](const std::string& after) {
    CAPTURE(after);
    CHECK(worst_after_each(e, id, clone) < 1e-9);
    propagate(e, number);  // what else the two share comes to the fore with time
    HeldPose held;
    REQUIRE(e.held(id, held));
    CHECK((held.p_n_b - twin.p_n).norm() < 1e-9);
    CHECK(held.q_n_b.angularDistance(twin.q_n_b) < 1e-7);
    CHECK((held.own - e.P.block<6, 6>(clone, clone)).norm() < 1e-9);
    CHECK((held.cross - e.P.block<6, 6>(clone, kTheta)).norm() < 1e-9);
    CHECK((held.now - e.P.block<6, 6>(kTheta, kTheta)).norm() == 0);
  };
  same("the beginning");
  for (int round = 0; round < 3; ++round) {
    propagate(e, number), same("time");
    e.move_vo(Quaterniond(1, 0.01, 0, 0).normalized(), number.vector(), number.vector(), 1e-4, 1e-5), same("move_vo");
    CHECK(e.update(seen<3>(e, number, 0.05), 0).accepted);
    same("a plain update");
    CHECK(e.update(seen<1>(e, number, 0.05), 0, Hold::scale_and_steps).accepted);
    same("what is held");
    CHECK(e.update(seen<6>(e, number, 0.05), 0, Hold::all_but_scale_and_steps).accepted);
    same("few alone");
    CHECK(e.update(seen<3>(e, number, 0.05), 0, Hold::all_but_steps).accepted);
    same("steps alone");
    e.set_scale(0.1, 0.04, 0.5), same("set_scale");
    e.loosen_heading(0.1), same("loosen_heading");
    e.rotate(Eigen::Quaterniond(Eigen::AngleAxisd(2.5, Eigen::Vector3d::UnitZ())), Vector3d(3, -1, 0.5)), same("turn");
    e.loosen_velocity_since(0, 4 * kStep_ns, 1.0), same("loosen_velocity_since");
    e.attach_vo({e.x.q_n_b, e.x.p_n, e.column_back(1), kTheta, 0.4}, Quaterniond(0, 1, 0, 0), Vector3d(0.03, 0.05, 0),
                1e-4, 1e-5),
        same("attach_vo");
    e.clone((4 + round) * kStep_ns), same("another clone");
    e.set_independent(kStepHeading, 0.2), same("set_independent");
    e.wander(kLogScale, 0.8, 0.01), same("wander");
    CHECK(e.update(seen<3>(e, number, 0.02), 0).accepted);
    same("an update at last");
  }
  e.let_go(id);
  HeldPose held;
  CHECK_FALSE(e.held(id, held));
}

TEST_CASE("a held pose takes its share of a correction and of the correction's doubt") {
  ErrorState e;
  Numbers number;
  for (int i = 0; i < kFirstClone; ++i) e.P(i, i) = 0.01 + 0.001 * i;
  e.clone(0);
  propagate(e, number), e.clone(kStep_ns);
  constexpr double kFixed_m = 10, kNow_m = 50;
  const Vector3d by_n(1, -2, 0.5);
  const Matrix3d doubt = Vector3d(0.3, 0.2, 0.1).asDiagonal();
  std::vector<std::pair<uint64_t, double>> ids;  // and the share
  for (const double share : {0.0, 0.25, 1.0})
    ids.emplace_back(
        e.hold({e.x.q_n_b, e.x.p_n, kTheta, kTheta, 1.0}, kStep_ns, kFixed_m + share * (kNow_m - kFixed_m)), share);
  HeldPose before;
  REQUIRE(e.held(ids.front().first, before));
  e.shift(by_n);
  e.loosen_position(doubt);
  e.shift_held(by_n, doubt, kFixed_m, kNow_m);
  for (const auto& [id, share] : ids) {
    CAPTURE(share);
    HeldPose held;
    REQUIRE(e.held(id, held));
    CHECK((held.p_n_b - before.p_n_b - share * by_n).norm() < 1e-12);
    // The correction errs by d, the pose by share * d.
    const Matrix3d own = held.own.bottomRightCorner<3, 3>() - before.own.bottomRightCorner<3, 3>();
    const Matrix3d cross = held.cross.bottomRightCorner<3, 3>() - before.cross.bottomRightCorner<3, 3>();
    CHECK((own - share * share * doubt).norm() < 1e-12);
    CHECK((cross - share * doubt).norm() < 1e-12);
  }
}

TEST_CASE("what ties the body to a front-end that leads leaves held poses where they are, and later fixes do not") {
  ErrorState e;
  Numbers number;
  for (int i = 0; i < kFirstClone; ++i) e.P(i, i) = 0.01 + 0.001 * i;
  e.clone(0);
  propagate(e, number), e.clone(kStep_ns);
  const uint64_t id = e.hold({e.x.q_n_b, e.x.p_n, kTheta, kTheta, 1.0}, kStep_ns, 0);
  HeldPose before, after;
  REQUIRE(e.held(id, before));
  for (int i = 0; i < 20; ++i) {
    propagate(e, number);
    CHECK(e.update(seen<3>(e, number, 0.01), 0, Hold::odometry_and_scale).accepted);
  }
  REQUIRE(e.held(id, after));
  CHECK(after.p_n_b == before.p_n_b);
  CHECK(after.own == before.own);
  Eigen::Matrix<double, 12, 12> joint;
  joint << after.own, after.cross, after.cross.transpose(), after.now;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 12, 12>> solver(joint);
  CHECK(solver.eigenvalues().minCoeff() > -1e-9);
  CHECK(e.update(seen<3>(e, number, 0.01), 0).accepted);
  REQUIRE(e.held(id, before));
  CHECK(before.p_n_b != after.p_n_b);
  CHECK(before.own.trace() < after.own.trace());
}

TEST_CASE("what is held changes nothing of the filter, to the bit") {
  const auto run = [](bool holds) {
    WalkMeasurements what;
    what.fix_every_s = 5;
    EstimatorWalk walk(estimator_scenario(25), what, 3);
    CouplingConfig config;
    config.type = CouplingType::inertial;
    InertialEstimator estimator(config, {}, {true, false});
    std::vector<odo_pose> poses;
    walk.run(estimator, [&](double, const odo_pose& pose) {
      if (holds && poses.size() % 20 == 0) estimator.hold_pose(pose.header.t_ns);
      poses.push_back(pose);
    });
    return poses;
  };
  const auto with = run(true), without = run(false);
  REQUIRE(with.size() == without.size());
  bool same = true;
  for (size_t i = 0; i < with.size(); ++i) same = same && std::memcmp(&with[i], &without[i], sizeof(odo_pose)) == 0;
  CHECK(same);
}

TEST_CASE("a held pose is nearer to the truth after the fixes that come later, as near as it says") {
  double squares = 0, before_m = 0, after_m = 0;
  int count = 0;
  for (uint64_t seed = 1; seed <= 12; ++seed) {
    WalkMeasurements what;
    what.fix_every_s = 12;
    what.fix_sigma_m = 0.1;
    EstimatorWalk walk(estimator_scenario(60), what, seed);
    CouplingConfig config;
    config.type = CouplingType::inertial;
    InertialEstimator estimator(config, {}, {true, false});
    struct Kept {
      uint64_t id;
      double t_s, error_m;
    };
    std::vector<Kept> kept;
    double next_s = 20;
    const auto error_of = [&](const Kept& k, HeldPose& held) {
      REQUIRE(estimator.held_pose(k.id, held));
      const auto truth = walk.truth(k.t_s);
      return Vector3d(truth.p_n_c - (held.p_n_b + held.q_n_b * walk.p_b_c()));
    };
    walk.run(estimator, [&](double t_s, const odo_pose& pose) {
      if (t_s < next_s) return;
      next_s += 4;
      HeldPose held;
      kept.push_back({estimator.hold_pose(pose.header.t_ns), t_s, 0});
      kept.back().error_m = error_of(kept.back(), held).head<2>().norm();
    });
    for (const Kept& k : kept) {
      HeldPose held;
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
  CHECK(squares / count < 3);
  CHECK(squares / count > 0.2);
}

TEST_SUITE_END();
