// SPDX-License-Identifier: Apache-2.0
#include <optional>
#include <utility>
#include <vector>

#include <odograph/plugin.hpp>

#include "plugins/scale/slant_distance/slant_scale.hpp"
#include "plugins/scale/step_fit/step_fit.hpp"
#include "plugins/scale/step_length/step_scale.hpp"
#include "sdk/tools/simulation/random.hpp"
#include "tests/support/messages.hpp"
#include "tests/support/plugin_run.hpp"
#include "tests/support/support.hpp"

using Eigen::Vector2d;
using Eigen::Vector3d;

TEST_SUITE_BEGIN("scale_sources");

namespace {

constexpr int64_t kSecond = 1'000'000'000, kFrame = 100'000'000;

/// An odometry that moves as commanded, ten frames a second, and the steps beside it, two a second.
struct Walked {
  step_fit::StepFit fit;
  int64_t t = 17 * kSecond;
  uint32_t group = 4;

  explicit Walked(double drift = 0.004, double common = 0.06) : fit(drift, common) {
    fit.add_motion(t - kSecond, t, {1, 1}, group);
  }
  void move(const Vector2d& d, int frames = 5) {
    for (int k = 0; k < frames; ++k, t += kFrame) fit.add_motion(t, t + kFrame, d / frames, group);
  }
  /// The odometry moves by d within half a second, with a step of a given length.
  bool step(const Vector2d& d, double length_m, double sigma_m = 0.05) {
    move(d);
    return fit.add_step(t - 5 * kFrame, t, length_m, sigma_m);
  }
};

const step_fit::StepFit::Parameters kFit;

}  // namespace

TEST_CASE("the scale of all steps equals that of a plain filter of their logarithms with bounded outliers") {
  for (const uint64_t seed : {1u, 2u, 3u, 4u}) {
    Random random(seed, 9);
    const double drift = 0.01 * static_cast<double>(seed), common = 0.03;
    Walked walked(drift, common);
    double level = 0, variance = -1;
    int outliers = 0;
    for (int k = 0; k < 60; ++k) {
      const double d = random.uniform(0.25, 0.32), relative = random.uniform(0.03, 0.2);
      const double length = 2.5 * d * (k % 7 == 6 ? random.uniform(1.8, 4.0) : random.uniform(0.9, 1.1));
      const bool taken = walked.step({0.6 * d, 0.8 * d}, length, relative * length);
      CHECK(taken == (k >= 2));
      // The variance by the step and by its timing; beyond 1.5 sigma a step has the effect of 1.5 sigma.
      const double z = std::log(length / d), r = relative * relative + kFit.timing * kFit.timing;
      if (variance < 0) {
        level = z, variance = r;
      } else {
        variance += drift * drift;
        const double sigma = std::sqrt(variance + r), off = (z - level) / sigma;
        const double weight = std::min(1.0, kFit.huber / std::abs(off));
        outliers += weight < 1;
        level += weight * off * variance / sigma;
        variance *= 1 - weight * variance / (variance + r);
      }
      if (!taken) continue;
      CHECK(std::abs(walked.fit.scale()->scale / std::exp(level) - 1) < 1e-9);
      CHECK(std::abs(walked.fit.scale()->relative_sigma / std::hypot(std::sqrt(variance), common) - 1) < 1e-9);
    }
    CHECK(outliers >= 6);
  }
}

TEST_CASE("a step seen three times too long has the same effect on the scale as one seen ten times too long") {
  double pulled[2] = {};
  for (const int k : {0, 1}) {
    Walked walked;
    for (int i = 0; i < 20; ++i) walked.step({0.3, 0}, 0.7);
    const double before = std::log(walked.fit.scale()->scale);
    walked.step({0.3, 0}, k == 0 ? 2.1 : 7.0, k == 0 ? 0.15 : 0.5);
    pulled[k] = std::log(walked.fit.scale()->scale) - before;
  }
  CHECK(pulled[0] > 0.01);
  CHECK(std::abs(pulled[1] - pulled[0]) < 1e-9);
}

TEST_CASE("a walk is three consecutive similar displacements in a straight line") {
  const auto at = [](double length, double deg) {
    return Vector2d(length * std::cos(deg * M_PI / 180), length * std::sin(deg * M_PI / 180));
  };
  struct Row {
    Vector2d steps[3];
    bool walk;
  };
  const Row rows[] = {
      {{at(1, 0), at(1.4, 0), at(1.95, 0)}, true},   {{at(1, 0), at(1.4, 0), at(2.05, 0)}, false},
      {{at(1.95, 0), at(1.4, 0), at(1, 0)}, true},   {{at(2.05, 0), at(1.4, 0), at(1, 0)}, false},
      {{at(1, 0), at(1, 40), at(1, 80)}, true},      {{at(1, 0), at(1, 50), at(1, 100)}, false},  // 0.84, 0.76
      {{at(1, 0), at(1, -40), at(1, -80)}, true},    {{at(1, 0), at(1, 180), at(1, 0)}, false},
      {{at(1, 170), at(1, 179), at(1, -175)}, true},  // across the wrap of the heading
  };
  for (const Row& row : rows) {
    Walked walked;
    for (int k = 0; k < 3; ++k) CHECK(walked.step(row.steps[k], 0.7) == (k == 2 && row.walk));
    CHECK(walked.fit.scale().has_value() == row.walk);
  }
}

TEST_CASE("after a pause, and in another scale group, a walk must be detected again") {
  for (const int frames : {9, 11}) {  // while standing
    Walked walked;
    for (int k = 0; k < 3; ++k) walked.step({0.3, 0}, 0.7);
    walked.move({0, 0}, frames);
    CHECK(walked.step({0.3, 0}, 0.7) == (frames == 9));
    CHECK(walked.step({0.3, 0}, 0.7) == (frames == 9));
    CHECK(walked.step({0.3, 0}, 0.7));
  }
  Walked walked;
  for (int k = 0; k < 8; ++k) walked.step({0.3, 0}, 0.7);
  walked.group = 9;
  for (int k = 0; k < 3; ++k) CHECK(walked.step({0.1, 0}, 0.7) == (k == 2));
  CHECK(walked.fit.scale()->scale == doctest::Approx(7.0));  // nothing of the old group's 2.33
  CHECK_FALSE(walked.step({0.1, 0}, 0));
  CHECK_FALSE(walked.fit.add_step(16 * kSecond, walked.t, 0.7, 0.05));  // before the group's first motion
}

TEST_CASE("a step between frames gets its share of their motions") {
  Walked walked(0, 0);
  // A growing displacement per frame, so that fractions of a frame matter.
  for (int k = 0; k < 40; ++k) walked.move({0.1 + 0.001 * k, 0}, 1);
  const auto gone = [](double frames) {
    double sum = 0;
    for (int k = 0; k < 40; ++k) sum += std::clamp(frames - k, 0.0, 1.0) * (0.1 + 0.001 * k);
    return sum;
  };
  double logs = 0;
  for (int k = 0; k < 3; ++k) {
    const double from = 3.3 + 5.4 * k, to = from + 5.4;
    const int64_t start = 17 * kSecond + std::llround(from * 1e8), end = 17 * kSecond + std::llround(to * 1e8);
    CHECK(walked.fit.add_step(start, end, 0.7, 0.05) == (k == 2));
    logs += std::log(0.7 / (gone(to) - gone(from))) / 3;
  }
  CHECK(std::abs(std::log(walked.fit.scale()->scale) - logs) < 1e-7);  // equal weights: the mean of the logarithms
}

TEST_CASE("between two frames a walker has the speed of the preceding step, and stands on command") {
  const double hold = 1.6;
  step_scale::StepInterpolation steps(hold);
  struct Step {
    double start_s, end_s, length_m, sigma_m;
  };
  const Step all[] = {{10, 10.5, 0.7, 0.07}, {10.5, 11.1, 0.9, 0.045}, {11.1, 11.5, 0.5, 0.1}, {14, 14.6, 0.6, 0.03}};
  const auto ns = [](double s) { return static_cast<int64_t>(std::llround(s * 1e9)); };
  CHECK_FALSE(steps.between(ns(10), ns(10.4)));
  for (const Step& s : all) steps.add_step(ns(s.start_s), ns(s.end_s), s.length_m, s.sigma_m);
  steps.add_step(ns(20), ns(20), 0.7, 0.1);  // no duration: no step
  steps.stand(ns(15));
  const auto plain = [&](double from, double to) {
    step_scale::Displacement sum{0, 0};
    constexpr int kParts = 20000;
    for (int i = 0; i < kParts; ++i) {
      const double t = from + (to - from) * (i + 0.5) / kParts;
      const Step* last = nullptr;
      for (const Step& s : all)
        if (s.end_s <= t) last = &s;
      if (!last || t > last->end_s + hold * (last->end_s - last->start_s) || t > 15) continue;
      const double d = last->length_m / (last->end_s - last->start_s) * (to - from) / kParts;
      sum.metres += d, sum.relative_sigma += d * last->sigma_m / last->length_m;
    }
    if (sum.metres > 0) sum.relative_sigma /= sum.metres;
    return sum;
  };
  const double intervals[][2] = {{10.2, 10.9}, {10.6, 10.8}, {10.4, 11.3}, {11.2, 12.9}, {12.3, 13.9},
                                 {14.5, 14.9}, {14.9, 15.4}, {15.2, 15.5}, {10.5, 15.5}};
  for (const auto& in : intervals) {
    CAPTURE(in[0]);
    const auto seen = steps.between(ns(in[0]), ns(in[1]));
    const auto expected = plain(in[0], in[1]);
    REQUIRE(seen);
    CHECK(std::abs(seen->metres - expected.metres) < 2e-4);
    CHECK(std::abs(seen->relative_sigma - expected.relative_sigma) < 2e-4);
  }
  CHECK_FALSE(steps.between(ns(10.1), ns(10.5)));
  steps.add_step(ns(16), ns(16.5), 0.7, 0.07);  // walking again
  CHECK(steps.between(ns(16.5), ns(16.6))->metres == doctest::Approx(0.14));
  steps.add_step(ns(16.5), ns(17), 0, 0);  // on the spot
  CHECK(steps.between(ns(17), ns(17.1))->metres == 0);
}

namespace {

/// A drive along `heading` with an odometry scaled by 1 / scale, and a fix per frame.
struct Driven {
  slant_scale::SlantScale fit;
  int64_t t = 5 * kSecond;
  uint32_t group = 1;
  Vector2d place{200, -100};
  explicit Driven(double window_s = 15, double min_m = 8, double drift = 0) : fit(window_s, min_m, drift) {}
  void go(const Vector2d& by_m, double scale, double variance = 1, const Vector2d& off = Vector2d::Zero()) {
    const Vector3d d(by_m.x() / scale, by_m.y() / scale, 0.3);
    fit.add_motion(t, t + kFrame, d, group);
    t += kFrame, place += by_m;
    if (variance > 0) fit.add_position(t, place + off, variance);
  }
};

}  // namespace

TEST_CASE(
    "the scale from roofs needs the extent of the fixes, uses the window only, and its sigma follows from their "
    "errors") {
  Driven near;
  for (int k = 0; k < 8; ++k) near.go({0, 1}, 2);
  CHECK_FALSE(near.fit.known());  // 7 m
  for (int k = 0; k < 4; ++k) near.go({0, 1}, 2);
  REQUIRE(near.fit.known());
  CHECK(near.fit.scale()->scale == doctest::Approx(2.0));
  // sigma of the scale: that of a position over the odometry's spread, plus the odometry's drift.
  double spread = 0;
  for (int k = 0; k < 12; ++k) spread += std::pow((k - 5.5) / 2, 2);
  CHECK(std::abs(near.fit.scale()->sigma * std::sqrt(spread) - 1) < 1e-6);
  Driven drifting(15, 8, 0.05);
  for (int k = 0; k < 12; ++k) drifting.go({0, 1}, 2, 4);
  CHECK(std::abs(drifting.fit.scale()->sigma / std::hypot(2 / std::sqrt(spread), 0.05 * 2) - 1) < 1e-6);
  // Fixes older than the window are ignored.
  Driven changing(3, 8, 0);
  for (int k = 0; k < 40; ++k) changing.go({1, 0}, 2);
  for (int k = 0; k < 32; ++k) changing.go({1, 0}, 1.5);
  CHECK(changing.fit.scale()->scale == doctest::Approx(1.5));
}

TEST_CASE("a scale that doubles within a window is accepted after twenty persistent fixes, not after nineteen") {
  Driven driven(2, 4, 0);
  for (int k = 0; k < 40; ++k) driven.go({1, 0}, 2);
  int until = 0;
  while (std::abs(driven.fit.scale()->scale - 2) < 0.9 && until < 80) driven.go({1, 0}, 5), ++until;
  CHECK(driven.fit.scale()->scale > 3);
  Driven back(2, 4, 0);
  for (int k = 0; k < 40; ++k) back.go({1, 0}, 2);
  for (int round = 0; round < 3; ++round) {  // never long enough
    for (int k = 0; k < until - 2; ++k) back.go({1, 0}, 5);
    CHECK(back.fit.scale()->scale < 4.1);
    for (int k = 0; k < 25; ++k) back.go({1, 0}, 2);
    CHECK(back.fit.scale()->scale == doctest::Approx(2.0).epsilon(0.05));
  }
}

TEST_CASE("a new group has the previous speed for one second of motions, and fixes of the old one are dropped") {
  Driven driven;
  for (int k = 0; k < 60; ++k) driven.go({0.9, 0}, 2);
  driven.group = 2;
  for (int k = 0; k < 10; ++k) driven.go({0.9, 0}, 6, 0);
  CHECK(driven.fit.scale()->scale == doctest::Approx(6.0));
  CHECK(driven.fit.scale()->sigma == doctest::Approx(1.8));
  for (int k = 0; k < 10; ++k) driven.go({0.3, 0}, 6, 0);  // slower: no longer the previous speed
  CHECK(driven.fit.scale()->scale == doctest::Approx(6.0));
  driven.group = 3;
  for (int k = 0; k < 12; ++k) driven.go({0.9, 0}, 3);
  CHECK(driven.fit.scale()->scale == doctest::Approx(3.0));
  CHECK(driven.fit.scale()->sigma < 1);  // from fixes again
  Driven standing;
  for (int k = 0; k < 60; ++k) standing.go({0.04, 0}, 2);
  standing.group = 2;
  standing.go({0.04, 0}, 6, 0);
  CHECK_FALSE(standing.fit.scale());
}

namespace {

/// A drive behind scale/slant_distance: frames of a metre in units of `u` metres, a camera that looks up and moves
/// along its x, landmarks on a wall 12 m ahead near a roof 16 m above, and fixes with the slant distance to that roof.
struct SlantDrive {
  double u;
  std::vector<AnyMessage> messages;
  int64_t t_ns = kSecond;
  Vector3d p_n{100, 50, -1.5};

  void frame(bool with_points, bool metric_points = false) {
    if (with_points) {
      odo::PointsWriter points;
      points.begin(t_ns + kFrame, 0, 0, metric_points);
      for (int k = 0; k < 5; ++k) {
        odo_point point{};
        Eigen::Vector3f::Map(point.p_c) = Eigen::Vector3f(12, 0.1f * static_cast<float>(k - 2), 16) / float(u);
        for (const int i : {0, 3, 5}) point.covariance[i] = 0.01f;
        points.add(point);
      }
      messages.emplace_back(points.message().header);
    }
    auto motion =
        motion_between(t_ns, t_ns + kFrame, {1 / u, 0, 0}, ODO_VO_ROTATION | ODO_VO_TRANSLATION | ODO_FLAG_NAVIGATION);
    put_quaternion(Eigen::Quaterniond(0, 1, 0, 0), motion.q_n_c0);
    messages.emplace_back(motion.header);
    t_ns += kFrame, p_n.x() += 1;
  }
  void pose(const Vector3d& at_n) {
    auto pose = make_message<odo_pose>(ODO_TYPE_POSE, t_ns);
    pose.header.flags = ODO_POSE_POSITION | ODO_POSE_ORIENTATION | ODO_POSE_COVARIANCE;
    Vector3d::Map(pose.p_n) = at_n, pose.q_n[0] = 1;
    messages.emplace_back(pose.header);
  }
  void fix(double slant_m = 20) {
    auto fix = fix_at(t_ns, p_n, 0.3, ODO_FIX_NORTH | ODO_FIX_EAST | ODO_FIX_COVARIANCE | ODO_FIX_SLANT);
    Vector3d::Map(fix.landmark_n) = p_n + Vector3d(0.6, 0, -0.8) * slant_m, fix.slant_distance_m = slant_m;
    messages.emplace_back(fix.header);
  }
  /// The last scale by a formula.
  std::optional<odo_scale> scale(const char* formula, PluginRun::Settings settings = {}) const {
    settings.emplace_back("formula", formula);
    PluginRun run("scale_slant_distance", settings);
    const auto events = run(messages);
    return events.empty() ? std::nullopt : std::optional(as<odo_scale>(events.back().header()));
  }
};

}  // namespace

TEST_CASE("the slant distance is a scale by the front-end's landmarks, before the car has moved far") {
  SlantDrive drive{40};
  drive.frame(true), drive.fix(), drive.frame(true);
  const auto scale = drive.scale("points");
  REQUIRE(scale);
  CHECK(scale->scale == doctest::Approx(40).epsilon(0.01));
  CHECK(scale->sigma < 0.25 * scale->scale);
  // Half the slant distance to the same landmarks is half the scale: it does not cancel.
  SlantDrive near{40};
  near.frame(true), near.fix(10), near.frame(true);
  CHECK(near.scale("points")->scale == doctest::Approx(20).epsilon(0.01));
  // `baseline`, which has no line yet, starts with it instead of waiting for a scale that never comes.
  CHECK(drive.scale("baseline")->scale == doctest::Approx(40).epsilon(0.01));
  SlantDrive without{40};
  without.frame(false), without.fix(), without.frame(false);
  CHECK_FALSE(without.scale("points"));
  CHECK(without.scale("points", {{"initial_scale", "30"}})->scale == 30);
  SlantDrive metric{1};
  metric.frame(true, true), metric.fix(), metric.frame(true, true);
  CHECK_FALSE(metric.scale("points"));
}

TEST_CASE("the literal scale counts from navigation.start, which the first pose states") {
  SlantDrive drive{0.5};
  drive.frame(false);
  drive.pose(Vector3d(100, 50, -1.5) + Vector3d(2, 0, 0));  // moved by Algorithm 1's first scale, 1
  for (int k = 1; k < 10; ++k) drive.frame(false);
  CHECK(drive.scale("gakne2018")->scale == 1);
  drive.fix(40);
  drive.frame(false);
  // After 10 m: P_3DBM is 10 m from the start, P_VO of the frame before 9 / 0.5 = 18: 40 / 8.
  CHECK(drive.scale("gakne2018")->scale == doctest::Approx(5));
}

TEST_CASE("the slant distance cancels in `baseline`") {
  SlantDrive drive{0.5}, other{0.5};
  for (int k = 0; k < 20; ++k) drive.frame(false), drive.fix(20), other.frame(false), other.fix(33);
  CHECK(drive.scale("baseline")->scale == doctest::Approx(0.5));
  CHECK(other.scale("baseline")->scale == drive.scale("baseline")->scale);
}
