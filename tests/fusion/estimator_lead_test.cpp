// SPDX-License-Identifier: Apache-2.0
//
// Front-ends that use inertia themselves, and the effect of a first fix.
#include "sdk/math/atmosphere.hpp"
#include "tests/support/measured_walk.hpp"
#include "tests/support/messages.hpp"
#include "tests/support/support.hpp"

using Eigen::Quaterniond;
using Eigen::Vector3d;

TEST_SUITE_BEGIN("estimator");

TEST_CASE("with an accurate visual-inertial front-end the track is the front-end's own, without a jump at the start") {
  for (const double start_s : {0.0, 6.0})
    for (uint64_t seed = 1; seed <= 10; ++seed) {
      WalkMeasurements what;
      what.start_s = start_s;
      what.odometry.inverse_scale = 1, what.odometry.scale_sigma = 0.03;
      what.odometry.position_m = 0.003, what.odometry.rotation_rad = 0.0005;
      what.step_factor_sigma = 0.3;  // steps not calibrated to this walker
      Quaterniond q = Quaterniond::Identity();
      Vector3d own = Vector3d::Zero(), own_from = own, from = own;
      double worst_m = 0, worst_jump_m = 0, before_m = -1;
      what.change = [&](double, odo_vo_motion& m) {
        own += q * Vector3d(m.p_c0_c1);
        q = q * Quaterniond(m.q_c0_c1[0], m.q_c0_c1[1], m.q_c0_c1[2], m.q_c0_c1[3]);
      };
      MeasuredWalk walk(walk_scenario(40), what, seed);
      TestFusion fusion({.type = CouplingType::localizer}, {}, {true, false});
      walk.run(fusion, [&](double, const odo_pose& pose) {
        if ((pose.header.flags & ODO_POSE_METRIC) == 0) return;
        if (before_m < 0) own_from = own, from = Vector3d(pose.p_n);
        const double difference_m = (Vector3d(pose.p_n) - from).norm() - (own - own_from).norm();
        worst_m = std::max(worst_m, std::abs(difference_m));
        if (before_m >= 0) worst_jump_m = std::max(worst_jump_m, std::abs(difference_m - before_m));
        before_m = before_m < 0 ? 0 : difference_m;
      });
      CAPTURE(start_s);
      CAPTURE(seed);
      CHECK(worst_m < 0.1);  // of 40 m
      CHECK(worst_jump_m < 0.05);
    }
}

TEST_CASE("a first sample in free fall does not tilt the walk permanently") {
  for (const double tilt_rad : {0.0, 0.3, 1.1, -2.5})
    for (uint64_t seed = 1; seed <= 5; ++seed) {
      WalkMeasurements what;
      what.start_s = 4;
      what.odometry.inverse_scale = 1, what.odometry.scale_sigma = 0.02;
      what.odometry.position_m = 0.003, what.odometry.rotation_rad = 0.0005;
      what.first_tilt_rad = tilt_rad;
      MeasuredWalk walk(walk_scenario(40), what, seed);
      TestFusion fusion({.type = CouplingType::localizer}, {}, {true, false});
      double worst_tilt_rad = 0, first_s = -1, height_m = 0, true_height_m = 0;
      walk.run(fusion, [&](double t, const odo_pose& pose) {
        if ((pose.header.flags & ODO_POSE_METRIC) == 0) return;
        if (first_s < 0) first_s = t, height_m = pose.p_n[2], true_height_m = walk.truth(t).p_n_c.z();
        if (t < first_s + 0.5) return;
        const Quaterniond q(pose.q_n[0], pose.q_n[1], pose.q_n[2], pose.q_n[3]);
        worst_tilt_rad = std::max(worst_tilt_rad, log_rotation(walk.truth(t).q_n_c * q.conjugate()).head<2>().norm());
        CHECK(std::abs(pose.p_n[2] - height_m - (walk.truth(t).p_n_c.z() - true_height_m)) < 0.5);
      });
      CAPTURE(tilt_rad);
      CAPTURE(seed);
      CHECK(first_s > 0);
      CHECK(worst_tilt_rad < 0.05);
    }
}

TEST_CASE("motion before the first metric motion is part of the first position") {
  for (const double tilt_rad : {0.0, 0.2, -0.2})
    for (const double start_s : {0.0, 4.0})            // standing, walking
      for (const double silent_s : {0.6, 1.3, 6.0}) {  // inertia covers 1.5 s of it
        WalkMeasurements what;
        what.start_s = start_s;
        what.odometry.inverse_scale = 1, what.odometry.scale_sigma = 0.02;
        what.odometry.position_m = 0.003, what.odometry.rotation_rad = 0.0005;
        what.first_tilt_rad = tilt_rad;
        what.step_times = [](double) { return 0; };
        what.change = [&](double t, odo_vo_motion& m) {
          if (t > start_s + silent_s) return;
          m.header.flags &= ~(ODO_VO_METRIC | ODO_VO_INERTIAL | ODO_VO_TRANSLATION);
          m.state = ODO_DEGRADED, m.reason = ODO_REASON_INITIALISING, m.scale_group = 77;
        };
        MeasuredWalk walk(walk_scenario(20), what, 3);
        CouplingConfig config{.type = CouplingType::localizer};
        TestFusion fusion(config, {}, {true, false});
        std::optional<double> off_m;
        double sigma_m = 0;
        walk.run(fusion, [&](double t, const odo_pose& pose) {
          if ((pose.header.flags & ODO_POSE_METRIC) == 0 || off_m) return;
          sigma_m = std::sqrt(pose.covariance[21]);
          const Vector3d moved = walk.truth(t).p_n_c - walk.truth(start_s).p_n_c;
          off_m = std::abs(Vector3d(pose.p_n).head<2>().norm() - moved.head<2>().norm());
        });
        CAPTURE(tilt_rad);
        CAPTURE(start_s);
        CAPTURE(silent_s);
        REQUIRE(off_m);
        if (silent_s < 1.5) CHECK(*off_m < 0.15);
        CHECK(*off_m < 3 * sigma_m + 0.15);
        CHECK(sigma_m < config.fastest_mps * silent_s);
      }
}

TEST_CASE("a heading drifted by the gyroscope's bias before the walk has a matching sigma") {
  for (const double rate_radps : {0.0, 0.01, -0.015})
    for (uint64_t seed = 1; seed <= 5; ++seed) {
      constexpr double kStands_s = 6;  // until then the front-end's rotation is the gyroscope's, with a wrong bias
      WalkMeasurements what;
      what.odometry.inverse_scale = 1, what.odometry.scale_sigma = 0.02;
      what.odometry.position_m = 0.003, what.odometry.rotation_rad = 0.0005, what.odometry.rotation_walk = 3e-4;
      double last_s = -1;
      what.change = [&](double t, odo_vo_motion& m) {
        const double dt_s = last_s < 0 ? 0 : t - last_s;
        last_s = t;
        if (t > kStands_s) return;
        m.scale_sigma = 1;
        const Quaterniond astray = exp_rotation(rate_radps * dt_s * Vector3d(m.gravity_c1));
        const Quaterniond q = Quaterniond(m.q_c0_c1[0], m.q_c0_c1[1], m.q_c0_c1[2], m.q_c0_c1[3]) * astray;
        m.q_c0_c1[0] = q.w(), m.q_c0_c1[1] = q.x(), m.q_c0_c1[2] = q.y(), m.q_c0_c1[3] = q.z();
      };
      Scenario scenario = walk_scenario(40);
      scenario.walker.stand_s = kStands_s;
      MeasuredWalk walk(scenario, what, seed);
      TestFusion fusion({.type = CouplingType::localizer}, {}, {true, false});
      double error_rad = 0, sigma_rad = 0;
      walk.run(fusion, [&](double t, const odo_pose& pose) {
        if (t > 20) return;
        const Quaterniond q(pose.q_n[0], pose.q_n[1], pose.q_n[2], pose.q_n[3]);
        error_rad = log_rotation(walk.truth(t).q_n_c * q.conjugate()).z();
        sigma_rad = std::sqrt(pose.covariance[14]);
      });
      CAPTURE(rate_radps);
      CAPTURE(seed);
      CHECK(std::abs(error_rad) < 3 * sigma_rad);
      CHECK(sigma_rad < 0.07);
    }
}

TEST_CASE("neither barometer readings nor a front-end's gravity shows in the height of an app's pictures") {
  for (uint64_t seed = 1; seed <= 3; ++seed) {
    WalkMeasurements what;
    what.odometry.inverse_scale = 1, what.odometry.scale_sigma = 0.02;
    what.odometry.position_m = 0.001, what.odometry.rotation_rad = 0.0003, what.odometry.rotation_walk = 3e-4;
    what.odometry.drift_per_root_m = 0;
    TestFusion fusion({.type = CouplingType::localizer}, {}, {true, false});
    MeasuredWalk* running = nullptr;
    int frame = 0;
    what.change = [&](double t, odo_vo_motion& m) {
      m.gravity_c1[0] += 0.01;  // a constant error, as from an accelerometer bias
      if (++frame % 10 != 0) return;
      constexpr double kGust_m = 0.5;
      auto barometer = make_message<odo_barometer>(ODO_TYPE_BAROMETER, MeasuredWalk::ns(t));
      const double up_m = (frame % 20 == 0 ? kGust_m : -kGust_m) - running->truth(t).p_n_c.z();
      barometer.pressure_pa = pressure_at_pa(up_m);
      fusion.update(&barometer);
    };
    MeasuredWalk walk(walk_scenario(60), what, seed);
    running = &walk;
    double worst_m = 0, last_m = 0;
    walk.run(fusion, [&](double t, const odo_pose& pose) {
      const double off_m = pose.p_n[2] - walk.truth(t).p_n_c.z();
      if (t > 10) worst_m = std::max(worst_m, std::abs(off_m - last_m));
      last_m = off_m;
    });
    CAPTURE(seed);
    CHECK(worst_m < 0.015);
  }
}

TEST_CASE(
    "a fix that sets a track without a start also sets its heading, whatever it is, and the track continues from it") {
  for (const double heading_rad : {0.1, 1.6, 3.1, -2.2})
    for (const bool whole : {true, false}) {
      const Quaterniond turned(Eigen::AngleAxisd(heading_rad, Vector3d::UnitZ()));
      const Vector3d at_n(300, -120, 0);
      WalkMeasurements what;
      what.odometry.inverse_scale = 1, what.odometry.scale_sigma = 0.02;
      what.odometry.position_m = 0.003, what.odometry.rotation_rad = 0.0005;
      what.fix_every_s = 8, what.fix_sigma_m = 0.1, what.fix_late_s = 0.8;
      MeasuredWalk* made = nullptr;
      const auto body_of = [&](double t) {
        return (turned * made->truth(t).q_n_c * Quaterniond(0, -1, 0, 0)).normalized();
      };
      what.change_fix = [&](double t, odo_fix& fix) {
        Vector3d::Map(fix.p_n) = at_n + turned * Vector3d(fix.p_n);
        const Quaterniond q = body_of(t);
        if (whole) {
          fix.header.flags |= ODO_FIX_ORIENTATION | ODO_FIX_ORIENTATION_COVARIANCE;
          fix.q_n_b[0] = q.w(), fix.q_n_b[1] = q.x(), fix.q_n_b[2] = q.y(), fix.q_n_b[3] = q.z();
          for (const int i : {0, 4, 8}) fix.orientation_cov_n[i] = 0.01 * 0.01;
        } else {
          fix.header.flags |= ODO_FIX_YAW, fix.yaw_axis_b[1] = 1;
          const Vector3d y_n = q * Vector3d::UnitY();
          fix.yaw_rad = std::atan2(y_n.y(), y_n.x()), fix.yaw_sigma_rad = 0.01;
        }
      };
      MeasuredWalk walk(walk_scenario(40), what, 3);
      made = &walk;
      TestFusion fusion({.type = CouplingType::localizer}, {}, {true, false});
      double worst_m = 0, worst_rad = 0, seen = 0;
      walk.run(fusion, [&](double t, const odo_pose& pose) {
        if (t < 9.5) return;
        ++seen;
        const Quaterniond q(pose.q_n[0], pose.q_n[1], pose.q_n[2], pose.q_n[3]);
        worst_rad = std::max(worst_rad, std::abs(log_rotation(turned * walk.truth(t).q_n_c * q.conjugate()).z()));
        worst_m = std::max(worst_m, (at_n + turned * walk.truth(t).p_n_c - Vector3d(pose.p_n)).head<2>().norm());
      });
      CAPTURE(heading_rad);
      CAPTURE(whole);
      CHECK(seen > 100);
      CHECK(worst_rad < 0.05);
      CHECK(worst_m < 0.8);
    }
}

TEST_CASE("a first fix of the height alone gives no information about north and east, and no known position") {
  TestFusion fusion({.type = CouplingType::localizer}, {}, {true, false});
  auto imu = imu_at(0, {0, 0, 0}, {0, 0, -9.81});
  for (imu.header.t_ns = 0; imu.header.t_ns <= 1'000'000'000; imu.header.t_ns += 5'000'000) fusion->on_imu(imu);
  fusion.update(FrameTime{1'000'000'000});
  Estimate before, after;
  REQUIRE(fusion.at({}, before) == ODO_OK);
  auto fix = make_message<odo_fix>(ODO_TYPE_FIX, 1'000'000'000);
  fix.header.flags = ODO_FIX_DOWN | ODO_FIX_COVARIANCE;
  fix.p_n[2] = -30;
  fix.covariance_n[8] = 0.25;
  CHECK(fusion.update(&fix).accepted);
  REQUIRE(fusion.at({}, after) == ODO_OK);
  CHECK(after.p_n_b.z() == doctest::Approx(before.p_n_b.z() - 30).epsilon(0.01));
  CHECK(after.p_n_b.head<2>().isApprox(before.p_n_b.head<2>()));
  for (const int i : {21, 28})
    CHECK(after.pose.covariance[i] < before.pose.covariance[i] + 1);  // m^2, in a tenth of a second
  CHECK((after.pose.header.flags & ODO_POSE_POSITION) == 0);
  fix.header.flags = ODO_FIX_NORTH | ODO_FIX_EAST | ODO_FIX_COVARIANCE;
  fix.p_n[0] = 100, fix.p_n[1] = 50;
  fix.covariance_n[0] = fix.covariance_n[4] = 4;
  CHECK(fusion.update(&fix).accepted);
  REQUIRE(fusion.at({}, after) == ODO_OK);
  CHECK(after.p_n_b.x() == doctest::Approx(100).epsilon(0.01));
  CHECK(after.p_n_b.z() == doctest::Approx(before.p_n_b.z() - 30).epsilon(0.01));
  CHECK((after.pose.header.flags & ODO_POSE_POSITION) != 0);
}

TEST_CASE("a camera that starts during a walk continues it, without a pause, a jump or another part of the phone") {
  for (uint64_t seed = 1; seed <= 5; ++seed) {
    WalkMeasurements what;
    what.start_s = 4;
    what.odometry.inverse_scale = 1, what.odometry.scale_sigma = 0.02;
    what.odometry.position_m = 0.003, what.odometry.rotation_rad = 0.0005;
    what.odometry.from_s = 9;
    what.step_factor_sigma = 0.02, what.step_offset_rad = 0;
    what.change = [&](double t, odo_vo_motion& m) {
      if (t > what.odometry.from_s + 2.4) return;
      m.header.flags &= ~(ODO_VO_METRIC | ODO_VO_INERTIAL | ODO_VO_TRANSLATION);
      m.state = ODO_DEGRADED, m.reason = ODO_REASON_INITIALISING, m.scale_group = 77;
    };
    MeasuredWalk walk(walk_scenario(30), what, seed);
    TestFusion fusion({.type = CouplingType::localizer}, {}, {true, false});
    double last_s = -1, longest_s = 0, jump_m = 0, worst_m = 0;
    bool of_camera = true, metric = false;
    std::optional<Vector3d> offset, last_error;
    double moved_s = what.start_s;
    Vector3d last_p = Vector3d::Zero();
    walk.run(fusion, [&](double t, const odo_pose& pose) {
      if ((pose.header.flags & ODO_POSE_METRIC) == 0) return;
      of_camera = of_camera && (pose.header.flags & ODO_POSE_CAMERA);
      const Vector3d p(pose.p_n), error = p - walk.truth(t).p_n_c;
      if (!offset) offset = error;
      worst_m = std::max(worst_m, (error - *offset).head<2>().norm());
      if ((p - last_p).head<2>().norm() > 0.05) longest_s = std::max(longest_s, t - moved_s), moved_s = t;
      metric = metric || t > what.odometry.from_s + 3;
      if (metric && last_error) jump_m = std::max(jump_m, (error - *last_error).head<2>().norm());
      last_error = error, last_p = p, last_s = t;
    });
    CAPTURE(seed);
    CHECK(last_s > 20);
    CHECK(of_camera);
    CHECK(longest_s < 1.2);  // a step and its delay
    CHECK(jump_m < 0.1);     // after the first metric motion
    CHECK(worst_m < 1.6);    // steps lag by one
  }
}
