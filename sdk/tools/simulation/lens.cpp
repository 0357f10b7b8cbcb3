// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/simulation/lens.hpp"

#include <algorithm>
#include <cmath>

#include "sdk/tools/simulation/signal.hpp"

namespace odograph {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kStabiliser_hz = 1000.0;  // of the stabiliser's controller: 1 kHz and more in phones
constexpr double kTwoPi = 6.283185307179586;

}  // namespace

SimLens::SimLens(const Scenario::Camera& c, const Eigen::Quaterniond& in_body, const Motion& phone, uint64_t seed) {
  if (c.stabiliser.travel_rad > 0) stabilise(c, in_body, phone, seed);
  if (c.focus.breathing > 0) focus(c, phone.duration_s(), seed);
  const double corner = 0.5 * std::hypot(c.width, c.height);
  for (const Vector2d& shift : shift_) reach_px_ = std::max(reach_px_, shift.cwiseAbs().maxCoeff());
  reach_px_ += c.focus.breathing * corner;
}

void SimLens::stabilise(const Scenario::Camera& c, const Eigen::Quaterniond& in_body, const Motion& phone,
                        uint64_t seed) {
  const auto& s = c.stabiliser;
  const double dt = 1 / kStabiliser_hz, lag_s = s.settling_s / 4;  // settled: within 2 %, four time constants
  const Eigen::Matrix3d R_c_b = in_body.conjugate().toRotationMatrix();
  const auto n = static_cast<size_t>(std::ceil(phone.duration_s() * kStabiliser_hz)) + 1;
  Signal residual[2] = {Signal(n), Signal(n)};
  for (size_t axis = 0; axis < 2; ++axis) {
    add_gauss_markov(residual[axis], Random(seed, 95 + axis), 0.02, 1, kStabiliser_hz);
    smooth(residual[axis], 0.004, kStabiliser_hz);
    double power = 0;
    for (const double x : residual[axis]) power += x * x;
    const double scale = s.residual_px / std::sqrt(std::max(power / static_cast<double>(n), 1e-12));
    for (double& x : residual[axis]) x *= scale;
  }
  Vector2d angle(0, 0), lens(0, 0);
  shift_.reserve(n);
  for (size_t i = 0; i < n; ++i) {
    const Vector3d w = R_c_b * phone.at(static_cast<double>(i) * dt).angular_velocity_b;
    // A far point at the centre moves by f (-w_y, w_x); the lens compensates.
    const Vector2d rate(w.y(), -w.x());
    const double used = std::min(1.0, angle.norm() / s.travel_rad);
    const double leak_hz = s.high_pass_hz + (s.end_pass_hz - s.high_pass_hz) * used * used;
    angle = (angle + dt * rate) / (1 + dt * kTwoPi * leak_hz);
    if (angle.norm() > s.travel_rad) angle *= s.travel_rad / angle.norm();
    lens += dt / (lag_s + dt) * (s.gain * angle - lens);
    shift_.push_back(c.focal_px * lens + Vector2d(residual[0][i], residual[1][i]));
  }
}

void SimLens::focus(const Scenario::Camera& c, double duration_s, uint64_t seed) {
  Random random(seed, 97);
  const auto target = [&] { return 1 + c.focus.breathing * random.uniform(-1, 1); };
  move_s_ = c.focus.move_s;
  double now = target();
  focus_.push_back({-move_s_, now, now});
  for (double t = 0; t < duration_s;) {
    t += move_s_ - c.focus.interval_s * std::log(1 - random.uniform());
    const double next = target();
    focus_.push_back({t, now, next});
    now = next;
  }
}

SimLens::State SimLens::at(double t_s) const {
  State state;
  if (shift_.size() > 1) {
    const double u = std::clamp(t_s * kStabiliser_hz, 0.0, static_cast<double>(shift_.size() - 1));
    const size_t i = std::min(static_cast<size_t>(u), shift_.size() - 2);
    const Vector2d step = shift_[i + 1] - shift_[i];
    state.shift_px = shift_[i] + (u - static_cast<double>(i)) * step;
    state.rate_px_s = kStabiliser_hz * step;
  }
  if (!focus_.empty()) {
    auto move = std::upper_bound(focus_.begin(), focus_.end(), t_s,
                                 [](double t, const FocusMove& m) { return t < m.t_start_s; });
    if (move != focus_.begin()) --move;
    const double x = move_s_ > 0 ? std::clamp((t_s - move->t_start_s) / move_s_, 0.0, 1.0) : 1.0;
    state.focal = move->from + (move->to - move->from) * x * x * (3 - 2 * x);
  }
  return state;
}

}  // namespace odograph
