// SPDX-License-Identifier: Apache-2.0
//
// The visual-inertial filter on a walk past known points: effect of IMU axis errors and bad corners on the scale.
#include <random>

#include "plugins/vo/odograph/inertial/filter.hpp"
#include "plugins/vo/odograph/inertial/update.hpp"
#include "sdk/math/rotation.hpp"
#include "sdk/math/scalar.hpp"
#include "tests/support/support.hpp"

namespace {

using odograph::kPi;
using namespace odograph::vio;
using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector2d;
using Eigen::Vector3d;
using odograph::CameraModel;
using odograph::exp_rotation;
using odograph::log_rotation;

constexpr double kGravity = 9.81, kFrame_s = 0.1, kSample_s = 0.005;
constexpr int kWidth = 640, kHeight = 480;

/// A phone in a walker's hand: 1.5 m/s towards x, two steps per second; later small steps of 0.2 m/s.
struct Walk {
  double slow_from_s = 1e3;

  Vector3d position(double t) const {
    const double u = (t - slow_from_s) / 0.3, slow = 1 / (1 + std::exp(-u)),
                 since = u > 30 ? u : std::log1p(std::exp(u));
    const double bounce = 1 - 0.9 * slow;
    return {1.5 * t - 1.3 * 0.3 * since + 0.01 * bounce * std::sin(4 * kPi * t + 1),
            0.02 * bounce * std::sin(2 * kPi * t), 0.022 * bounce * std::sin(4 * kPi * t)};
  }
  static Quaterniond orientation(double t) {
    Matrix3d forward;  // camera: x right, y down, z forward
    forward << 0, 0, 1, 1, 0, 0, 0, 1, 0;
    const Vector3d sway(0.04 * std::sin(4 * kPi * t + 0.5), 0.05 * std::sin(2 * kPi * t + 2), 0.02 * std::sin(kPi * t));
    return Quaterniond(forward) * exp_rotation(sway);
  }
  Vector3d velocity(double t) const { return (position(t + 1e-4) - position(t - 1e-4)) / 2e-4; }
  ImuSample imu(double t) const {
    constexpr double h = 1e-3;
    const Vector3d a = (position(t + h) - 2 * position(t) + position(t - h)) / (h * h);
    const Quaterniond q = orientation(t);
    const Vector3d rate = log_rotation(orientation(t - h).conjugate() * orientation(t + h)) / (2 * h);
    return {std::llround(t * 1e9), rate, q.conjugate() * (a - Vector3d(0, 0, kGravity))};
  }
};

struct Trial {
  Matrix3d gyro_axes = Matrix3d::Identity(), accel_axes = Matrix3d::Identity();
  double bad_corners = 0;                               ///< share of the points that slide
  double walk_px = 0;                                   ///< random walk of each corner on its point, px/sqrt(s)
  double scale_sigma = 0.35;                            ///< at the filter's start
  double breathing = 0;                                 ///< of the focal length, with a period of five seconds
  double longer = 0;                                    ///< relative, of the focal length than stated
  double follow = 0;                                    ///< share of the rotation that a stabilised lens compensates
  double leak_hz = 0, end_leak_hz = 13, travel_px = 8;  ///< of that lens
  Walk walk;
  FilterParameters p;
  double duration_s = 25, judged_from_s = 5;

  struct Result {
    double scale = 0;  ///< path by the filter over the true one, from judged_from_s on
    State state;
  };
  Result run() const;
};

/// Measurements of a trial's phone: a single generator, so that a trial is reproducible.
class Phone {
 public:
  explicit Phone(const Trial& trial) : trial_(trial), points_(900) {
    for (Point& x : points_) {
      const double side = uniform_(generator_) < 0.5 ? -1 : 1;
      x.p = {90 * uniform_(generator_), side * (3 + 7 * uniform_(generator_)), -6 + 7.5 * uniform_(generator_)};
      x.bad = uniform_(generator_) < trial.bad_corners;
      x.slide.setZero();
    }
  }

  static Camera camera() {
    Camera camera;
    camera.lens = {CameraModel::Distortion::radial_tangential, 500, 500, 320, 240, {0, 0, 0, 0}};
    camera.middle_row = 0.5 * (kHeight - 1);
    return camera;
  }

  /// Samples until slightly after the frame at t; meanwhile the lens follows the hand.
  void measure_motion(double t, ImuBuffer& imu) {
    for (; next_sample_s_ < t + 0.03; next_sample_s_ += kSample_s) {
      ImuSample s = trial_.walk.imu(next_sample_s_);
      if (next_sample_s_ <= t) {
        const double used = std::min(1.0, shift_.norm() / trial_.travel_px);
        const double leak = 2 * kPi * (trial_.leak_hz + (trial_.end_leak_hz - trial_.leak_hz) * used * used);
        shift_ =
            (shift_ + kSample_s * trial_.follow * 500 * Vector2d(s.gyro_b.y(), -s.gyro_b.x())) / (1 + kSample_s * leak);
      }
      s.gyro_b = trial_.gyro_axes * s.gyro_b + 0.002 * Vector3d{normal(), normal(), normal()};
      s.accel_b = trial_.accel_axes * s.accel_b + 0.02 * Vector3d{normal(), normal(), normal()};
      imu.add(s);
    }
  }

  FrameCorners frame(double t) {
    FrameCorners corners;
    corners.t_ns = std::llround(t * 1e9);
    const Quaterniond q = Walk::orientation(t);
    CameraModel lens = camera().lens;
    lens.fx = lens.fy = 500 * (1 + trial_.longer + trial_.breathing * std::sin(2 * kPi * t / 5));
    for (size_t k = 0; k < points_.size(); ++k) {
      Point& x = points_[k];
      const Vector3d y = q.conjugate() * (x.p - trial_.walk.position(t));
      if (y.z() < 0.5 || y.z() > 30) continue;
      const Vector2d pixel = lens.project(y.head<2>() / y.z()) + shift_;
      if (!(pixel.x() > 0 && pixel.y() > 0 && pixel.x() < kWidth && pixel.y() < kHeight)) continue;
      // A bad corner is held back, unevenly, by its background.
      const Vector2d outward = (pixel - Vector2d(320, 240)).normalized();
      if (trial_.walk_px > 0) x.slide += trial_.walk_px * std::sqrt(kFrame_s) * Vector2d{normal(), normal()};
      if (x.bad) x.slide += (-0.35 + 0.5 * normal()) * outward;
      const Vector2d noise = 0.15 * Vector2d{normal(), normal()};
      corners.corners.push_back({k, pixel + x.slide + noise, pixel.y()});
    }
    return corners;
  }

 private:
  struct Point {
    Vector3d p;
    Vector2d slide;
    bool bad;
  };
  double normal() { return normal_(generator_); }

  const Trial& trial_;
  std::mt19937 generator_{5};
  std::normal_distribution<double> normal_;
  std::uniform_real_distribution<double> uniform_;
  std::vector<Point> points_;
  Vector2d shift_ = Vector2d::Zero();  // of the stabilised lens
  double next_sample_s_ = 0;
};

Trial::Result Trial::run() const {
  Phone phone(*this);
  Filter::Start start;
  start.nav.q_w_b = Walk::orientation(0), start.nav.v_w = walk.velocity(0);
  start.tilt_rad = 0.005, start.velocity_mps = 0.05, start.gyro_bias_radps = 0.003, start.accel_bias_mps2 = 0.05;
  start.scale = scale_sigma;
  Filter filter(p, Phone::camera(), start);
  ImuBuffer imu;
  double path_m = 0, true_path_m = 0;
  Vector3d before = Vector3d::Zero(), true_before = Vector3d::Zero();
  for (int frame = 0; frame * kFrame_s < duration_s; ++frame) {
    const double t = frame * kFrame_s;
    phone.measure_motion(t, imu);
    filter.process(phone.frame(t), imu);
    const Vector3d now = filter.newest().p_w, true_now = walk.position(t);
    if (t > judged_from_s && frame % 10 == 0) {
      if (true_path_m > 0 || before != Vector3d::Zero())
        path_m += (now - before).norm(), true_path_m += (true_now - true_before).norm();
      before = now, true_before = true_now;
    }
  }
  return {path_m / true_path_m, filter.state()};
}

}  // namespace

TEST_SUITE_BEGIN("vio_filter");

TEST_CASE("misaligned axes are estimated and do not affect the scale") {
  Trial trial;
  trial.accel_axes << 1, 0.004, -0.006, 0.004, 1, 0.003, 0.007, -0.005, 1;
  trial.gyro_axes << 1.006, 0.003, 0, -0.003, 0.996, 0.004, 0.002, 0, 1;
  const auto found = trial.run();
  CHECK(std::abs(found.scale - 1) < 0.0073);
  CHECK(found.state.nav.gyro_axes(0, 0) == doctest::Approx(1 / 1.006).epsilon(0.003));
  trial.p.priors.gyro_scale = trial.p.priors.accel_scale = trial.p.priors.misalignment_rad = 0;
  const auto as_correct = trial.run();
  MESSAGE("scale " << found.scale << ", with axes taken as right " << as_correct.scale);
  CHECK(std::abs(as_correct.scale - 1) > 2 * std::abs(found.scale - 1));
}

TEST_CASE("what the filter models does not affect the scale, and would without the model") {
  struct Row {
    const char* name;
    double error;   ///< largest of the scale
    double factor;  ///< least, of the error without the model
    void (*disturb)(Trial& trial);
    void (*without)(Trial& trial);
  };
  constexpr Row rows[] = {
      // Over twelve seeds 0.4 % too long with a standard deviation of 0.5 %; this one is among the worst.
      {"sliding corners have less weight than static ones", 0.02, 1.5, [](Trial& trial) { trial.bad_corners = 0.3; },
       [](Trial& trial) { trial.p.typical_residual_px = trial.p.min_residual_px = 1e3; }},
      {"random walk of corners: the scale of all lengths is an error state of its own", 0.01, 2,
       [](Trial& trial) { trial.walk_px = 0.3; }, [](Trial& trial) { trial.scale_sigma = 0; }},
      {"unreported change of focal length", 0.02, 2, [](Trial& trial) { trial.breathing = 0.006; },
       [](Trial& trial) { trial.p.focus_sigma = 0; }},
      {"small steps of 0.2 m/s are not standing", 0.015, 2,
       [](Trial& trial) { trial.walk.slow_from_s = 12, trial.judged_from_s = 13.5, trial.duration_s = 24; },
       [](Trial& trial) { trial.p.stand.sway_m = 10; }},  // any motion may be a hand's
  };
  for (const Row& row : rows) {
    CAPTURE(row.name);
    Trial trial;
    row.disturb(trial);
    const double with = trial.run().scale;
    row.without(trial);
    const double without = trial.run().scale;
    MESSAGE(row.name << ": scale " << with << ", without " << without);
    CHECK(std::abs(with - 1) < row.error);
    CHECK(std::abs(without - 1) > row.factor * std::abs(with - 1));
  }
}

TEST_CASE("a fixed lens is recognised, and a stabilised one is not taken for fixed, whatever its leak") {
  Trial trial;
  const auto fixed = trial.run();
  CHECK(std::abs(fixed.state.camera.gain) < 1e-3);
  CHECK(fixed.state.camera.shift_px.norm() < 0.01);
  CHECK(std::abs(fixed.scale - 1) < 0.0075);
  trial.follow = 0.8;
  for (const double more : {0.4, 1.0, 2.5}) {  // factor on the model's leak
    CAPTURE(more);
    trial.leak_hz = 0.9 * more, trial.end_leak_hz = 13 * more;
    const auto found = trial.run();
    MESSAGE("leak x " << more << ": scale " << found.scale << ", follow " << found.state.camera.gain << ", leak "
                      << found.state.camera.leak);
    CHECK(std::abs(found.state.camera.gain - 0.8) < 0.2);
    CHECK(std::abs(found.scale - 1) < 0.02);
  }
}

TEST_CASE("a lens 10 % off its calibration is found, and would not be with the prior as stated") {
  for (const double longer : {0.1, -0.1}) {
    Trial trial;
    trial.longer = longer, trial.duration_s = 10;
    const double focal_px = 500 * (1 + longer);
    const auto found = trial.run();
    trial.p.doubtful_chi2 = 1e9;
    const auto kept = trial.run();
    const auto off = [&](const Trial::Result& result) { return result.state.camera.lens.fx / focal_px - 1; };
    MESSAGE("focal length " << off(found) << ", scale " << found.scale << "; as stated " << off(kept) << ", "
                            << kept.scale);
    CHECK(std::abs(off(found)) < 0.0075);
    CHECK(std::abs(off(kept)) > 1.8 * std::abs(off(found)));
    CHECK(std::abs(found.scale - 1) < 0.02);
  }
}

TEST_CASE("a weakened prior leaves what a wider one would have given") {
  constexpr double stated = 0.01, factor = 3, focal_px = 500;
  const auto estimate = [&](double sigma) {
    State state;
    state.camera = Phone::camera();
    state.P = Eigen::MatrixXd::Identity(block::fixed, block::fixed) * 1e-4;
    state.P(block::lens, block::lens) = sigma * sigma;
    // Two measurements of the focal length, of which one depends on the gyroscope's bias as well.
    for (const double by_bias : {0.0, 2.0}) {
      Eigen::VectorXd H = Eigen::VectorXd::Zero(block::fixed);
      H[block::lens] = 1, H[block::gyro_bias] = by_bias;
      const double expected = std::log(state.camera.lens.fx / focal_px) + by_bias * state.nav.gyro_bias.x();
      const Eigen::VectorXd PH = state.P * H;
      const double S = H.dot(PH) + 0.01 * 0.01;
      state.P -= PH * PH.transpose() / S;
      state.correct(PH / S * (0.08 - expected));
    }
    return state;
  };
  State weakened = estimate(stated);
  const State wide = estimate(factor * stated);
  CHECK(std::abs(weakened.camera.lens.fx - wide.camera.lens.fx) > 5);
  weakened.weaken_prior(block::lens, std::log(weakened.camera.lens.fx / focal_px), stated, factor);
  CHECK(weakened.camera.lens.fx == doctest::Approx(wide.camera.lens.fx));
  CHECK(weakened.nav.gyro_bias.x() == doctest::Approx(wide.nav.gyro_bias.x()));
  CHECK((weakened.P - wide.P).norm() < 1e-9 * wide.P.norm());
}

TEST_CASE("a joint update of landmarks equals consecutive ones if the equations are linear") {
  Trial trial;
  trial.duration_s = 3;
  const State state = trial.run().state;
  REQUIRE(state.landmarks.size() > 4);
  FilterParameters p;
  p.residual_part = 0;
  std::vector<SeenLandmark> seen;
  const Clone& newest = state.clones.back();
  for (size_t j = 0; j < 4; ++j) {
    const double row = 200;
    const auto o = required(observe(newest, state.camera, state.point(state.landmarks[j]), row));
    seen.push_back({j, {newest.id, o->pixel + Vector2d(0.01, -0.01 * static_cast<double>(j)), row}});
  }
  State together = state, alone = state;
  for (const Outcome& outcome : update_with_landmarks(together, seen, p)) CHECK(outcome.accepted);
  for (const SeenLandmark& one : seen) CHECK(update_with_landmarks(alone, {one}, p)[0].accepted);
  CHECK((together.P - alone.P).norm() < 1e-4 * alone.P.norm());
  CHECK((together.nav.v_w - alone.nav.v_w).norm() < 1e-6);
  CHECK((together.P - together.P.transpose()).norm() == 0);
  CHECK(together.P.diagonal().sum() < state.P.diagonal().sum());
}

TEST_CASE("a track says less of the motion the more its corners may slide") {
  Trial trial;
  trial.duration_s = 3;
  const State state = trial.run().state;
  REQUIRE(!state.landmarks.empty());
  const Vector3d point = state.point(state.landmarks.front());
  std::vector<Observation> track;
  for (const Clone& clone : state.clones)
    if (const auto o = observe(clone, state.camera, point, 200)) track.push_back({clone.id, o->pixel, 200});
  REQUIRE(track.size() > 4);
  const auto left = [&](double walk_px, bool as_landmark) {
    State updated = state;
    FilterParameters p;
    p.corner_walk_px = walk_px;
    const auto outcome = as_landmark ? add_landmark(updated, 1000, track, p) : update_with_track(updated, track, p);
    CHECK(outcome.accepted);
    return updated.P.diagonal().head(state.P.rows()).sum();
  };
  const double before = state.P.diagonal().sum();
  for (const bool as_landmark : {false, true}) {
    CAPTURE(as_landmark);
    CHECK(left(0, as_landmark) < left(0.3, as_landmark));
    CHECK(left(0.3, as_landmark) < left(3, as_landmark));
    CHECK(left(3, as_landmark) < before);
  }
}
