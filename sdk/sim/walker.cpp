// SPDX-License-Identifier: Apache-2.0
#include "sdk/sim/walker.hpp"

#include <algorithm>
#include <cmath>

#include "sdk/sim/random.hpp"

namespace odograph {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kGravity = 9.80665;

/// 6x^5 - 15x^4 + 10x^3: from 0 to 1 with two continuous derivatives; and its integral from 0.
double smooth(double x) {
  x = std::clamp(x, 0.0, 1.0);
  return x * x * x * (x * (6 * x - 15) + 10);
}
double smooth_integral(double x) {
  if (x <= 0) return 0;
  if (x >= 1) return 0.5 + (x - 1);
  return x * x * x * x * (x * (x - 3) + 2.5);
}

}  // namespace

Walker::Walker(const Scenario& scenario, uint64_t seed) : c_(scenario) {
  Random random(seed, 1);
  for (double& phase : tremor_phase_) phase = random.uniform(0, 2 * kPi);
  stride_asymmetry_ = random.uniform(-0.02, 0.02);
  const double length = 2 * c_.straight_m + std::abs(c_.turn_rad) * c_.turn_radius_m;
  walk_s_ = std::max(length / c_.speed_mps, 2 * ramp_s_);
  duration_s_ = 2 * c_.stand_s + walk_s_ + ramp_s_;
  // Feet meet the ground where the phase is whole: search each crossing.
  double last_t = c_.stand_s, last_s = 0;
  const double total = step_phase(duration_s_);
  for (int k = 1; k < total; ++k) {
    double low = last_t, high = duration_s_;
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (low + high);
      (step_phase(middle) < k ? low : high) = middle;
    }
    steps_.push_back({last_t, low, arc_length(low) - last_s});
    last_t = low;
    last_s = arc_length(low);
  }
}

double Walker::vigour(double t) const {
  return smooth((t - c_.stand_s) / ramp_s_) - smooth((t - c_.stand_s - walk_s_) / ramp_s_);
}

double Walker::arc_length(double t) const {
  return c_.speed_mps * ramp_s_ *
         (smooth_integral((t - c_.stand_s) / ramp_s_) - smooth_integral((t - c_.stand_s - walk_s_) / ramp_s_));
}

double Walker::step_phase(double t) const {
  // A left step differs from a right one: the phase runs a little ahead on every other step.
  const double whole = arc_length(t) / c_.step_length_m;
  return whole + stride_asymmetry_ / kPi * std::sin(kPi * whole);
}

void Walker::path(double s, Eigen::Vector2d& p, double& heading) const {
  const double arc = std::abs(c_.turn_rad) * c_.turn_radius_m, side = c_.turn_rad < 0 ? -1.0 : 1.0;
  const double on_arc = std::clamp(s - c_.straight_m, 0.0, arc);
  heading = side * on_arc / c_.turn_radius_m;
  const double before = std::min(s, c_.straight_m), after = std::max(0.0, s - c_.straight_m - arc);
  p = {before + c_.turn_radius_m * std::sin(std::abs(heading)) + after * std::cos(heading),
       side * c_.turn_radius_m * (1 - std::cos(heading)) + after * std::sin(heading)};
}

Eigen::Isometry3d Walker::pose(double t) const {
  Eigen::Vector2d p;
  double heading = 0;
  path(arc_length(t), p, heading);
  const double v = vigour(t), phase = step_phase(t);
  const double bob = -0.022 * v * std::cos(2 * kPi * phase) + 0.001 * v * std::cos(4 * kPi * phase);
  const double sway = 0.018 * v * std::sin(kPi * phase), surge = 0.012 * v * std::sin(2 * kPi * phase + 0.6);
  const auto tremor = [&](int i, double hz) { return std::sin(2 * kPi * hz * t + tremor_phase_[i]); };
  const Eigen::Vector2d forward(std::cos(heading), std::sin(heading)), right(-forward.y(), forward.x());
  p += surge * forward + (sway + 0.004 * tremor(0, 0.31)) * right;
  const double up = 0.85 * c_.walker_height_m + bob + 0.003 * tremor(1, 0.23);

  const double yaw = heading + 0.035 * v * std::sin(kPi * phase + 0.4) + 0.01 * tremor(2, 0.37);
  const double pitch = c_.pitch_rad + 0.012 * v * std::sin(2 * kPi * phase + 1.1) + 0.008 * tremor(3, 0.29);
  const double roll = 0.02 * v * std::sin(kPi * phase + 0.9) + 0.008 * tremor(4, 0.41);
  Eigen::Matrix3d camera_axes;  // columns: where the body's x, y, z point in n for a level phone facing north
  camera_axes << 0, 0, -1, 1, 0, 0, 0, -1, 0;
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = (Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitY()) *
                Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitX()))
                   .toRotationMatrix() *
               camera_axes;
  T.translation() = Eigen::Vector3d(p.x(), p.y(), -up);
  return T;
}

Walker::Kinematics Walker::kinematics(double t) const {
  constexpr double h = 1e-3;
  const Eigen::Isometry3d before = pose(t - h), now = pose(t), after = pose(t + h);
  const Eigen::Vector3d acceleration_n = (after.translation() - 2 * now.translation() + before.translation()) / (h * h);
  const Eigen::AngleAxisd turn(before.linear().transpose() * after.linear());
  const Eigen::Matrix3d R_b_n = now.linear().transpose();
  return {turn.axis() * turn.angle() / (2 * h), R_b_n * (acceleration_n - Eigen::Vector3d(0, 0, kGravity))};
}

}  // namespace odograph
