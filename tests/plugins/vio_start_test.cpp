// SPDX-License-Identifier: Apache-2.0
//
// Start of the visual-inertial filter, detection of standing, and inputs that are ignored.
#include <random>

#include "plugins/vo/odograph/inertial/corners.hpp"
#include "plugins/vo/odograph/inertial/observe.hpp"
#include "plugins/vo/odograph/inertial/start.hpp"
#include "sdk/math/rotation.hpp"
#include "tests/support/support.hpp"

namespace {

using namespace odograph::vio;
using Eigen::Quaterniond;
using Eigen::Vector2d;
using Eigen::Vector3d;
using odograph::CameraModel;
using odograph::exp_rotation;

constexpr double kGravity_mps2 = 9.81;

Camera global_shutter() {
  Camera camera;
  camera.lens = {CameraModel::Distortion::radial_tangential, 460, 460, 320, 240, {0, 0, 0, 0}};
  camera.middle_row = 239.5;
  return camera;
}

/// An upright phone (y down) that rotates about gravity, or also moves along x: 1.2 s, 20 frames and 200 samples per
/// second, 60 points at 3 to 8 m.
struct Scene {
  std::deque<StartFrame> frames;
  ImuBuffer imu;

  Scene(double rate_radps, double speed_mps, double bias_radps = 0, double shake_mps2 = 0) {
    std::mt19937 generator(3);
    std::uniform_real_distribution<double> across(-2, 2), depth(3, 8);
    std::vector<Vector3d> points;
    for (int k = 0; k < 60; ++k) points.push_back({across(generator), across(generator), depth(generator)});
    std::normal_distribution<double> noise(0, 0.2);
    const Camera camera = global_shutter();
    std::normal_distribution<double> shake(0, shake_mps2);
    for (int k = 0; k <= 260; ++k) {
      const Vector3d shaken{shake(generator), shake(generator), shake(generator)};
      imu.add({5'000'000LL * k, Vector3d(0, rate_radps + bias_radps, 0), Vector3d(0, -kGravity_mps2, 0) + shaken});
    }
    for (int k = 1; k <= 24; ++k) {
      const double t = 0.05 * k;
      StartFrame frame;
      frame.corners.t_ns = static_cast<int64_t>(std::llround(t * 1e9));
      const Quaterniond q = exp_rotation(Vector3d(0, rate_radps * t, 0));
      for (size_t j = 0; j < points.size(); ++j) {
        const Vector3d at = q.conjugate() * (points[j] - Vector3d(speed_mps * t, 0, 0));
        if (at.z() < 0.5) continue;
        const Vector2d pixel =
            camera.lens.project(at.head<2>() / at.z()) + Vector2d{noise(generator), noise(generator)};
        if (pixel.x() > 0 && pixel.x() < 640 && pixel.y() > 0 && pixel.y() < 480)
          frame.corners.corners.push_back({j, pixel, pixel.y()});
      }
      frames.push_back(frame);
    }
  }

  std::optional<Filter> start(const FilterParameters& p = {}) const {
    return start_still(frames, imu, global_shutter(), p, {});
  }
};

}  // namespace

TEST_SUITE_BEGIN("vio_start");

TEST_CASE("a phone that is held still starts with a known gyro bias") {
  const auto filter = required(Scene(0, 0, 0.01).start());
  CHECK(std::abs(filter->state().nav.gyro_bias.y() - 0.01) < 0.0005);
  CHECK(filter->state().nav.v_w.norm() < 0.02);
  const Vector3d up_b = filter->state().nav.q_w_b.conjugate() * -Vector3d::UnitZ();
  CHECK(up_b.dot(-Vector3d::UnitY()) > 0.9999);
}

TEST_CASE("half a second of a swing about its turning point looks like standing, a second of it does not") {
  // 0.9 m/s^2 at the end of a swing of 2.4 s and 13 cm: 1.5 px in the picture at 3 to 8 m in the last half second.
  Scene scene(0, 0);
  const auto x = [](double t) { return 0.13 * std::cos(2.6 * (t - 0.95)); };
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> across(-2, 2), depth(3, 8);
  std::vector<Vector3d> points;
  for (int k = 0; k < 60; ++k) points.push_back({across(generator), across(generator), depth(generator)});
  const Camera camera = global_shutter();
  for (StartFrame& frame : scene.frames) {
    const double t = 1e-9 * static_cast<double>(frame.corners.t_ns);
    frame.corners.corners.clear();
    for (size_t j = 0; j < points.size(); ++j) {
      const Vector3d at = points[j] - Vector3d(x(t), 0, 0);
      const Vector2d pixel = camera.lens.project(at.head<2>() / at.z());
      frame.corners.corners.push_back({j, pixel, pixel.y()});
    }
  }
  StartParameters half;
  half.still_s = 0.5;
  CHECK(start_still(scene.frames, scene.imu, global_shutter(), {}, half));  // taken for standing
  StartParameters second;
  second.still_s = 1.0;
  CHECK_FALSE(start_still(scene.frames, scene.imu, global_shutter(), {}, second));
}

TEST_CASE("at rest the accelerometer bias along gravity is observable, and across gravity only with the tilt") {
  Scene scene(0, 0);
  const Vector3d bias(0.39, -0.43, -0.11);  // of a recorded phone
  ImuBuffer biased;
  for (int k = 0; k <= 260; ++k) biased.add({5'000'000LL * k, Vector3d::Zero(), Vector3d(0, -kGravity_mps2, 0) + bias});
  scene.imu = biased;
  const auto filter = required(scene.start());
  const State& s = filter->state();
  const Vector3d up_b = s.nav.q_w_b.conjugate() * -Vector3d::UnitZ();
  CHECK(s.nav.accel_bias.dot(up_b) == doctest::Approx(bias.dot(up_b)).epsilon(0.35));
  const auto sigma = [&](int at) { return std::sqrt(s.P(at, at)); };
  CHECK(sigma(block::accel_bias + 1) < 0.13);  // along gravity
  CHECK(sigma(block::accel_bias) > 0.15);      // across
  // The tilt error is that of the bias across gravity, and so is its sigma.
  const double tilt = std::acos(std::clamp(up_b.dot(-Vector3d::UnitY()), -1.0, 1.0));
  CHECK(tilt == Between{0.03, 3 * std::hypot(sigma(block::theta), sigma(block::theta + 1))});
}

TEST_CASE("the samples' second differences measure vibration, not motion") {
  std::mt19937 generator(5);
  std::normal_distribution<double> unit(0, 1);
  ImuBuffer smooth, shaken;
  for (int k = 0; k < 400; ++k) {
    const double t = 0.005 * k;
    const Vector3d rate(std::sin(3 * t), 0, 0), force(2 * std::sin(6 * t), -kGravity_mps2, 0);
    const Vector3d noise{unit(generator), unit(generator), unit(generator)};
    smooth.add({5'000'000LL * k, rate, force});
    shaken.add({5'000'000LL * k, rate + 0.05 * noise, force + 1.0 * noise});
  }
  const auto quiet = smooth.roughness(1'990'000'000, 1.5), rough = shaken.roughness(1'990'000'000, 1.5);
  CHECK(quiet.accel < 1e-4);
  CHECK(quiet.gyro < 1e-4);
  CHECK(rough.accel == doctest::Approx(1.0 / std::sqrt(200.0)).epsilon(0.1));
  CHECK(rough.gyro == doctest::Approx(0.05 / std::sqrt(200.0)).epsilon(0.1));
  CHECK(shaken.roughness(20'000'000, 1.5).accel == 0);  // too few samples
  CHECK(rough.rate_hz == doctest::Approx(200));
}

TEST_CASE("a vibration aliased into the band of the motion is noise of the velocity") {
  // 97 Hz plus jitter, as a rotor is never steady, sampled at 100 Hz: integrals of the force over half a second differ
  // from those of a body at rest.
  ImuBuffer folded;
  std::mt19937 generator(5);
  std::normal_distribution<double> unit(0, 1);
  double sum = 0, squares = 0, phase = 0;
  int n = 0;
  for (int k = 0; k < 4000; ++k) {
    phase += 2 * M_PI * 0.97 + 1.8 * unit(generator);
    const double force = std::sin(phase);
    folded.add({10'000'000LL * k, Vector3d::Zero(), Vector3d(force, force, force - kGravity_mps2)});
    sum += 0.01 * force;
    if (k % 50 == 49) squares += sum * sum, sum = 0, ++n;
  }
  const double off = std::sqrt(squares / n / 0.5);
  const auto shown = folded.roughness(39'990'000'000, 30);
  const ImuNoise noise;
  MESSAGE("off by " << off << ", shown " << shown.accel);
  const double fast = noise.accel_vibration_part;
  CHECK(fast * shown.accel < 0.5 * off);
  CHECK(noise.part_of_vibration(shown.rate_hz, fast) * shown.accel > 0.8 * off);
  CHECK(noise.part_of_vibration(50, fast) == noise.part_of_vibration(100, fast));
  CHECK(noise.part_of_vibration(400, fast) == noise.part_of_vibration(200, fast));
  CHECK(noise.part_of_vibration(100, noise.gyro_vibration_part) == noise.part_of_vibration(100, fast));
}

TEST_CASE("two starts are compared by their paths through the frames of both, whatever their headings") {
  State first, second;
  for (State* s : {&first, &second})
    for (int k = 0; k < 5; ++k) {
      Clone clone;
      clone.frame_ns = s == &first ? k : k + 1;
      const double x = static_cast<double>(clone.frame_ns);
      clone.p_w = s == &first ? Vector3d(x, 0, x * x) : 1.25 * Vector3d(7, x, x * x);
      s->clones.push_back(clone);
    }
  CHECK(*required(scale_between(first, second, 0.1)) == doctest::Approx(1.25));
  const double path_m = std::sqrt(10.) + std::sqrt(26.) + std::sqrt(50.);  // between 1, 2, 3 and 4
  CHECK(scale_between(first, second, 0.99 * path_m));
  CHECK_FALSE(scale_between(first, second, 1.01 * path_m));
  for (Clone& clone : second.clones) clone.frame_ns += 100;
  CHECK_FALSE(scale_between(first, second, 0.1));
}

TEST_CASE("a start needs more agreement after a contradiction, which is forgotten in time") {
  const StartParameters p;
  const auto at = [](double t_s) { return static_cast<int64_t>(1e9 * t_s); };
  StartEvidence evidence;
  CHECK_FALSE(evidence.add(std::nullopt, at(0), p));
  CHECK(evidence.add(1.05, at(0.3), p));
  CHECK(evidence.spread() == doctest::Approx(std::log(1.05)));
  evidence = {};
  CHECK_FALSE(evidence.add(2.2, at(0), p));
  CHECK_FALSE(evidence.add(0.9, at(0.3), p));
  CHECK(evidence.add(1.01, at(0.6), p));
  CHECK(evidence.spread() == doctest::Approx(-std::log(0.9)));
  CHECK_FALSE(evidence.add(std::nullopt, at(0.9), p));  // not comparable: begins again, and contradicts nothing
  CHECK_FALSE(evidence.add(1.0, at(1.2), p));
  evidence = {};
  CHECK_FALSE(evidence.add(2.2, at(0), p));
  CHECK_FALSE(evidence.add(1.1, at(0.3), p));
  CHECK_FALSE(evidence.add(1.1, at(0.6), p));  // creeps away: a contradiction
  evidence = {};
  CHECK_FALSE(evidence.add(2.2, at(0), p));
  CHECK(evidence.add(1.0, at(p.max_s + 0.1), p));
}

TEST_CASE("a phone that rotates slowly starts, and its rotation is not taken for a bias") {
  const auto filter = required(Scene(0.1, 0).start());
  CHECK(std::abs(filter->state().nav.gyro_bias.y()) < 0.01);
}

TEST_CASE("turning on the spot carries the phone around and is not standing") { CHECK_FALSE(Scene(0.6, 0).start()); }

TEST_CASE("a uniform motion has the force of standing, and the pictures distinguish it") {
  CHECK_FALSE(Scene(0, 0.3).start());
}

TEST_CASE("a trembling hand stands, also with a noisy accelerometer") {
  CHECK(Scene(0, 0, 0, 0.27).start());  // m/s^2 per axis
  CHECK_FALSE(Scene(0, 0, 0, 0.7).start());
  FilterParameters noisy;
  noisy.noise.accel = 0.05;  // 0.7 m/s^2 at 200 Hz
  CHECK(Scene(0, 0, 0, 0.7).start(noisy));
}

TEST_CASE("a standing camera fits any scale, and no start in motion results from it") {
  for (unsigned seed = 0; seed < 40; ++seed) {  // without the parallax check six of them start
    Scene scene(0, 0, 0, 0.3);
    std::mt19937 generator(seed);
    std::normal_distribution<double> unit(0, 1), noise(0, 1e-4);
    const Vector3d speed{unit(generator), unit(generator), unit(generator)};
    const Vector3d acceleration{unit(generator), unit(generator), unit(generator)};
    for (StartFrame& frame : scene.frames) {  // a diverging visual odometry
      frame.posed = true;
      const double t = 1e-9 * static_cast<double>(frame.corners.t_ns);
      frame.T_w_c.translation() =
          t * speed + 0.5 * t * t * acceleration + Vector3d{noise(generator), noise(generator), noise(generator)};
    }
    CAPTURE(seed);
    CHECK_FALSE(start_moving(scene.frames, scene.imu, global_shutter(), Vector3d::Zero(), {}, {}));
  }
}

TEST_CASE("a start in motion uses that the phone stood shortly before, which improves the scale of one second") {
  // Standing for 2 s, then 1 s of a starting walk; a visual odometry accurate to 0.3 % of the depth.
  const auto velocity = [](double t) { return t < 2 ? 0.0 : 1.2 * (1 - std::exp(-(t - 2) / 0.4)); };
  std::vector<double> with, without;
  for (unsigned seed = 0; seed < 21; ++seed) {
    std::mt19937 generator(seed);
    std::normal_distribution<double> noise(0, 1);
    ImuBuffer imu;
    std::deque<StartFrame> frames;
    double x = 0, next_frame_s = 2;
    for (int k = 0; k <= 605; ++k) {
      const double t = 0.005 * k;
      const double force = (velocity(t + 1e-3) - velocity(t - 1e-3)) / 2e-3;
      imu.add({5'000'000LL * k, Vector3d::Zero(), Vector3d(force, -kGravity_mps2, 0) + 0.3 * Vector3d(0.1, 0.1, 0.1)});
      if (t >= next_frame_s - 1e-9 && t <= 3) {
        StartFrame frame;
        frame.corners.t_ns = 5'000'000LL * k;
        frame.posed = true;
        frame.T_w_c.translation() =
            0.2 * Vector3d(x, 0, 0) + 3e-3 * Vector3d{noise(generator), noise(generator), noise(generator)};
        frames.push_back(frame);
        next_frame_s += 0.1;
      }
      x += 0.005 * velocity(t);
    }
    const auto error = [&](double history_s) {
      StartParameters s;
      s.history_s = history_s;
      const auto found = align_with_imu(frames, 0, imu, global_shutter(), Vector3d::Zero(), {}, s);
      return found ? std::abs(std::log(found->scale / 5)) : 3.0;
    };
    with.push_back(error(3)), without.push_back(error(0));
  }
  std::sort(with.begin(), with.end()), std::sort(without.begin(), without.end());
  MESSAGE("median error of the metre, of its logarithm: " << with[10] << ", without the second before " << without[10]);
  CHECK(with[10] < 0.35);
  CHECK(without[10] > 1.5 * with[10]);
}

TEST_CASE("the flow beyond a rotation is the parallax") {
  const Scene turning(0.3, 0), moving(0.3, 0.5);
  const auto flow = [](const Scene& s) {
    return residual_flow(s.frames[4].corners, s.frames[12].corners, global_shutter(), 15);
  };
  REQUIRE(flow(turning));
  CHECK(*flow(turning) < 0.6);
  REQUIRE(flow(moving));
  CHECK(*flow(moving) > 2);
  CHECK_FALSE(residual_flow(turning.frames[4].corners, turning.frames[12].corners, global_shutter(), 500));
}

TEST_CASE("the hot pixels of a dark picture are not corners") {
  cv::Mat bright(480, 640, CV_8U), dark(480, 640, CV_8U, cv::Scalar(2));
  for (int y = 0; y < bright.rows; ++y)
    for (int x = 0; x < bright.cols; ++x) bright.at<uchar>(y, x) = (x / 40 + y / 40) % 2 ? 180 : 60;
  cv::RNG random(5);
  for (int k = 0; k < 4000; ++k) dark.at<uchar>({random.uniform(0, 640), random.uniform(0, 480)}) = 120;
  GuidedCorners corners({});
  const CameraModel lens = global_shutter().lens;
  const auto follow = [&](const cv::Mat& picture, int64_t k) {
    return corners
        .follow(picture, {}, 50'000'000 * k, k > 0 ? 0.05 : 0, Quaterniond::Identity(), Vector2d::Zero(), lens)
        .corners;
  };
  const auto before = follow(bright, 0);
  REQUIRE(before.size() > 50);
  CHECK(follow(bright, 1).size() > 50);
  CHECK(follow(dark, 2).empty());
  CHECK(corners.followed() == 0);
  CHECK(follow(dark, 3).empty());
  const auto after = follow(bright, 4);
  REQUIRE(after.size() > 50);
  CHECK(after.front().track > before.back().track);  // nothing is tracked through the dark
}
