// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/checks/picture_check.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>

#include "sdk/host/base/saturating.hpp"
#include "sdk/math/rotation.hpp"
#include "sdk/math/time.hpp"

namespace odograph {

using Eigen::Vector2d;
using Eigen::Vector3d;

void PictureCheck::add(const odo_calibration& calibration) {
  reset();
  calibrated_ = calibration.fx > 0 && calibration.fy > 0 && (calibration.header.flags & ODO_CALIBRATION_EXTRINSICS);
  f_px_ = 0.5 * (calibration.fx + calibration.fy);
  q_b_c_ = quaternion(calibration.q_b_c);
  const double off_x = std::abs(calibration.cx / std::max(1u, calibration.width) - 0.5),
               off_y = std::abs(calibration.cy / std::max(1u, calibration.height) - 0.5);
  found_(InputFault::principal_point, std::max(off_x, off_y) > p_.off_middle, std::max(off_x, off_y), {});
}

void PictureCheck::add(const odo_imu& imu) {
  const bool first = turned_.empty();
  const Turned last = first ? Turned{} : turned_.back(0);
  const double dt_s = first ? 0 : seconds(saturating_difference(imu.header.t_ns, last.t_ns));
  if (dt_s < 0 || dt_s > p_.max_gap_s) return reset();
  turned_.push({imu.header.t_ns, last.turned_b + dt_s * Vector3d(imu.gyro_b)});
}

void PictureCheck::reset() {
  turned_.clear();
  pairs_.clear();
  picture_ns_.reset();
  still_.reset();
  rows_ = {};
  pairs_since_ = open_ = 0, pictures_ = same_ = 0;
}

/// Rotation of the camera between two times, in its own axes; nothing beyond the stored samples.
std::optional<Vector3d> PictureCheck::rotation_c(int64_t from_ns, int64_t to_ns) const {
  const auto at = [this](int64_t t_ns) -> std::optional<Vector3d> {
    const size_t later = turned_.later_than(t_ns);
    if (later == turned_.size() || (later == 0 && turned_.back(0).t_ns != t_ns)) return std::nullopt;
    const Turned& a = turned_.back(later);
    if (a.t_ns == t_ns) return a.turned_b;
    const Turned& b = turned_.back(later - 1);
    return a.turned_b + weight_between(a, b, t_ns) * (b.turned_b - a.turned_b);
  };
  const auto from = at(from_ns), to = at(to_ns);
  if (!from || !to) return std::nullopt;
  return Vector3d(q_b_c_.conjugate() * (*to - *from));
}

void PictureCheck::add(const odo_frame& frame) {
  const int64_t t_ns = frame.header.t_ns;
  if (calibrated_) check_repeated(frame);
  if (!calibrated_ || (picture_ns_ && seconds(saturating_difference(t_ns, *picture_ns_)) < p_.interval_s)) return;
  complete_pairs();
  const auto last_ns = std::exchange(picture_ns_, t_ns);
  const Vector3d turned_c = q_b_c_.conjugate() * (turned_.empty() ? Vector3d(0, 0, 0) : turned_.back(0).turned_b);
  if (const auto shift_px = rows_.add(frame, turned_c)) found_(InputFault::picture_rows, *shift_px != 0, *shift_px, {});
  const Profiles& earlier = profiles_[newest_];
  newest_ = 1 - newest_;
  Profiles& picture = profiles_[newest_];
  if (!picture.take(frame, p_.min_contrast)) return picture_ns_.reset();
  if (!last_ns || seconds(saturating_difference(t_ns, *last_ns)) > p_.max_gap_s) return;
  if (const auto share = still_.add(frame, turned_c))
    found_(InputFault::picture_overlay, *share > p_.overlay, 100 * *share, {});
  const double f_px = (frame.header.flags & ODO_FRAME_INTRINSICS) && frame.fx > 0 ? frame.fx : f_px_;
  const Vector2d shift_px = picture.shift_since(earlier, p_.min_likeness);
  if (shift_px.array().isNaN().all()) return;
  pairs_.push({*last_ns, t_ns, shift_px / f_px, {}, false});
  open_ = std::min(open_ + 1, pairs_.size());
}

/// Gives pairs their rotations once the gyroscope has reached the largest lag after them.
void PictureCheck::complete_pairs() {
  constexpr int64_t kMost_ns = static_cast<int64_t>(kNoLag) * kLag_ns;
  for (; open_ > 0; --open_) {
    Pair& pair = pairs_.back(open_ - 1);
    if (turned_.empty() || saturating_difference(turned_.back(0).t_ns, pair.to_ns) < kMost_ns) return;
    pair.known = true;
    for (size_t lag = 0; lag < kLags; ++lag) {
      const int64_t later_ns = static_cast<int64_t>(lag) * kLag_ns - kMost_ns;
      const auto turned = rotation_c(pair.from_ns + later_ns, pair.to_ns + later_ns);
      if (turned) pair.turned_c[lag] = *turned;
      pair.known = pair.known && turned;
    }
    if (!pair.known || ++pairs_since_ < p_.min_pairs) continue;
    pairs_since_ = p_.min_pairs / 2;
    check();
  }
}

void PictureCheck::check_repeated(const odo_frame& frame) {
  const auto [offset, stride] = brightness(frame.format);
  const odo_plane& plane = frame.planes[0];
  if (stride == 0 || !plane.data) return;
  const auto last = sparse_;
  for (uint32_t r = 0; r < 16; ++r)
    for (uint32_t c = 0; c < 16; ++c) {
      const int64_t y = (2 * r + 1) * frame.height / 32, x = (2 * c + 1) * frame.width / 32;
      sparse_[16 * r + c] =
          plane.data[y * plane.row_stride + x * static_cast<int64_t>(stride) + static_cast<int64_t>(offset)];
    }
  const int mean = std::accumulate(sparse_.begin(), sparse_.end(), 0) / static_cast<int>(sparse_.size());
  const auto varied = std::count_if(sparse_.begin(), sparse_.end(),
                                    [&](uint8_t value) { return std::abs(value - mean) > p_.varied_by; });
  const Vector3d turned_b = turned_.empty() ? sparse_turned_b_ : turned_.back(0).turned_b;
  const double turned_rad = (turned_b - std::exchange(sparse_turned_b_, turned_b)).norm();
  if (varied < p_.varied || turned_rad < p_.turned_rad) return;
  same_ += sparse_ == last;
  if (++pictures_ < p_.of_pictures) return;
  const double share = static_cast<double>(std::exchange(same_, 0)) / std::exchange(pictures_, 0);
  found_(InputFault::picture_repeated, share > p_.repeated, 100 * share, {});
}

/// Of the shifts with the rotations, if the camera's axes were exchanged and its clock was behind by a lag.
PictureCheck::Fit PictureCheck::fit(const SignedAxes& axes, size_t lag) const {
  Fit out;
  for (size_t i = 0; i < pairs_.size(); ++i) {
    const Pair& pair = pairs_.back(i);
    if (!pair.known) continue;
    const Vector3d& turned_c = pair.turned_c[lag];  // of a distant point, in focal lengths:
    out.x.add(pair.shift.x(), -axes.of(turned_c, 1)), out.y.add(pair.shift.y(), axes.of(turned_c, 0));
  }
  return out;
}

void PictureCheck::Component::add(double shift, double expected) {
  if (std::isnan(shift)) return;
  product += shift * expected, power += shift * shift, energy += expected * expected, ++pairs;
}

void PictureCheck::check() {
  const auto shows = [this](const Fit& f) {
    return std::min(f.x.pairs, f.y.pairs) >= p_.min_pairs && std::min(f.x.energy, f.y.energy) > p_.turned_rad2;
  };
  const Fit stated = fit({});
  if (!shows(stated)) return;
  Fit timed = stated;  // by the clock that fits best
  size_t lag = kNoLag;
  for (size_t each = 0; each < kLags; ++each)
    if (const Fit other = fit({}, each); shows(other) && other.worse() > timed.worse()) timed = other, lag = each;
  Fit best = timed;
  SignedAxes axes;
  for (const SignedAxes& each : all_signed_axes())  // those with fewer changes first
    if (const Fit other = fit(each); shows(other) && other.worse() > best.worse() + 0.1) best = other, axes = each;
  const bool agrees = stated.worse() > p_.agrees;
  const bool turned = !agrees && axes.changes() > 0 && stated.worse() < p_.contradicts && best.worse() > p_.explains;
  if (agrees || turned) {
    const bool in_plane = axes.from[0] < 2 && axes.from[1] < 2;
    const double clockwise_deg = axes.from[0] == 1 ? (axes.sign[0] > 0 ? 270 : 90) : 180;
    const bool proper = (axes.from[0] == 0) == (axes.sign[0] == axes.sign[1]);  // of the two axes of the picture
    found_(InputFault::picture_turned, turned && in_plane && proper, clockwise_deg, axes);
    found_(InputFault::picture_mirrored, turned && in_plane && !proper, 0, axes);
    found_(InputFault::camera_mount, turned && !in_plane, 0, axes);
  }
  if (axes.changes() > 0) return;
  const int64_t behind_ns = (static_cast<int64_t>(lag) - static_cast<int64_t>(kNoLag)) * kLag_ns;
  const auto unexplained = [](const Fit& f) { return 1 - f.worse() * std::abs(f.worse()); };
  const bool elsewhere = std::abs(behind_ns) > p_.other_time_ns;
  if (timed.worse() > p_.explains && (!elsewhere || unexplained(timed) < p_.halved * unexplained(stated)))
    found_(InputFault::picture_time, elsewhere, seconds(behind_ns), {});
  const auto bound = [&timed](double sigmas) {  // of both ratios
    const double x = timed.x.ratio() * (1 + sigmas * timed.x.relative_sigma()),
                 y = timed.y.ratio() * (1 + sigmas * timed.y.relative_sigma());
    return std::minmax({x, y});
  };
  const auto [less, more] = bound(0);
  const bool other = bound(p_.sigmas).second < p_.focal_low || bound(-p_.sigmas).first > p_.focal_high;
  const bool same = more > p_.focal_low && less < p_.focal_high;
  if (timed.worse() > p_.explains && (other || same))
    found_(InputFault::focal_length, other, (more < 1 ? more : less) * f_px_, {});
}

}  // namespace odograph
