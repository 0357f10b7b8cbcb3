// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>
#include <rapidcheck.h>

#include "sdk/tools/evaluation/evaluation.hpp"
#include "tests/support/support.hpp"

using Eigen::Vector3d;

TEST_SUITE_BEGIN("evaluation");

namespace {

StampedPoses winding(size_t n) {
  StampedPoses t;
  for (size_t i = 0; i < n; ++i) {
    const double s = 0.05 * static_cast<double>(i);
    t.push_back({static_cast<int64_t>(i) * 100'000'000,
                 Eigen::Quaterniond(Eigen::AngleAxisd(s, Vector3d(0.2, 0.3, 1).normalized())),
                 {3 * std::cos(s), 2 * std::sin(1.3 * s), 0.4 * s}});
  }
  return t;
}

StampedPoses moved(const StampedPoses& t, double scale, const Eigen::Quaterniond& q, const Vector3d& p) {
  StampedPoses out = t;
  for (auto& x : out) x.p = q * (scale * x.p) + p, x.q = q * x.q;
  return out;
}

}  // namespace

TEST_CASE(
    "a scale error's part is all of the error of a track that is only too long, and none of one that is only bent") {
  const StampedPoses truth = winding(200);
  const Eigen::Quaterniond yaw(Eigen::AngleAxisd(0.7, Vector3d::UnitZ()));
  const Pairs longer{truth, moved(truth, 1.25, yaw, {5, -3, 1})};
  const auto of_scale = required(scale_part(truth, align(longer, Alignment::yaw, nullptr)));
  CHECK(of_scale->scale == doctest::Approx(1.25));
  CHECK(of_scale->rms_m < 1e-9);
  Pairs both = longer;
  for (size_t i = 0; i < both.estimate.size(); ++i) both.estimate[i].p.z() += i % 2 ? 0.1 : -0.1;
  const auto rest = required(scale_part(truth, align(both, Alignment::yaw, nullptr)));
  CHECK(rest->scale == doctest::Approx(1.25).epsilon(0.01));
  CHECK(rest->rms_m == doctest::Approx(0.1 / 1.25).epsilon(0.02));
  CHECK_FALSE(scale_part(truth, moved(truth, 0, yaw, {1, 2, 3})));
}

TEST_CASE("every figure of the reference results agrees with evo's" * doctest::test_suite("evaluation_data")) {
  const auto folder = data_or_skip("trajectories");
  if (folder.empty()) return;
  const auto expected = nlohmann::json::parse(read_text(folder / "expected.json"));
  const std::pair<const char*, std::pair<const char*, const char*>> sets[] = {
      {"fr2_desk_ORB", {"fr2_desk_groundtruth.txt", "fr2_desk_ORB.txt"}},
      {"fr1_xyz_rgbdslam", {"freiburg1_xyz-groundtruth.txt", "freiburg1_xyz-rgbdslam.txt"}}};
  int figures = 0;
  for (const auto& [name, files] : sets) {
    const auto pairs = associate(*read_tum(folder / files.first), *read_tum(folder / files.second), 0.01);
    CHECK(pairs.reference.size() == expected[name]["n"].get<size_t>());
    for (const auto& [key, figure] : expected[name].items()) {
      if (!figure.is_object()) continue;
      const auto last = key.rfind('_');
      const auto alignment = *parse_alignment(key.substr(last + 1));
      const auto aligned = align(pairs, alignment, nullptr);
      const std::string what = key.substr(0, last);
      std::vector<double> errors = what == "ape" ? absolute_errors(pairs.reference, aligned).translation_m
                                   : what == "rpe1_trans"
                                       ? relative_errors(pairs.reference, aligned, 1, false).translation_m
                                       : relative_errors(pairs.reference, aligned, 1, false).rotation_rad;
      if (what == "rpe1_rot_deg")
        for (double& e : errors) e *= 180 / EIGEN_PI;
      const Statistics s = statistics_of(errors);
      const std::pair<const char*, double> ours[] = {{"rmse", s.rmse}, {"mean", s.mean}, {"median", s.median},
                                                     {"std", s.std},   {"min", s.min},   {"max", s.max},
                                                     {"sse", s.sse}};
      for (const auto& [statistic, value] : ours) {
        const std::string which = std::string(name) + " " + key + " " + statistic;
        CAPTURE(which);
        CHECK(std::abs(value / figure[statistic].get<double>() - 1) < 1e-5);
        ++figures;
      }
    }
  }
  CHECK(figures == 2 * 7 * 7);
}

TEST_CASE("each alignment removes its own transformation and no other") {
  rc::check("random similarity", [] {
    const auto number = [](double low, double high) { return low + (high - low) * *rc::gen::inRange(0, 100000) / 1e5; };
    const StampedPoses reference = winding(80);
    const double scale = number(0.2, 5);
    const Eigen::Quaterniond q(
        Eigen::AngleAxisd(number(-3, 3), Vector3d{number(-1, 1), number(-1, 1), 1.1}.normalized()));
    const Vector3d p{number(-9, 9), number(-9, 9), number(-9, 9)};
    double found = 0;
    const Pairs similar{reference, moved(reference, scale, q, p)};
    const auto aligned = align(similar, Alignment::sim3, &found);
    RC_ASSERT(std::abs(found * scale - 1) < 1e-9);
    RC_ASSERT(statistics_of(absolute_errors(reference, aligned).translation_m).max < 1e-9);
    RC_ASSERT(statistics_of(absolute_errors(reference, aligned).rotation_rad).max < 1e-7);
    const Pairs rigid{reference, moved(reference, 1, q, p)};
    for (const Alignment a : {Alignment::first, Alignment::se3})
      RC_ASSERT(statistics_of(absolute_errors(reference, align(rigid, a, nullptr)).translation_m).max < 1e-9);
    const Eigen::Quaterniond yaw(Eigen::AngleAxisd(number(-3, 3), Vector3d::UnitZ()));
    RC_ASSERT(statistics_of(
                  absolute_errors(reference, align({reference, moved(reference, 1, yaw, p)}, Alignment::yaw, nullptr))
                      .translation_m)
                  .max < 1e-9);
    // A tilt is not a yaw and must remain visible.
    const Eigen::Quaterniond tilt(Eigen::AngleAxisd(0.5, Vector3d::UnitX()));
    RC_ASSERT(statistics_of(
                  absolute_errors(reference, align({reference, moved(reference, 1, tilt, p)}, Alignment::yaw, nullptr))
                      .translation_m)
                  .max > 0.01);
  });
}

TEST_CASE("percentiles interpolate between ranks") {
  CHECK(percentile({4, 1, 3, 2}, 0.5) == doctest::Approx(2.5));
  CHECK(percentile({1, 2, 3, 4, 5}, 0.9) == doctest::Approx(4.6));
  CHECK(percentile({}, 0.5) == 0.0);
}

TEST_CASE("the scale along the path shows a drift") {
  StampedPoses reference, estimate;
  double x = 0;
  for (int i = 0; i <= 200; ++i) {
    reference.push_back({i, Eigen::Quaterniond::Identity(), {0.5 * i, 0, 0}});
    estimate.push_back({i, Eigen::Quaterniond::Identity(), {x, 0, 0}});
    x += 0.5 * (1.0 + 0.001 * i);
  }
  const auto ratios = scale_along_path(reference, estimate, 10);
  REQUIRE(ratios.size() == 10);
  CHECK(ratios.front().second == doctest::Approx(1.0095));
  CHECK(ratios.back().second == doctest::Approx(1.1895));
}

TEST_CASE("waypoints: the heading is fitted over the first metres, and errors are horizontal") {
  StampedPoses track;
  std::vector<Waypoint> waypoints;
  for (int i = 0; i <= 10; ++i) {
    const int64_t t = i * 1'000'000'000LL;
    track.push_back({t, Eigen::Quaterniond::Identity(), {0, 2.2 * i, 0.3}});  // heads east, 10 % too long
    waypoints.push_back({t, {5 + 2.0 * i, 7, 0}});                            // the truth heads north
  }
  const double rotation = heading_offset(track, waypoints, 10);
  CHECK(rotation == doctest::Approx(-EIGEN_PI / 2));
  const auto errors = waypoint_errors(align_to_waypoints(track, waypoints, rotation), waypoints);
  CHECK(errors.distance_error() == doctest::Approx(0.1));
  CHECK(errors.position_m.back() == doctest::Approx(2.0));
}

TEST_CASE("oracles separate heading errors from length errors") {
  StampedPoses bent{{0, Eigen::Quaterniond::Identity(), {4, -1, 2}}}, longer = bent;
  std::vector<Waypoint> waypoints{{0, {5, 7, 0}}};
  for (int i = 1; i <= 20; ++i) {
    const int64_t t = i * 1'000'000'000LL;
    const double direction = 1.0 + 0.05 * i;  // the estimate bends by this much per leg, the truth does not
    waypoints.push_back({t, waypoints.back().p_n + Eigen::Vector3d(3, 0, 0)});
    const Eigen::Vector3d leg(3 * std::cos(direction), 3 * std::sin(direction), 0.1);
    bent.push_back({t, Eigen::Quaterniond::Identity(), bent.back().p + leg});
    longer.push_back({t, Eigen::Quaterniond::Identity(), longer.back().p + Eigen::Vector3d(0, 3.3, 0)});
  }
  const auto bends = leg_errors(bent, waypoints, 10), lengthens = leg_errors(longer, waypoints, 10);
  CHECK(percentile(bends.true_headings_m, 1.0) < 1e-9);
  CHECK(percentile(bends.true_lengths_m, 1.0) > 10);
  CHECK(percentile(lengthens.true_headings_m, 1.0) == doctest::Approx(20 * 0.3));
  CHECK(percentile(lengthens.true_lengths_m, 1.0) < 1e-9);
  REQUIRE(bends.heading_rad.size() == 20);
  CHECK(bends.heading_rad.front() - bends.heading_rad.back() == doctest::Approx(19 * 0.05));
  CHECK(lengthens.length.front() == doctest::Approx(0.1));
  CHECK(leg_errors(bent, {}, 10).true_headings_m.empty());
}

TEST_CASE("a drifting scale shows as a change of scale within windows") {
  Pairs pairs;
  double own = 0;
  for (int i = 0; i <= 400; ++i) {
    const double unit = 0.7 * (1 + 0.001 * i);  // 0.1 m per pose; 10 m: 100 poses
    pairs.reference.push_back({i, Eigen::Quaterniond::Identity(), {0.1 * i, 0, 0}});
    pairs.estimate.push_back({i, Eigen::Quaterniond::Identity(), {0, own, 0}});
    own += 0.1 * unit;
  }
  const auto changes = scale_changes(pairs, 10);
  REQUIRE(changes.size() == 4);
  CHECK(std::abs(changes[0] - (1.0245 / 1.0745 - 1)) < 0.01 * std::abs(1.0245 / 1.0745 - 1));
  for (const double change : changes) CHECK(change < -0.03);
  CHECK(scale_changes({}, 10).empty());
}

TEST_CASE("with the true lengths only direction errors remain") {
  Pairs pairs;
  const auto pose = [](int i, double x, double y) {
    return StampedPose{i * 1'000'000LL, Eigen::Quaterniond::Identity(), {x, y, 0}};
  };
  for (int i = 0; i <= 40; ++i) {
    pairs.reference.push_back(pose(i, 2.0 * i, 0));
    pairs.estimate.push_back(pose(i, i < 20 ? 0.1 * i : 1.9 + 0.3 * (i - 19), 0));  // the scale changes within it
  }
  TrueLengths t = with_true_lengths(pairs, 0);
  CHECK((t.track.back().p - pairs.reference.back().p).norm() < 1e-9);
  CHECK(percentile(t.direction_error_rad, 1.0) < 1e-9);
  t = with_true_lengths(pairs, 10);
  CHECK((t.track.back().p - pairs.reference.back().p).norm() < 1e-9);
  // A step backwards costs twice its length; a missing one costs it once.
  for (int i = 30; i <= 40; ++i) pairs.estimate[static_cast<size_t>(i)].p.x() -= 0.6;
  CHECK((with_true_lengths(pairs, 0).track.back().p - pairs.reference.back().p).norm() == doctest::Approx(4.0));
  for (int i = 35; i <= 40; ++i) pairs.estimate[static_cast<size_t>(i)].p.x() -= 0.3;
  t = with_true_lengths(pairs, 0);
  CHECK(t.without_motion == 1);
  CHECK((t.track.back().p - pairs.reference.back().p).norm() == doctest::Approx(6.0));
}
