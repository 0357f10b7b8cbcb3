// SPDX-License-Identifier: Apache-2.0
#include "plugins/vo/odograph/inertial/filter.hpp"

#include <algorithm>
#include <cmath>

#include "plugins/shared/median.hpp"
#include "plugins/vo/odograph/inertial/propagate.hpp"
#include "sdk/math/time.hpp"

namespace odograph::vio {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kMedianNis = 0.8;          // of chi-square with 2 to 10 degrees of freedom, per degree of freedom
constexpr double kHeadingSigma_rad = 1e-4;  // arbitrary: heading and position are unobservable

}  // namespace

Filter::Filter(const FilterParameters& parameters, const Camera& camera, const Start& start)
    : p_(parameters), calibrated_(camera) {
  state_.t_ns = start.t_ns;
  state_.nav = start.nav;
  state_.camera = camera;
  state_.P = Eigen::MatrixXd::Zero(block::fixed, block::fixed);
  auto sigmas = state_.P.diagonal();
  const auto set = [&](int from, int count, double sigma) { sigmas.segment(from, count).setConstant(sigma * sigma); };
  set(block::theta, 2, start.tilt_rad);
  set(block::theta + 2, 1, kHeadingSigma_rad);
  set(block::nu, 3, start.velocity_mps);
  set(block::rho, 3, 1e-4);
  set(block::gyro_bias, 3, start.gyro_bias_radps);
  set(block::accel_bias, 3, start.accel_bias_mps2);
  for (int i = 0; i < 9; ++i) {
    const bool own = i % 4 == 0;
    set(block::gyro_axes + i, 1, own ? p_.priors.gyro_scale : p_.priors.misalignment_rad);
    set(block::accel_axes + i, 1, own ? p_.priors.accel_scale : p_.priors.misalignment_rad);
  }
  set(block::extrinsics, 3, p_.priors.extrinsics_rad);
  set(block::lever, 3, p_.priors.lever_m);
  set(block::time_offset, 1, p_.priors.time_offset_s);
  const double line = camera.line_time_s;
  set(block::line_time, 1,
      line > 0 ? p_.priors.line_time_relative * line : p_.priors.readout_s / (2 * camera.middle_row + 1));
  set(block::shift, 2, p_.stabiliser.shift_sigma_px);
  set(block::gain, 1, p_.stabiliser.gain_sigma);
  set(block::leak, 1, p_.stabiliser.leak_sigma);
  set(block::focus, 1, p_.focus_sigma);
  set(block::scale, 1, start.scale);
  set(block::lens, 1, p_.priors.focal_relative);
  set(block::lens + 1, 1, p_.priors.centre_px[0]);
  set(block::lens + 2, 1, p_.priors.centre_px[1]);
  set(block::lens + 3, 1, p_.priors.distortion[0]);
  set(block::lens + 4, 1, p_.priors.distortion[1]);
  if (start.rest_force_b) update_gravity(state_, *start.rest_force_b, p_.gravity_mps2, start.rest_force_mps2);
}

void Filter::count(const Outcome& outcome, FrameReport& report) {
  if (outcome.dof == 0) return;
  ++report.tried;
  report.accepted += outcome.accepted;
  report.nis_per_dof.push_back(outcome.nis / outcome.dof);
  if (outcome.rms_px > 0) report.rms_px.push_back(outcome.rms_px);
}

FrameReport Filter::process(const FrameCorners& frame, const ImuBuffer& imu) {
  FrameReport report;
  const int64_t t_ns = frame.t_ns + nanoseconds(state_.camera.time_offset_s);
  report.imu_whole = propagate(state_, std::max(t_ns, state_.t_ns), imu, p_);
  if (!recent_.empty()) inflate_landmark_noise(seconds(frame.t_ns - recent_.back().t_ns));
  report.standing = !is_translating(frame.t_ns) && is_standing(frame, imu);
  if (state_.clones.size() > 2 && ((report.standing && was_standing_) || without_parallax()))
    marginalise_clone(state_.clones.size() - 1);
  was_standing_ = report.standing;
  augment(state_, next_id_++, frame.t_ns, imu, p_);
  for (const Corner& corner : frame.corners) tracks_[corner.track].push_back({newest().id, corner.pixel, corner.row});
  if (report.standing) update_zero_velocity(state_, p_.stand.sigma_mps(newest().rate_c.norm()));
  update_landmarks(frame, report);
  update_tracks(report);
  marginalise();
  detect_fixed_lens();
  doubt_lens();
  update_scale_sigma();
  if (!recent_.empty()) update_pixel_sigma(report, seconds(frame.t_ns - recent_.back().t_ns));
  recent_.push_back(frame);
  while (seconds(frame.t_ns - recent_.front().t_ns) > 1.5 * p_.stand.window_s) recent_.pop_front();
  return report;
}

void Filter::inflate_landmark_noise(double dt_s) {
  const double walk = p_.corner_walk_px / state_.camera.lens.focal();
  for (size_t j = 0; j < state_.landmarks.size(); ++j)
    state_.P.diagonal().segment<2>(state_.landmark_at(j)).array() += walk * walk * dt_s;
}

/// True if the mean velocity exceeds that of a person who stands, or rotates on the spot with the phone at arm's
/// length.
bool Filter::is_translating(int64_t t_ns) {
  motions_.push_back({t_ns, state_.nav.v_w, state_.nav.q_w_b});
  while (seconds(t_ns - motions_.front().t_ns) > p_.stand.mean_s) motions_.pop_front();
  Vector3d mean = Vector3d::Zero();
  for (const Motion& x : motions_) mean += x.v_w / static_cast<double>(motions_.size());
  const double rotation_rad = motions_.front().q_w_b.angularDistance(state_.nav.q_w_b);
  const double sigma_mps = std::hypot(p_.stand.sway_m, p_.stand.arm_m * rotation_rad) / p_.stand.mean_s;
  Matrix3d S = velocity_covariance();
  S.diagonal().array() += sigma_mps * sigma_mps;
  return mean.dot(S.ldlt().solve(mean)) > chi_square_bound(3, p_.gate_tail);
}

/// True if a rotation explains the picture and the specific force is nearly constant.
bool Filter::is_standing(const FrameCorners& frame, const ImuBuffer& imu) const {
  const auto before = std::find_if(recent_.rbegin(), recent_.rend(), [&](const FrameCorners& f) {
    return seconds(frame.t_ns - f.t_ns) > p_.stand.window_s;
  });
  if (before == recent_.rend()) return false;
  Vector3d sum = Vector3d::Zero(), squares = Vector3d::Zero();
  int n = 0;
  imu.for_each(before->t_ns, frame.t_ns, 1'000'000'000,
               [&](const ImuSample& a, const ImuSample&) { sum += a.accel_b, squares += a.accel_b.cwiseAbs2(), ++n; });
  if (n < p_.stand.min_samples) return false;
  // A rotating phone changes the direction of gravity in b without translating: only the norm counts then.
  const Vector3d mean = sum / n;
  const double variance = (squares / n - mean.cwiseAbs2()).sum();
  double norms = 0, norm_squares = 0;
  imu.for_each(before->t_ns, frame.t_ns, 1'000'000'000, [&](const ImuSample& a, const ImuSample&) {
    const double norm = a.accel_b.norm();
    norms += norm, norm_squares += norm * norm;
  });
  const double norm_variance = norm_squares / n - norms * norms / (n * n);
  const double rate_hz = n / seconds(frame.t_ns - before->t_ns);
  if (std::min(variance, 2 * norm_variance) > p_.stand.max_force_variance(p_.noise, rate_hz)) return false;
  const auto flow_px = residual_flow(*before, frame, state_.camera, p_.stand.min_corners);
  return flow_px && *flow_px < p_.stand.flow_px;
}

/// The newest clone adds no parallax to the previous one. Keeping both would push clones with parallax out of the
/// window.
bool Filter::without_parallax() const {
  if (state_.landmarks.size() < p_.stand.min_corners) return false;
  std::vector<double> inverse_depths;
  for (const Landmark& landmark : state_.landmarks) inverse_depths.push_back(landmark.at.z());
  const size_t n = state_.clones.size();
  return (state_.clones[n - 1].p_w - state_.clones[n - 2].p_w).norm() * median(inverse_depths) *
             state_.camera.lens.focal() <
         p_.min_clone_parallax_px;
}

void Filter::marginalise_clone(size_t i) {
  const uint32_t id = state_.clones[i].id;
  const size_t other = i + 1 < state_.clones.size() ? state_.clones.size() - 1 : i - 1;
  for (size_t j = 0; j < state_.landmarks.size(); ++j)
    if (state_.landmarks[j].anchor == id) state_.move_anchor(j, other);
  for (auto& [track, seen] : tracks_)
    seen.erase(std::remove_if(seen.begin(), seen.end(), [id](const Observation& o) { return o.clone == id; }),
               seen.end());
  state_.remove_clone(i);
}

void Filter::update_landmarks(const FrameCorners& frame, FrameReport& report) {
  std::vector<SeenLandmark> seen;
  for (size_t j = 0; j < state_.landmarks.size(); ++j) {
    const uint64_t track = state_.landmarks[j].track;
    const auto at = std::lower_bound(frame.corners.begin(), frame.corners.end(), track,
                                     [](const Corner& c, uint64_t t) { return c.track < t; });
    if (at != frame.corners.end() && at->track == track) seen.push_back({j, {newest().id, at->pixel, at->row}});
    tracks_.erase(track);  // its observations are used by the landmark
  }
  const std::vector<Outcome> outcomes = update_with_landmarks(state_, seen, p_);
  std::vector<char> keep(state_.landmarks.size(), 0);
  for (size_t k = 0; k < seen.size(); ++k) {
    count(outcomes[k], report);
    int& misses = state_.landmarks[seen[k].landmark].misses;
    misses = outcomes[k].accepted ? 0 : misses + 1;
    keep[seen[k].landmark] = misses < p_.max_misses;
  }
  for (size_t j = keep.size(); j-- > 0;)
    if (!keep[j]) state_.remove_landmark(j);
}

/// Updates with the tracks that ended and those that span the window, which are about to lose their oldest clone.
void Filter::update_tracks(FrameReport& report) {
  const bool full = state_.clones.size() > p_.clones;
  const uint32_t oldest = state_.clones.front().id;
  std::vector<std::pair<uint64_t, bool>> ready;  // and whether the track continues
  for (auto& [track, seen] : tracks_) {
    const bool alive = !seen.empty() && seen.back().clone == newest().id;
    // A camera that stands gets no new clones, so its landmarks would decrease.
    const bool wanted = report.standing && state_.landmarks.size() < p_.landmarks && seen.size() >= p_.min_track;
    const bool spans = full && !seen.empty() && seen.front().clone == oldest;
    if (!alive || spans || wanted) ready.emplace_back(track, alive);
  }
  std::stable_sort(ready.begin(), ready.end(),
                   [&](const auto& a, const auto& b) { return tracks_[a.first].size() > tracks_[b.first].size(); });
  size_t used = 0;
  for (const auto& [track, alive] : ready) {
    const Track seen = std::move(tracks_[track]);
    tracks_.erase(track);
    if (seen.size() < p_.min_track) {
      if (alive) tracks_[track] = {seen.back()};
      continue;
    }
    if (alive && state_.landmarks.size() < p_.landmarks && (report.standing || seen.size() >= p_.clones / 2)) {
      const Outcome outcome = add_landmark(state_, track, seen, p_);
      count(outcome, report);
      if (outcome.accepted) continue;
    } else if (used < p_.features) {
      const Outcome outcome = update_with_track(state_, seen, p_);
      used += outcome.dof > 0;
      count(outcome, report);
    }
    if (alive) tracks_[track] = {seen.back()};  // restarts as a new track
  }
}

void Filter::marginalise() {
  while (state_.clones.size() > p_.clones) marginalise_clone(0);
}

/// A stabiliser takes out most of the rotation. A lens that follows clearly less is therefore fixed, and its small
/// gain, which cannot be told apart from a slow drift of the principal point, is set to zero.
void Filter::detect_fixed_lens() {
  if (fixed_lens_) return;
  const StabiliserParameters& s = p_.stabiliser;
  const double sigma = std::sqrt(state_.P(block::gain, block::gain));
  const int64_t now_ns = newest().frame_ns;
  if (state_.camera.gain + s.fixed_sigmas * sigma > s.min_gain) {
    fixed_since_ns_.reset();
    return;
  }
  if (!fixed_since_ns_) fixed_since_ns_ = now_ns;
  if (seconds(now_ns - *fixed_since_ns_) < s.fixed_s) return;
  fixed_lens_ = true;
  disable_stabiliser(state_);
}

/// A lens that was assumed or calibrated badly deviates by many sigmas. Its prior is then wider than stated.
void Filter::doubt_lens() {
  const Vector3d displacement =
      newest().p_w - state_.clones.front().p_w;  // without one the scale's sigma is an old one
  if (lens_doubted_ || lens_chi2() <= p_.doubtful_chi2 || displacement.norm() < p_.min_displacement_m) return;
  lens_doubted_ = true;
  const auto weaken = [&](int i, double deviation, double& sigma) {
    state_.weaken_prior(block::lens + i, deviation, sigma, p_.doubt);
    sigma *= p_.doubt;
  };
  Priors& prior = p_.priors;
  const CameraModel &now = state_.camera.lens, &given = calibrated_.lens;
  const auto coefficient = [](const CameraModel& lens, size_t k) {
    return k < lens.coefficients.size() ? lens.coefficients[k] : 0.0;
  };
  weaken(0, std::log(now.fx / given.fx), prior.focal_relative);
  weaken(1, now.cx - given.cx, prior.centre_px[0]);
  weaken(2, now.cy - given.cy, prior.centre_px[1]);
  for (size_t k = 0; k < 2; ++k)
    weaken(3 + static_cast<int>(k), coefficient(now, k) - coefficient(given, k), prior.distortion[k]);
}

/// The noise of tracked corners depends on light, blur and compression. It is estimated from the median of the
/// normalised innovations, which is 0.7 to 0.9 of the degrees of freedom if the noise is right, by a low-pass filter in
/// the logarithm.
void Filter::update_pixel_sigma(const FrameReport& report, double dt_s) {
  const double part = 1 - std::exp(-dt_s / p_.gate_sigma_s);
  const auto towards = [&](double value, double seen) { return value * std::pow(seen / value, part); };
  if (report.nis_per_dof.size() >= p_.min_for_noise) {
    const double ratio = median(report.nis_per_dof) / kMedianNis;
    p_.gate_sigma = std::clamp(towards(p_.gate_sigma, p_.gate_sigma * std::sqrt(std::clamp(ratio, 0.01, 100.0))),
                               p_.min_gate_sigma, p_.max_pixel_sigma);
    p_.pixel_sigma = std::max(p_.gate_sigma, p_.min_pixel_sigma);
  }
  if (report.rms_px.size() >= p_.min_for_noise)
    p_.typical_residual_px = std::max(p_.min_residual_px, towards(p_.typical_residual_px, median(report.rms_px)));
}

/// Without the heading error, on which the velocity depends as well.
Matrix3d Filter::velocity_covariance() const {
  const Vector3d& v = state_.nav.v_w;
  const Vector3d with_scale =
      state_.P.block<3, 1>(block::nu, block::scale) + 0.5 * state_.P(block::scale, block::scale) * v;
  const Matrix3d cross = with_scale * v.transpose();
  return state_.P.block<3, 3>(block::nu, block::nu) + cross + cross.transpose();
}

double Filter::lens_chi2() const {
  const auto squared = [](double x) { return x * x; };
  const CameraModel &now = state_.camera.lens, &given = calibrated_.lens;
  const Priors& prior = p_.priors;
  return squared(std::log(now.fx / given.fx) / prior.focal_relative) +
         squared((now.cx - given.cx) / prior.centre_px[0]) + squared((now.cy - given.cy) / prior.centre_px[1]);
}

double Filter::calibration_chi2() const {
  const Camera& now = state_.camera;
  const CameraModel& given = calibrated_.lens;
  if (std::abs(std::log(now.lens.fx / given.fx)) > p_.max_focal_off ||
      std::hypot(now.lens.cx - given.cx, now.lens.cy - given.cy) > p_.max_centre_off * given.focal())
    return INFINITY;
  const auto squared = [](double x) { return x * x; };
  const Priors& prior = p_.priors;
  double sum = lens_chi2() + squared((now.time_offset_s - calibrated_.time_offset_s) / prior.time_offset_s);
  if (calibrated_.line_time_s > 0)
    sum += squared((now.line_time_s / calibrated_.line_time_s - 1) / prior.line_time_relative);
  return sum;
}

/// From the displacement over the window.
void Filter::update_scale_sigma() {
  const size_t last = state_.clones.size() - 1;
  const Clone &a = state_.clones.front(), &b = state_.clones[last];
  const Vector3d d = b.p_w - a.p_w;
  if (d.norm() < p_.min_displacement_m) return;  // a standing camera keeps its map and its scale uncertainty
  // d = p_b - p_a: theta_b x p_b - theta_a x p_a + rho_b - rho_a + s d; along d.
  const Vector3d u = d.normalized();
  Eigen::VectorXd J = Eigen::VectorXd::Zero(state_.size());
  J.segment<3>(state_.clone_at(0)) = -a.p_w.cross(u);
  J.segment<3>(state_.clone_at(0) + 3) = -u;
  J.segment<3>(state_.clone_at(last)) = b.p_w.cross(u);
  J.segment<3>(state_.clone_at(last) + 3) = u;
  J[block::scale] = d.norm();
  scale_sigma_ = std::sqrt(std::max(0.0, J.dot(state_.P * J))) / d.norm();
}

}  // namespace odograph::vio
