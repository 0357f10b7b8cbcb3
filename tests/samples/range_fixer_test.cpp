// SPDX-License-Identifier: Apache-2.0
//
// samples/plugins_c/fix_range: ranges correct a drifting track, with a consistent covariance in all directions.
#include <Eigen/Eigenvalues>

#include "tests/samples/corridor_walk.hpp"

using Eigen::Matrix3d;
using Eigen::Vector3d;

TEST_SUITE_BEGIN("range_fixer");

namespace {

using RowMatrix3d = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
const std::string kRange = "absolute_fixers: [{plugin: fix/range}]\n";
/// 3 % too long, and rotating by 3 degrees per minute.
const CorridorWalk::Platform kDrifting{1.03, 9e-4, false, 20};

/// Errors of the pose at each second.
std::vector<double> walk(App& app, double seconds, const CorridorWalk::Ranging* ranging) {
  REQUIRE_MESSAGE(app.session != nullptr, app.message);
  CorridorWalk walk;
  std::vector<double> errors;
  CorridorWalk::calibration(app);
  for (int i = 0; i < static_cast<int>(seconds * 100); ++i) {
    const double t = 0.01 * i;
    CorridorWalk::imu(app, t);
    if (i % 5 == 0) {
      const odo_platform_pose pose = walk.platform_pose(t, kDrifting);
      CHECK(app.push(pose) == ODO_OK);
    }
    if (ranging && i % 20 == 7) walk.ranges(app, t, *ranging);
    if (i % 100 == 50 && i > 300) errors.push_back(CorridorWalk::error(app, t - 0.2));
  }
  app.flush();
  return errors;
}

double quantile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values[static_cast<size_t>(share * static_cast<double>(values.size() - 1))];
}

}  // namespace

TEST_CASE("ranges with outliers correct a track that drifts by metres to within a quarter of a metre") {
  App without(platform_config(""), ODO_RUN_REPLAY, sample_plugins());
  const auto drifting = walk(without, 180, nullptr);
  App with(platform_config(kRange), ODO_RUN_REPLAY, sample_plugins());
  const CorridorWalk::Ranging ranging;
  const auto errors = walk(with, 180, &ranging);
  MESSAGE("without ranges " << drifting.back() << " m at the end; with them median " << quantile(errors, 0.5)
                            << " m, 95 % " << quantile(errors, 0.95) << " m, " << with.statistics().fixes_accepted
                            << " fixes, " << with.statistics().fixes_rejected << " rejected");
  CHECK(drifting.back() > 4);
  CHECK(quantile(errors, 0.5) < 0.25);
  CHECK(quantile(errors, 0.95) < 0.6);
  CHECK(with.statistics().fixes_accepted > 200);
  CHECK(with.statistics().plugin_faults == 0);
}

TEST_CASE("a fix's error matches its covariance in each of its axes") {
  App app(platform_config(kRange), ODO_RUN_REPLAY, sample_plugins());
  const CorridorWalk::Ranging ranging;
  walk(app, 120, &ranging);
  const auto fixes = app.all<odo_fix>(ODO_TYPE_FIX);
  REQUIRE(fixes.size() > 150);
  int axes = 0, beyond = 0;
  for (const odo_fix& fix : fixes) {
    CHECK((fix.header.flags & (ODO_FIX_COVARIANCE | ODO_FIX_LEVER)) == (ODO_FIX_COVARIANCE | ODO_FIX_LEVER));
    const double t = static_cast<double>(fix.header.t_ns - CorridorWalk::ns(0)) * 1e-9;
    const Vector3d antenna = CorridorWalk::p_n(t) + CorridorWalk::q_n_b(t) * Vector3d(fix.lever_b);
    const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(Matrix3d(Eigen::Map<const RowMatrix3d>(fix.covariance_n)));
    for (int k = 0; k < 3; ++k) {
      const double off = solver.eigenvectors().col(k).dot(Vector3d(fix.p_n) - antenna);
      ++axes, beyond += std::abs(off) > 3 * std::sqrt(solver.eigenvalues()[k]);
    }
  }
  MESSAGE(beyond << " of " << axes << " axes beyond 3 sigma");
  CHECK(beyond < axes / 50);
}

TEST_CASE("one transmitter gives information along its line of sight only") {
  App app(platform_config(kRange), ODO_RUN_REPLAY, sample_plugins());
  const CorridorWalk::Ranging one{0.1, 0, 100, 3};
  walk(app, 15, &one);
  const auto fixes = app.all<odo_fix>(ODO_TYPE_FIX);
  REQUIRE(fixes.size() > 10);
  for (const odo_fix& fix : fixes) {
    const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(Matrix3d(Eigen::Map<const RowMatrix3d>(fix.covariance_n)));
    const Vector3d u = (Vector3d(fix.p_n) - CorridorWalk::transmitter(3)).normalized();
    CHECK(std::sqrt(solver.eigenvalues()[0]) < 0.6);
    CHECK(std::sqrt(solver.eigenvalues()[1]) > 500);
    CHECK(std::abs(solver.eigenvectors().col(0).dot(u)) > 0.99);
  }
}

TEST_CASE("against a track with a wrong start the ranges finally prevail") {
  App app(platform_config(kRange, "20 m"), ODO_RUN_REPLAY, sample_plugins());
  const CorridorWalk::Ranging ranging;
  const auto errors = walk(app, 60, &ranging);
  MESSAGE("20 m off at first, then " << errors.back() << " m; " << app.statistics().fixes_accepted << " fixes, "
                                     << app.statistics().fixes_rejected << " rejected");
  CHECK(errors.front() > 10);
  CHECK(errors.back() < 0.6);
}

TEST_CASE("ranges of unknown transmitters and impossible ones give no fix") {
  App app(platform_config(kRange), ODO_RUN_REPLAY, sample_plugins());
  walk(app, 4, nullptr);
  auto range = make_message<odo_range>(ODO_TYPE_RANGE, CorridorWalk::ns(4));
  range.range_m = 10, range.sigma_m = 0.1;
  for (int i = 0; i < 100; ++i) {
    range.header.t_ns += 10'000'000;
    CHECK(app.push(range) == ODO_OK);
    CorridorWalk::imu(app, 4 + 0.01 * i);
  }
  app.flush();
  CHECK(app.all<odo_fix>(ODO_TYPE_FIX).empty());
}
