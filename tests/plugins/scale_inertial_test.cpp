// SPDX-License-Identifier: Apache-2.0
#include "tests/support/plugin_run.hpp"
#include "tests/plugins/scale_inertial_walk.hpp"

using namespace odograph::inertial_scale;
using Eigen::Quaterniond;
using Eigen::Vector3d;

TEST_SUITE_BEGIN("scale_inertial");

namespace {

/// In a hand that trembles by 1 mm, for this time.
Motion standing(double seconds, uint64_t seed) {
  Random random(seed, 5);
  std::vector<Vector3d> p;
  for (int i = 0; i < seconds * 10; ++i) p.push_back({1e-3 * random.normal(), 1e-3 * random.normal(), 0});
  const std::vector<Quaterniond> q(p.size(), Quaterniond(0, 1, 0, 0));
  return Motion(10, std::move(p), q);
}

struct Consistency {
  double nees = 0, bias = 0, rms = 0;
  int n = 0;
};

/// Over 30 walkers, one result per 5 s.
Consistency consistency(const Errors& errors) {
  Consistency sum;
  for (uint64_t seed = 1; seed <= 30; ++seed) {
    double next_s = 0;
    for (const auto& answer : Walk::of_length(60, seed, errors).run()) {
      if (answer.t_s < next_s) continue;
      next_s = answer.t_s + 5;
      sum.nees += std::pow(answer.normalised(), 2), sum.bias += answer.off(), sum.rms += std::pow(answer.off(), 2);
      ++sum.n;
    }
  }
  return {sum.nees / sum.n, sum.bias / sum.n, std::sqrt(sum.rms / sum.n), sum.n};
}

}  // namespace

TEST_CASE("without errors the scale is exact, also with a long lever arm and frames between the IMU's samples") {
  for (const uint64_t seed : {1u, 2u, 3u}) {
    Walk walk = Walk::of_length(30, seed, Errors::none());
    walk.p_b_c = {0.3, -0.4, 0.2};
    const auto answers = walk.run();
    REQUIRE(answers.size() > 150);
    CHECK(answers.front().t_s < 5);  // the first window
    for (const auto& answer : answers) CHECK(std::abs(answer.off()) < 2e-3);
    CHECK(answers.back().scale.relative_sigma ==
          Between{0.01, 0.025});  // the accelerometer's scale error is never averaged out
  }
}

TEST_CASE("a walk with a phone's errors gives the scale within 5 % and three sigmas") {
  int within = 0;
  for (uint64_t seed = 101; seed <= 110; ++seed) {
    Errors errors;
    errors.scale_walk = 2e-3;
    const auto answers = Walk::of_length(60, seed, errors).run();
    REQUIRE_FALSE(answers.empty());
    CHECK(std::abs(answers.back().normalised()) < 3);
    within += std::abs(answers.back().off()) < 0.05;
  }
  CHECK(within >= 9);
}

TEST_CASE("the scale error matches its sigma for each dominant error source") {
  const auto with = [](auto&& change) {
    Errors e;
    change(e);
    return e;
  };
  const struct {
    const char* name;
    Errors errors;
  } rows[] = {
      {"as a phone", {}},
      {"a good odometry", with([](Errors& e) { e.noise_m = 0.002; })},
      {"an odometry that errs by more than the gait moves", with([](Errors& e) { e.noise_m = 0.03; })},
      {"errors of the odometry that last", with([](Errors& e) { e.noise_m = 0.02, e.noise_s = 5; })},
      {"an inclination that sways", with([](Errors& e) { e.tilt_s = 2; })},
      {"an inclination that trembles", with([](Errors& e) { e.tilt_rad = 0.003, e.tilt_s = 0.1; })},
  };
  for (const auto& row : rows) {
    CAPTURE(row.name);
    const Consistency c = consistency(row.errors);
    CAPTURE(c.nees);
    CAPTURE(c.rms);
    CHECK(c.n > 60);
    CHECK(c.nees == Between{0.3, 2});
    CHECK(std::abs(c.bias) < 0.025);  // regressing alpha on y gives -0.2 and more
  }
}

TEST_CASE(
    "a window's regression is insensitive to a cubic trend, to rotation seen as translation, and to noise of the "
    "gait's size") {
  Random random(1, 1);
  double sum = 0, chi = 0;
  constexpr int kWindows = 400;
  for (int k = 0; k < kWindows; ++k) {
    Window exact{{}}, noisy{{}};
    Vector3d error = Vector3d::Zero();
    double signal = 0, noise = 0;
    for (int i = 0; i < 45; ++i) {
      const double t = 0.09 * i;
      const Vector3d gait(0.01 * std::sin(6 * t), 0.02 * std::sin(6.3 * t + k), 0.02 * std::cos(12.3 * t));
      const Vector3d trend =
          Vector3d(1.3, -0.4, 0.2) * t + Vector3d(0.1, 0.2, -0.1) * t * t + Vector3d(0.02, 0, 0.03) * t * t * t;
      for (int axis = 0; axis < 3; ++axis) error[axis] = 0.8 * error[axis] + 0.6 * 0.017 * random.normal();
      signal += gait.squaredNorm(), noise += error.squaredNorm();
      const Vector3d beta(0, 2e-3 * std::sin(6.3 * t + k + 0.5), 2e-3 * std::cos(12.3 * t + 0.5));
      exact.add({t, gait, 2.5 * gait + trend + 12 * beta, beta});
      noisy.add({t, gait + trend, 2.5 * (gait + error), Vector3d::Zero()});
    }
    REQUIRE(exact.solve());
    CHECK(std::abs(exact.solve()->inverse_scale - 2.5) < 1e-9);
    REQUIRE(noisy.solve());
    CHECK(noise > 0.3 * signal);
    sum += noisy.solve()->inverse_scale;
    chi += std::pow((noisy.solve()->inverse_scale - 2.5) / noisy.solve()->sigma, 2);
  }
  CHECK(std::abs(sum / kWindows / 2.5 - 1) < 0.02);
  CHECK(chi / kWindows == Between{0.3, 2});

  Window small{{}};
  for (int i = 0; i < 11; ++i) {
    CHECK_FALSE(small.solve());
    small.add({0.4 * i, {0, 0, 0.01 * std::sin(5.0 * i)}, {0, 0.1 * i, 0.02 * std::sin(5.0 * i)}, Vector3d::Zero()});
  }
  CHECK_FALSE(small.solve());
  small.add({4.4, {0, 0, 0}, {0, 1.1, 0}, Vector3d::Zero()});
  CHECK(small.solve());
}

TEST_CASE("rotation seen as translation at a depth of 5 m, in step with the gait, does not bias the scale") {
  for (const uint64_t seed : {1u, 2u, 3u}) {
    Walk walk = Walk::of_length(40, seed, Errors::none());
    walk.change = [](double t, InertialScale::Motion& m) {
      const Vector3d wrong(2e-3 * (std::sin(12 * t) - std::sin(12 * (t - 0.1))), 0, 0);
      m.q_c0_c1 = exp_rotation(wrong) * m.q_c0_c1;
      m.p_c0_c1 -= 2.5 * 5 * wrong.cross(Vector3d::UnitZ());
    };
    const auto answers = walk.run();
    REQUIRE(answers.size() > 150);
    for (const auto& answer : answers) CHECK(std::abs(answer.off()) < 0.01);  // without beta 0.1 and more
  }
}

TEST_CASE("a new scale group has no scale before its own windows, and nothing of the old group's") {
  for (const uint64_t seed : {1u, 2u, 3u, 4u}) {
    Walk walk = Walk::of_length(60, seed);
    walk.change = [](double t, InertialScale::Motion& m) {
      if (t > 20) m.group = 9, m.p_c0_c1 *= 0.4;
    };
    int before = 0, after = 0;
    for (const auto& answer : walk.run()) {
      if (answer.t_s < 20) {
        ++before;
        continue;
      }
      CHECK(answer.t_s > 24);
      CHECK(std::abs((answer.off() + std::log(0.4)) / answer.scale.relative_sigma) < 3.5);
      ++after;
    }
    CHECK(before > 100);
    CHECK(after > 100);
  }
}

TEST_CASE("a scale that changes within its group is estimated again after three contradicting windows") {
  Walk walk = Walk::of_length(80, 3);
  walk.change = [](double t, InertialScale::Motion& m) {
    if (t > 20) m.p_c0_c1 *= 0.4;
  };
  const auto answers = walk.run();
  REQUIRE(answers.back().t_s > 45);
  for (const auto& answer : answers)
    if (answer.t_s > 37) CHECK(std::abs(answer.off() + std::log(0.4)) < 3 * answer.scale.relative_sigma);
}

TEST_CASE("a window with a gap in the IMU or in the motions gives no result") {
  const auto answers = [](auto&& prepare) {
    Walk walk = Walk::of_length(60, 5);
    prepare(walk);
    return walk.run().size();
  };
  CHECK(answers([](Walk&) {}) > 100);
  // Something is missing every 3 s: no window of 4 s is complete.
  CHECK(answers([](Walk& w) { w.imu_missing = [](double t) { return std::fmod(t, 3) < 0.07; }; }) == 0);
  CHECK(answers([](Walk& w) { w.imu_missing = [](double t) { return std::fmod(t, 3) < 0.03; }; }) > 100);
  CHECK(answers([](Walk& w) { w.change = [](double t, auto& m) { m.translates = std::fmod(t, 3) > 0.15; }; }) == 0);
  CHECK(answers([](Walk& w) {
          w.change = [](double t, auto& m) { m.from_ns += std::fmod(t, 3) < 0.15 ? 1'000'000 : 0; };
        }) == 0);
  CHECK(answers([](Walk& w) {  // the host rotates north by 10 degrees
          w.change = [](double t, auto& m) {
            m.q_n_c0 = Eigen::AngleAxisd(0.17 * std::floor(t / 3), Vector3d::UnitZ()) * m.q_n_c0;
          };
        }) == 0);

  Walk walk = Walk::of_length(60, 5);  // half of the walk without an IMU: the scale stays, with a larger sigma
  walk.imu_missing = [](double t) { return t > 20; };
  const auto all = walk.run();
  double sigma = 0;
  for (const auto& answer : all) {
    CHECK(std::abs(answer.normalised()) < 3.5);
    if (answer.t_s < 21) continue;
    CHECK(answer.scale.relative_sigma > sigma);
    sigma = answer.scale.relative_sigma;
  }
  CHECK(all.back().t_s > 35);
}

TEST_CASE("standing gives no scale at first, and keeps an existing one") {
  for (const uint64_t seed : {1u, 2u, 3u, 4u, 5u, 6u}) CHECK(Walk(standing(60, seed), seed).run().empty());

  Scenario s;
  s.route = {{0, 0, 0}, {60, 0, 0}};
  Scenario::Event stand;
  stand.at_m = 40, stand.what = "stand", stand.for_s = 60;
  s.events = {stand};
  for (const bool seen : {true, false}) {  // by an IMU, while standing
    Walk walk(make_walk(s, 2).phone, 2);
    walk.imu_missing = [&](double t) { return !seen && t > 40; };
    const auto answers = walk.run();
    REQUIRE(answers.back().t_s > 90);
    for (const auto& answer : answers) CHECK(std::abs(answer.normalised()) < 3.5);
    if (!seen) CHECK(answers.back().scale.relative_sigma > 0.01 * std::sqrt(50.0));
  }
}

TEST_CASE("the plugin scales each motion of a non-metric odometry, and reports a metric one") {
  for (const bool metric : {false, true}) {
    std::vector<AnyMessage> messages;
    Walk walk = Walk::of_length(40, 6);
    for (const uint32_t camera : {0u, 4u}) {
      auto c = make_message<odo_calibration>(ODO_TYPE_CALIBRATION, ns(0));
      c.header.source = camera;
      c.header.flags = ODO_CALIBRATION_EXTRINSICS;
      c.q_b_c[camera == 4 ? 1 : 0] = 1;  // the other one looks backwards
      Vector3d::Map(c.p_b_c) = walk.p_b_c;
      messages.emplace_back(c.header);
    }
    walk.run([&](const odo_imu& imu) { messages.emplace_back(imu.header); },
             [&](double t, const InertialScale::Motion& motion) {
               auto m = make_message<odo_vo_motion>(ODO_TYPE_VO_MOTION, ns(t));
               m.header.flags =
                   ODO_VO_ROTATION | ODO_VO_TRANSLATION | ODO_FLAG_NAVIGATION | (metric ? ODO_VO_METRIC : 0);
               m.t_from_ns = motion.from_ns;
               m.q_n_c0[0] = motion.q_n_c0.w();
               Vector3d::Map(m.q_n_c0 + 1) = motion.q_n_c0.vec();
               m.q_c0_c1[0] = motion.q_c0_c1.w();
               Vector3d::Map(m.q_c0_c1 + 1) = motion.q_c0_c1.vec();
               Vector3d::Map(m.p_c0_c1) = motion.p_c0_c1;
               m.camera = 4, m.state = ODO_TRACKING, m.scale_group = 3;
               messages.emplace_back(m.header);
             });
    PluginRun plugin("scale_inertial");
    const auto events = plugin(messages);
    if (metric) {
      CHECK(events.empty());
      continue;
    }
    REQUIRE(events.size() > 100);
    for (const auto& event : events) {
      REQUIRE(event.header().type == ODO_TYPE_SCALE);
      const auto& scale = as<odo_scale>(event.header());
      CHECK(scale.header.flags == (ODO_SCALE_NOT_BY_STEPS | ODO_SCALE_STEADY));
      CHECK(scale.valid_to_ns == scale.header.t_ns);
      CHECK(scale.valid_from_ns < scale.valid_to_ns);
      CHECK(scale.scale_group == 3);
      CHECK(std::abs(std::log(scale.scale * 2.5)) < 4 * scale.sigma / scale.scale);
    }
  }
}
