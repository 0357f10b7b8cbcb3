// SPDX-License-Identifier: Apache-2.0
//
// Figures of synthetic tracks with closed-form answers.
#include "sdk/tools/evaluation/fix_figures.hpp"
#include "sdk/tools/evaluation/pose_consistency.hpp"
#include "sdk/tools/evaluation/vo_consistency.hpp"
#include "tests/support/messages.hpp"
#include "tests/support/support.hpp"

using Eigen::AngleAxisd;
using Eigen::Quaterniond;
using Eigen::Vector3d;

namespace {

constexpr int64_t kSecond = 1'000'000'000;

Quaterniond yaw(double rad) { return Quaterniond(AngleAxisd(rad, Vector3d::UnitZ())); }

/// Half a metre per pose to the north, ten poses per second, scaled and bent.
StampedPoses line(int n, double scale = 1, double bend_rad = 0) {
  StampedPoses t;
  for (int i = 0; i < n; ++i) t.push_back({i * kSecond / 10, yaw(bend_rad * i), {0.5 * scale * i, 0, 0}});
  return t;
}

bool is_near(double found, double expected) { return std::abs(found - expected) < 1e-9 * (std::abs(expected) + 1e-3); }

}  // namespace

TEST_SUITE("evaluation") {
  TEST_CASE("the statistics of four numbers match a calculation by hand") {
    const Statistics s = statistics_of({3, -1, 7, 2});
    CHECK(s.n == 4);
    CHECK(is_near(s.mean, 2.75));
    CHECK(is_near(s.sse, 63));
    CHECK(is_near(s.rmse, std::sqrt(63 / 4.0)));
    CHECK(is_near(s.std, std::sqrt(63 / 4.0 - 2.75 * 2.75)));
    CHECK((s.median == 2.5 && s.min == -1 && s.max == 7));
  }

  TEST_CASE("relative errors are those over intervals of a number of frames or of metres") {
    for (const double scale : {1.02, 0.98}) {
      CAPTURE(scale);
      const PoseErrors frames = relative_errors(line(41), line(41, scale), 4, false);
      CHECK(frames.translation_m.size() == 10);
      for (const double e : frames.translation_m) CHECK(is_near(e, 0.04));
      const PoseErrors metres = relative_errors(line(41), line(41, scale), 3, true);
      CHECK(metres.translation_m.size() == 6);
      for (const double e : metres.translation_m) CHECK(is_near(e, 0.06));
    }
    for (const double bend : {0.003, -0.003}) {
      for (const double e : relative_errors(line(41), line(41, 1, bend), 4, false).rotation_rad)
        CHECK(is_near(e, 0.012));
      const auto absolute = absolute_errors(line(41), line(41, 1, bend)).rotation_rad;
      CHECK(is_near(absolute[7], 0.021));
    }
    StampedPoses other = line(3);
    for (auto& x : other) x.q.coeffs() *= -1;  // the same rotation
    CHECK(absolute_errors(line(3), other).rotation_rad[1] < 1e-9);
  }

  TEST_CASE("the scale along a path is assigned to the middle of its window") {
    const auto ratios = scale_along_path(line(61), line(61, 1.25), 10);
    REQUIRE(ratios.size() == 3);
    for (size_t i = 0; i < 3; ++i) {
      CHECK(is_near(ratios[i].first, 5 + 10.0 * static_cast<double>(i)));
      CHECK(is_near(ratios[i].second, 1.25));
    }
  }

  TEST_CASE("a position and a pose at a time are interpolated between their neighbours") {
    const StampedPoses t = {{kSecond, yaw(0), {0, 4, 0}}, {2 * kSecond, yaw(0.8), {10, 0, 1}}};
    CHECK((position_at(t, kSecond + kSecond / 4) - Vector3d(2.5, 3, 0.25)).norm() < 1e-12);
    CHECK(position_at(t, 0) == t[0].p);
    CHECK(position_at(t, 5 * kSecond) == t[1].p);
    const auto pose = required(pose_at(t, kSecond + kSecond / 4, 1));
    CHECK(pose->t_ns == kSecond + kSecond / 4);
    CHECK((pose->p - Vector3d(2.5, 3, 0.25)).norm() < 1e-12);
    CHECK(pose->q.angularDistance(yaw(0.2)) < 1e-9);
    CHECK_FALSE(pose_at(t, kSecond + kSecond / 4, 0.9));
    CHECK_FALSE(pose_at(t, kSecond - 1, 9));
    CHECK_FALSE(pose_at(t, 2 * kSecond + 1, 9));
    CHECK(pose_at(t, 2 * kSecond, 0.1)->p == t[1].p);
  }

  TEST_CASE("poses are matched to the nearest within the allowed difference") {
    const StampedPoses reference = {{100, yaw(0), {0, 0, 0}}, {200, yaw(0), {1, 0, 0}}, {300, yaw(0), {2, 0, 0}}};
    const StampedPoses estimate = {{149'000'100, yaw(0), {5, 0, 0}}};
    const StampedPoses wide = {
        {0, yaw(0), {0, 0, 0}}, {100'000'000, yaw(0), {1, 0, 0}}, {200'000'000, yaw(0), {2, 0, 0}}};
    CHECK(associate(wide, estimate, 0.05).reference.at(0).p.x() == 1);
    CHECK(associate(wide, estimate, 0.048).reference.empty());
    CHECK(associate(estimate, wide, 0.05).estimate.at(0).p.x() == 1);
    CHECK(associate(reference, {reference[1]}, 1e-9).reference.at(0).p.x() == 1);
  }

  TEST_CASE("a heading is fitted over the first metres only, for either direction, and legs are separated") {
    for (const double off : {0.4, -0.4, 3.0}) {
      CAPTURE(off);
      std::vector<Waypoint> marks;
      StampedPoses track;
      for (int i = 0; i <= 6; ++i) {
        marks.push_back({i * kSecond, {3.0 * i, 1, 2}});
        const Vector3d p =
            i <= 3 ? Vector3d(3.3 * i, 0, 0) : Vector3d(9.9, 3.3 * (i - 3), 0);  // it bends where the truth does not
        track.push_back({i * kSecond, yaw(0), yaw(-off) * p + Vector3d(7, 8, 9)});
      }
      CHECK(is_near(heading_offset(track, marks, 9), off));
      const WaypointErrors e = waypoint_errors(align_to_waypoints(track, marks, off), marks);
      CHECK(is_near(e.reference_m, 18));
      CHECK(is_near(e.estimate_m, 6 * 3.3));
      CHECK(is_near(e.distance_error(), 0.1));
      REQUIRE(e.position_m.size() == 6);
      CHECK(is_near(e.position_m[1], 0.6));
      CHECK(is_near(e.position_m[5], std::hypot(18 - 9.9, 9.9)));
      const LegErrors legs = leg_errors(track, marks, 9);
      CHECK(is_near(legs.true_headings_m[5], 1.8));
      CHECK(is_near(legs.true_lengths_m[5], 9 * std::sqrt(2.0)));
      REQUIRE(legs.heading_rad.size() == 6);
      CHECK(is_near(legs.heading_rad[0], EIGEN_PI / 4));
      CHECK(is_near(legs.heading_rad[5], -EIGEN_PI / 4));
      for (const double l : legs.length) CHECK(is_near(l, 0.1));
    }
  }

  TEST_CASE("a covariance is used with its own axes and correlations") {
    const double covariance[9] = {4, 1.5, 0, 1.5, 1, 0, 0, 0, 9};
    // The inverse of (4 1.5; 1.5 1) is (1 -1.5; -1.5 4) / 1.75.
    CHECK(is_near(horizontal_nees({2, 1, 50}, covariance), (4 - 6 + 4) / 1.75));
    CHECK(is_near(horizontal_nees({2, -1, 50}, covariance), (4 + 6 + 4) / 1.75));
    const StampedPoses truth = line(50);
    std::vector<odo_pose> poses;
    for (const StampedPose& x : truth) {
      auto pose = make_message<odo_pose>(ODO_TYPE_POSE, x.t_ns);
      const bool first = poses.empty();
      const Quaterniond q = yaw(first ? 0 : -0.06);
      pose.q_n[0] = q.w(), pose.q_n[3] = q.z();
      Vector3d::Map(pose.p_n) = x.p + Vector3d(first ? 0 : 0.4, first ? 0 : -0.3, 8);
      const double sigmas[6] = {0.5, 0.25, 0.02, 0.8, 0.1, 5};
      for (int i = 0; i < 6; ++i) pose.covariance[7 * i] = sigmas[i] * sigmas[i];
      poses.push_back(pose);
    }
    const PoseConsistency c = pose_consistency(poses, truth);
    const double part = 49.0 / 50;
    CHECK(is_near(c.position_nees, part * 0.5 * (0.16 / (0.64 + 1e-4) + 0.09 / (0.01 + 1e-4))));
    CHECK(is_near(c.heading_nees, part * 0.0036 / (4e-4 + 1e-6)));
    CHECK(std::abs(c.ape_m - 0.5 * std::sqrt(49.0) / 50) < 2e-3);

    auto m = make_message<odo_vo_motion>(ODO_TYPE_VO_MOTION, kSecond / 10);
    m.header.flags = ODO_VO_COVARIANCE;
    const Vector3d rotation(0.01, -0.02, 0.03);
    const Quaterniond q(AngleAxisd(rotation.norm(), rotation.normalized()));
    m.q_c0_c1[0] = q.w(), m.q_c0_c1[1] = q.x(), m.q_c0_c1[2] = q.y(), m.q_c0_c1[3] = q.z();
    Vector3d::Map(m.p_c0_c1) = Vector3d(1, 0.004, -0.002);  // any length: only directions matter
    const double sigmas[6] = {0.01, 0.05, 0.02, 0.3, 0.002, 0.004};
    for (int i = 0; i < 6; ++i) m.covariance[7 * i] = sigmas[i] * sigmas[i];
    const MotionConsistency f = motion_consistency(truth, {m});
    REQUIRE(f.rotation.size() == 1);
    CHECK(is_near(f.rotation[0], (1 + 0.16 + 2.25) / 3));
    CHECK(std::abs(f.direction.at(0) - (4 + 0.25) / 2) < 1e-3);
  }
}
