// SPDX-License-Identifier: Apache-2.0
#include "plugins/vo/odograph/inertial/start.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "plugins/vo/odograph/inertial/propagate.hpp"
#include "sdk/math/rotation.hpp"
#include "sdk/math/rotation_integral.hpp"

namespace odograph::vio {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Quaterniond;
using Eigen::Vector3d;

int64_t imu_time(const StartFrame& frame, const Camera& camera) {
  return frame.corners.t_ns + nanoseconds(camera.time_offset_s);
}

/// The newest frame that is at least `ago_s` old.
std::optional<size_t> frame_before(const std::deque<StartFrame>& frames, double ago_s) {
  for (size_t i = frames.size(); i-- > 0;)
    if (seconds(frames.back().corners.t_ns - frames[i].corners.t_ns) > ago_s) return i;
  return std::nullopt;
}

/// Velocity change over a segment from the specific force alone, in the w defined by the orientation at its end.
struct ForceOverTime {
  Vector3d v = Vector3d::Zero();
  double s = 0;
};
ForceOverTime force_before(int64_t end_ns, double reach_s, const Quaterniond& q_w_b_end, const Vector3d& gyro_bias,
                           const ImuBuffer& imu) {
  const auto reach_ns = nanoseconds(reach_s);
  const int64_t from_ns = std::max(imu.oldest_ns(), end_ns - reach_ns);
  if (from_ns >= end_ns) return {};
  Quaterniond q = Quaterniond::Identity();
  Vector3d v = Vector3d::Zero();
  const bool whole =
      imu.for_each(from_ns, end_ns, ImuBuffer::kLongestGap_ns, [&](const ImuSample& a, const ImuSample& b) {
        const double dt = seconds(b.t_ns - a.t_ns);
        const Vector3d rate = 0.5 * (a.gyro_b + b.gyro_b) - gyro_bias;
        v += dt * (rotate_body(q, dt * rate) * (0.5 * (a.accel_b + b.accel_b)));
      });
  if (!whole) return {};
  return {q_w_b_end * q.conjugate() * v, seconds(end_ns - from_ns)};
}

/// Inertial and visual positions of the camera at each frame, in the visual odometry's w.
struct Displacements {
  std::vector<double> t_s;                                      ///< since the first frame
  std::vector<Vector3d> inertial;                               ///< m, without gravity and initial velocity
  std::vector<Matrix3d> by_bias;                                ///< derivative by the accelerometer bias
  std::vector<Vector3d> visual;                                 ///< in the map's scale
  Vector3d force_sum = Vector3d::Zero(), v = Vector3d::Zero();  ///< integral of the specific force, m/s
};
/// Nothing if samples are missing.
std::optional<Displacements> displacements(const std::deque<StartFrame>& frames, size_t from, const ImuBuffer& imu,
                                           const Camera& camera, const Quaterniond& q_w_b0, const Vector3d& gyro_bias) {
  Displacements out;
  Quaterniond q = q_w_b0;
  Vector3d x = Vector3d::Zero();
  Matrix3d V = Matrix3d::Zero(), X = Matrix3d::Zero();
  const int64_t t0_ns = imu_time(frames[from], camera);
  int64_t now_ns = t0_ns;
  for (size_t i = from; i < frames.size(); ++i) {
    const int64_t t_ns = imu_time(frames[i], camera);
    const bool whole =
        imu.for_each(now_ns, t_ns, ImuBuffer::kLongestGap_ns, [&](const ImuSample& a, const ImuSample& b) {
          const double dt = seconds(b.t_ns - a.t_ns);
          const Vector3d rate = 0.5 * (a.gyro_b + b.gyro_b) - gyro_bias;
          const Matrix3d R = rotate_body(q, dt * rate);
          const Vector3d force = R * (0.5 * (a.accel_b + b.accel_b));
          out.force_sum += dt * force;
          x += dt * out.v + 0.5 * dt * dt * force, out.v += dt * force;
          X -= dt * V + 0.5 * dt * dt * R, V += dt * R;
        });
    if (!whole) return std::nullopt;
    now_ns = t_ns;
    out.t_s.push_back(seconds(t_ns - t0_ns));
    out.inertial.push_back(x + q.toRotationMatrix() * camera.p_b_c);
    out.visual.push_back(frames[i].T_w_c.translation());
    out.by_bias.push_back(X);
  }
  return out;
}

/// Linearisation point of the alignment.
struct AlignmentPoint {
  Vector3d down;        ///< direction of gravity in w
  double d = 1;         ///< length in the map per metre; one before it is known
  double visual_sigma;  ///< of a visual position
};
/// A x = z, weighted by the standard deviations. Unknowns: a, b (3 each), c across gravity (2), d, accelerometer bias
/// times d (3). The last six rows are priors: on the bias, and on the change of velocity over `span_s`.
struct AlignmentEquations {
  MatrixXd A;
  Eigen::VectorXd z;
};
AlignmentEquations alignment_equations(const Displacements& x, const ForceOverTime& force, const AlignmentPoint& at,
                                       const FilterParameters& p, const StartParameters& s) {
  const int rows = 3 * static_cast<int>(x.t_s.size());
  const Quaterniond tangent = shortest_rotation(Vector3d::UnitZ(), at.down);
  AlignmentEquations e{MatrixXd::Zero(rows + 6, 12), Eigen::VectorXd::Zero(rows + 6)};
  MatrixXd& A = e.A;
  for (size_t i = 0; i < x.t_s.size(); ++i) {
    const int row = 3 * static_cast<int>(i);
    const double half = 0.5 * x.t_s[i] * x.t_s[i];
    A.block<3, 3>(row, 0).setIdentity();
    A.block<3, 3>(row, 3) = x.t_s[i] * Matrix3d::Identity();
    A.block<3, 1>(row, 6) = half * (tangent * Vector3d::UnitX());
    A.block<3, 1>(row, 7) = half * (tangent * Vector3d::UnitY());
    A.block<3, 1>(row, 8) = x.inertial[i] + half * p.gravity_mps2 * at.down;
    A.block<3, 3>(row, 9) = x.by_bias[i];
    e.z.segment<3>(row) = x.visual[i];
  }
  A.topRows(rows) /= at.visual_sigma, e.z.head(rows) /= at.visual_sigma;
  const double bias_sigma = p.priors.accel_bias_mps2 * at.d;
  A.block<3, 3>(rows, 9) = Matrix3d::Identity() / bias_sigma;
  // Specific force minus gravity is the change of velocity, which is small for a hand-held phone.
  const double change_sigma = s.velocity_change_mps * at.d;
  A.block<3, 1>(rows + 3, 6) = force.s / change_sigma * (tangent * Vector3d::UnitX());
  A.block<3, 1>(rows + 3, 7) = force.s / change_sigma * (tangent * Vector3d::UnitY());
  A.block<3, 1>(rows + 3, 8) = (force.v + force.s * p.gravity_mps2 * at.down) / change_sigma;
  return e;
}

}  // namespace

std::optional<Alignment> align_with_imu(const std::deque<StartFrame>& frames, size_t from, const ImuBuffer& imu,
                                        const Camera& camera, const Vector3d& gyro_bias, const FilterParameters& p,
                                        const StartParameters& s) {
  if (frames.size() - from < s.min_frames) return std::nullopt;
  const StartFrame& first = frames[from];
  const Quaterniond q_w_b0 = Quaterniond(first.T_w_c.linear()) * camera.q_b_c.conjugate();
  const auto x = displacements(frames, from, imu, camera, q_w_b0, gyro_bias);
  if (!x) return std::nullopt;
  ForceOverTime force = force_before(imu_time(first, camera), s.history_s - x->t_s.back(), q_w_b0, gyro_bias, imu);
  force.v = force.v + x->v, force.s = force.s + x->t_s.back();
  const int rows = 3 * static_cast<int>(x->t_s.size());
  AlignmentPoint at{-x->force_sum.normalized(), 1, s.min_visual_sigma};
  Eigen::VectorXd solution;
  Alignment out;
  for (int iteration = 0; iteration < s.alignment_iterations; ++iteration) {
    const auto [A, z] = alignment_equations(*x, force, at, p, s);
    const MatrixXd information = A.transpose() * A;
    const Eigen::VectorXd right = A.transpose() * z;
    const Eigen::LDLT<MatrixXd> normal(information);
    solution = normal.solve(right);
    const double d = solution[8];
    if (!(d > 0) || !solution.allFinite()) return std::nullopt;
    const double left = (A * solution - z).head(rows).squaredNorm();
    const auto variance = [&](int i) {
      const Eigen::VectorXd unit = Eigen::VectorXd::Unit(12, i), column = normal.solve(unit);
      return std::max(0.0, column[i]);
    };
    out.scale = 1 / d;
    out.relative_sigma = std::sqrt(variance(8)) / d;
    out.tilt_rad = std::sqrt(std::max(variance(6), variance(7))) / (d * p.gravity_mps2);
    out.rms_m = at.visual_sigma * std::sqrt(left / rows) / d;
    const Quaterniond tangent = shortest_rotation(Vector3d::UnitZ(), at.down);
    const Vector3d c = d * p.gravity_mps2 * at.down + tangent * Vector3d(solution[6], solution[7], 0);
    at.visual_sigma = std::max(s.min_visual_sigma, at.visual_sigma * std::sqrt(left / std::max(1, rows - 9)));
    at.down = c.normalized(), at.d = d;
  }
  const Quaterniond to_gravity = shortest_rotation(at.down, Vector3d::UnitZ());
  out.nav.q_w_b = (to_gravity * q_w_b0).normalized();
  out.nav.v_w = to_gravity * (solution.segment<3>(3) / at.d);
  out.nav.accel_bias = solution.segment<3>(9) / at.d;
  out.nav.gyro_bias = gyro_bias;
  return out;
}

namespace {

/// IMU statistics of a body that may be at rest.
struct Rest {
  Vector3d force_b = Vector3d::Zero();  ///< mean, in the initial body axes
  Vector3d rate_b = Vector3d::Zero();   ///< mean
  double force_variance = 0;            ///< sum of the three axes, (m/s^2)^2
  double rate_rms = 0;
  int n = 0;
  bool steady = false;  ///< the mean rate is the gyro bias
};
std::optional<Rest> rest_between(int64_t t0_ns, int64_t t1_ns, const ImuBuffer& imu, const StartParameters& s) {
  Rest rest;
  Vector3d sum = Vector3d::Zero(), squares = Vector3d::Zero();
  double rate_squares = 0;
  const bool whole = imu.for_each(t0_ns, t1_ns, ImuBuffer::kLongestGap_ns, [&](const ImuSample& a, const ImuSample&) {
    sum += a.accel_b, squares += a.accel_b.cwiseAbs2(), rest.rate_b += a.gyro_b, ++rest.n;
    rate_squares += a.gyro_b.squaredNorm();
  });
  if (!whole || rest.n < s.still_samples) return std::nullopt;
  rest.rate_b /= rest.n, rest.rate_rms = std::sqrt(rate_squares / rest.n);
  rest.force_variance = (squares / rest.n - (sum / rest.n).cwiseAbs2()).sum();
  rest.steady = rest.rate_rms < s.still_rate_radps;
  const Vector3d bias = rest.steady ? rest.rate_b : Vector3d::Zero();
  Quaterniond q = Quaterniond::Identity();
  imu.for_each(t0_ns, t1_ns, ImuBuffer::kLongestGap_ns, [&](const ImuSample& a, const ImuSample& b) {
    const double dt = seconds(b.t_ns - a.t_ns);
    const Matrix3d R = rotate_body(q, dt * (0.5 * (a.gyro_b + b.gyro_b) - bias));
    rest.force_b += dt * (R * (0.5 * (a.accel_b + b.accel_b)));
  });
  rest.force_b /= seconds(t1_ns - t0_ns);
  return rest;
}

/// True if a pure rotation relates the newest picture to each of the sampled ones.
bool only_rotates(const std::deque<StartFrame>& frames, size_t from, const Camera& camera, const FilterParameters& p,
                  const StartParameters& s) {
  const size_t last = frames.size() - 1, step = std::max<size_t>(1, (last - from) / static_cast<size_t>(s.still_looks));
  for (size_t i = from; i < last; i += step) {
    const auto flow_px = residual_flow(frames[i].corners, frames[last].corners, camera, p.stand.min_corners);
    if (!flow_px || *flow_px > s.still_px) return false;
  }
  return true;
}

}  // namespace

std::optional<Filter> start_still(const std::deque<StartFrame>& frames, const ImuBuffer& imu, const Camera& camera,
                                  const FilterParameters& p, const StartParameters& s) {
  const auto before = frame_before(frames, s.still_s);
  if (!before) return std::nullopt;
  const size_t from = *before;
  const int64_t t0_ns = imu_time(frames[from], camera), t1_ns = imu_time(frames.back(), camera);
  const auto rest = rest_between(t0_ns, t1_ns, imu, s);
  if (!rest) return std::nullopt;
  const double duration_s = seconds(t1_ns - t0_ns), carried_mps = p.stand.arm_m * rest->rate_rms;
  if (rest->force_variance > p.stand.max_force_variance(p.noise, rest->n / duration_s) ||
      std::abs(rest->force_b.norm() - p.gravity_mps2) > s.still_gravity_sigmas * p.priors.accel_bias_mps2 ||
      carried_mps > s.still_arm_mps || !only_rotates(frames, from, camera, p, s))
    return std::nullopt;
  Filter::Start start;
  start.t_ns = t0_ns;
  // Specific force at rest is minus gravity.
  start.nav.q_w_b = shortest_rotation(rest->force_b, -Vector3d::UnitZ());
  if (rest->steady) start.nav.gyro_bias = rest->rate_b;
  start.velocity_mps = std::hypot(p.priors.velocity_mps, carried_mps);
  start.scale = s.alignment_sigma;
  start.gyro_bias_radps = rest->steady ? s.still_bias_sigma_radps : p.priors.gyro_bias_radps;
  start.accel_bias_mps2 = p.priors.accel_bias_mps2;
  // From the possible change of velocity, and the error of gravity by the accelerometer's scale.
  start.tilt_rad = s.still_tilt_rad;
  start.rest_force_b = rest->force_b;
  start.rest_force_mps2 = std::hypot(M_SQRT2 * start.velocity_mps / duration_s, p.priors.accel_scale * p.gravity_mps2);
  Filter filter(p, camera, start);
  for (size_t i = from; i < frames.size(); ++i) filter.process(frames[i].corners, imu);
  return filter;
}

std::optional<Filter> start_moving(const std::deque<StartFrame>& frames, const ImuBuffer& imu, const Camera& camera,
                                   const Vector3d& gyro_bias, const FilterParameters& p, const StartParameters& s) {
  const StartFrame& last = frames.back();
  size_t from = frames.size();
  while (from > 0 && frames[from - 1].posed && frames[from - 1].group == last.group &&
         seconds(last.corners.t_ns - frames[from - 1].corners.t_ns) <= s.max_s)
    --from;
  if (from == frames.size() || seconds(last.corners.t_ns - frames[from].corners.t_ns) < s.min_s) return std::nullopt;
  // Without parallax there is no displacement to align: a standing camera fits any scale.
  const auto flow_px = residual_flow(frames[from].corners, last.corners, camera, p.stand.min_corners);
  if (flow_px && *flow_px < s.min_flow_px) return std::nullopt;
  const auto alignment = align_with_imu(frames, from, imu, camera, gyro_bias, p, s);
  if (!alignment || alignment->rms_m > s.max_rms_m || alignment->relative_sigma > s.alignment_sigma ||
      alignment->nav.accel_bias.norm() > s.max_bias_sigmas * p.priors.accel_bias_mps2)
    return std::nullopt;
  Filter::Start start;
  start.t_ns = imu_time(frames[from], camera);
  start.nav = alignment->nav;
  start.nav.accel_bias.setZero();
  start.tilt_rad = std::hypot(p.priors.tilt_rad, alignment->tilt_rad);
  start.velocity_mps = s.velocity_sigma_mps;
  start.scale = s.alignment_sigma;
  start.gyro_bias_radps = 0.5 * p.priors.gyro_bias_radps;
  start.accel_bias_mps2 = p.priors.accel_bias_mps2;
  for (int pass = 0; pass < s.passes; ++pass) {
    Filter filter(p, camera, start);
    int accepted = 0, tried = 0;
    for (size_t i = from; i < frames.size(); ++i) {
      const FrameReport report = filter.process(frames[i].corners, imu);
      accepted += report.accepted, tried += report.tried;
    }
    const Navigation& end = filter.state().nav;
    if (!end.v_w.allFinite() || end.accel_bias.norm() > s.max_bias_sigmas * p.priors.accel_bias_mps2)
      return std::nullopt;
    if (pass + 1 == s.passes) {
      if (accepted == 0 || accepted < s.min_fit * tried || filter.gate_sigma() > s.max_gate_px ||
          filter.scale_sigma() > s.scale_sigma || filter.calibration_chi2() > s.max_calibration_chi2)
        return std::nullopt;
      return filter;
    }
    // The next pass linearises about the final estimate, propagated back to the start.
    Navigation begin = end;
    if (!integrate(begin, filter.state().t_ns, start.t_ns, imu, p.gravity_mps2)) return std::nullopt;
    begin.p_w.setZero();
    begin.accel_bias.setZero();  // as the prior: the equations are linear in it
    begin.gyro_axes.setIdentity(), begin.accel_axes.setIdentity();
    start.nav = begin;
  }
  return std::nullopt;
}

bool StartEvidence::add(std::optional<double> ratio, int64_t t_ns, const StartParameters& s) {
  while (!contradicted_ns_.empty() && seconds(t_ns - contradicted_ns_.front()) > s.max_s) contradicted_ns_.pop_front();
  if (ratio) {
    sum_ += std::log(*ratio);
    lowest_ = std::min(lowest_, sum_), highest_ = std::max(highest_, sum_);
    if (spread() < s.max_spread) return ++agreeing_ >= s.confirmations + static_cast<int>(contradicted_ns_.size());
    contradicted_ns_.push_back(t_ns);
  }
  agreeing_ = 0, sum_ = lowest_ = highest_ = 0;
  return false;
}

std::optional<double> scale_between(const State& first, const State& second, double min_path_m) {
  double of_first = 0, of_second = 0;
  const Clone *a0 = nullptr, *b0 = nullptr;
  for (const Clone& a : first.clones) {
    const auto b = std::find_if(second.clones.begin(), second.clones.end(),
                                [&](const Clone& c) { return c.frame_ns == a.frame_ns; });
    if (b == second.clones.end()) continue;
    if (a0) of_first += (a.p_w - a0->p_w).norm(), of_second += (b->p_w - b0->p_w).norm();
    a0 = &a, b0 = &*b;
  }
  if (of_first < min_path_m || of_second < min_path_m) return std::nullopt;
  return of_second / of_first;
}

}  // namespace odograph::vio
