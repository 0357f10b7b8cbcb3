// SPDX-License-Identifier: Apache-2.0
//
// The scale from slant distances to roof lines, and the sky odometry (Gakne & O'Keefe 2018).
#include <random>

#include <opencv2/imgproc.hpp>

#include "plugins/fix/skyline/matcher.hpp"
#include "plugins/fix/skyline/robust_sky.hpp"
#include "plugins/scale/slant_distance/slant_scale.hpp"
#include "plugins/vo/gakne2018/sky_odometry.hpp"
#include "tests/support/support.hpp"

using namespace odograph::skyline;

TEST_SUITE_BEGIN("skyline");

TEST_CASE("eq. (5): the scale is the line through positions, for any heading and robust against outliers") {
  slant_scale::SlantScale scale(15, 8, 0.02);
  const double true_scale = 0.4;
  const Eigen::Rotation2Dd turned(0.1);
  Eigen::Vector2d at(0, 0);
  for (int k = 0; k < 100; ++k) {
    const int64_t t = (k + 1) * 100'000'000LL;
    at += turned * Eigen::Vector2d(1.0, 0.05 * k / 100);
    scale.add_motion(t - 100'000'000, t, {1.0 / true_scale, 0.05 * k / 100 / true_scale, 0}, 1);
    if (k % 5 == 0)
      scale.add_position(t, at + Eigen::Vector2d(k == 50 ? 25.0 : 0.2 * std::sin(k), 0.2 * std::cos(3 * k)), 0.25);
  }
  REQUIRE(scale.scale());
  CHECK(scale.scale()->scale == doctest::Approx(true_scale).epsilon(0.03));
  CHECK(scale.scale()->sigma < 0.1 * true_scale);
  // Another scale: until the next fixes the speed is assumed unchanged.
  scale.add_motion(10'000'000'000, 10'100'000'000, {0.2, 0, 0}, 2);
  REQUIRE(scale.scale());
  CHECK(scale.scale()->scale == doctest::Approx(5.0).epsilon(0.05));
  CHECK(scale.scale()->sigma > 1.0);
}

TEST_CASE("each new scale group continues with the previous speed, also without fixes in between") {
  slant_scale::SlantScale scale(15, 8, 0.02);
  int64_t t = 0;
  const auto move = [&](double units, uint32_t group) {
    scale.add_motion(t, t + 100'000'000, {units, 0, 0}, group);
    t += 100'000'000;
  };
  for (int k = 1; k <= 100; ++k) {  // 10 m/s, a metre per unit
    move(1, 1);
    if (k % 5 == 0) scale.add_position(t, {static_cast<double>(k), 0}, 0.01);
  }
  REQUIRE(scale.scale());
  CHECK(scale.scale()->scale == doctest::Approx(1.0).epsilon(0.01));
  uint32_t group = 1;
  for (const double units : {0.2, 4.0, 0.5}) {
    ++group;
    CAPTURE(group);
    for (int k = 0; k < 15; ++k) move(units, group);
    REQUIRE(scale.scale());
    CHECK(scale.scale()->scale == doctest::Approx(1 / units).epsilon(0.05));
  }
}

TEST_CASE("eq. (5) taken literally decreases with the distance driven and is not a scale") {
  const double u = 0.5;
  slant_scale::LiteralScale scale;
  CHECK_FALSE(scale.scale());
  std::vector<double> at_10_40_160;
  for (int metre = 1; metre <= 160; ++metre) {
    scale.add_motion({1 / u, 0, 0}, 1);
    scale.add_position({double(metre), 0, 0}, 40);
    if (metre == 10 || metre == 40 || metre == 160) at_10_40_160.push_back(*scale.scale());
  }
  CHECK(at_10_40_160[0] == doctest::Approx(40.0 / 8));  // the previous position: one frame behind, 2 units
  CHECK(at_10_40_160[1] == doctest::Approx(40.0 / 38));
  CHECK(at_10_40_160[2] == doctest::Approx(40.0 / 158));
}

TEST_CASE("eq. (1): the rigid motion of weighted points is found") {
  std::vector<Eigen::Vector2d> p, q;
  const Eigen::Rotation2Dd R(0.2);
  for (int i = 0; i < 20; ++i) {
    p.emplace_back(std::cos(i * 1.7), std::sin(i * 2.3));
    q.push_back(R * p.back() + Eigen::Vector2d(0.3, -0.1));
  }
  q[3] += Eigen::Vector2d(5, 5);
  std::vector<double> weights(20, 1.0);
  weights[3] = 0;
  const auto motion = gakne2018::rigid_motion(p, q, weights);
  CHECK((motion.R - R.toRotationMatrix()).norm() < 1e-9);
  CHECK((motion.T - Eigen::Vector2d(0.3, -0.1)).norm() < 1e-9);
}

TEST_CASE("the sky odometry moves against the roofs, in units of their height") {
  cv::Mat noise(120, 160, CV_8UC1), roofs;
  cv::RNG(7).fill(noise, cv::RNG::UNIFORM, 0, 255);
  cv::resize(noise, roofs, {1280, 960}, 0, 0, cv::INTER_LINEAR);
  CameraModel camera{.fx = 400, .fy = 400, .cx = 319.5, .cy = 239.5};
  gakne2018::SkyOdometry vo({}, camera);
  const Eigen::Quaterniond level(0, 1, 0, 0);  // x right of the picture stays x
  vo.process(roofs(cv::Rect(300, 200, 640, 480)), {}, level, 0.1);
  const auto motion = vo.process(roofs(cv::Rect(308, 196, 640, 480)), {}, level, 0.1);
  REQUIRE(motion.valid);
  CHECK(std::abs(motion.p_c0_c1.x() - 8.0 / 400) < 0.05 * 8.0 / 400);
  CHECK(std::abs(motion.p_c0_c1.y() + 4.0 / 400) < 0.1 * 4.0 / 400);
  CHECK(motion.q_c0_c1.angularDistance(Eigen::Quaterniond::Identity()) < 0.002);
  const auto nothing = vo.process(cv::Mat(480, 640, CV_8UC1, cv::Scalar(128)), {}, level, 0.1);
  CHECK_FALSE(nothing.valid);
}
