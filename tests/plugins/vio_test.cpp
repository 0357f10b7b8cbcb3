// SPDX-License-Identifier: Apache-2.0
//
// The visual-inertial filter's equations against numeric derivatives and closed forms.
#include <random>

#include <opencv2/imgproc.hpp>

#include "plugins/vo/odograph/inertial/patch.hpp"
#include "plugins/vo/odograph/inertial/propagate.hpp"
#include "plugins/vo/odograph/inertial/update.hpp"
#include "sdk/math/rotation.hpp"
#include "tests/support/support.hpp"

namespace {

using namespace odograph::vio;
using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using odograph::CameraModel;
using odograph::exp_rotation;
using odograph::log_rotation;

std::mt19937 generator(7);
double normal() { return std::normal_distribution<double>()(generator); }
Vector3d vector(double sigma) { return sigma * Vector3d{normal(), normal(), normal()}; }

Camera some_camera() {
  Camera camera;
  camera.lens = {CameraModel::Distortion::radial_tangential, 460, 458, 320, 240, {-0.2, 0.05, 0.001, -0.0005}};
  camera.q_b_c = exp_rotation(Vector3d(0.3, 1.2, -0.4));
  camera.p_b_c = Vector3d(0.02, -0.05, 0.01);
  camera.line_time_s = 30e-6;
  camera.middle_row = 239.5;
  return camera;
}

State some_state() {
  State state;
  state.t_ns = 1'000'000'000;
  state.camera = some_camera();
  state.nav.q_w_b = exp_rotation(vector(1));
  state.nav.v_w = vector(1), state.nav.p_w = Vector3d(30, -20, 5);
  state.nav.gyro_bias = vector(0.01), state.nav.accel_bias = vector(0.1);
  for (int k = 0; k < 3; ++k) state.nav.gyro_axes.col(k) += vector(0.02), state.nav.accel_axes.col(k) += vector(0.02);
  state.P = Eigen::MatrixXd::Identity(block::fixed, block::fixed) * 1e-4;
  return state;
}

ImuBuffer some_imu() {
  ImuBuffer imu;
  for (int k = 0; k < 400; ++k) {
    const double t = 0.005 * k;
    imu.add({5'000'000LL * k, Vector3d(0.4 * std::sin(7 * t), 0.6 * std::cos(5 * t), 0.3),
             Vector3d(1 + std::sin(9 * t), std::cos(8 * t), -9.8 + 2 * std::sin(12 * t))});
  }
  return imu;
}

/// Right-invariant difference of two poses: theta, rho.
Eigen::Matrix<double, 6, 1> difference(const Quaterniond& q, const Vector3d& p, const Quaterniond& q0,
                                       const Vector3d& p0) {
  Eigen::Matrix<double, 6, 1> out;
  const Quaterniond rotation = q * q0.conjugate();
  out << log_rotation(rotation), p - rotation * p0;
  return out;
}

}  // namespace

TEST_SUITE_BEGIN("vio");

TEST_CASE("an observation's derivatives equal finite differences") {
  generator.seed(11);
  for (int trial = 0; trial < 20; ++trial) {
    State state = some_state();
    const ImuBuffer imu = some_imu();
    augment(state, 0, 1, imu, {});
    const Clone& clone = state.clones[0];
    const Vector3d p_w = clone.p_w + clone.q_w_c * Vector3d{normal() * 0.5, normal() * 0.5, 2 + std::abs(normal())};
    const double row = 20 + 200 * (trial % 3);
    const auto o = required(observe(clone, state.camera, p_w, row));
    const double h = 1e-6;
    const auto numeric = [&](auto change) {
      const auto at = [&](double step) {
        State moved = state;
        Vector3d p = p_w;
        change(moved, p, step);
        return observe(moved.clones[0], moved.camera, p, row)->pixel;
      };
      return Eigen::Vector2d((at(h) - at(-h)) / (2 * h));
    };
    for (int k = 0; k < 3; ++k)
      CHECK((numeric([&](State&, Vector3d& p, double d) { p[k] += d; }) - o->by_point.col(k)).norm() <
            1e-3 * (1 + o->by_point.norm()));
    const auto by_state = [&](int index) {
      return numeric([&](State& s, Vector3d&, double d) {
        Eigen::VectorXd delta = Eigen::VectorXd::Zero(s.size());
        delta[index] = d;
        s.correct(delta);
      });
    };
    for (int k = 0; k < block::clone; ++k)
      CHECK((by_state(state.clone_at(0) + k) - o->by_clone.col(k)).norm() < 1e-3 * (1 + o->by_clone.norm()));
    CHECK((by_state(block::line_time) - o->by_line_time).norm() < 1e-3 * (1 + o->by_line_time.norm()));
    CHECK((by_state(block::gain) - o->by_gain).norm() < 1e-3 * (1 + o->by_gain.norm()));
    for (int k = 0; k < kLensStates; ++k)
      CHECK((by_state(block::lens + k) - o->by_lens.col(k)).norm() < 1e-3 * (1 + o->by_lens.col(k).norm()));
  }
}

TEST_CASE("the covariance is propagated by the derivative of the motion") {
  const ImuBuffer imu = some_imu();
  FilterParameters p;
  p.noise = {0, 0, 0, 0, 0, 0};
  p.focal_walk = p.centre_walk_px = 0;
  const double h = 1e-5;
  constexpr int sensed = block::navigation + block::axes;
  double worst = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    generator.seed(seed);
    const State state = some_state();
    State reference = state;
    propagate(reference, state.t_ns + 300'000'000, imu, p);
    const auto moved = [&](int k, double step) {
      State s = state;
      Eigen::VectorXd delta = Eigen::VectorXd::Zero(s.size());
      delta[k] = step;
      s.correct(delta);
      propagate(s, state.t_ns + 300'000'000, imu, p);
      const Navigation &a = s.nav, &b = reference.nav;
      Eigen::Matrix<double, 15, 1> out;
      const Quaterniond rotation = a.q_w_b * b.q_w_b.conjugate();
      const double scale = std::exp(delta[block::scale]);
      out << log_rotation(rotation), a.v_w - scale * (rotation * b.v_w), a.p_w - scale * (rotation * b.p_w),
          a.gyro_bias - b.gyro_bias, a.accel_bias - b.accel_bias;
      return out;
    };
    Eigen::MatrixXd numeric(15, sensed + 1);
    for (int k = 0; k <= sensed; ++k) {
      const int at = k < sensed ? k : block::scale;
      numeric.col(k) = (moved(at, h) - moved(at, -h)) / (2 * h);
    }
    const Eigen::MatrixXd expected = 1e-4 * numeric * numeric.transpose();
    const Eigen::MatrixXd carried = reference.P.topLeftCorner<15, 15>();
    CHECK((carried - expected).norm() < 5e-3 * expected.norm());
    const Eigen::MatrixXd with_axes = numeric.middleCols<block::axes>(block::gyro_axes) * 1e-4;
    CHECK((reference.P.block<15, block::axes>(0, block::gyro_axes) - with_axes).norm() < 5e-3 * with_axes.norm());
    // The position alone, which is small compared with the velocity, is off by the integration's second order.
    const Eigen::MatrixXd position = with_axes.middleRows<3>(block::rho);
    worst = std::max(
        worst, (reference.P.block<3, block::axes>(block::rho, block::gyro_axes) - position).norm() / position.norm());
  }
  MESSAGE("the position's derivative by the axes is off by " << worst);
  CHECK(worst < 5e-4);
}

TEST_CASE("a stabilised lens's shift and its covariance follow the gyroscope") {
  generator.seed(15);
  const ImuBuffer imu = some_imu();
  State state = some_state();
  state.camera.gain = 0.6;
  state.camera.shift_px = {1, -2};
  FilterParameters p;
  p.stabiliser.drive_error = p.stabiliser.gain_walk = 0;
  const auto shift = [&](double follow, Eigen::Vector2d from, double leak = 0.3) {
    State s = state;
    s.camera.gain = follow, s.camera.shift_px = from, s.camera.leak = leak;
    propagate(s, state.t_ns + 100'000'000, imu, p);
    return s;
  };
  const State moved = shift(0.6, state.camera.shift_px);
  state.camera.leak = 0.3;
  CHECK((predict_lens_shift(state, state.t_ns + 100'000'000, imu, p) - (moved.camera.shift_px - state.camera.shift_px))
            .norm() < 1e-9);
  const double h = 1e-4;
  Eigen::Matrix<double, 2, 4> J;
  for (int k = 0; k < 2; ++k)
    J.col(k) =
        (shift(0.6, state.camera.shift_px + h * Eigen::Vector2d::Unit(k)).camera.shift_px - moved.camera.shift_px) / h;
  J.col(2) = (shift(0.6 + h, state.camera.shift_px).camera.shift_px - moved.camera.shift_px) / h;
  J.col(3) = (shift(0.6, state.camera.shift_px, 0.3 + h).camera.shift_px - moved.camera.shift_px) / h;
  REQUIRE(J.col(2).norm() > 1);    // there was a rotation to compensate
  REQUIRE(J.col(3).norm() > 0.1);  // and a shift to leak
  const Eigen::Matrix2d expected = J * state.P.block<4, 4>(block::shift, block::shift) * J.transpose();
  const Eigen::Matrix2d carried = moved.P.block<2, 2>(block::shift, block::shift);
  CHECK((carried - expected).norm() < 1e-3 * expected.norm());
  // Without a gain there is no shift.
  CHECK(shift(0, Eigen::Vector2d::Zero()).camera.shift_px.norm() == 0);
}

TEST_CASE("a patch is matched after growth, shear, shift and a change of light") {
  cv::Mat texture(240, 240, CV_8U);
  for (int y = 0; y < 240; ++y)
    for (int x = 0; x < 240; ++x)
      texture.at<uchar>(y, x) =
          static_cast<uchar>(120 + 40 * std::sin(0.31 * x + 0.1 * y) + 35 * std::sin(0.27 * y - 0.12 * x) +
                             20 * std::sin(0.05 * x * y / 40.));
  Eigen::Matrix2d A;
  A << 1.15, 0.05, -0.04, 1.1;
  const Eigen::Vector2d at(110.3, 121.6), now_at(113.1, 118.2);
  cv::Mat now(240, 240, CV_8U);
  const Eigen::Matrix2d back = A.inverse();
  cv::Mat map_x(240, 240, CV_32F), map_y(240, 240, CV_32F);
  for (int y = 0; y < 240; ++y)
    for (int x = 0; x < 240; ++x) {
      const Eigen::Vector2d from = at + back * (Eigen::Vector2d(x, y) - now_at);
      map_x.at<float>(y, x) = static_cast<float>(from.x()), map_y.at<float>(y, x) = static_cast<float>(from.y());
    }
  cv::remap(texture, now, map_x, map_y, cv::INTER_LINEAR);
  now.convertTo(now, CV_8U, 0.8, 10);
  Patch::Parameters p;
  p.affine_sigma = 0.2;
  Patch patch;
  REQUIRE(patch.store(texture, at, p));
  const auto match = required(patch.find(now, {now_at + Eigen::Vector2d(0.7, -0.5), Eigen::Matrix2d::Identity()}, p));
  CHECK((match->map.at - now_at).norm() < 0.05);
  CHECK((match->map.A - A).norm() < 0.03);
  CHECK(match->difference < 1.5);
  // Without texture, and at the border.
  CHECK_FALSE(patch.store(cv::Mat(100, 100, CV_8U, cv::Scalar(80)), {50, 50}, p));
  CHECK_FALSE(patch.store(texture, {4, 100}, p));
  REQUIRE(patch.store(texture, at, p));
  CHECK_FALSE(patch.find(now, {{2, 2}, Eigen::Matrix2d::Identity()}, p));
}

TEST_CASE("a clone's covariance is that of the camera's pose") {
  generator.seed(13);
  const ImuBuffer imu = some_imu();
  const State state = some_state();
  FilterParameters p;
  p.rotation_jitter_rad = 0;
  State reference = state;
  augment(reference, 0, 1, imu, p);
  const double h = 1e-6;
  Eigen::MatrixXd numeric(6, block::fixed);
  for (int k = 0; k < block::fixed; ++k) {
    const auto at = [&](double step) {
      State s = state;
      Eigen::VectorXd delta = Eigen::VectorXd::Zero(s.size());
      delta[k] = step;
      s.correct(delta);
      if (k == block::time_offset) {  // the camera's pose is later by that
        integrate(s.nav, s.t_ns, s.t_ns + static_cast<int64_t>(step * 1e9), imu, p.gravity_mps2);
      }
      augment(s, 0, 1, imu, p);
      const double scale = k == block::scale ? std::exp(step) : 1;
      return difference(s.clones[0].q_w_c, s.clones[0].p_w, reference.clones[0].q_w_c, scale * reference.clones[0].p_w);
    };
    numeric.col(k) = (at(h) - at(-h)) / (2 * h);
  }
  const Eigen::MatrixXd expected = numeric * state.P;
  const Eigen::MatrixXd cloned = reference.P.block(block::fixed, 0, 6, block::fixed);
  CHECK((cloned - expected).norm() < 1e-2 * expected.norm());
  for (int k = 0; k < block::fixed; ++k)
    CHECK((cloned.col(k) - expected.col(k)).norm() < 2e-2 * (expected.col(k).norm() + 1e-6));
}

TEST_CASE("a landmark moved to another clone keeps its position and its covariance in the world") {
  generator.seed(14);
  State state = some_state();
  const ImuBuffer imu = some_imu();
  augment(state, 0, 1, imu, {});
  propagate(state, state.t_ns + 200'000'000, imu, {});
  augment(state, 1, 2, imu, {});
  Landmark landmark{5, 0, Vector3d(0.1, -0.2, 0.4), 0};
  Eigen::MatrixXd cross = Eigen::MatrixXd::Zero(3, state.size());
  state.add_landmark(landmark, cross, Vector3d(1e-6, 1e-6, 1e-4).asDiagonal());
  const Vector3d before = state.point(state.landmarks[0]);
  const auto covariance_in_w = [](const State& s) {  // of the point by theta_a, rho_a and its own
    const size_t a = s.find_clone(s.landmarks[0].anchor);
    Eigen::MatrixXd J = Eigen::MatrixXd::Zero(3, s.size());
    const Vector3d p = s.point(s.landmarks[0]);
    J.block<3, 3>(0, s.clone_at(a)) = -odograph::skew(p);
    J.block<3, 3>(0, s.clone_at(a) + 3).setIdentity();
    J.block<3, 3>(0, s.landmark_at(0)) = s.clones[a].q_w_c.toRotationMatrix() * landmark_jacobian(s.landmarks[0].at);
    return Eigen::Matrix3d(J * s.P * J.transpose());
  };
  const Eigen::Matrix3d covariance = covariance_in_w(state);
  state.move_anchor(0, 1);
  CHECK((state.point(state.landmarks[0]) - before).norm() < 1e-9);
  CHECK((covariance_in_w(state) - covariance).norm() < 1e-9 * covariance.norm());
}

TEST_CASE("the common scale of all lengths changes no picture, and only accelerations constrain it") {
  generator.seed(15);
  State state = some_state();
  state.camera.line_time_s = 0;  // with a rolling shutter the acceleration, in metres, enters
  const ImuBuffer imu = some_imu();
  FilterParameters p;
  p.noise = {0, 0, 0, 0, 0, 0};
  const auto scaled = [](State s, double by) {
    Eigen::VectorXd delta = Eigen::VectorXd::Zero(s.size());
    delta[block::scale] = by;
    s.correct(delta);
    return s;
  };
  State seen = state;
  augment(seen, 0, 1, imu, p);
  propagate(seen, seen.t_ns + 200'000'000, imu, p);
  augment(seen, 1, 2, imu, p);
  seen.add_landmark({5, 0, Vector3d(0.1, -0.2, 0.4), 0}, Eigen::MatrixXd::Zero(3, seen.size()), Matrix3d::Identity());
  const State larger = scaled(seen, 0.3);
  CHECK(larger.clones[1].p_w.norm() == doctest::Approx(std::exp(0.3) * seen.clones[1].p_w.norm()));
  const auto pixel = [](const State& s) { return observe(s.clones[1], s.camera, s.point(s.landmarks[0]), 100)->pixel; };
  CHECK((pixel(larger) - pixel(seen)).norm() < 1e-9);

  State reference = state;
  propagate(reference, state.t_ns + 300'000'000, imu, p);
  const double h = 1e-5;
  const auto beside = [&](double by) {
    State s = scaled(state, by);
    propagate(s, state.t_ns + 300'000'000, imu, p);
    return Vector3d(s.nav.v_w - std::exp(by) * reference.nav.v_w);
  };
  const Vector3d numeric = (beside(h) - beside(-h)) / (2 * h);
  const Vector3d carried = reference.P.block<3, 1>(block::nu, block::scale) / reference.P(block::scale, block::scale);
  CHECK((numeric - carried).norm() < 1e-3 * numeric.norm());
  CHECK((numeric - (state.nav.v_w - reference.nav.v_w)).norm() < 1e-6);

  // From then on the scale error multiplies the correction of the velocity.
  Eigen::VectorXd delta = Eigen::VectorXd::Zero(reference.size());
  delta.segment<3>(block::nu) = Vector3d(0.1, -0.2, 0.3);
  reference.correct(delta);
  const Vector3d now = reference.P.block<3, 1>(block::nu, block::scale) / reference.P(block::scale, block::scale);
  CHECK((carried - now - Vector3d(0.1, -0.2, 0.3)).norm() < 1e-9);
}
