// SPDX-License-Identifier: Apache-2.0
//
// Held poses of the past. The oracle is the present pose, which equals a pose held now.
#include <cstdlib>
#include <optional>
#include <tuple>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "tests/support/measured_walk.hpp"
#include "tests/support/support.hpp"

using Eigen::Quaterniond;
using Eigen::Vector3d;

TEST_SUITE_BEGIN("kept_poses");

TEST_CASE("holding a pose does not change the filter, bit for bit") {
  const auto run = [](bool holds) {
    WalkMeasurements what{.fix_every_s = 5};
    MeasuredWalk walk(walk_scenario(25), what, 3);
    TestFusion fusion({.type = CouplingType::localizer}, {}, {true, false});
    std::vector<odo_pose> poses;
    walk.run(fusion, [&](double, const odo_pose& pose) {
      if (holds && poses.size() % 20 == 0) fusion->keep_pose(pose.header.t_ns);
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
    TestFusion fusion({.type = CouplingType::localizer}, {}, {true, false});
    struct Kept {
      uint64_t id;
      double t_s, error_m;
    };
    std::vector<Kept> kept;
    double next_s = 20;
    const auto error_of = [&](const Kept& k, KeptPose& held) {
      REQUIRE(fusion->kept_pose(k.id, held));
      const auto truth = walk.truth(k.t_s);
      return Vector3d(truth.p_n_c - (held.p_n_b + held.q_n_b * walk.p_b_c()));
    };
    walk.run(fusion, [&](double t_s, const odo_pose& pose) {
      if (t_s < next_s) return;
      next_s += 4;
      KeptPose held;
      kept.push_back({fusion->keep_pose(pose.header.t_ns).pose_id, t_s, 0});
      kept.back().error_m = error_of(kept.back(), held).head<2>().norm();
    });
    for (const Kept& k : kept) {
      KeptPose held;
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
  PoseFilter filter;
  for (const StateIndex i : {kNorth, kEast}) filter.set(i, 0, 0.04);
  for (const StateIndex i : {kHeading, kStepHeading}) filter.set(i, 0, 0.01);
  filter.add_variance(kHeading, kStepHeading, 0.03);
  const TrackPoint here;
  const uint64_t id = filter.keep_pose(here, here);
  Innovation seen(1);
  seen.residual[0] = 0.2, seen.noise(0, 0) = 0.01;
  seen.H(0, kStepHeading) = 1;
  REQUIRE(filter.update(seen, 0, all_but({kStepHeading})).accepted);
  KeptPose held;
  REQUIRE(filter.kept_pose(id, 0, held));
  CHECK(held.q_n_b.angularDistance(Quaterniond::Identity()) < 1e-12);
  CHECK(std::abs(held.own(2, 2) - 0.04) < 1e-12);
  REQUIRE(filter.update(seen, 0).accepted);
  REQUIRE(filter.kept_pose(id, 0, held));
  CHECK(std::abs(filter.x()[kHeading]) > 0.01);
  CHECK(std::abs(held.q_n_b.angularDistance(filter.q_n_o())) < 1e-9);
  CHECK(std::abs(held.own(2, 2) - filter.P()(kHeading, kHeading)) < 1e-12);
  CHECK(std::abs(held.cross(2, 2) - filter.P()(kHeading, kHeading)) < 1e-12);
}

TEST_CASE("a shift of the position moves held poses linearly in the path since the last fixed position") {
  struct Case {
    double fixed_m;
    std::array<double, 4> shares;
  };
  for (const Case& c : {Case{0, {0, 0.2, 0.6, 1}}, Case{2, {0, 0, 0.5, 1}}}) {
    CAPTURE(c.fixed_m);
    PoseFilter filter;
    const double paths_m[] = {0, 2, 6, 10};
    uint64_t ids[4];
    TrackPoint here;
    for (size_t i = 0; i < 4; ++i) here.path_m = paths_m[i], ids[i] = filter.keep_pose(here, here);
    const Vector3d by_n(1, -2, 0.5);
    filter.place({by_n, Vector3d::Ones(), 0.09 * Eigen::Matrix3d::Identity(), c.fixed_m}, here, here);
    for (size_t i = 0; i < 4; ++i) {
      KeptPose held;
      REQUIRE(filter.kept_pose(ids[i], 0, held));
      CHECK((held.p_n_b - c.shares[i] * by_n).norm() < 1e-12);
      CHECK(held.own(3, 3) == doctest::Approx(0.09 * c.shares[i] * c.shares[i]));
    }
  }
}

TEST_CASE("a first position leaves a pose its error alone, and other poses theirs relative to it") {
  constexpr double kHeading_rad = 0.3, kPath_m = 100, kSigma_m = 5;
  PoseFilter filter;
  filter.set(kHeading, 0, squared(kHeading_rad));
  TrackPoint then, now;
  const uint64_t start = filter.keep_pose(then, then);
  const Vector3d path_n(kPath_m, 0, 0);
  filter.move(path_n, {{kHeading, across(path_n)}}, Eigen::Matrix3d::Zero());
  now.p_o_b = path_n, now.path_m = kPath_m;
  filter.place({{7, 8, 9}, {1, 1, 0}, squared(kSigma_m) * Eigen::Matrix3d::Identity(), {}}, now, now);
  CHECK((filter.p_n() - Vector3d(kPath_m + 7, 8, 9)).norm() < 1e-12);
  CHECK(filter.P()(kNorth, kNorth) == doctest::Approx(squared(kSigma_m)));
  CHECK(filter.P()(kEast, kEast) == doctest::Approx(squared(kSigma_m)));
  CHECK(std::abs(filter.P()(kEast, kHeading)) < 1e-9);  // the path does not show where n's origin is
  CHECK(filter.P()(kHeading, kHeading) == doctest::Approx(squared(kHeading_rad)));
  KeptPose held;
  REQUIRE(filter.kept_pose(start, 0, held));
  CHECK((held.p_n_b - Vector3d(7, 8, 9)).norm() < 1e-12);
  CHECK(held.own(4, 4) == doctest::Approx(squared(kSigma_m) + squared(kPath_m * kHeading_rad)));
  CHECK(held.cross(4, 4) == doctest::Approx(squared(kSigma_m)));
  CHECK(held.own(5, 5) == doctest::Approx(0));  // not of these axes
}

namespace {

/// Any call of the filter with any plausible numbers.
class RandomCalls {
 public:
  RandomCalls(PoseFilter& filter, uint64_t seed, size_t max_kept) : filter_(filter), random_(seed, 5), max_(max_kept) {
    for (int i = 0; i < kStates; ++i) filter_.set(state(i), 0, 1);
    for (size_t i = 0; i < max_; ++i) keep_or_release();
  }
  void call() {
    const StateIndex i = any(), j = any();
    const double x = number(), y = variance();
    const Vector3d v = vector(), w = vector();
    const Eigen::Matrix3d noise = 0.01 * w * w.transpose();
    switch (random_.next() % 14) {
      case 0: return filter_.move(v, {{kHeading, w}, {kLogScale, x * v}}, noise);
      case 1: return i != j ? filter_.add_multiple(i, j, x) : void();
      case 2: return filter_.add_variance(i, y);
      case 3: return i != j ? filter_.add_variance(i, j, y) : void();
      case 4: return filter_.decay(i, v.x(), std::abs(std::tanh(x)), y);
      case 5: return filter_.set(i, x, y);
      case 6: return filter_.set_variance(i, y + 1e-3);
      case 7: return i != j ? filter_.copy_error(i, j) : void();
      case 8: return filter_.place({v, axes(), noise, x}, point(), point());
      case 9: return filter_.rotate(x, v);
      case 10: return filter_.inflate_heading(0.3 * x);
      case 11: return keep_or_release();
      case 12: return filter_.place({v, axes(), noise, {}}, point(), point());
      default: return update();
    }
  }

 private:
  static StateIndex state(int i) { return static_cast<StateIndex>(i); }
  StateIndex any() { return state(static_cast<int>(random_.next() % kStates)); }
  double number() { return random_.normal(); }
  double variance() { return std::pow(10, -4 + std::abs(number())); }
  Vector3d vector() { return {number(), number(), number()}; }
  Vector3d axes() { return {double(random_.next() % 2), double(random_.next() % 2), double(random_.next() % 2)}; }
  TrackPoint point() {
    TrackPoint out;
    out.path_m = std::abs(number()), out.p_o_b = vector(), out.drift_m2 = vector().cwiseAbs(),
    out.heading_drift_rad2 = 0.01 * std::abs(number());
    return out;
  }
  void keep_or_release() {
    const TrackPoint then = point();
    if (ids_.size() < max_) return ids_.push_back(filter_.keep_pose(then, point()));
    const size_t k = random_.next() % ids_.size();
    filter_.release_pose(ids_[k]);
    ids_.erase(ids_.begin() + static_cast<std::ptrdiff_t>(k));
  }
  void update() {
    const int rows = 1 + static_cast<int>(random_.next() % 4);
    Innovation seen(rows);
    for (double& x : seen.H.reshaped()) x = random_.next() % 3 ? 0.0 : number();
    for (int r = 0; r < rows; ++r) seen.residual[r] = 0.1 * number(), seen.noise(r, r) = variance();
    if (random_.next() % 2) seen.drift_then = drift_of(point()), seen.drift_now = drift_of(point());
    for (auto& kept : seen.kept)
      if (!ids_.empty() && random_.next() % 2) {
        kept.id = ids_[random_.next() % ids_.size()], kept.H.resize(rows, 4);
        for (double& x : kept.H.reshaped()) x = number();
      }
    StateSet considered;
    if (random_.next() % 2) considered.set(static_cast<size_t>(any()));
    filter_.update(seen, random_.next() % 2 ? 0 : 9, considered);
  }

  PoseFilter& filter_;
  Random random_;
  size_t max_;
  std::vector<uint64_t> ids_;
};

/// Smallest eigenvalue of the correlations.
double smallest(const PoseFilter& filter) {
  const Eigen::MatrixXd whole = filter.whole_covariance();
  const Eigen::VectorXd scale =
      whole.diagonal().cwiseMax(1e-9 * whole.diagonal().maxCoeff()).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd normal = scale.asDiagonal() * whole * scale.asDiagonal();
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(normal, Eigen::EigenvaluesOnly).eigenvalues().minCoeff();
}

}  // namespace

TEST_CASE("after any calls in any order the covariance is symmetric and positive semidefinite") {
  const char* times = std::getenv("ODOGRAPH_RANDOM_CALLS");  // 1000000 takes some minutes
  const int calls = times ? std::atoi(times) : 50'000;
  for (const auto& row : {std::tuple{4, calls, 1}, std::tuple{64, calls / 50, 20}}) {
    const auto max_kept = std::get<0>(row), count = std::get<1>(row), every = std::get<2>(row);
    PoseFilter filter;
    std::optional<RandomCalls> random(std::in_place, filter, 1, static_cast<size_t>(max_kept));
    double worst = 0, asymmetry = 0;
    for (int i = 0; i < count; ++i) {
      random->call();
      if (i % every != 0) continue;
      const Eigen::MatrixXd whole = filter.whole_covariance();
      REQUIRE(whole.allFinite());
      asymmetry = std::max(asymmetry, (whole - whole.transpose()).cwiseAbs().maxCoeff() / whole.diagonal().maxCoeff());
      worst = std::min(worst, smallest(filter));
      if (whole.diagonal().maxCoeff() < 1e8) continue;
      filter = PoseFilter();  // numbers that no walk has
      random.emplace(filter, static_cast<uint64_t>(i), static_cast<size_t>(max_kept));
    }
    MESSAGE(count << " calls with " << max_kept << " kept poses: smallest eigenvalue of the correlations " << worst);
    CHECK(worst > -1e-6);
    CHECK(asymmetry < 1e-9);
  }
}

TEST_CASE("a relative pose between two kept poses is an ordinary measurement: it closes a loop") {
  PoseFilter filter;
  for (const StateIndex i : {kNorth, kEast, kDown, kHeading}) filter.set(i, 0, 1e-6);
  TrackPoint here;
  const uint64_t first = filter.keep_pose(here, here);
  filter.move({10, 0, 0}, {}, 0.04 * Eigen::Matrix3d::Identity());
  const uint64_t second = filter.keep_pose(here, here);
  filter.move({5, 0, 0}, {}, 0.01 * Eigen::Matrix3d::Identity());
  Innovation seen(3);  // the second is 9.7 m north of the first, not 10
  seen.residual = Vector3d(-0.3, 0, 0);
  seen.noise = 1e-4 * Eigen::Matrix3d::Identity();
  seen.kept[0] = {first, Eigen::MatrixXd::Zero(3, 4)}, seen.kept[1] = {second, Eigen::MatrixXd::Zero(3, 4)};
  seen.kept[0].H.rightCols<3>() = -Eigen::Matrix3d::Identity(), seen.kept[1].H.rightCols<3>().setIdentity();
  REQUIRE(filter.update(seen, kGate[3]).accepted);
  KeptPose one, other;
  REQUIRE((filter.kept_pose(first, 0, one) && filter.kept_pose(second, 0, other)));
  CHECK(std::abs(other.p_n_b.x() - one.p_n_b.x() - 9.7) < 0.002);
  CHECK(std::abs(filter.p_n().x() - 14.7) < 0.002);  // the present pose goes with the second
  CHECK(std::abs(filter.sigma(kNorth) - 0.1) < 0.01);
  seen.kept[0].id = 99;
  CHECK_FALSE(filter.update(seen, 0).accepted);  // no longer kept
}

TEST_CASE(
    "a kept pose is near only if neither unobserved motion nor a turned heading lies between, and neighbours merge") {
  PoseFilter filter;
  for (const StateIndex i : {kNorth, kEast, kDown, kHeading}) filter.set(i, 0, 1);
  const TrackPoint here;
  const uint64_t id = filter.keep_pose(here, here);
  CHECK(filter.nearest_kept(here, here, 0.02, 5e-3).pose_id == id);  // though both are known to a metre only
  PoseFilter turned = filter, carried = filter;
  turned.add_variance(kHeading, 1e-4);
  CHECK(turned.nearest_kept(here, here, 0.02, 5e-3).pose_id == 0);
  carried.add_variance(kEast, 100);  // a camera that was covered while its carrier walked on
  CHECK(carried.nearest_kept(here, here, 0.02, 5e-3).pose_id == 0);
  while (!carried.crowded()) {
    carried.add_variance(kEast, carried.whole_covariance().rows() == 4 * 30 + kStates ? 1e-6 : 1);
    REQUIRE(carried.keep_pose(here, here) != 0);
  }
  CHECK(carried.keep_pose(here, here) == 0);
  const auto merge = required(carried.crowded());
  CHECK(merge->from == 31);
  CHECK(merge->to == 30);
  carried.release_pose(merge->from);
  CHECK_FALSE(carried.crowded());
}
