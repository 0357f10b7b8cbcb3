// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/messages/messages.hpp"
#include "sdk/tools/evaluation/vo_figures.hpp"
#include "tests/support/support.hpp"

using Eigen::Quaterniond;
using Eigen::Vector3d;

TEST_SUITE_BEGIN("vo_figures");

namespace {

constexpr int64_t kFrame_ns = 100'000'000;  // 10 Hz

/// Report of an odometry for one frame, beside the true motion.
struct StatedScale {
  double scale = 1;
  uint32_t flags = ODO_VO_ROTATION | ODO_VO_TRANSLATION | ODO_VO_METRIC | ODO_VO_INERTIAL;
  uint32_t group = 0;
  double sigma = 0.01;
  uint32_t state = ODO_TRACKING;
};

struct Run {
  StampedPoses truth;
  std::vector<odo_vo_motion> motions;
  std::vector<int64_t> emitted_ns, frames_ns;

  VoFigures figures(const VoFigureParameters& parameters = {}) const {
    return vo_figures(truth, motions, emitted_ns, frames_ns, parameters);
  }
};

/// An odometry that reports every true motion as changed by `says`. `down`: in the truth's frame.
template <class Speaker>
Run run(const StampedPoses& truth, Speaker says, const Vector3d& down = Vector3d::UnitZ()) {
  Run r{truth, {}, {}, {truth.front().t_ns}};
  for (size_t i = 1; i < truth.size(); ++i) {
    const StampedPose &a = truth[i - 1], &b = truth[i];
    const StatedScale s = says(i);
    auto m = make_message<odo_vo_motion>(ODO_TYPE_VO_MOTION, b.t_ns);
    m.header.flags = s.flags;
    m.t_from_ns = a.t_ns, m.state = s.state, m.scale_group = s.group, m.scale_sigma = s.sigma;
    const Quaterniond q = a.q.conjugate() * b.q;
    const Vector3d p = s.scale * (a.q.conjugate() * (b.p - a.p)), g = b.q.conjugate() * down;
    m.q_c0_c1[0] = q.w(), m.q_c0_c1[1] = q.x(), m.q_c0_c1[2] = q.y(), m.q_c0_c1[3] = q.z();
    Vector3d::Map(m.p_c0_c1) = p, Vector3d::Map(m.gravity_c1) = g;
    r.motions.push_back(m), r.emitted_ns.push_back(b.t_ns), r.frames_ns.push_back(b.t_ns);
  }
  return r;
}

StatedScale right(size_t) { return {}; }

/// A number of frames of a camera that looks about while it moves along `at` (m, by s).
template <class Path>
StampedPoses path(size_t frames, Path at) {
  StampedPoses t;
  for (size_t i = 0; i < frames; ++i) {
    const double s = 0.1 * static_cast<double>(i);
    const Quaterniond q = Quaterniond(Eigen::AngleAxisd(0.3 * std::sin(s), Vector3d::UnitZ())) *
                          Quaterniond(Eigen::AngleAxisd(1.4 + 0.1 * std::cos(2 * s), Vector3d(1, 0.2, 0).normalized()));
    t.push_back({5'000'000'000 + static_cast<int64_t>(i) * kFrame_ns, q, at(s)});
  }
  return t;
}

StampedPoses line(size_t frames) {
  return path(frames, [](double s) { return Vector3d(1.2 * s, 0, 0); });
}

/// 20 s straight ahead at 1 m/s, standing, and another 20 s.
StampedPoses with_stop(double standing_s) {
  return path(static_cast<size_t>(10 * (40 + standing_s)), [=](double s) {
    return Vector3d(s < 20 ? s : std::max(20.0, s - standing_s), 0.1 * std::sin(0.2 * s), 0);
  });
}

double spread(const StampedPoses& t) {
  std::vector<double> x;
  for (const StampedPose& pose : t) x.push_back(pose.p.x());
  return statistics_of(x).std;
}

}  // namespace

TEST_CASE("correct motions compose to the true path") {
  const auto truth = path(400, [](double s) { return Vector3d(10 * std::sin(0.2 * s), s, 0.3 * std::cos(s)); });
  const VoFigures f = run(truth, right).figures();
  CHECK(f.se3_rmse_m < 1e-9);
  CHECK(f.yaw_rmse_m < 1e-9);
  CHECK(f.scale == doctest::Approx(1));
  CHECK(f.path_m == doctest::Approx(f.own_path_m));
  CHECK(f.metric_share == doctest::Approx(399.0 / 400));
  CHECK(f.before_metric_share == 0);
  CHECK(f.groups == 1);
  CHECK(f.holes == 0);
  CHECK(f.start_s == doctest::Approx(0.1));
  CHECK(f.overconfident_share == 0);
  CHECK(f.scale_nees < 1e-9);
}

TEST_CASE("a scale that is wrong everywhere gives its factor, and an error in proportion to the path's spread") {
  Run r = run(line(300), [](size_t) { return StatedScale{.scale = 1.25}; });
  const VoFigures f = r.figures();
  CHECK(f.scale == doctest::Approx(0.8));
  r.truth.erase(r.truth.begin());  // no motion ends at the first pose
  CHECK(f.se3_rmse_m == doctest::Approx(0.25 * spread(r.truth)));
  CHECK(f.sim3_rmse_m < 1e-9);
}

TEST_CASE("yaw alignment takes the vertical from the gravity of the motions, for either sign of the reference's z") {
  const double tilt = 0.02;
  for (const double sign : {1.0, -1.0}) {
    const Vector3d down = sign * Vector3d::UnitZ(), tilted = Eigen::AngleAxisd(tilt, Vector3d::UnitY()) *
                                                             down;  // with an error about the path's lateral axis
    CHECK(run(line(300), right, down).figures().yaw_rmse_m < 1e-9);
    const auto stairs = path(300, [](double s) { return Vector3d(8 * std::sin(0.3 * s), s, 0.4 * s); });
    CHECK(run(stairs, right, down).figures().yaw_rmse_m < 1e-9);  // a line may be upside down, stairs may not
    const Run wrong = run(line(300), right, tilted);
    StampedPoses ends = wrong.truth;
    ends.erase(ends.begin());
    CHECK(wrong.figures().yaw_rmse_m == doctest::Approx(2 * std::sin(tilt / 2) * spread(ends)).epsilon(1e-6));
    CHECK(wrong.figures().se3_rmse_m < 1e-9);
  }
  CHECK(std::isnan(run(line(300), right, Vector3d::UnitX()).figures().yaw_rmse_m));  // a reference on its side
}

TEST_CASE("poses before the first metric motion of a group are not metric and are counted separately") {
  const auto truth = path(200, [](double s) { return Vector3d(std::max(0.0, s - 1), 0, 0); });
  Run r = run(truth, [](size_t i) {
    StatedScale s;
    if (i <= 40) s.flags &= ~uint32_t{ODO_VO_METRIC | ODO_VO_INERTIAL}, s.scale = 7;
    if (i > 100) s.flags &= ~uint32_t{ODO_VO_METRIC};  // the group is metric, flagged once
    return s;
  });
  for (int64_t& t : r.emitted_ns) t += 30'000'000;
  const VoFigures f = r.figures();
  CHECK(f.se3_rmse_m < 1e-9);
  CHECK(f.metric_share == doctest::Approx(159.0 / 200));
  CHECK(f.before_metric_share == doctest::Approx(40.0 / 200));
  CHECK(f.placed_share == doctest::Approx(199.0 / 200));
  CHECK(f.start_s == doctest::Approx(4.13));
  CHECK(f.start_from_motion_s == doctest::Approx(3.03));  // 0.1 m at 1.1 s is the first beyond 5 cm
}

TEST_CASE("an odometry that is never metric has no metric figures") {
  const VoFigures f =
      run(line(100), [](size_t) { return StatedScale{.flags = ODO_VO_ROTATION | ODO_VO_TRANSLATION}; }).figures();
  CHECK(f.metric_share == 0);
  CHECK(f.placed_share == doctest::Approx(0.99));
  CHECK(std::isnan(f.se3_rmse_m));
  CHECK(std::isnan(f.start_s));
  CHECK(std::isnan(f.overconfident_share));
  CHECK(f.before_metric_share == 0);
}

TEST_CASE("a new group without metric scale keeps the position") {
  const Run r = run(line(300), [](size_t i) {
    StatedScale s;
    if (i > 100) s.group = 1;
    if (i > 100 && i <= 150) s.flags = ODO_VO_ROTATION | ODO_VO_TRANSLATION, s.scale = 3;
    return s;
  });
  const ComposedMotions composed = compose(r.motions);
  CHECK((composed.poses[150].p_m - composed.poses[100].p_m).norm() == 0);
  CHECK((composed.poses[299].p_m - composed.poses[150].p_m).norm() == doctest::Approx(0.12 * 149));
  CHECK((composed.poses[150].unscaled - composed.poses[100].unscaled).norm() == doctest::Approx(3 * 0.12 * 50));
  const VoFigures f = r.figures();
  CHECK(f.groups == 2);
  CHECK(f.longest_group_share == doctest::Approx(199.0 / 300));
  CHECK(f.before_metric_share == doctest::Approx(50.0 / 300));
  CHECK(f.own_path_m == doctest::Approx(0.12 * (99 + 149)));  // the frames themselves; the gap adds nothing
}

TEST_CASE("motions without a displacement, lost ones and gaps are counted") {
  Run r = run(line(100),
              [](size_t i) { return StatedScale{.flags = i % 10 == 0 ? ODO_VO_ROTATION : StatedScale{}.flags}; });
  for (size_t i = 50; i < 60; ++i) r.motions[i].state = ODO_LOST;
  r.motions.erase(r.motions.begin() + 70);
  const ComposedMotions composed = compose(r.motions);
  CHECK(composed.holes == 1);
  CHECK(composed.poses[10].unscaled == composed.poses[9].unscaled);
  CHECK_FALSE(composed.poses[10].placed);
  CHECK_FALSE(composed.poses[55].placed);
  CHECK(composed.poses[56].unscaled != composed.poses[55].unscaled);
}

TEST_CASE("an error of a hand's breadth at a reversal is not counted as a scale error") {
  // Out and back at 1 m/s, ten times; at each far end the odometry has an error of 15 cm.
  const auto there_and_back = [](double s) {
    const double phase = std::fmod(s, 14.2);
    return Vector3d(phase < 7.1 ? phase : 14.2 - phase, 0, 0);
  };
  Run r = run(path(1400, there_and_back), [](size_t) { return StatedScale{.sigma = 0.02}; });
  for (size_t i = 71; i < r.motions.size(); i += 142) {
    const Vector3d aside = r.truth[i].q.conjugate() * Vector3d(-0.15, 0, 0);
    Vector3d::Map(r.motions[i - 1].p_c0_c1) += aside;
  }
  CHECK(r.figures().overconfident_share == 0);
  CHECK(r.figures().windows.size() > 10);
}

TEST_CASE("tracked segments are measured separately, without those in between") {
  // 48 m: 24 m correct, 12 m degraded and twice too long, 12 m a tenth too long.
  const Run r = run(line(401), [](size_t i) {
    if (i <= 200) return StatedScale{};
    return i <= 300 ? StatedScale{.scale = 2, .state = ODO_DEGRADED} : StatedScale{.scale = 1.1};
  });
  const VoFigures f = r.figures();
  REQUIRE(f.tracked.size() == 2);
  CHECK(f.tracked[0].path_m == doctest::Approx(24).epsilon(0.02));
  CHECK(f.tracked[0].rmse_m < 1e-9);
  CHECK(f.tracked[1].path_m == doctest::Approx(12).epsilon(0.02));
  // A line too long by a tenth, with centres aligned: a tenth of L / sqrt(12).
  CHECK(std::abs(f.worst_tracked - 0.1 / std::sqrt(12)) < 0.02 * 0.1 / std::sqrt(12));
  CHECK(f.se3_rmse_m > 1);
  CHECK(std::isnan(run(line(401), [](size_t) { return StatedScale{.state = ODO_DEGRADED}; }).figures().worst_tracked));
}

TEST_CASE("stops are detected from the camera's displacement, not from the sway of the trunk") {
  const auto stops = stops_of(with_stop(5), {});
  REQUIRE(stops.size() == 1);
  CHECK(static_cast<double>(stops[0].from_ns) * 1e-9 == doctest::Approx(25).epsilon(0.03));
  CHECK(static_cast<double>(stops[0].to_ns) * 1e-9 == doctest::Approx(30).epsilon(0.03));
  CHECK(stops_of(with_stop(1.5), {}).empty());
  const auto swaying =
      stops_of(path(300, [](double s) { return Vector3d(0.04 * std::sin(6 * s), 0.03 * std::cos(6 * s), 0); }), {});
  REQUIRE(swaying.size() == 1);
  CHECK(swaying[0].to_ns - swaying[0].from_ns == 299 * kFrame_ns);
  CHECK(stops_of({}, {}).empty());
}

TEST_CASE("a scale that changes while the camera stands is found with and without a new group") {
  const auto jumping = [](bool said) {
    return run(with_stop(5), [said](size_t i) {
      StatedScale s{.flags = ODO_VO_ROTATION | ODO_VO_TRANSLATION};
      if (i > 225) s.scale = 2.5, s.group = said ? 1 : 0;
      return s;
    });
  };
  const VoFigures unsaid = jumping(false).figures();
  REQUIRE(unsaid.stops.size() == 1);
  CHECK(unsaid.stops[0].measured());
  CHECK(unsaid.stops[0].scale_before == doctest::Approx(1));
  CHECK(unsaid.stops[0].scale_after == doctest::Approx(2.5).epsilon(0.02));
  CHECK(unsaid.worst_jump == doctest::Approx(1.5).epsilon(0.03));
  const VoFigures said = jumping(true).figures();
  CHECK(said.stops[0].new_group);
  CHECK(std::isnan(said.worst_jump));
}

TEST_CASE("a stop too close to the start has no segment before it") {
  const auto truth = path(300, [](double s) { return Vector3d(s < 3 ? s : std::max(3.0, s - 5), 0, 0); });
  const VoFigures f = run(truth, right).figures();
  REQUIRE(f.stops.size() == 1);
  CHECK_FALSE(f.stops[0].measured());
  CHECK(f.stops[0].scale_after == doctest::Approx(1));
}

TEST_CASE("drift while standing is given per minute") {
  Run r = run(with_stop(30), right);
  for (size_t i = 230; i < 430; ++i) {  // 1 mm per frame, straight in the camera's axes at the start of the stop
    const Vector3d d = r.truth[i].q.conjugate() * Vector3d(0.001, 0, 0);
    Vector3d::Map(r.motions[i].p_c0_c1) += d;
  }
  const VoFigures f = r.figures();
  REQUIRE(f.stops.size() == 1);
  CHECK(std::abs(f.stops[0].drift_m - 0.2) < 0.002);
  CHECK(std::abs(f.standing_drift_m_min - 0.4) < 0.02);
}

TEST_CASE("a scale is wrong and certain if it is off by more than three of its own sigmas") {
  const auto figures = [](double sigma) {
    return run(line(600),
               [sigma](size_t i) { return StatedScale{.scale = i > 300 ? std::exp(0.06) : 1.0, .sigma = sigma}; })
        .figures();
  };
  CHECK(std::abs(figures(0.01).overconfident_share - 0.5) < 0.025);
  CHECK(figures(0.01).scale_nees == doctest::Approx(18).epsilon(0.1));
  CHECK(figures(0.03).overconfident_share == 0);
  CHECK(figures(0.03).scale_nees == doctest::Approx(2).epsilon(0.1));
  CHECK(figures(0.0).windows.size() > 10);
  CHECK(std::isnan(figures(0.0).overconfident_share));
  for (const ScaleWindow& w : figures(0.01).windows)
    if (w.path_m > 40) CHECK(w.log_scale == doctest::Approx(0.06));
}

TEST_CASE("a pose is interpolated between two others, unless they are too far apart") {
  const auto truth = line(10);
  const int64_t t = truth[3].t_ns + kFrame_ns / 4;
  const auto pose = required(pose_at(truth, t, 0.25));
  CHECK((pose->p - (truth[3].p + 0.25 * (truth[4].p - truth[3].p))).norm() < 1e-12);
  CHECK(pose->q.angularDistance(truth[3].q.slerp(0.25, truth[4].q)) < 1e-12);
  CHECK(pose_at(truth, truth[3].t_ns, 0)->p == truth[3].p);
  CHECK_FALSE(pose_at(truth, t, 0.05));
  CHECK_FALSE(pose_at(truth, truth.front().t_ns - 1, 1));
  CHECK_FALSE(pose_at(truth, truth.back().t_ns + 1, 1));
}
