// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <unistd.h>

#include "plugins/vo/odograph/visual/bundle.hpp"
#include "plugins/vo/odograph/visual/odometry.hpp"
#include "sdk/math/rotation.hpp"
#include "sdk/tools/simulation/random.hpp"
#include "tests/plugins/film.hpp"
#include "tests/support/support.hpp"

using namespace odograph::vo;
using Eigen::Isometry3d;
using Eigen::Quaterniond;
using Eigen::Vector2d;
using Eigen::Vector3d;

TEST_SUITE_BEGIN("vo_odograph");

namespace {

constexpr int64_t kMilli = 1'000'000;

Isometry3d pose(const Vector3d& p, const Vector3d& rotation) {
  Isometry3d T = Isometry3d::Identity();
  T.translation() = p;
  T.linear() = exp_rotation(rotation).toRotationMatrix();
  return T;
}

std::vector<Vector3d> scene(uint64_t seed, size_t n = 150) {
  Random random(seed, 3);
  std::vector<Vector3d> points;
  for (size_t i = 0; i < n; ++i)
    points.push_back({random.uniform(-4, 4), random.uniform(-3, 3), random.uniform(3, 15)});
  return points;
}

Vector2d see(const Isometry3d& T_w_c, const Vector3d& X, Random& random, double sigma) {
  const Vector3d x = T_w_c.inverse() * X;
  return x.head<2>() / x.z() + sigma * Vector2d{random.normal(), random.normal()};
}

/// A camera that moves to the right and rotates; every keyframe sees every point.
Isometry3d along_path(int k) { return pose({0.25 * k, 0.02 * k, 0.05 * k}, {0.01 * k, 0.03 * k, -0.01 * k}); }

}  // namespace

TEST_CASE("a gyroscope's rotation, its derivative by the bias, and gaps are correct") {
  Gyroscope gyroscope;
  const Vector3d bias(0.01, -0.02, 0.005);
  const auto rate = [](double t) { return Vector3d(std::sin(3 * t), 0.5 * std::cos(2 * t), 0.3); };
  Quaterniond truth = Quaterniond::Identity();
  for (int i = 0; i <= 1000; ++i) {
    gyroscope.add(i * kMilli, rate(0.001 * i) + bias);
    if (i > 0) truth = truth * exp_rotation(rate(0.001 * i - 0.0005) * 0.001);
  }
  const auto rotation = required(gyroscope.between(0, 1000 * kMilli, bias));
  CHECK(rotation->q_c0_c1.angularDistance(truth) < 1e-5);
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3d h = 1e-5 * Vector3d::Unit(axis);
    const auto moved = gyroscope.between(0, 1000 * kMilli, bias + h);
    const Vector3d numeric = log_rotation(rotation->q_c0_c1.conjugate() * moved->q_c0_c1) / 1e-5;
    CHECK((numeric - rotation->by_bias.col(axis)).norm() < 1e-3);
  }
  CHECK_FALSE(gyroscope.between(0, 1200 * kMilli, bias));
  CHECK_FALSE(gyroscope.between(2000 * kMilli, 2100 * kMilli, bias));
}

TEST_CASE("a pose is found among outliers, and its error matches its covariance") {
  double nees = 0;
  constexpr int kRuns = 60;
  for (int run = 0; run < kRuns; ++run) {
    Random random(static_cast<uint64_t>(run), 5);
    const Isometry3d T = pose({0.2, -0.1, 0.3}, {0.02, 0.05, -0.03});
    std::vector<PointSeen> points;
    for (const Vector3d& X : scene(static_cast<uint64_t>(run) + 9)) {
      PointSeen point;
      point.X_w << X / X.z(), 1 / X.z();
      point.anchor_w.setZero();
      point.seen = see(T, X, random, 1e-3);
      if (points.size() % 4 == 0) point.seen += Vector2d{random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2)};
      points.push_back(point);
    }
    const auto fit = required(fit_pose(points, Isometry3d::Identity(), 1e-3, 0.2, std::nullopt));
    CHECK(fit->count > 95);
    Eigen::Matrix<double, 6, 1> error;
    error << log_rotation(Quaterniond(T.linear()).conjugate() * Quaterniond(fit->T_w_c.linear())),
        fit->T_w_c.translation() - T.translation();
    CHECK(error.tail<3>().norm() < 0.03);
    nees += error.dot(fit->covariance.inverse() * error) / 6 / kRuns;
  }
  CHECK(nees == Between{0.5, 1.6});
}

TEST_CASE("an unknown depth acts along its epipolar line only") {
  // Every other point is off its true depth, seen from the side: without its variance it biases the pose.
  const Isometry3d T = pose({0.3, 0, 0}, Vector3d::Zero());
  double error = 0, without = 0;
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    Random random(seed, 3);
    std::vector<PointSeen> points;
    for (const Vector3d& X : scene(seed, 30)) {
      PointSeen point;
      const bool wrong = points.size() % 2 == 0;
      const double inverse = wrong ? 1.15 / X.z() : 1 / X.z();
      point.X_w << X / X.z(), inverse;
      point.anchor_w.setZero();
      point.seen = see(T, X, random, 0);
      point.inverse_depth_variance = wrong ? 0.02 * 0.02 : 0;
      points.push_back(point);
    }
    const auto fit = required(fit_pose(points, T, 1e-3, 1e-2, std::nullopt));
    for (PointSeen& point : points) point.inverse_depth_variance = 0;
    const auto fooled = required(fit_pose(points, T, 1e-3, 1e-2, std::nullopt));
    error += (fit->T_w_c.translation() - T.translation()).norm();
    without += (fooled->T_w_c.translation() - T.translation()).norm();
  }
  CHECK(error < 0.2 * without);
}

TEST_CASE("the window's adjustment corrects poses, depths and the gyro bias, and preserves the scale") {
  Random random(8, 8);
  const double sigma = 8e-4;
  const Vector3d bias(0.008, -0.005, 0.003);
  Window window{KeyframeParameters{}};
  const auto points = scene(6);
  for (int k = 0; k < 6; ++k) {
    const Isometry3d T = along_path(k);
    Keyframe keyframe{0, 0, T, std::nullopt, Vector3d::Zero()};
    if (k > 0) {  // a gyroscope with its bias for 0.4 s
      const Quaterniond rotation = Quaterniond(along_path(k - 1).linear()).conjugate() * Quaterniond(T.linear());
      keyframe.rotation = GyroRotation{rotation * exp_rotation(0.4 * bias), -0.4 * Eigen::Matrix3d::Identity(), 2e-4};
    }
    if (k > 1) {  // the first two fix the scale
      keyframe.T_w_c.translation() += 0.02 * Vector3d{random.normal(), random.normal(), random.normal()};
      keyframe.T_w_c.linear() *=
          exp_rotation(0.005 * Vector3d{random.normal(), random.normal(), random.normal()}).toRotationMatrix();
    }
    window.add(keyframe);
    for (size_t i = 0; i < points.size(); ++i) window.observe(i, see(T, points[i], random, sigma));
  }
  window.triangulate();
  CHECK(window.triangulated() > 140);
  Vector3d found = Vector3d::Zero();
  const auto report = adjust(window, found, sigma);
  REQUIRE(report.solved);
  for (int k = 1; k < 6; ++k) {
    const Isometry3d error = along_path(k).inverse() * window.keyframes()[static_cast<size_t>(k)].T_w_c;
    CHECK(error.translation().norm() < 0.01);
    CHECK(Eigen::AngleAxisd(error.linear()).angle() < 0.0025);
  }
  CHECK((found - bias).norm() < 0.002);
  // The same window gives bit-identical numbers.
  Vector3d again = found;
  Window copy = window;
  adjust(window, found, sigma), adjust(copy, again, sigma);
  CHECK(found == again);
  CHECK(window.keyframes().back().T_w_c.matrix() == copy.keyframes().back().T_w_c.matrix());
}

namespace {

/// Output of the process to standard error while `work` runs.
template <class Work>
std::string standard_error_of(Work work) {
  const TemporaryFolder folder;
  const auto file = folder / "stderr";
  std::fflush(stderr);
  const int terminal = dup(STDERR_FILENO), caught = open(file.c_str(), O_CREAT | O_WRONLY, 0600);
  REQUIRE((terminal >= 0 && caught >= 0 && dup2(caught, STDERR_FILENO) >= 0));
  work();
  std::fflush(stderr);
  dup2(terminal, STDERR_FILENO);
  close(caught), close(terminal);
  return read_text(file);
}

Window window_along_path(int keyframes, double sigma) {
  Random random(8, 8);
  Window window{KeyframeParameters{}};
  const auto points = scene(6);
  for (int k = 0; k < keyframes; ++k) {
    window.add({0, 0, along_path(k), std::nullopt, Vector3d::Zero()});
    for (size_t i = 0; i < points.size(); ++i) window.observe(i, see(along_path(k), points[i], random, sigma));
  }
  window.triangulate();
  return window;
}

}  // namespace

TEST_CASE("points behind a camera at the start do not stop the adjustment, and Ceres prints nothing to the terminal") {
  const double sigma = 8e-4;
  Window window = window_along_path(6, sigma);
  window.keyframes()[3].T_w_c.translation().z() += 4;  // past the nearest points
  Vector3d bias = Vector3d::Zero();
  BundleReport report;
  const std::string said = standard_error_of([&] { report = adjust(window, bias, sigma); });
  CHECK(said == "");
  CHECK(report.solved);
  CHECK_FALSE(report.failed);
  CHECK((along_path(5).inverse() * window.keyframes()[5].T_w_c).translation().norm() < 0.02);
}

TEST_CASE("a failed adjustment shows in its report only, and leaves the window unchanged") {
  const double sigma = 8e-4;
  Window window = window_along_path(6, sigma);
  window.keyframes()[3].T_w_c.translation().x() = std::nan("");
  const Window before = window;
  Vector3d bias(0.001, 0, 0);
  BundleReport report;
  const std::string said = standard_error_of([&] { report = adjust(window, bias, sigma); });
  CHECK(said == "");
  CHECK(report.failed);
  CHECK_FALSE(report.solved);
  CHECK(bias == Vector3d(0.001, 0, 0));
  CHECK(window.keyframes()[5].T_w_c.matrix() == before.keyframes()[5].T_w_c.matrix());
  CHECK(window.landmarks().at(7).inverse_depth == before.landmarks().at(7).inverse_depth);
}

TEST_CASE("a point outlives the keyframe that saw it first") {
  Window window{KeyframeParameters{.window = 3, .point_parallax_rad = 0.001}};
  Random random(1, 1);
  const auto points = scene(2, 20);
  for (int k = 0; k < 5; ++k) {
    window.add({0, 0, along_path(k), std::nullopt, Vector3d::Zero()});
    for (size_t i = 0; i < points.size(); ++i) window.observe(i, see(along_path(k), points[i], random, 0));
    window.triangulate();
    window.slide();
  }
  CHECK(window.keyframes().size() == 3);
  for (const auto& [track, landmark] : window.landmarks()) {
    CHECK(landmark.seen.size() == 3);
    REQUIRE(landmark.triangulated);
    const Eigen::Vector4d X = window.point(landmark);
    CHECK((X.head<3>() / X.w() - points[track]).norm() < 1e-6);
  }
}

TEST_CASE("a walk along a street has one scale, is straight and repeatable, and darkness is reported as lost") {
  Film film(320, 240, 250, 3);
  std::vector<cv::Mat> frames;
  for (size_t i = 0; i < 40; ++i) frames.push_back(film.frame({0.13 * static_cast<double>(i), 0, -1.5}, i));
  std::vector<vo::Motion> first;
  for (int repeat = 0; repeat < 2; ++repeat) {
    Odometry vo({}, film.model());
    Vector3d p = Vector3d::Zero();
    std::vector<double> lengths;
    for (size_t i = 0; i < frames.size(); ++i) {
      const vo::Motion motion = vo.process({frames[i], {}, static_cast<int64_t>(i) * 100 * kMilli, 0});
      if (repeat == 0)
        first.push_back(motion);
      else
        CHECK(motion.p_c0_c1 == first[i].p_c0_c1);
      if (motion.translation_valid && i > 6) lengths.push_back(motion.p_c0_c1.norm());
      p += motion.p_c0_c1;
      if (i > 8) CHECK(motion.state == Tracking::tracking);
    }
    CHECK(std::abs(p.x()) < 0.03 * p.norm());
    std::sort(lengths.begin(), lengths.end());
    CHECK(lengths[lengths.size() * 9 / 10] < 1.25 * lengths[lengths.size() / 10]);
    const cv::Mat dark(240, 320, CV_8U, cv::Scalar(2));
    int64_t t = 40;
    const auto next = [&](const cv::Mat& picture) { return vo.process({picture, {}, t++ * 100 * kMilli, 0}); };
    const auto darken = [&](int count) {
      for (int i = 0; i < count; ++i) {
        const auto motion = next(dark);
        CHECK(motion.state == Tracking::lost);
        CHECK(motion.failure == FailureReason::too_dark);
        CHECK_FALSE(motion.translation_valid);
      }
    };
    // After a moment it relocalises at the same position, in the same scale.
    darken(4);
    const auto back = next(frames[39]);
    CHECK(back.state == Tracking::tracking);
    CHECK(back.scale_group == 0);
    CHECK(back.p_c0_c1.norm() < 0.3 * lengths[lengths.size() / 2]);
    darken(30);
    for (size_t i = 0; i < 12; ++i) {
      const auto motion = next(frames[i + 20]);
      CHECK(motion.scale_group > 0);
      if (i > 8) CHECK(motion.state == Tracking::tracking);
    }
  }
}

TEST_CASE("memory does not grow over 10,000 frames") {
  Film film(320, 240, 250, 3);
  std::vector<cv::Mat> frames;
  for (size_t i = 0; i < 40; ++i) frames.push_back(film.frame({0.13 * static_cast<double>(i), 0, -1.5}, i));
  const auto resident_kb = [] {
    std::ifstream file("/proc/self/statm");
    long all = 0, resident = 0;
    file >> all >> resident;
    return resident * (sysconf(_SC_PAGESIZE) / 1024);
  };
  Odometry vo({}, film.model());
  long settled_kb = 0;
  size_t tracked = 0;
  for (size_t i = 0; i < 10000; ++i) {  // up and down the street
    const size_t k = i % 78, at = k < 40 ? k : 78 - k;
    const auto motion = vo.process({frames[at], {}, static_cast<int64_t>(i) * 100 * kMilli, 0});
    tracked += motion.state == Tracking::tracking;
    if (i == 2000) settled_kb = resident_kb();
  }
  CHECK(tracked > 9000);
  CHECK(resident_kb() - settled_kb < 2048);
}

TEST_CASE("turning on the spot gives a rotation without translation, and the gyro bias is estimated") {
  Film film(320, 240, 250, 3);
  Odometry vo({}, film.model());
  const double rate = 0.2, bias = 0.01;
  Quaterniond q = Quaterniond::Identity();
  for (size_t i = 0; i < 15; ++i) {
    const int now_ms = static_cast<int>(i) * 100;
    for (int t = now_ms - 95; i > 0 && t <= now_ms; t += 5)
      vo.add_gyroscope(t * kMilli, {0, rate + bias, 0});  // y: down
    const auto motion =
        vo.process({film.frame({0, 0, -1.5}, i, 0.02 * static_cast<double>(i)), {}, now_ms * kMilli, 0});
    CHECK_FALSE(motion.translation_valid);
    if (i == 0) continue;
    CHECK(motion.failure == FailureReason::no_parallax);
    q = q * motion.q_c0_c1;
  }
  CHECK(std::abs(log_rotation(q).y() - 0.28) < 0.0056);
  CHECK(std::abs(vo.gyro_bias_c().y() - bias) < 0.2 * std::abs(bias));
}
