// SPDX-License-Identifier: Apache-2.0
//
// Faults in the estimator's input: the error stays bounded, the covariance reflects it, and the estimator recovers.
// `odograph-tests --test-suite=estimator_faults --success` prints the table of docs/accuracy.md.
#include <Eigen/LU>

#include "tests/support/measured_walk.hpp"
#include "tests/support/messages.hpp"
#include "tests/support/support.hpp"

using Eigen::Vector3d;

TEST_SUITE_BEGIN("estimator_faults");

namespace {

constexpr double kFrom_s = 40, kAfter_s = 20;
constexpr double kBeyond = 11.83;  // chi-square of two degrees of freedom at three sigmas of one

struct Run {
  double before_m = 0;              // largest error before the fault
  double worst_m = 0;               // from its start until kAfter_s after its end, in excess of the one at its start
  double after_m = 0;               // at kAfter_s after its end, in excess of the one at its start
  double sigma_m = 0, grown_m = 0;  // along the worse axis, at its start and at its end
  double beyond_s = 0;              // longest time beyond three sigmas
  bool finite = true, oriented = true;
};

/// A visual-inertial front-end, as in the recommended pipeline.
WalkMeasurements usual() {
  WalkMeasurements what;
  what.odometry.inverse_scale = 1, what.odometry.scale_sigma = 0.02, what.odometry.scale_walk = 5e-4;
  what.odometry.position_m = 0.003, what.odometry.rotation_rad = 0.0005;
  what.odometry.rotation_walk = Odometry::Parameters().inertial_rotation_walk;
  return what;
}

Run run(const WalkMeasurements& what, double for_s, uint64_t seed) {
  MeasuredWalk walk(walk_scenario(150), what, seed);
  TestFusion fusion({.type = CouplingType::localizer}, {}, {what.camera, false});
  Run r;
  bool has_start = false;
  Vector3d start = Vector3d::Zero(), error_at_fault = Vector3d::Zero();
  double last_t = 0, beyond_s = 0;
  walk.run(fusion, [&](double t, const odo_pose& pose) {
    if ((pose.header.flags & ODO_POSE_POSITION) == 0) return;
    const Vector3d truth = walk.truth(t).p_n_c, p(pose.p_n);
    if (!has_start) has_start = true, start = what.fix_every_s > 0 ? Vector3d(Vector3d::Zero()) : Vector3d(truth - p);
    const Vector3d error = p + start - truth;
    const Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>> P(pose.covariance);
    const Eigen::Matrix2d horizontal = P.block<2, 2>(3, 3) + 1e-4 * Eigen::Matrix2d::Identity();
    const double sigma_m = std::sqrt(horizontal.diagonal().maxCoeff());
    r.finite = r.finite && p.allFinite();
    r.oriented = r.oriented && (pose.header.flags & ODO_POSE_ORIENTATION) != 0;
    if (t < kFrom_s) {
      r.before_m = std::max(r.before_m, error.head<2>().norm());
      error_at_fault = error, r.sigma_m = sigma_m;
    } else if (t < kFrom_s + for_s + kAfter_s) {
      r.worst_m = std::max(r.worst_m, (error - error_at_fault).head<2>().norm());
      r.after_m = (error - error_at_fault).head<2>().norm();
      if (t < kFrom_s + for_s + 0.5) r.grown_m = std::max(r.grown_m, sigma_m);
    }
    const double nis = error.head<2>().dot(horizontal.inverse() * error.head<2>());
    const bool placed = what.fix_every_s == 0 || t > 3 * what.fix_every_s;
    beyond_s = placed && nis > kBeyond ? beyond_s + t - last_t : 0;
    r.beyond_s = std::max(r.beyond_s, beyond_s), last_t = t;
  });
  return r;
}

/// The worst of each figure over five walks, and the mean of the sigmas.
Run worst_of(const char* name, WalkMeasurements what, double for_s) {
  Run worst;
  for (uint64_t seed = 11; seed <= 15; ++seed) {
    const Run r = run(what, for_s, seed);
    worst.before_m = std::max(worst.before_m, r.before_m), worst.worst_m = std::max(worst.worst_m, r.worst_m);
    worst.after_m = std::max(worst.after_m, r.after_m), worst.beyond_s = std::max(worst.beyond_s, r.beyond_s);
    worst.sigma_m += r.sigma_m / 5, worst.grown_m += r.grown_m / 5;
    worst.finite = worst.finite && r.finite, worst.oriented = worst.oriented && r.oriented;
  }
  MESSAGE(std::string(name) << ": before " << worst.before_m << " m; since it began " << worst.worst_m
                            << " m, 20 s after its end " << worst.after_m << " m; sigma " << worst.sigma_m << " -> "
                            << worst.grown_m << " m; beyond 3 sigma for " << worst.beyond_s << " s");
  CHECK(worst.finite);
  CHECK(worst.oriented);
  return worst;
}

/// Without odometry, which restarts after the outage.
void blind(WalkMeasurements& what, double for_s) {
  what.odometry.blind_from_s = kFrom_s, what.odometry.blind_to_s = kFrom_s + for_s;
  what.change = [](double t, odo_vo_motion& m) {
    if (t > kFrom_s) m.scale_group = 1;
  };
}

}  // namespace

TEST_CASE("the error stays bounded during a fault and consistent with the covariance, which grows where it must") {
  struct Row {
    const char* name;
    double for_s, worst_m;
    void (*disturb)(WalkMeasurements& what);
    double grown_by = 0, grown_m = 0;  ///< least growth of the sigma, and its least size
  };
  constexpr Row rows[] = {
      {"nothing", 10, 1.5, [](WalkMeasurements&) {}},
      {"odometry dead for 10 s", 10, 3.0, [](WalkMeasurements& what) { blind(what, 10); }, 1.2},  // of 13 m by steps
      {"camera off for 4 s: the orientation is kept", 4, 2.0,
       [](WalkMeasurements& what) {
         what.odometry.off_from_s = kFrom_s, what.odometry.off_to_s = kFrom_s + 4;
         what.change = [](double t, odo_vo_motion& m) {  // restarts: the first motion after the gap is missing
           if (t > kFrom_s && t < kFrom_s + 4.2) m.header.flags = 0, m.state = ODO_LOST;
           if (t > kFrom_s) m.scale_group = 1;
         };
       }},
      {"no IMU for 2 s, nor the odometry that needs it", 2.5, 3.0,
       [](WalkMeasurements& what) {
         what.no_imu_from_s = kFrom_s, what.no_imu_to_s = kFrom_s + 2;
         blind(what, 2.5);
       },
       1.2},
      {"positions 40 m off for 60 s", 60, 8,
       [](WalkMeasurements& what) {
         what.fix_every_s = 1, what.fix_sigma_m = 4;
         what.change_fix = [](double t, odo_fix& fix) {
           if (t > kFrom_s && t < kFrom_s + 60) fix.p_n[1] += 40;
         };
       }},
      {"a fix lies by 50 m, once", 5, 4,
       [](WalkMeasurements& what) {
         what.fix_every_s = 5, what.fix_sigma_m = 2;
         what.change_fix = [](double t, odo_fix& fix) {
           if (t > kFrom_s && t < kFrom_s + 5) fix.p_n[0] += 50;
         };
       }},
      {"in a pocket for 15 s, steps' heading off by 0.5 rad", 15, 13,  // of 20 m walked
       [](WalkMeasurements& what) {
         blind(what, 15);
         what.change_step = [](double t, odo_step& s) {
           if (t >= kFrom_s && t <= kFrom_s + 15) s.mode = ODO_MODE_WALKING_POCKET, s.heading_rad += 0.5;
         };
       },
       0, 3},
      {"turned by 0.6 rad on the way into a pocket, seen by the camera", 15, 4,
       [](WalkMeasurements& what) {
         blind(what, 15);
         what.change_step = [](double t, odo_step& s) {
           if (t < kFrom_s - 2 || t > kFrom_s + 15) return;
           s.mode = ODO_MODE_WALKING_POCKET;
           if (t < kFrom_s + 0.5) s.heading_rad += 0.6;
         };
       }},
  };
  for (const Row& row : rows) {
    CAPTURE(row.name);
    WalkMeasurements what = usual();
    row.disturb(what);
    const Run r = worst_of(row.name, what, row.for_s);
    CHECK(r.worst_m < row.worst_m);
    CHECK(r.after_m < row.worst_m);
    CHECK(r.grown_m > std::max(row.grown_by * r.sigma_m, row.grown_m));
    CHECK(r.beyond_s < 5);
  }
}

TEST_CASE("steps that are reported twice count once") {
  WalkMeasurements what = usual();
  what.step_times = [](double t) { return t > kFrom_s && t < kFrom_s + 20 ? 2 : 1; };
  Run r = worst_of("steps told twice for 20 s, beside a camera", what, 20);
  CHECK(r.worst_m < 1.5);
  CHECK(r.beyond_s < 5);
  what.camera = false;
  r = worst_of("steps told twice for 20 s, without a camera", what, 20);
  what.step_times = {};
  const Run once = worst_of("the same steps told once", what, 20);
  CHECK(r.worst_m < once.worst_m + 1.5);  // of 26 m: each step counts once
  CHECK(r.beyond_s < 5);
}

TEST_CASE("a step faster than any walker is rejected and reported, and one of no length is not used") {
  WalkMeasurements what{.camera = false, .end_s = 12};
  MeasuredWalk walk(walk_scenario(40), what, 3);
  CouplingConfig config{.type = CouplingType::localizer};
  config.fastest_mps = 2;
  TestFusion fusion(config, {}, {false, false});
  walk.run(fusion, [](double, const odo_pose&) {});
  while (fusion.take_notice().key) continue;
  auto step = step_between(MeasuredWalk::ns(11.3), MeasuredWalk::ns(11.9), MeasuredWalk::ns(11.95), 6.1,
                           0.05);  // 10 m/s are 6 m
  step.mode = ODO_MODE_WALKING_TEXTING;
  CHECK_FALSE(fusion.update(&step).accepted);
  CHECK(std::string(fusion.take_notice().key) == "fast_step");
  step.length_m = 0;
  CHECK_FALSE(fusion.update(&step).accepted);
  CHECK(fusion.take_notice().key == nullptr);
  step.length_m = 0.9;
  CHECK(fusion.update(&step).accepted);
}

TEST_CASE("steps that wait for a camera which never moves are all used") {
  TestFusion fusion({.type = CouplingType::localizer}, {}, {true, false});
  fusion.update(FrameTime{0});
  for (int64_t k = 1; k <= 70; ++k) {
    const int64_t t_ns = k * 100'000'000;
    auto attitude = attitude_at(t_ns, Eigen::Quaterniond::Identity(), 1e-4);
    fusion.update(&attitude);
    if (k == 20 || k == 25) {
      auto step = step_between(t_ns - 500'000'000, t_ns, t_ns, 0.7, 0.05);
      fusion.update(&step);
    }
    fusion.update(FrameTime{t_ns});
  }
  CHECK(fusion.filter().p_n().head<2>().norm() == doctest::Approx(1.4).epsilon(0.05));
}

TEST_CASE("an attitude source that has stopped neither rotates the track nor corrects its inclination") {
  for (const Orientation orientation : {Orientation::attitude, Orientation::vo}) {
    CAPTURE(static_cast<int>(orientation));
    CouplingConfig config{.type = CouplingType::localizer};
    config.orientation = orientation;
    TestFusion fusion(config, {}, {true, false});
    for (int64_t k = 0; k <= 30; ++k) {  // it stops after 1 s; then the phone leans by 0.6 rad about north
      const int64_t t_ns = k * 100'000'000;
      auto attitude = attitude_at(t_ns, Eigen::Quaterniond::Identity(), 1e-4);
      if (k <= 10) fusion.update(&attitude);
      fusion.update(FrameTime{t_ns});
      if (k == 0) continue;
      auto motion = motion_between(t_ns - 100'000'000, t_ns, {0.1, 0, 0}, ODO_VO_ROTATION | ODO_VO_TRANSLATION);
      const Eigen::Quaterniond q_b0_b1(Eigen::AngleAxisd(k <= 10 ? 0 : 0.03, Eigen::Vector3d::UnitX()));
      put_quaternion(rear_camera_mount().conjugate() * q_b0_b1 * rear_camera_mount(), motion.q_c0_c1);
      fusion.update(RelativeMotion{&motion, nullptr});
    }
    Estimate now;
    REQUIRE(fusion.at({}, now) == ODO_OK);
    CHECK(log_rotation(now.q_n_b).x() == doctest::Approx(0.6).epsilon(0.05));
  }
}

TEST_CASE("an orientation composed from the gyroscope goes on after a gap from where the camera brought it") {
  CouplingConfig config{.type = CouplingType::localizer};
  config.orientation = Orientation::gyroscope;
  TestFusion fusion(config, {}, {true, false});
  const double rate_radps = 0.3;  // about down
  for (int64_t k = 0; k <= 400; ++k) {
    const int64_t t_ns = k * 10'000'000;
    const bool gap = k > 100 && k < 300;
    if (!gap) fusion->on_imu(imu_at(t_ns, {0, 0, rate_radps}, {0, 0, -9.81}));
    if (k % 10) continue;
    fusion.update(FrameTime{t_ns});
    if (k == 0) continue;
    auto motion = motion_between(t_ns - 100'000'000, t_ns, {0, 0, 0.1}, ODO_VO_ROTATION | ODO_VO_TRANSLATION);
    const Eigen::Quaterniond q_b0_b1(Eigen::AngleAxisd(0.1 * rate_radps, Eigen::Vector3d::UnitZ()));
    put_quaternion(rear_camera_mount().conjugate() * q_b0_b1 * rear_camera_mount(), motion.q_c0_c1);
    fusion.update(RelativeMotion{&motion, nullptr});
  }
  Estimate now;
  REQUIRE(fusion.at({}, now) == ODO_OK);
  CHECK(log_rotation(now.q_n_b).z() == doctest::Approx(1.2).epsilon(0.03));
}
