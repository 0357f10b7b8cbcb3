// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/checks/motion_check.hpp"

#include <algorithm>
#include <cmath>

#include "sdk/host/base/saturating.hpp"
#include "sdk/math/rotation.hpp"
#include "sdk/math/time.hpp"

namespace odograph {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

namespace {

double angle(const Vector3d& a, const Vector3d& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

}  // namespace

Vector3d MotionCheck::Window::direction(size_t rate, const SignedAxes& axes) const {
  Vector3d out = Vector3d::Zero();
  for (int i = 0; i < 3; ++i) {
    const auto k = static_cast<size_t>(i);
    out += axes.sign[k] * rotated[rate][static_cast<size_t>(axes.from[k])].col(i);
  }
  return out;
}

void MotionCheck::Range::add(double value) {
  if (samples == 0 || value < low) low = value, lows = 0;
  if (samples == 0 || value > high) high = value, highs = 0;
  lows += value == low, highs += value == high;
  sum += value, sum2 += value * value, ++samples;
}

void MotionCheck::reset() {
  windows_.clear();
  now_ = {};
  ranges_ = {};
  q_e_b_.fill(Quaterniond::Identity());
  begun_ns_ = last_ns_ = 0;
  in_g_ = without_ = off_ = filtered_ = biased_ = range_windows_ = 0;
}

void MotionCheck::add(const odo_imu& imu) {
  const int64_t t_ns = imu.header.t_ns;
  const double dt_s = seconds(saturating_difference(t_ns, last_ns_));
  if (last_ns_ != 0 && (dt_s <= 0 || dt_s > p_.max_gap_s)) reset();
  if (last_ns_ == 0) begun_ns_ = last_ns_ = t_ns;
  const Vector3d rate_b(imu.gyro_b), force_b(imu.accel_b);
  const double step_s = seconds(t_ns - last_ns_);
  for (size_t k = 0; k < kRates; ++k) {
    q_e_b_[k] = (q_e_b_[k] * exp_rotation(kRate[k] * step_s * rate_b)).normalized();
    const Matrix3d R = q_e_b_[k].toRotationMatrix();
    for (int axis = 0; axis < 3; ++axis) now_.rotated[k][static_cast<size_t>(axis)] += R * force_b[axis];
  }
  now_.force += force_b;
  now_.norm += force_b.norm(), now_.norm2 += force_b.squaredNorm();
  now_.turned_rad += rate_b.norm() * step_s, now_.rotation += rate_b * step_s;
  ++now_.samples;
  for (int axis = 0; axis < 3; ++axis) ranges_[static_cast<size_t>(axis)].add(force_b[axis]);
  last_ns_ = t_ns;
  if (seconds(t_ns - begun_ns_) >= p_.window_s) end_window();
}

void MotionCheck::end_window() {
  begun_ns_ = last_ns_;
  if (now_.samples >= p_.min_samples) {
    windows_.push(now_);
    check_level(now_);
    check_range();
    check_axes();
  }
  now_ = {};
}

void MotionCheck::check_level(const Window& w) {
  const double n = w.samples, norm = w.norm / n, share = w.force.norm() / w.norm;
  const double scatter_mps2 = std::sqrt(std::max(0.0, w.norm2 / n - norm * norm));
  const bool quiet = scatter_mps2 < p_.quiet_mps2 && w.turned_rad < p_.unturned_rad;
  if (scatter_mps2 > p_.walking_mps2) walked_s_ += p_.window_s;
  const auto count = [](int& windows, bool holds) { windows = holds ? windows + 1 : 0; };
  const bool in_g = norm > p_.one_g_low && norm < p_.one_g_high && share > p_.with_gravity;
  const bool without = !in_g && (norm < p_.still || (norm < p_.moving && share < p_.without_gravity));
  const bool off = !in_g && !without &&
                   ((quiet && (norm < p_.low_mps2 || norm > p_.high_mps2)) || share * norm > p_.fast_mps2 ||
                    (share > p_.with_gravity && norm < p_.moving));
  count(in_g_, in_g), count(without_, without), count(off_, off);
  count(filtered_, scatter_mps2 < p_.filtered_mps2 && w.turned_rad > p_.filtered_rad);
  found_(InputFault::accel_filtered, filtered_ >= p_.steady, scatter_mps2, {});
  found_(InputFault::accel_in_g, in_g_ >= p_.steady, norm, {});
  found_(InputFault::accel_without_gravity, without_ >= p_.steady, norm, {});
  found_(InputFault::accel_level, off_ >= p_.steady, norm, {});
}

void MotionCheck::check_range() {
  if (++range_windows_ < p_.steady) return;
  range_windows_ = 0;
  double clipped = 0;
  for (const Range& r : ranges_) {
    const double mean = r.sum / r.samples, scatter2 = r.sum2 / r.samples - mean * mean;
    if (scatter2 < p_.clipped_scatter * p_.clipped_scatter) continue;
    if (r.lows > p_.clipped_share * r.samples) clipped = r.low;
    if (r.highs > p_.clipped_share * r.samples) clipped = r.high;
  }
  found_(InputFault::accel_clipped, clipped != 0, clipped, {});
  ranges_ = {};
}

/// Root of the summed squares of the angles between consecutive windows.
double MotionCheck::turn(size_t rate, const SignedAxes& axes) const {
  double squares = 0;
  Vector3d after = windows_.back(0).direction(rate, axes);
  for (size_t i = 1; i < windows_.size(); ++i) {
    const Vector3d before = windows_.back(i).direction(rate, axes);
    squares += std::pow(angle(before, after), 2);
    after = before;
  }
  return std::sqrt(squares);
}

double MotionCheck::rotation_in_body() const {
  double squares = 0;
  for (size_t i = 1; i < windows_.size(); ++i)
    squares += std::pow(angle(windows_.back(i).force, windows_.back(i - 1).force), 2);
  return std::sqrt(squares);
}

/// Whether, in the newest windows, the gyroscope swings gravity to and fro as far as it cancels, and in degrees would
/// hold it still, as it is in b.
bool MotionCheck::swings_too_far() const {
  const auto steady = static_cast<size_t>(p_.steady);
  if (windows_.size() < steady) return false;
  for (size_t i = 0; i < steady; ++i) {
    const Window& w = windows_.back(i);
    const double claimed = w.direction(0, {}).norm(), in_degrees = w.direction(2, {}).norm();
    if (claimed > p_.cancelled * w.norm || std::min(in_degrees, w.force.norm()) < p_.held * w.norm) return false;
  }
  return true;
}

/// Where gravity stays in b, the phone can only have turned about the vertical.
void MotionCheck::check_bias() {
  if (windows_.size() < kWindows) return;
  Vector3d rotation = Vector3d::Zero(), force = Vector3d::Zero();
  double whole_rad = 0;
  for (size_t i = 0; i < kWindows; ++i) {
    const Window& w = windows_.back(i);
    rotation += w.rotation, force += w.force, whole_rad += w.turned_rad;
  }
  const double about_force = rotation.dot(force.normalized()), turned = rotation.norm();
  const double across = std::sqrt(std::max(0.0, turned * turned - about_force * about_force));
  const bool straight = turned > p_.straight * whole_rad;  // rates of a swinging leg do not add up to its rotation
  const bool biased = straight && across > p_.biased_rad && std::abs(about_force) < p_.vertical * turned;
  biased_ = biased ? biased_ + 1 : 0;
  if (biased_ >= p_.biased_windows || across < 0.5 * p_.biased_rad)
    found_(InputFault::gyro_bias, biased_ > 0, turned / (static_cast<double>(kWindows) * p_.window_s), {});
}

/// Whether the phone was turned far, and the gyroscope's rotation leaves about as much, again and again.
bool MotionCheck::is_unexplained() const {
  double swept = 0, left = 0;
  int steps = 0;
  for (size_t i = 0; i < windows_.size(); ++i) {
    const Window& w = windows_.back(i);
    const Vector3d direction = w.direction(0, {});
    const double level = w.force.norm() / w.samples;
    if (level < p_.low_mps2 || level > p_.high_mps2) return false;
    for (size_t k = i + 1; k < windows_.size(); ++k) {
      const double off = angle(direction, windows_.back(k).direction(0, {}));
      swept = std::max(swept, angle(w.force, windows_.back(k).force)), left = std::max(left, off);
      steps += k == i + 1 && off > p_.step_rad;
    }
  }
  return swept > p_.swept_rad && left > p_.left_rad && steps >= p_.steps;
}

void MotionCheck::check_axes() {
  double least = 1e9, largest = 0;  // of gravity
  for (size_t i = 0; i < windows_.size(); ++i) {
    const double level = windows_.back(i).force.norm() / windows_.back(i).samples;
    least = std::min(least, level), largest = std::max(largest, level);
  }
  if (largest > p_.steady_level * least) return;  // a sensor that fails or a phone that falls
  const double shown = rotation_in_body();
  if (shown < p_.turned_rad && largest > p_.high_mps2) return;  // carried round a curve
  if (shown < p_.turned_rad) {  // it stays in b: a gyroscope that claims large turns of it has another unit
    const double claimed = turn(0, {});
    const bool degrees = (claimed > p_.claimed_rad && turn(2, {}) < p_.explained * claimed) || swings_too_far();
    if (degrees || claimed < p_.turned_rad) found_(InputFault::gyro_in_degrees, degrees, 0, {});
    if (!degrees) check_bias();
    return;
  }
  double turned_rad = 0;
  for (size_t i = 0; i < windows_.size(); ++i) turned_rad += windows_.back(i).turned_rad;
  const bool silent = turned_rad < p_.silent_rad * static_cast<double>(windows_.size()) && shown > p_.unnoticed_rad;
  found_(InputFault::gyro_silent, silent, shown, {});
  if (turned_rad < p_.silent_rad) return;
  const double contradiction = turn(0, {});
  double best = contradiction;
  SignedAxes axes;
  size_t rate = 0;
  for (size_t k = 0; k < kRates; ++k)  // a simpler explanation comes first and wins unless another is much better
    for (const SignedAxes& each : all_signed_axes())
      if (const double left = turn(k, each); left < 0.6 * best) best = left, axes = each, rate = k;
  const bool right = contradiction < p_.explained * shown || (contradiction < p_.turned_rad);
  const bool wrong = !right && best < p_.explained * contradiction;
  const bool unexplained = !right && !wrong && is_unexplained();
  if (right || wrong || unexplained) found_(InputFault::gyro_wrong, unexplained, contradiction, {});
  if (!right && !wrong && !unexplained) return;
  const bool exchanged = axes.changes() > 0;
  found_(InputFault::gyro_in_degrees, wrong && rate == 2, 0, {});
  found_(InputFault::gyro_sign, wrong && rate == 1 && !exchanged, 0, {});
  // Axes of the gyroscope: of a rate, whose sign is that of the rotation too.
  found_(InputFault::imu_axes, wrong && rate < 2 && exchanged, kRate[rate], rate == 1 ? axes.of_opposite_rate() : axes);
}

}  // namespace odograph
