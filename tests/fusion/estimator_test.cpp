// SPDX-License-Identifier: Apache-2.0
//
// The filter on simulated measurements: consistency and robustness.
#include <Eigen/LU>

#include "tests/support/measured_walk.hpp"
#include "tests/support/messages.hpp"
#include "sdk/math/atmosphere.hpp"
#include "tests/support/support.hpp"

using Eigen::Quaterniond;
using Eigen::Vector3d;

TEST_SUITE_BEGIN("estimator");

namespace {

struct Outcome {
  ScaleKnowledge knowledge;
  double end_error_m = 0, worst_error_m = 0, worst_jump_m = 0, position_nees = 0, height_nees = 0, heading_nees = 0,
         scale_error = 0, scale_sigma = 0, factor_error = 0, path_ratio = 0, first_metric_s = -1;
  int poses = 0, references = 0, corrections = 0;
  bool finite = true;
};

Outcome run_walk(const WalkMeasurements& what, uint64_t seed, double length_m = 40) {
  MeasuredWalk walk(walk_scenario(length_m), what, seed);
  TestFusion fusion({.type = CouplingType::localizer}, {}, {what.camera, false});
  Outcome o;
  bool has_start = false;
  Vector3d start = Vector3d::Zero(), last = Vector3d::Zero(), last_truth = Vector3d::Zero(), path_from = last,
           truth_from = last;
  double path = 0, true_path = 0;
  walk.run(
      fusion,
      [&](double t, const odo_pose& pose) {
        const auto truth = walk.truth(t);
        if (!has_start) has_start = true, start = truth.p_n_c;
        const bool placed = what.fix_every_s > 0;  // north and east, never the height
        const Vector3d known(placed ? 0 : start.x(), placed ? 0 : start.y(), start.z());
        const Vector3d p(pose.p_n), p_true = truth.p_n_c - known;
        o.finite = o.finite && p.allFinite();
        const bool metric = (pose.header.flags & ODO_POSE_METRIC) != 0;
        if (!metric) return;
        const Vector3d error = p - p_true;
        if (o.first_metric_s < 0)
          o.first_metric_s = t, path_from = p, truth_from = p_true;
        else
          o.worst_jump_m = std::max(o.worst_jump_m, (p - last - (p_true - last_truth)).norm());
        last = p, last_truth = p_true;
        if ((p_true - truth_from).norm() > 1) {
          path += (p - path_from).norm(), true_path += (p_true - truth_from).norm();
          path_from = p, truth_from = p_true;
        }
        o.end_error_m = error.head<2>().norm();
        o.worst_error_m = std::max(o.worst_error_m, o.end_error_m);
        odo_fix reference;
        o.references += fusion.take_step_reference(reference);
        if (t < 10) return;
        const Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>> P(pose.covariance);
        const Eigen::Matrix2d horizontal = P.block<2, 2>(3, 3);
        o.position_nees += error.head<2>().dot(horizontal.inverse() * error.head<2>()) / 2;
        o.height_nees += error.z() * error.z() / P(5, 5);
        const Quaterniond q(pose.q_n[0], pose.q_n[1], pose.q_n[2], pose.q_n[3]);
        o.heading_nees += std::pow(log_rotation(truth.q_n_c * q.conjugate()).z(), 2) / P(2, 2);
        ++o.poses;
      },
      [&](const Correction&, const odo_pose&) { ++o.corrections; });
  const PoseFilter& filter = fusion.filter();
  o.scale_error = filter.x()[kLogScale] + std::log(what.odometry.inverse_scale);
  o.scale_sigma = filter.sigma(kLogScale);
  o.knowledge = fusion->scale_knowledge();
  o.factor_error = filter.x()[kLogFactor] - walk.log_factor();
  o.position_nees /= std::max(1, o.poses), o.height_nees /= std::max(1, o.poses);
  o.heading_nees /= std::max(1, o.poses);
  o.path_ratio = path / std::max(1e-9, true_path);
  return o;
}

}  // namespace

TEST_CASE("errors match the covariance: 20 walks each, with and without metric scale, with and without fixes") {
  enum class Kind { no_metre, metric, metric_stabilised_lens, steps_alone };
  for (const Kind kind : {Kind::no_metre, Kind::metric, Kind::metric_stabilised_lens, Kind::steps_alone})
    for (const bool fixes : {false, true}) {
      if (kind == Kind::steps_alone && !fixes) continue;  // estimator_heading_test.cpp
      WalkMeasurements what{.camera = kind != Kind::steps_alone};
      const Odometry::Parameters assumed;
      const bool metric = kind == Kind::metric || kind == Kind::metric_stabilised_lens;
      what.odometry.rotation_walk = metric ? assumed.inertial_rotation_walk : assumed.rotation_walk;
      if (metric) what.odometry.inverse_scale = 1, what.odometry.scale_sigma = 0.02, what.odometry.scale_walk = 5e-4;
      if (metric) what.odometry.rotation_rad = 5e-4;
      if (kind == Kind::metric_stabilised_lens)  // 2 to 3 mrad per frame
        what.odometry.rotation_rad = 2.5e-3;
      if (fixes) what.fix_every_s = 2;
      double position = 0, height = 0, heading = 0;
      for (uint64_t seed = 1; seed <= 20; ++seed) {
        const Outcome o = run_walk(what, seed);
        position += o.position_nees / 20, height += o.height_nees / 20, heading += o.heading_nees / 20;
      }
      CAPTURE(static_cast<int>(kind));
      CAPTURE(fixes);
      MESSAGE("NEES: position " << position << ", height " << height << ", heading " << heading);
      CHECK(position == Between{0.5, 2.0});
      if (kind == Kind::steps_alone) continue;  // the pose is the body's, and the height stays that of the start
      CHECK(height == Between{0.1, 1.2});
      CHECK(heading == Between{0.5, 2.0});
    }
}

TEST_CASE(
    "the scale is unaffected by the odometry's own covariance, and does not collapse with odometry errors of 5 cm") {
  for (const double error_m : {0.02, 0.05}) {
    WalkMeasurements what;
    what.odometry.position_m = error_m;
    double length_4 = 0, length_quarter = 0, worst = 0;
    for (uint64_t seed = 1; seed <= 5; ++seed) {
      what.odometry.stated_covariance = 4;
      const Outcome more = run_walk(what, seed);
      what.odometry.stated_covariance = 0.25;
      const Outcome less = run_walk(what, seed);
      length_4 += more.path_ratio, length_quarter += less.path_ratio;
      worst = std::max(worst, std::abs(more.scale_error) / more.scale_sigma);
      CHECK(more.path_ratio == Between{0.9, 1.1});
    }
    CHECK(length_4 == doctest::Approx(length_quarter).epsilon(0.02));
    CHECK(worst < 3.5);
  }
}

TEST_CASE(
    "an accurate metric odometry passes through, steps outweigh an inaccurate one, and learn from an accurate one") {
  WalkMeasurements sure;
  sure.odometry.inverse_scale = 1, sure.odometry.scale_sigma = 0.005, sure.odometry.scale_walk = 0;
  sure.odometry.position_m = 0.005, sure.odometry.drift_per_root_m = 0;
  sure.step_factor_sigma = 0.15;
  for (uint64_t seed = 1; seed <= 5; ++seed) {
    const Outcome o = run_walk(sure, seed, 60);
    CHECK(o.path_ratio == doctest::Approx(1.0).epsilon(0.015));
    CHECK(std::abs(o.factor_error) < 0.05);
    CHECK(o.references >= 1);
    CHECK(o.knowledge.by_inertia > 0.95);
    CHECK(o.knowledge.sigma < 0.01);
  }
  WalkMeasurements doubtful = sure;
  doubtful.odometry.scale_sigma = 0.3;
  doubtful.step_factor_sigma = 0.02;
  // Within the spread among walkers (factor_sigma), with a mean odometry error of 0.3.
  for (uint64_t seed = 1; seed <= 5; ++seed) {
    const Outcome o = run_walk(doubtful, seed, 60);
    CHECK(std::abs(o.path_ratio - 1) < 0.1);
    CHECK(o.knowledge.by_steps > 0.6);
    CHECK(o.knowledge.by_steps + o.knowledge.by_inertia == doctest::Approx(1));
  }
}

TEST_CASE(
    "steps reported late after a stop are applied fully and do not change the walker's factor, with or without a "
    "camera") {
  for (const bool vo : {false, true}) {
    TestFusion fusion({.type = CouplingType::localizer}, {}, {vo, false});
    const auto ns = [](double t_s) { return 1'000'000'000 + static_cast<int64_t>(std::llround(t_s * 1e9)); };
    // Stands for 8 s, walks eight steps that are reported together 0.4 s after the last, and continues; repeatedly.
    constexpr double kStep_s = 0.5, kStep_m = 0.7, kCycle_s = 16;
    double walked = 0, path = 0, last = 0;
    int told = 0;
    for (double t = 0; t < 80; t += 0.01) {
      auto imu = imu_at(ns(t), {0, 0, 0}, {0, 0, -9.81});
      const double in_cycle = std::fmod(t, kCycle_s);
      if (in_cycle > 8) imu.accel_b[0] = 2 * std::sin(4 * EIGEN_PI * t);
      fusion->on_imu(imu);
      auto attitude = attitude_at(ns(t), Eigen::Quaterniond::Identity(), 4e-4);
      fusion.update(&attitude);
      odo_pose pose;
      const auto drain = [&] {
        Correction correction;
        while (fusion.take_correction(correction, pose)) path += pose.p_n[0] - last, last = pose.p_n[0];
        while (fusion.take_pose(pose)) path += pose.p_n[0] - last, last = pose.p_n[0];
      };
      drain();
      const int cycle = static_cast<int>(t / kCycle_s);
      const int done = static_cast<int>((in_cycle - 8 - 0.4) / kStep_s);  // ends of steps at least 0.4 s ago
      for (int k = told - cycle * 14; done >= 8 && k < std::min(done, 14); ++k, ++told) {
        auto step = step_between(ns(cycle * kCycle_s + 8 + k * kStep_s), ns(cycle * kCycle_s + 8 + (k + 1) * kStep_s),
                                 ns(t), kStep_m, 0.07);
        step.mode = ODO_MODE_WALKING_TEXTING;
        CHECK(fusion.update(&step).accepted);
        walked += kStep_m;
        drain();
      }
    }
    CHECK(walked == doctest::Approx(5 * 14 * kStep_m));
    CHECK(last == doctest::Approx(walked).epsilon(0.01));
    CHECK(path == doctest::Approx(walked).epsilon(0.01));
    CHECK(std::abs(fusion.filter().x()[kLogFactor]) < 0.01);
  }
}

TEST_CASE("steps carry the position while the camera is blind, and the covariance reflects it") {
  WalkMeasurements what;
  what.odometry.inverse_scale = 1, what.odometry.scale_sigma = 0.01;
  what.odometry.blind_from_s = 12, what.odometry.blind_to_s = 22;
  for (uint64_t seed = 1; seed <= 5; ++seed) {
    const Outcome o = run_walk(what, seed, 40);
    CHECK(o.worst_error_m < 1.5);
    CHECK(o.position_nees < 4);
  }
}

TEST_CASE("the metric scale arrives without a jump, from standing and during the walk") {
  for (const double start_s : {0.0, 6.0}) {
    WalkMeasurements what{.start_s = start_s};
    for (uint64_t seed = 1; seed <= 5; ++seed) {
      const Outcome o = run_walk(what, seed);
      CHECK(o.first_metric_s > 0);
      CHECK(o.first_metric_s - start_s < 5);
      CHECK(o.worst_jump_m < 0.3);
    }
  }
}

TEST_CASE("numbers without their flag are not read") {
  WalkMeasurements what, poisoned;
  poisoned.change = [](double, odo_vo_motion& m) {
    m.header.flags &= ~ODO_VO_COVARIANCE;
    for (double& c : m.covariance) c = std::numeric_limits<double>::quiet_NaN();
    m.velocity_c1[0] = m.scale_sigma = std::numeric_limits<double>::quiet_NaN();
  };
  const Outcome clean = run_walk(what, 1), odd = run_walk(poisoned, 1);
  CHECK(odd.finite);
  CHECK(odd.end_error_m == clean.end_error_m);
}

TEST_CASE("a faulty fix, an odometry jump and an unannounced change of scale do not carry the pose away") {
  WalkMeasurements jump;
  jump.odometry.inverse_scale = 1, jump.odometry.scale_sigma = 0.01;
  jump.change = [](double t, odo_vo_motion& m) {
    if (t > 15 && t < 15.1) m.p_c0_c1[2] += 20;
  };
  CHECK(run_walk(jump, 1).worst_error_m < 1.5);
  WalkMeasurements unit;  // M5: another scale after a stop
  unit.change = [](double t, odo_vo_motion& m) {
    if (t > 15)
      for (double& p : m.p_c0_c1) p *= 2.5;
  };
  const Outcome o = run_walk(unit, 2, 60);
  CHECK(o.finite);
  CHECK(o.worst_error_m < 12);
}

TEST_CASE("with steps alone, height fixes on a slope are applied fully, and the climb continues between them") {
  TestFusion fusion({.type = CouplingType::localizer}, {}, {false, false});
  Random random(3, 7);
  const auto ns = [](double t_s) { return 1'000'000'000 + static_cast<int64_t>(std::llround(t_s * 1e9)); };
  const auto down_at = [](double t_s) { return -0.24 * std::clamp(t_s - 20, 0.0, 30.0); };  // flat, a slope, flat
  constexpr double kStep_s = 0.5, kTold_s = 0.4;
  double squares = 0, normalised = 0, n = 0;
  for (int i = 0; i < 7000; ++i) {
    const double t = 0.01 * i;
    fusion->on_imu(imu_at(ns(t), {0, 0, 0}, {0, 0, -9.81}));
    auto attitude = attitude_at(ns(t), Eigen::Quaterniond::Identity(), 4e-4);
    fusion.update(&attitude);
    if (i % 50 == 40 && t > 1) {
      auto step = step_between(ns(t - kTold_s - kStep_s), ns(t - kTold_s), ns(t), 0.7, 0.07);
      step.mode = ODO_MODE_WALKING_TEXTING;
      fusion.update(&step);
    }
    if (i % 100 == 41) {
      auto fix = make_message<odo_fix>(ODO_TYPE_FIX, ns(t - kTold_s));
      fix.header.flags = ODO_FIX_DOWN | ODO_FIX_COVARIANCE;
      fix.p_n[2] = down_at(t - kTold_s) + 0.25 * random.normal();
      fix.covariance_n[8] = 0.25 * 0.25;
      CHECK(fusion.update(&fix).accepted);
    }
    Estimate now;
    if (t < 10 || i % 10 != 0 || fusion.at({}, now) != ODO_OK) continue;
    const double error_m = now.pose.p_n[2] - down_at(t);
    squares += error_m * error_m, normalised += error_m * error_m / now.pose.covariance[35], n += 1;
  }
  CHECK(std::sqrt(squares / n) < 0.31);
  CHECK(normalised / n < 2);
  MESSAGE("heights now: " << std::sqrt(squares / n) << " m rms, normalised error squared " << normalised / n);
}

TEST_CASE("a pressure that arrives late refers to the height at its time") {
  CouplingConfig config{.type = CouplingType::localizer};
  StartPose start;
  start.given = start.heading_given = true;
  TestFusion fusion(config, start, {true, false});
  const auto ns = [](int frame) { return 1'000'000'000 + int64_t(100'000'000) * frame; };
  const auto ascend = [&](int from, int to) {  // by 0.1 m per frame, with a camera that looks ahead
    for (int k = from; k <= to; ++k) {
      auto motion =
          motion_between(ns(k - 1), ns(k), {0, -0.1, 0}, ODO_VO_ROTATION | ODO_VO_TRANSLATION | ODO_VO_METRIC);
      motion.scale_sigma = 0.01;
      fusion.update(FrameTime{ns(k)});
      fusion.update(RelativeMotion{&motion, nullptr});
    }
  };
  const auto read = [&](int frame) {
    double low = 90'000, high = 100'000;  // Pa; the height at frame 0 is that of 100 kPa
    while (high - low > 1e-6) {
      const double middle = 0.5 * (low + high);
      (pressure_height_m(middle) - pressure_height_m(100'000) > 0.1 * frame ? low : high) = middle;
    }
    auto barometer = pressure_at(ns(frame), low);
    return fusion.update(&barometer);
  };
  const auto down_m = [&] { return fusion.filter().x()[kDown]; };
  fusion.update(FrameTime{ns(0)});
  ascend(1, 10);
  CHECK(read(10).accepted);
  ascend(11, 60);
  const double before_m = down_m();
  CHECK(before_m == doctest::Approx(-6));
  CHECK(read(40).accepted);
  CHECK(std::abs(down_m() - before_m) < 1e-3);
}
