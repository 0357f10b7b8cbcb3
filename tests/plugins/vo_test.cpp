// SPDX-License-Identifier: Apache-2.0
#include <opencv2/imgproc.hpp>

#include "plugins/vo/antigny2019/odometry.hpp"
#include "plugins/vo/five_point/visual_odometry.hpp"
#include "sdk/tools/evaluation/evaluation.hpp"
#include "sdk/tools/simulation/random.hpp"
#include "tests/plugins/film.hpp"
#include "tests/support/runs.hpp"

using namespace odograph::five_point;
using Eigen::Vector3d;

TEST_SUITE_BEGIN("vo");

namespace {

struct Scene {
  std::vector<Vector3d> points;
  std::vector<cv::Point2d> project(const Eigen::Isometry3d& T_w_c, double noise, Random& random) const {
    std::vector<cv::Point2d> image;
    for (const auto& X : points) {
      const Vector3d x = T_w_c.inverse() * X;
      image.push_back({x.x() / x.z() + noise * random.normal(), x.y() / x.z() + noise * random.normal()});
    }
    return image;
  }
};

Scene random_scene(uint64_t seed) {
  Random random(seed, 2);
  Scene scene;
  for (int i = 0; i < 300; ++i)
    scene.points.push_back({random.uniform(-4, 4), random.uniform(-3, 3), random.uniform(4, 12)});
  return scene;
}

Eigen::Isometry3d pose(const Vector3d& p, double yaw) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() = p;
  T.linear() = Eigen::AngleAxisd(yaw, Vector3d::UnitY()).toRotationMatrix();
  return T;
}

}  // namespace

TEST_CASE("two views give rotation and direction of the translation with a third of the matches wrong") {
  std::vector<double> angles_rad, directions_rad;
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    Random random(seed, 4);
    const Scene scene = random_scene(seed);
    const Eigen::Isometry3d T = pose({0.5, 0.1, 0.2}, 0.1), T_1_0 = T.inverse();
    auto first = scene.project(Eigen::Isometry3d::Identity(), 5e-4, random), second = scene.project(T, 5e-4, random);
    for (size_t i = 0; i < 100; ++i) second[i] = {random.uniform(-0.5, 0.5), random.uniform(-0.4, 0.4)};
    const auto view = required(two_view(first, second, 2e-3));
    angles_rad.push_back(Eigen::AngleAxisd(view->R_1_0 * T_1_0.linear().transpose()).angle());
    directions_rad.push_back(std::acos(view->t_1_0.dot(T_1_0.translation().normalized())));
    CHECK(view->count == Between{150, 230});
  }
  CHECK(percentile(angles_rad, 0.5) < 1e-3);
  CHECK(percentile(angles_rad, 1) < 4e-3);
  CHECK(percentile(directions_rad, 1) < 0.02);
}

TEST_CASE(
    "two views with little parallax give the correct motion, or nothing while two solutions explain the matches") {
  int told = 0;
  for (uint64_t seed = 1; seed <= 12; ++seed) {
    Random random(seed, 6);
    const Scene scene = random_scene(seed);
    const Eigen::Isometry3d T = pose({0.09 * std::cos(0.5 * static_cast<double>(seed)), 0.04, 0.06}, 0.02);
    auto first = scene.project(Eigen::Isometry3d::Identity(), 6e-4, random), second = scene.project(T, 6e-4, random);
    for (size_t i = 0; i < 40; ++i) second[i] = {random.uniform(-0.5, 0.5), random.uniform(-0.4, 0.4)};
    const auto rotation = required(pure_rotation(first, second));
    const auto view = two_view_near(first, second, rotation->R_1_0, 2e-3, 200);
    if (!view) continue;
    ++told;
    const Eigen::Isometry3d T_1_0 = T.inverse();
    CHECK(Eigen::AngleAxisd(view->R_1_0 * T_1_0.linear().transpose()).angle() < 3e-3);
    CHECK(view->t_1_0.dot(T_1_0.translation().normalized()) > 0.9);
  }
  CHECK(told >= 8);
  // Distant points and noise only: any direction is equally good.
  Random random(77, 6);
  Scene far = random_scene(3);
  for (auto& X : far.points) X *= 100;
  const auto first = far.project(Eigen::Isometry3d::Identity(), 6e-4, random);
  const auto second = far.project(pose({0.05, 0, 0}, 0.02), 6e-4, random);
  CHECK_FALSE(two_view_near(first, second, pure_rotation(first, second)->R_1_0, 2e-3, 200));
}

TEST_CASE("pure rotation is distinguished from motion") {
  Random random(5, 4);
  const Scene scene = random_scene(2);
  const auto first = scene.project(Eigen::Isometry3d::Identity(), 5e-4, random);
  const auto turned = required(pure_rotation(first, scene.project(pose({0, 0, 0}, 0.12), 5e-4, random)));
  CHECK(turned->median_residual_rad < 1.5e-3);
  CHECK(Eigen::AngleAxisd(turned->R_1_0 * pose({0, 0, 0}, 0.12).linear()).angle() < 1e-3);
  const auto moved = pure_rotation(first, scene.project(pose({0.6, 0, 0}, 0.0), 5e-4, random));
  CHECK(moved->median_residual_rad > 5e-3);
}

TEST_CASE("triangulation needs parallax and rejects points behind a camera") {
  const Vector3d X(0.3, -0.2, 6);
  const auto see = [&](const Eigen::Isometry3d& T) {
    const Vector3d x = T.inverse() * X;
    return Sighting{T, {x.x() / x.z(), x.y() / x.z()}};
  };
  const auto a = see(pose({0, 0, 0}, 0)), b = see(pose({0.5, 0, 0}, 0.05)), c = see(pose({0.9, 0.1, 0.2}, -0.02));
  const auto found = required(triangulate({a, b, c}, 1e-3, 0.01));
  CHECK((*found - X).norm() < 1e-9);
  CHECK_FALSE(triangulate({a, see(pose({0.01, 0, 0}, 0))}, 1e-3, 0.01).has_value());
  auto crossed = b;
  crossed.normalized.x += 0.5;
  CHECK_FALSE(triangulate({a, crossed}, 1e-3, 0.01).has_value());
}

TEST_CASE("both camera models undistort what they distort") {
  // Forward model of Kannala & Brandt 2006 at one ray, by hand; the radial-tangential one likewise.
  const double x = 0.3, y = -0.2, r = std::hypot(x, y), theta = std::atan(r);
  CameraModel fisheye{CameraModel::Distortion::kannala_brandt, 300, 310, 320, 240, {0.02, -0.01, 0.003, -0.001}};
  const double t2 = theta * theta,
               d = theta * (1 + 0.02 * t2 - 0.01 * t2 * t2 + 0.003 * t2 * t2 * t2 - 0.001 * t2 * t2 * t2 * t2);
  std::vector<cv::Point2d> out;
  fisheye.undistort({cv::Point2f(static_cast<float>(300 * d / r * x + 320), static_cast<float>(310 * d / r * y + 240))},
                    out);
  CHECK(out[0].x == doctest::Approx(x).epsilon(1e-4));
  CHECK(out[0].y == doctest::Approx(y).epsilon(1e-4));
  CameraModel pinhole{CameraModel::Distortion::radial_tangential, 300, 310, 320, 240, {-0.1, 0.02, 1e-3, -2e-3}};
  const double r2 = r * r, radial = 1 - 0.1 * r2 + 0.02 * r2 * r2;
  const double xd = x * radial + 2 * 1e-3 * x * y - 2e-3 * (r2 + 2 * x * x),
               yd = y * radial + 1e-3 * (r2 + 2 * y * y) - 2 * 2e-3 * x * y;
  pinhole.undistort({cv::Point2f(static_cast<float>(300 * xd + 320), static_cast<float>(310 * yd + 240))}, out);
  CHECK(out[0].x == doctest::Approx(x).epsilon(1e-4));
  CHECK(out[0].y == doctest::Approx(y).epsilon(1e-4));
}

TEST_CASE("darkness is reported as lost without an invented motion, and is followed by a new scale group") {
  Film film(320, 240, 250, 3);
  VisualOdometry vo({}, film.model());
  const auto frame = [&](int i) { return film.frame({0.13 * i, 0, -1.5}, static_cast<size_t>(i)); };
  five_point::Motion motion;
  for (int i = 0; i < 10; ++i) motion = vo.process(frame(i), {});
  CHECK(motion.state == Tracking::tracking);
  CHECK(motion.scale_group == 0);
  const cv::Mat dark(240, 320, CV_8U, cv::Scalar(2));
  for (int i = 0; i < 5; ++i) {
    motion = vo.process(dark, {});
    CHECK(motion.state == Tracking::lost);
    CHECK(motion.failure == FailureReason::too_dark);
    CHECK_FALSE(motion.translation_valid);
  }
  for (int i = 15; i < 25; ++i) motion = vo.process(frame(i), {});
  CHECK(motion.state == Tracking::tracking);
  CHECK(motion.scale_group > 0);
}

TEST_CASE("sparse selection keeps the strongest of each cell, and matches are mutual and unlike the second best") {
  antigny2019::Features all;
  for (int i = 0; i < 50; ++i) {
    all.pixels.emplace_back(10.0f + 0.1f * static_cast<float>(i), 10.0f);
    all.strength.push_back(static_cast<float>(i % 7));
    all.descriptors.push_back(cv::Mat(1, 4, CV_32F, cv::Scalar(i)));
  }
  all.pixels.emplace_back(200.0f, 100.0f), all.strength.push_back(0.1f);
  all.descriptors.push_back(cv::Mat(1, 4, CV_32F, cv::Scalar(500)));
  const auto few = antigny2019::sparse(all, {320, 240}, 32, 3);
  REQUIRE(few.pixels.size() == 4);
  CHECK(few.strength[0] == 6);
  CHECK(few.strength[2] == 6);
  CHECK(few.pixels[3].x == 200);
  antigny2019::Features a, b;
  for (const float v : {0.0f, 10.0f, 20.0f, 20.5f})
    a.pixels.emplace_back(), a.descriptors.push_back(cv::Mat(1, 4, CV_32F, cv::Scalar(v)));
  for (const float v : {10.2f, 0.3f, 20.2f})
    b.pixels.emplace_back(), b.descriptors.push_back(cv::Mat(1, 4, CV_32F, cv::Scalar(v)));
  const auto pairs = antigny2019::match(a, b, 0.6);
  REQUIRE(pairs.size() == 3);
  CHECK(pairs[0] == std::pair(0, 1));
  CHECK(pairs[1] == std::pair(1, 0));
  CHECK(pairs[2] == std::pair(2, 2));  // the fourth has the same nearest one, which prefers the third
}

TEST_CASE(
    "Antigny et al.'s odometry: no displacement while standing, a constant scale in motion, a new group after "
    "darkness") {
  Film film(480, 360, 375, 5);
  for (const char* features : {"surf", "sift", "orb", "akaze"}) {
    CAPTURE(features);
    antigny2019::Odometry::Parameters p;
    p.features = features, p.ratio = 0.8;
    antigny2019::Odometry vo(p, film.model(), {480, 360});
    const auto frame = [&](int i, double north) { return film.frame({north, 0, -1.5}, static_cast<size_t>(i)); };
    antigny2019::Motion motion;
    for (int i = 0; i < 4; ++i) motion = vo.process(frame(i, 0), {});
    CHECK(motion.outcome == antigny2019::Outcome::no_parallax);
    CHECK_FALSE(motion.translation_valid);
    std::vector<double> displacements;
    Vector3d directions(0, 0, 0);
    int moved = 0;
    for (int i = 4; i < 12; ++i) {
      motion = vo.process(frame(i, 0.4 * (i - 3)), {});
      if (!motion.translation_valid || moved++ == 0) continue;  // the first includes the time before it
      CHECK(motion.T_c0_c1.translation().normalized().z() > 0.9);
      directions += motion.T_c0_c1.translation().normalized();
      displacements.push_back(motion.T_c0_c1.translation().norm());
    }
    REQUIRE(moved >= 5);
    CHECK(directions.normalized().z() > 0.97);
    std::sort(displacements.begin(), displacements.end());
    CHECK(displacements.back() < 3 * displacements.front());  // true displacements are equal; the scale drifts
    motion = vo.process(cv::Mat(360, 480, CV_8U, cv::Scalar(2)), {});
    CHECK(motion.outcome == antigny2019::Outcome::lost);
    CHECK_FALSE(motion.rotation_valid);
  }
}

TEST_CASE("a restart forgets the pictures before the last one and goes on without a gap, in a new scale group") {
  Film film(480, 360, 375, 5);
  antigny2019::Odometry vo({.ratio = 0.8}, film.model(), {480, 360});
  vo.restart();  // before the first picture
  antigny2019::Motion motion;
  for (int i = 0; i < 5; ++i) motion = vo.process(film.frame({0.4 * i, 0, -1.5}, static_cast<size_t>(i)), {});
  REQUIRE(motion.translation_valid);
  uint32_t group = motion.scale_group;
  CHECK(std::abs(motion.T_c0_c1.translation().norm() - 1) > 1e-9);
  vo.restart();
  motion = vo.process(film.frame({2.0, 0, -1.5}, 5), {});
  REQUIRE(motion.translation_valid);
  CHECK(motion.scale_group == group + 1);
  CHECK(motion.T_c0_c1.translation().norm() == doctest::Approx(1.0).epsilon(1e-9));  // the first two define the unit
  CHECK(motion.T_c0_c1.translation().normalized().z() > 0.9);
  // At rest the last picture has not become t-1; the restart is from it all the same.
  for (int i = 6; i < 9; ++i) motion = vo.process(film.frame({2.0, 0, -1.5}, static_cast<size_t>(i)), {});
  group = motion.scale_group;
  vo.restart();
  motion = vo.process(film.frame({2.4, 0, -1.5}, 9), {});
  CHECK(motion.scale_group == group + 1);
  CHECK(motion.translation_valid);
}

TEST_CASE("a rate below the camera's passes over frames, and motions join") {
  const TemporaryFolder folder;
  Scenario s;
  s.route = {{0, 0, 0}, {3, 0, 0}};
  s.walker.stand_s = 1;
  s.camera.width = 160, s.camera.height = 120, s.camera.focal_px = 125, s.camera.rate_hz = 30;
  const Recording recording = recorded(s, 1, folder / "w.odo");
  for (const double rate_hz : {0.0, 10.0}) {
    CAPTURE(rate_hz);
    std::ofstream(folder / "p.yaml") << "odograph: 1\nvo_frontend:\n  plugin: vo/antigny2019\n  parameters: {rate: "
                                     << rate_hz << " Hz}\n";
    const auto motions = run_of(recording, folder / "p.yaml").motions;
    REQUIRE(motions.size() > 20);
    const double all_s = 1e-9 * static_cast<double>(motions.back().header.t_ns - motions.front().t_from_ns) /
                         static_cast<double>(motions.size());
    CHECK(all_s == doctest::Approx(rate_hz > 0 ? 0.1 : 1.0 / 30).epsilon(0.05));
    for (size_t k = 1; k < motions.size(); ++k) CHECK(motions[k].t_from_ns == motions[k - 1].header.t_ns);
  }
}

TEST_CASE("the error of the real clips after Sim(3) stays below the plain baseline of 4.3 % and 4.1 % of the path" *
          doctest::test_suite("vo_data")) {
  for (const auto& clip : {std::pair("kitti_clip_b", 2.0), std::pair("tsukuba_90", 1.0)}) {
    const auto folder = data_or_skip(clip.first);
    if (folder.empty()) continue;
    const auto recording = required(read_recording(folder));
    const StampedPoses track = run_of(*recording, source("samples/configs/monocular.yaml")).track;
    CHECK(track.size() == recording->truth.size());
    const Pairs pairs = associate(recording->truth, track, 0.001);
    const double rmse =
        statistics_of(absolute_errors(pairs.reference, align(pairs, Alignment::sim3, nullptr)).translation_m).rmse;
    CAPTURE(clip.first);
    CHECK(100 * rmse / path_length(recording->truth) < clip.second);
  }
}

TEST_CASE("Antigny et al.'s odometry states its sigma from its inliers and the depth of its points") {
  constexpr double kFocal_px = 375;
  constexpr int kNear_px = 20, kFar_px = 12;  // motion of the lower and the upper half per frame
  Random random(3, 1);
  cv::Mat texture(360, 900, CV_8U);
  for (uint8_t& p : cv::Mat_<uint8_t>(texture)) p = static_cast<uint8_t>(random.uniform(0, 255));
  cv::GaussianBlur(texture, texture, {0, 0}, 2.5);
  cv::normalize(texture, texture, 0, 255, cv::NORM_MINMAX);
  antigny2019::Odometry vo({}, {CameraModel::Distortion::radial_tangential, kFocal_px, kFocal_px, 239.5, 179.5, {}},
                           {480, 360});
  int told = 0;
  for (int i = 0; i < 10; ++i) {
    cv::Mat grey(360, 480, CV_8U);
    texture(cv::Rect(kFar_px * i, 0, 480, 180)).copyTo(grey.rowRange(0, 180));
    texture(cv::Rect(kNear_px * i, 180, 480, 180)).copyTo(grey.rowRange(180, 360));
    const antigny2019::Motion motion = vo.process(grey, {});
    if (i < 2) continue;
    REQUIRE(motion.translation_valid);
    REQUIRE(motion.scale_group == 0);
    const double inliers = motion.inliers, moved = motion.T_c0_c1.translation().norm();
    CHECK(motion.rotation_sigma_rad * std::sqrt(inliers) * kFocal_px == doctest::Approx(1.5));
    const double depth = motion.position_sigma / motion.rotation_sigma_rad / moved;  // in displacements per frame
    CHECK(depth == Between{0.95 * kFocal_px / kNear_px, 1.05 * kFocal_px / kFar_px});
    ++told;
  }
  CHECK(told == 8);
}
