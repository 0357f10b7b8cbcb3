// SPDX-License-Identifier: Apache-2.0
//
// The scale from slant distances to roof lines, and the sky odometry (Gakne & O'Keefe 2018).
#include <algorithm>
#include <numbers>

#include <opencv2/imgproc.hpp>

#include "plugins/fix/skyline/matcher.hpp"
#include "plugins/fix/skyline/robust_sky.hpp"
#include "plugins/scale/slant_distance/literal_scale.hpp"
#include "plugins/scale/slant_distance/roof_points.hpp"
#include "plugins/scale/slant_distance/slant_scale.hpp"
#include "plugins/shared/median.hpp"
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

TEST_CASE("fixes that lie near each other give a first scale, as certain as they are, until they extend far enough") {
  slant_scale::SlantScale scale(15, 8, 0);
  // The start at (3, 4), and a fix of the same variance 0.02 m^2 after 2.5 units, 2 m farther: s = 2 / 2.5 = 0.8, with
  // sigma = sqrt(2 * 0.02) / 2.5 = 0.08.
  scale.add_motion(0, 100'000'000, {2.5, 0, 0}, 1);
  scale.start_at({3, 4}, 0.02);
  CHECK_FALSE(scale.scale());
  scale.add_position(100'000'000, {5, 4}, 0.02);
  REQUIRE(scale.scale());
  CHECK(scale.scale()->scale == doctest::Approx(0.8));
  CHECK(scale.scale()->sigma == doctest::Approx(0.08));
  CHECK_FALSE(scale.known());
  // Fixes of 1 m that are 2 m apart: sigma = sqrt(2) / 2.5 = 0.57, 71 % of the scale, is none.
  slant_scale::SlantScale uncertain(15, 8, 0);
  uncertain.add_motion(0, 100'000'000, {2.5, 0, 0}, 1);
  uncertain.start_at({3, 4}, 1);
  uncertain.add_position(100'000'000, {5, 4}, 1);
  CHECK_FALSE(uncertain.scale());
}

namespace {

constexpr int64_t kFrame_ns = 100'000'000;

/// A drive to the north of `metres` frames by a metre, in units of u metres, with a fix after the last one.
double literal_scale_after(int metres, double u, const Eigen::Vector3d& start_n, int frames_later = 0) {
  slant_scale::LiteralScale scale;
  scale.start_at(start_n);
  for (int k = 0; k < metres + frames_later; ++k)
    scale.add_motion(k * kFrame_ns, (k + 1) * kFrame_ns, {1 / u, 0, 0}, 1);
  scale.add_position(metres * kFrame_ns, start_n + Eigen::Vector3d(metres, 0, 0), 40);
  return scale.scale();
}

}  // namespace

TEST_CASE("eq. (5) taken literally decreases with the distance driven and is not a scale") {
  // u = 0.5 m, d_slant = 40 m. P_VO is that of the frame before: after n metres at 2 (n - 1) units from the start, n -
  // 2 from P_3DBM: 40 / 8, 40 / 38, 40 / 158.
  CHECK(literal_scale_after(10, 0.5, {0, 0, 0}) == doctest::Approx(5.0));
  CHECK(literal_scale_after(40, 0.5, {0, 0, 0}) == doctest::Approx(40.0 / 38));
  CHECK(literal_scale_after(160, 0.5, {0, 0, 0}) == doctest::Approx(40.0 / 158));
}

TEST_CASE("eq. (5): P_VO begins where the path does, and is of the time of the fix") {
  CHECK(literal_scale_after(10, 0.5, {0, 0, -1.5}) == doctest::Approx(5.0));
  CHECK(literal_scale_after(10, 0.5, {100, 50, -1.5}) == doctest::Approx(5.0));
  CHECK(literal_scale_after(10, 0.5, {100, 50, -1.5}, 7) == doctest::Approx(5.0));  // the fix comes 7 frames later
}

TEST_CASE("Algorithm 1: s is 1 until a fix, and eq. (6) is the length of a frame's displacement") {
  slant_scale::LiteralScale scale;
  CHECK(scale.scale() == 1);
  CHECK(scale.frame_displacement() == 1);
  scale.add_motion(0, kFrame_ns, {3, 4, 12}, 1);
  CHECK(scale.frame_displacement() == doctest::Approx(13));  // sqrt(9 + 16 + 144)
  CHECK(scale.scale() == 1);
  CHECK_FALSE(scale.corrected());
  scale.add_motion(kFrame_ns, 2 * kFrame_ns, {0, 0, 1}, 1);
  // P_VO of the frame before the fix: (3, 4, 12); from (3, 16, 17) it is sqrt(144 + 25) = 13 away: 39 / 13 = 3.
  scale.add_position(2 * kFrame_ns, {3, 16, 17}, 39);
  CHECK(scale.scale() == doctest::Approx(3));
  CHECK(scale.corrected());
  // A new group starts at the last P_3DBM: (3, 16, 17), and (3, 16, 21) is 4 away: 39 / 4.
  scale.add_motion(2 * kFrame_ns, 3 * kFrame_ns, {5, 5, 5}, 2);
  scale.add_position(3 * kFrame_ns, {3, 16, 21}, 39);
  CHECK(scale.scale() == doctest::Approx(9.75));
}

namespace {

/// Landmarks of a camera that looks up (x north, y west) on a wall 12 m to the north, in units of `u` metres, near the
/// roof point 12 m away and 16 m above: eq. (4) gives 16 / sin(53.13 deg) = 16 / 0.8 = 20 m.
std::vector<slant_scale::LandmarkPoint> wall(double u, int count = 5, float relative_sigma = 0.1f) {
  std::vector<slant_scale::LandmarkPoint> points;
  for (int k = 0; k < count; ++k) {
    const Eigen::Vector3d x_m(12, 0.1 * (k - 2), 16 - 0.2 * k);
    points.push_back({(x_m / u).cast<float>(), static_cast<float>(x_m.norm() / u) * relative_sigma});
  }
  return points;
}

const Eigen::Quaterniond kLooksUp(0, 1, 0, 0);
const slant_scale::RoofPoints::RoofPoint kRoof{{12, 0, -16}, 0.5};

}  // namespace

TEST_CASE("eq. (4) over the odometry's distance to the same roof is the scale, from one frame and without motion") {
  for (const double u : {0.25, 1.0, 40.0}) {
    CAPTURE(u);
    slant_scale::RoofPoints scale(15, 0);
    CHECK_FALSE(scale.scale_at(0));
    scale.add_points(kFrame_ns, 3, wall(u));
    scale.add_orientation(kFrame_ns, kLooksUp, 3);
    scale.add_fix(kFrame_ns, kRoof);
    REQUIRE(scale.scale_at(kFrame_ns));
    const auto s = *scale.scale_at(kFrame_ns);
    CHECK(s.scale == doctest::Approx(u).epsilon(0.002));
    // Relative variances: landmarks of 10 % each, of which three count: 0.01 / 3; the fix: 0.5 / 20 squared; the wall:
    // 8 % of the fix and 8 % of the mean.
    CHECK(s.sigma / s.scale == doctest::Approx(std::sqrt(0.01 / 3 + 0.000625 + 2 * 0.0064)).epsilon(0.01));
  }
}

TEST_CASE(
    "landmarks elsewhere, uncertain ones, other times and other groups give no scale, outliers hardly change it") {
  const auto scale_of = [](const std::vector<slant_scale::LandmarkPoint>& points, int64_t fix_ns, uint32_t group) {
    slant_scale::RoofPoints scale(15, 0);
    scale.add_points(kFrame_ns, 3, points);
    scale.add_orientation(kFrame_ns, kLooksUp, 3);
    scale.add_orientation(2 * kFrame_ns, kLooksUp, group);
    scale.add_fix(fix_ns, kRoof);
    return scale.scale_at(fix_ns);
  };
  CHECK(scale_of(wall(1), kFrame_ns, 3));
  CHECK_FALSE(scale_of(wall(1, 2), kFrame_ns, 3));        // two are too few
  CHECK_FALSE(scale_of(wall(1, 5, 1.5f), kFrame_ns, 3));  // distances known to 150 %
  CHECK_FALSE(scale_of(wall(1), 3 * kFrame_ns, 3));       // no frame within 0.1 s
  CHECK_FALSE(scale_of(wall(1), kFrame_ns, 4));           // the units are others now
  auto elsewhere = wall(1);
  for (auto& point : elsewhere) point.p_c.x() *= -1;  // the other side of the street
  CHECK_FALSE(scale_of(elsewhere, kFrame_ns, 3));
  auto with_cloud = wall(1);
  with_cloud[1].p_c *= 50, with_cloud[1].distance_sigma *= 50;
  CHECK(scale_of(with_cloud, kFrame_ns, 3)->scale == doctest::Approx(1).epsilon(0.1));
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

TEST_CASE("eq. (1): the weighted least squares by hand") {
  // p = (0, 0), (2, 0), (0, 2) with the weights 1, 1, 2; q = R p + T with R by 90 degrees, (x, y) -> (-y, x), and T =
  // (1, 3), but the first is off by (4, 0): q = (5, 3), (1, 5), (-1, 3). Weighted means: p0 = (0.5, 1), q0 = (1, 3.5).
  // S = sum w (p - p0)(q - q0)^T:
  //   (-0.5, -1)(4, -0.5)^T + (1.5, -1)(0, 1.5)^T + 2 (-0.5, 1)(-2, -0.5)^T = [0 3; -8 -2].
  // Angle of R: atan2(S_xy - S_yx, S_xx + S_yy) = atan2(11, -2) = 100.305 deg. T = q0 - R p0.
  const auto motion = gakne2018::rigid_motion({{0, 0}, {2, 0}, {0, 2}}, {{5, 3}, {1, 5}, {-1, 3}}, {1, 1, 2});
  const double c = -2 / std::sqrt(125.0), sine = 11 / std::sqrt(125.0);
  CHECK(motion.R(0, 0) == doctest::Approx(c));
  CHECK(motion.R(1, 0) == doctest::Approx(sine));
  CHECK(motion.T.x() == doctest::Approx(1 - (c * 0.5 - sine)));
  CHECK(motion.T.y() == doctest::Approx(3.5 - (sine * 0.5 + c)));
}

TEST_CASE("the height of a point follows from its displacement against the fitted one, and is one unit without any") {
  // T = (0.02, 0): a point that moves by 0.04 is at half the unit. Information of the prior 1 / 0.3^2 = 11.1, of the
  // match (0.02 / 0.001)^2 = 400: 1 / h = (11.1 + 2 * 400) / 411.1 = 1.973, sigma of 1 / h = 1 / sqrt(411.1) = 0.0493.
  const auto low = gakne2018::height_of({0.04, 0.5}, {0.02, 0}, 0.001, 0.3);  // across the motion: no information
  CHECK(low.value == doctest::Approx(1 / 1.973).epsilon(1e-3));
  CHECK(low.relative_sigma == doctest::Approx(0.0493 / 1.973).epsilon(1e-2));
  const auto standing = gakne2018::height_of({0.001, 0.001}, {0, 0}, 0.001, 0.3);
  CHECK(standing.value == doctest::Approx(1));
  CHECK(standing.relative_sigma == doctest::Approx(0.3));
  const auto backwards = gakne2018::height_of({-0.02, 0}, {0.02, 0}, 0.001, 0.3);
  CHECK(backwards.value > 10);
  CHECK(backwards.relative_sigma == doctest::Approx(1));
}

TEST_CASE("a camera is levelled without a heading of its own") {
  CHECK(gakne2018::levelled(Eigen::Vector3d::UnitZ()).angularDistance(Eigen::Quaterniond(0, 1, 0, 0)) < 1e-12);
  const Eigen::Vector3d up_c = Eigen::Vector3d(0.1, -0.05, 1).normalized();
  CHECK((gakne2018::levelled(up_c) * up_c + Eigen::Vector3d::UnitZ()).norm() < 1e-12);
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
  // All roofs of this picture are at one height: so are the points, one unit above the camera.
  REQUIRE(vo.points().size() == motion.inliers);
  std::vector<double> heights;
  for (const auto& point : vo.points()) heights.push_back(point.p_c.z());
  CHECK(median(heights) == doctest::Approx(1).epsilon(0.03));
  CHECK(vo.points().front().relative_sigma < 0.2);
  vo.process(roofs(cv::Rect(316, 192, 640, 480)), {}, level, 0.1);
  CHECK(std::any_of(vo.points().begin(), vo.points().end(), [](const auto& point) { return point.age == 3; }));
  const auto nothing = vo.process(cv::Mat(480, 640, CV_8UC1, cv::Scalar(128)), {}, level, 0.1);
  CHECK_FALSE(nothing.valid);
  CHECK(vo.points().empty());
}

TEST_CASE("the rotation of eq. (1) is found where it may be used, in pictures that are levelled only") {
  cv::Mat noise(160, 160, CV_8UC1), roofs, turned;
  cv::RNG(7).fill(noise, cv::RNG::UNIFORM, 0, 255);
  cv::resize(noise, roofs, {1280, 1280}, 0, 0, cv::INTER_LINEAR);
  const double rotation_deg = 3;
  cv::warpAffine(roofs, turned, cv::getRotationMatrix2D({639.5, 639.5}, rotation_deg, 1), roofs.size());
  CameraModel camera{.fx = 400, .fy = 400, .cx = 319.5, .cy = 239.5};
  const cv::Rect view(320, 400, 640, 480);
  for (const bool vision : {false, true}) {
    gakne2018::SkyOdometry vo({}, camera);
    const Eigen::Quaterniond level = gakne2018::levelled(Eigen::Vector3d::UnitZ());
    vo.process(roofs(view), {}, level, 0);
    const auto motion = vo.process(turned(view), {}, level, vision ? 0.15 : 0);
    const double turned_rad = motion.q_c0_c1.angularDistance(Eigen::Quaterniond::Identity());
    CAPTURE(vision);
    if (vision) CHECK(turned_rad == doctest::Approx(rotation_deg * std::numbers::pi / 180).epsilon(0.03));
    if (!vision) CHECK(turned_rad < 1e-9);
  }
}
