// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/checks/picture_check.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "sdk/host/base/saturating.hpp"
#include "sdk/math/rotation.hpp"
#include "sdk/math/time.hpp"

namespace odograph {

using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

/// Offset and stride of a brightness in a row; stride 0 if the format has none.
std::pair<size_t, size_t> brightness(uint32_t format) {
  switch (format) {
    case ODO_FORMAT_GREY8:
    case ODO_FORMAT_NV12:
    case ODO_FORMAT_NV21:
    case ODO_FORMAT_YUV420: return {0, 1};
    case ODO_FORMAT_RGB8: return {1, 3};  // green
    case ODO_FORMAT_RGBA8:
    case ODO_FORMAT_BGRA8: return {1, 4};
    default: return {0, 0};
  }
}

/// Removes the slow part and scales to unit power. Returns the root mean square before.
double normalise(Profiles::Profile& p) {
  constexpr size_t kHalf = 8;
  std::array<float, Profiles::kMost + 1> sums{};
  std::partial_sum(p.value.begin(), p.value.begin() + p.count, sums.begin() + 1);
  double power = 0;
  for (size_t i = 0; i < p.count; ++i) {
    const size_t low = i < kHalf ? 0 : i - kHalf, high = std::min(p.count, i + kHalf + 1);
    p.value[i] -= (sums[high] - sums[low]) / static_cast<float>(high - low);
  }
  for (size_t i = 0; i < p.count; ++i) power += double(p.value[i]) * p.value[i];
  const double rms = std::sqrt(power / static_cast<double>(std::max<size_t>(p.count, 1)));
  if (rms > 0)
    for (size_t i = 0; i < p.count; ++i) p.value[i] /= static_cast<float>(rms);
  return rms;
}

/// Mean product of b, shifted, with a: 1 if they are the same.
double likeness(const Profiles::Profile& a, const Profiles::Profile& b, int shift) {
  const int n = static_cast<int>(a.count), from = std::max(0, -shift), to = std::min(n, n - shift);
  float sum = 0, aa = 0, bb = 0;
  for (int i = from; i < to; ++i) {
    const float x = a.value[static_cast<size_t>(i)], y = b.value[static_cast<size_t>(i + shift)];
    sum += x * y, aa += x * x, bb += y * y;
  }
  return aa > 0 && bb > 0 ? double(sum) / std::sqrt(double(aa) * double(bb)) : 0;
}

std::optional<double> shift_between(const Profiles::Profile& a, const Profiles::Profile& b, double min_likeness) {
  if (a.count != b.count || a.count < 32) return std::nullopt;
  const int most = static_cast<int>(a.count / 4);
  int best = 0;
  double max_likeness = -1;
  for (int shift = -most; shift <= most; ++shift)
    if (const double like = likeness(a, b, shift); like > max_likeness) max_likeness = like, best = shift;
  if (max_likeness < min_likeness || std::abs(best) == most) return std::nullopt;
  const double before = likeness(a, b, best - 1), after = likeness(a, b, best + 1);
  const double bend = before - 2 * max_likeness + after, part = bend < 0 ? 0.5 * (before - after) / bend : 0;
  return (best + std::clamp(part, -0.5, 0.5)) * a.pixels;
}

}  // namespace

bool Profiles::take(const odo_frame& frame, double min_contrast) {
  const auto [offset, stride] = brightness(frame.format);
  const odo_plane& plane = frame.planes[0];
  if (stride == 0 || !plane.data || frame.width < 64 || frame.height < 64) return false;
  const size_t step = std::max<size_t>(1, std::max(frame.width, frame.height) / kMost + 1);
  x_.count = std::min<size_t>(kMost, frame.width / step), y_.count = std::min<size_t>(kMost, frame.height / step);
  x_.pixels = y_.pixels = static_cast<double>(step);
  x_.value.fill(0), y_.value.fill(0);
  for (size_t r = 0; r < y_.count; ++r) {
    const uint8_t* row = plane.data + static_cast<int64_t>(r * step) * plane.row_stride + offset;
    uint32_t sum = 0;
    for (size_t c = 0; c < x_.count; ++c) {
      const uint32_t value = row[c * step * stride];
      sum += value, x_.value[c] += static_cast<float>(value);
    }
    y_.value[r] = static_cast<float>(sum) / static_cast<float>(x_.count);
  }
  for (size_t c = 0; c < x_.count; ++c) x_.value[c] /= static_cast<float>(y_.count);
  const double contrast_x = normalise(x_), contrast_y = normalise(y_);
  return std::min(contrast_x, contrast_y) >= min_contrast;
}

std::optional<Vector2d> Profiles::shift_since(const Profiles& earlier, double min_likeness) const {
  const auto x = shift_between(earlier.x_, x_, min_likeness);
  const auto y = x ? shift_between(earlier.y_, y_, min_likeness) : std::nullopt;
  return x && y ? std::optional(Vector2d(*x, *y)) : std::nullopt;
}

void PictureCheck::add(const odo_calibration& calibration) {
  reset();
  calibrated_ = calibration.fx > 0 && calibration.fy > 0 && (calibration.header.flags & ODO_CALIBRATION_EXTRINSICS);
  f_px_ = 0.5 * (calibration.fx + calibration.fy);
  q_b_c_ = quaternion(calibration.q_b_c);
}

void PictureCheck::add(const odo_imu& imu) {
  const bool first = turned_.empty();
  const Turned last = first ? Turned{} : turned_.back(0);
  const double dt_s = first ? 0 : seconds(saturating_difference(imu.header.t_ns, last.t_ns));
  if (dt_s < 0 || dt_s > p_.max_gap_s) return reset();
  turned_.push({imu.header.t_ns, (last.q_e_b * exp_rotation(dt_s * Vector3d(imu.gyro_b))).normalized()});
}

void PictureCheck::reset() {
  turned_.clear();
  pairs_.clear();
  waiting_.reset(), picture_ns_.reset();
  pairs_since_ = 0, same_ = 0;
}

/// Rotation of the camera between two times, in its own axes; nothing beyond the stored samples.
std::optional<Vector3d> PictureCheck::rotation_c(int64_t from_ns, int64_t to_ns) const {
  const auto at = [this](int64_t t_ns) -> std::optional<Eigen::Quaterniond> {
    const size_t later = turned_.later_than(t_ns);
    if (later == turned_.size() || (later == 0 && turned_.back(0).t_ns != t_ns)) return std::nullopt;
    const Turned& a = turned_.back(later);
    if (a.t_ns == t_ns) return a.q_e_b;
    const Turned& b = turned_.back(later - 1);
    return a.q_e_b.slerp(weight_between(a, b, t_ns), b.q_e_b);
  };
  if (turned_.empty()) return std::nullopt;
  const auto from = at(from_ns), to = at(to_ns);
  if (!from || !to) return std::nullopt;
  return Vector3d(q_b_c_.conjugate() * log_rotation(from->conjugate() * *to));
}

void PictureCheck::add(const odo_frame& frame) {
  const int64_t t_ns = frame.header.t_ns;
  if (!calibrated_ || (picture_ns_ && seconds(saturating_difference(t_ns, *picture_ns_)) < p_.interval_s)) return;
  take_waiting();
  const auto last_ns = std::exchange(picture_ns_, t_ns);
  const Profiles& earlier = profiles_[newest_];
  newest_ = 1 - newest_;
  Profiles& picture = profiles_[newest_];
  if (!picture.take(frame, p_.min_contrast)) return picture_ns_.reset(), void(same_ = 0);
  if (!last_ns || seconds(saturating_difference(t_ns, *last_ns)) > p_.max_gap_s) return void(same_ = 0);
  check_frozen(picture == earlier, t_ns);
  const double f_px = (frame.header.flags & ODO_FRAME_INTRINSICS) && frame.fx > 0 ? frame.fx : f_px_;
  const auto shift_px = picture.shift_since(earlier, p_.min_likeness);
  if (shift_px) waiting_ = Pair{*last_ns, t_ns, *shift_px / f_px, Eigen::Vector3d::Zero()};
}

void PictureCheck::take_waiting() {
  if (!waiting_) return;
  Pair pair = *std::exchange(waiting_, std::nullopt);
  const auto turned = rotation_c(pair.from_ns, pair.to_ns);
  if (!turned) return;
  pair.turned_c = *turned;
  pairs_.push(pair);
  if (++pairs_since_ < p_.min_pairs) return;
  pairs_since_ = p_.min_pairs / 2;
  check();
}

void PictureCheck::check_frozen(bool same, int64_t t_ns) {
  if (!same || same_ == 0) same_since_ns_ = t_ns;
  same_ = same ? same_ + 1 : 0;
  const auto turned =
      same_ >= p_.frozen ? rotation_c(same_since_ns_, turned_.empty() ? 0 : turned_.back(0).t_ns) : std::nullopt;
  if (!same || turned) found_(InputFault::picture_frozen, turned && turned->norm() > p_.frozen_rad, same_, {});
}

/// Of the shifts with the rotations, if the camera's axes were exchanged.
PictureCheck::Fit PictureCheck::fit(const SignedAxes& axes) const {
  Fit out;
  double xx = 0, yy = 0, sx = 0, sy = 0;
  for (size_t i = 0; i < pairs_.size(); ++i) {
    const Pair& pair = pairs_.back(i);
    const double x = -axes.of(pair.turned_c, 1), y = axes.of(pair.turned_c, 0);  // of a distant point, in focal lengths
    ++out.pairs;
    sx += pair.shift.x() * x, sy += pair.shift.y() * y;
    xx += pair.shift.x() * pair.shift.x(), yy += pair.shift.y() * pair.shift.y();
    out.energy_x += x * x, out.energy_y += y * y;
  }
  const auto correlation = [](double product, double a, double b) {
    return a > 0 && b > 0 ? product / std::sqrt(a * b) : 0;
  };
  out.x = correlation(sx, xx, out.energy_x), out.y = correlation(sy, yy, out.energy_y);
  const double energy = out.energy_x + out.energy_y;
  out.ratio = energy > 0 ? (sx + sy) / energy : 1;
  return out;
}

void PictureCheck::check() {
  const auto shows = [this](const Fit& f) {
    return f.pairs >= p_.min_pairs && f.energy_x > p_.turned_rad2 && f.energy_y > p_.turned_rad2;
  };
  const Fit stated = fit({});
  if (!shows(stated)) return;
  Fit best = stated;
  SignedAxes axes;
  for (const SignedAxes& each : all_signed_axes())  // those with fewer changes first
    if (const Fit other = fit(each); shows(other) && other.worse() > best.worse() + 0.1) best = other, axes = each;
  const bool agrees = stated.worse() > p_.agrees;
  const bool turned = !agrees && stated.worse() < p_.contradicts && best.worse() > p_.explains;
  if (agrees || turned) {
    const bool in_plane = axes.from[0] < 2 && axes.from[1] < 2;
    const double clockwise_deg = axes.from[0] == 1 ? (axes.sign[0] > 0 ? 270 : 90) : 180;
    const bool proper = (axes.from[0] == 0) == (axes.sign[0] == axes.sign[1]);  // of the two axes of the picture
    found_(InputFault::picture_turned, turned && in_plane && proper, clockwise_deg, axes);
    found_(InputFault::picture_mirrored, turned && in_plane && !proper, 0, axes);
    found_(InputFault::camera_mount, turned && !in_plane, 0, axes);
  }
  if (stated.worse() > p_.sure && stated.energy_x + stated.energy_y > p_.focal_rad2)
    found_(InputFault::focal_length, stated.ratio < p_.focal_low || stated.ratio > p_.focal_high, stated.ratio * f_px_,
           {});
}

}  // namespace odograph
