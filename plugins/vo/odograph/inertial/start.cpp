// SPDX-License-Identifier: Apache-2.0
#include "plugins/vo/odograph/inertial/start.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "plugins/vo/odograph/inertial/propagate.hpp"
#include "plugins/vo/odograph/visual/gyroscope.hpp"

namespace odograph::vio {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr size_t kLeastFrames = 6;
constexpr int kIterations = 4;
constexpr double kLeastVisualSigma = 2e-3;  // of a visual position, in its units
constexpr double kStillBiasSigma_radps = 0.005;

double seconds(int64_t ns) { return static_cast<double>(ns) * 1e-9; }

int64_t imu_time(const StartFrame& frame, const Camera& camera) {
  return frame.corners.t_ns + static_cast<int64_t>(std::llround(camera.time_offset_s * 1e9));
}

/// The newest frame that is at least so long ago.
std::optional<size_t> frame_before(const std::deque<StartFrame>& frames, double ago_s) {
  for (size_t i = frames.size(); i-- > 0;)
    if (seconds(frames.back().corners.t_ns - frames[i].corners.t_ns) > ago_s) return i;
  return std::nullopt;
}

/// Change of the velocity over a stretch by the specific force alone, in the w of the orientation at its end.
struct ForceOverTime {
  Vector3d v = Vector3d::Zero();
  double s = 0;
};
ForceOverTime force_before(int64_t end_ns, double reach_s, const Quaterniond& q_w_b_end, const Vector3d& gyro_bias,
                           const ImuBuffer& imu) {
  const auto reach_ns = static_cast<int64_t>(reach_s * 1e9);
  const int64_t from_ns = std::max(imu.oldest_ns(), end_ns - reach_ns);
  if (from_ns >= end_ns) return {};
  Quaterniond turn = Quaterniond::Identity();
  Vector3d v = Vector3d::Zero();
  const bool whole = imu.for_each(from_ns, end_ns, 60'000'000, [&](const ImuSample& a, const ImuSample& b) {
    const double dt = seconds(b.t_ns - a.t_ns);
    const Vector3d rate = 0.5 * (a.gyro_b + b.gyro_b) - gyro_bias;
    v += dt * (turn * vo::exp_rotation(0.5 * dt * rate) * (0.5 * (a.accel_b + b.accel_b)));
    turn = (turn * vo::exp_rotation(dt * rate)).normalized();
  });
  if (!whole) return {};
  return {q_w_b_end * turn.conjugate() * v, seconds(end_ns - from_ns)};
}

/// Rotation that takes `from` to the direction of `to`.
Quaterniond between(const Vector3d& from, const Vector3d& to) { return Quaterniond::FromTwoVectors(from, to); }

}  // namespace

std::optional<Alignment> align_with_imu(const std::deque<StartFrame>& frames, size_t from, const ImuBuffer& imu,
                                        const Camera& camera, const Vector3d& gyro_bias, const FilterParameters& p,
                                        const StartParameters& s) {
  const size_t count = frames.size() - from;
  if (count < kLeastFrames) return std::nullopt;
  const StartFrame& first = frames[from];
  const int64_t t0_ns = imu_time(first, camera);
  // Inertial displacement without gravity and velocity, in the visual w: also by the accelerometer's bias.
  const Quaterniond q_w_b0 = Quaterniond(first.T_w_c.linear()) * camera.q_b_c.conjugate();
  std::vector<double> t(count);
  std::vector<Vector3d> inertial(count), visual(count);
  std::vector<Matrix3d> by_bias(count);
  Quaterniond q = q_w_b0;
  Vector3d v = Vector3d::Zero(), x = Vector3d::Zero(), force_sum = Vector3d::Zero();
  Matrix3d V = Matrix3d::Zero(), X = Matrix3d::Zero();
  int64_t now_ns = t0_ns;
  for (size_t i = 0; i < count; ++i) {
    const int64_t t_ns = imu_time(frames[from + i], camera);
    const bool whole = imu.for_each(now_ns, t_ns, 60'000'000, [&](const ImuSample& a, const ImuSample& b) {
      const double dt = seconds(b.t_ns - a.t_ns);
      const Vector3d rate = 0.5 * (a.gyro_b + b.gyro_b) - gyro_bias;
      const Matrix3d R = (q * vo::exp_rotation(0.5 * dt * rate)).toRotationMatrix();
      const Vector3d force = R * (0.5 * (a.accel_b + b.accel_b));
      force_sum += dt * force;
      x += dt * v + 0.5 * dt * dt * force, v += dt * force;
      X -= dt * V + 0.5 * dt * dt * R, V += dt * R;
      q = (q * vo::exp_rotation(dt * rate)).normalized();
    });
    if (!whole) return std::nullopt;
    now_ns = t_ns;
    t[i] = seconds(t_ns - t0_ns);
    inertial[i] = x + q.toRotationMatrix() * camera.p_b_c;
    visual[i] = frames[from + i].T_w_c.translation();
    by_bias[i] = X;
  }
  // X is by minus V: the displacement that a bias of one takes away.
  const ForceOverTime earlier = force_before(t0_ns, s.history_s - t.back(), q_w_b0, gyro_bias, imu);
  const Vector3d force_s = earlier.v + v;
  const double span_s = earlier.s + t.back();
  Vector3d down = -force_sum.normalized();
  const int rows = 3 * static_cast<int>(count);
  double sigma = kLeastVisualSigma, d = 0, d_sigma = 0, rms = 0;
  Eigen::VectorXd solution;
  Alignment out;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    const Quaterniond tangent = between(Vector3d::UnitZ(), down);
    // Unknown: a, b (3 each), c across gravity (2), d, accelerometer's bias times d (3).
    MatrixXd A = MatrixXd::Zero(rows + 6, 12);
    Eigen::VectorXd z = Eigen::VectorXd::Zero(rows + 6);
    for (size_t i = 0; i < count; ++i) {
      const int row = 3 * static_cast<int>(i);
      const double half = 0.5 * t[i] * t[i];
      A.block<3, 3>(row, 0).setIdentity();
      A.block<3, 3>(row, 3) = t[i] * Matrix3d::Identity();
      A.block<3, 1>(row, 6) = half * (tangent * Vector3d::UnitX());
      A.block<3, 1>(row, 7) = half * (tangent * Vector3d::UnitY());
      A.block<3, 1>(row, 8) = inertial[i] + half * p.gravity_mps2 * down;
      A.block<3, 3>(row, 9) = by_bias[i];
      z.segment<3>(row) = visual[i];
    }
    A.topRows(rows) /= sigma, z.head(rows) /= sigma;
    const double bias_sigma = p.priors.accel_bias_mps2 * (d > 0 ? d : 1.0);
    A.block<3, 3>(rows, 9) = Matrix3d::Identity() / bias_sigma;
    // What gravity leaves of the force changes the velocity, which for a hand does not change by much.
    const double change_sigma = s.velocity_change_mps * (d > 0 ? d : 1.0);
    A.block<3, 1>(rows + 3, 6) = span_s / change_sigma * (tangent * Vector3d::UnitX());
    A.block<3, 1>(rows + 3, 7) = span_s / change_sigma * (tangent * Vector3d::UnitY());
    A.block<3, 1>(rows + 3, 8) = (force_s + span_s * p.gravity_mps2 * down) / change_sigma;
    const Eigen::LDLT<MatrixXd> normal(A.transpose() * A);
    solution = normal.solve(A.transpose() * z);
    d = solution[8];
    if (!(d > 0) || !solution.allFinite()) return std::nullopt;
    const double left = (A * solution - z).head(rows).squaredNorm();
    rms = sigma * std::sqrt(left / rows);
    sigma = std::max(kLeastVisualSigma, sigma * std::sqrt(left / std::max(1, rows - 9)));
    const auto variance = [&](int i) { return std::max(0.0, normal.solve(Eigen::VectorXd::Unit(12, i))[i]); };
    d_sigma = std::sqrt(variance(8));
    out.tilt_rad = std::sqrt(std::max(variance(6), variance(7))) / (d * p.gravity_mps2);
    const Vector3d c = d * p.gravity_mps2 * down + tangent * Vector3d(solution[6], solution[7], 0);
    down = c.normalized();
  }
  out.metres_per_unit = 1 / d;
  out.relative_sigma = d_sigma / d;
  out.rms_m = rms / d;
  const Quaterniond level = between(down, Vector3d::UnitZ());
  out.nav.q_w_b = (level * q_w_b0).normalized();
  out.nav.v_w = level * (solution.segment<3>(3) / d);
  out.nav.accel_bias = solution.segment<3>(9) / d;
  out.nav.gyro_bias = gyro_bias;
  return out;
}

std::optional<Filter> start_still(const std::deque<StartFrame>& frames, const ImuBuffer& imu, const Camera& camera,
                                  const FilterParameters& p, const StartParameters& s) {
  const auto before = frame_before(frames, s.still_s);
  if (!before) return std::nullopt;
  const size_t from = *before;
  const StartFrame& last = frames.back();
  const int64_t t0_ns = imu_time(frames[from], camera), t1_ns = imu_time(last, camera);
  Vector3d force = Vector3d::Zero(), force_squares = Vector3d::Zero(), rate = Vector3d::Zero();
  double rate_squares = 0;
  int n = 0;
  const bool whole = imu.for_each(t0_ns, t1_ns, 60'000'000, [&](const ImuSample& a, const ImuSample&) {
    force += a.accel_b, force_squares += a.accel_b.cwiseAbs2(), rate += a.gyro_b, ++n;
    rate_squares += a.gyro_b.squaredNorm();
  });
  if (!whole || n < 10) return std::nullopt;
  force /= n, rate /= n;
  const double variance = (force_squares / n - force.cwiseAbs2()).sum();
  if (variance > p.stand.most_force_variance(p.noise, n / seconds(t1_ns - t0_ns)) ||
      std::abs(force.norm() - p.gravity_mps2) > 3 * p.priors.accel_bias_mps2)
    return std::nullopt;
  if (p.stand.arm_m * std::sqrt(rate_squares / n) > s.still_arm_mps) return std::nullopt;
  const auto flow_px = flow_beside_rotation(frames[from].corners, last.corners, camera, p.stand.least_corners);
  if (!flow_px || *flow_px > s.still_px) return std::nullopt;
  Filter::Start start;
  start.t_ns = t0_ns;
  // Specific force at rest is minus gravity.
  start.nav.q_w_b = between(force, -Vector3d::UnitZ());
  const bool steady = std::sqrt(rate_squares / n) < s.still_rate_radps;
  if (steady) start.nav.gyro_bias = rate;
  start.tilt_rad = p.priors.tilt_rad,
  start.velocity_mps = std::hypot(p.priors.velocity_mps, p.stand.arm_m * std::sqrt(rate_squares / n));
  start.gyro_bias_radps = steady ? kStillBiasSigma_radps : p.priors.gyro_bias_radps;
  start.accel_bias_mps2 = p.priors.accel_bias_mps2;
  Filter filter(p, camera, start);
  for (size_t i = from; i < frames.size(); ++i) filter.process(frames[i].corners, imu);
  return filter;
}

std::optional<Filter> start_moving(const std::deque<StartFrame>& frames, const ImuBuffer& imu, const Camera& camera,
                                   const Vector3d& gyro_bias, const FilterParameters& p, const StartParameters& s) {
  const StartFrame& last = frames.back();
  size_t from = frames.size();
  while (from > 0 && frames[from - 1].posed && frames[from - 1].group == last.group &&
         seconds(last.corners.t_ns - frames[from - 1].corners.t_ns) <= s.most_s)
    --from;
  if (from == frames.size() || seconds(last.corners.t_ns - frames[from].corners.t_ns) < s.least_s) return std::nullopt;
  // Without parallax there is no way to compare with the accelerometer's: a camera that stands fits any metre.
  const auto flow_px = flow_beside_rotation(frames[from].corners, last.corners, camera, p.stand.least_corners);
  if (flow_px && *flow_px < s.least_flow_px) return std::nullopt;
  const auto alignment = align_with_imu(frames, from, imu, camera, gyro_bias, p, s);
  if (!alignment || alignment->rms_m > s.most_rms_m || alignment->relative_sigma > s.alignment_sigma ||
      alignment->nav.accel_bias.norm() > s.most_accel_bias_mps2)
    return std::nullopt;
  Filter::Start start;
  start.t_ns = imu_time(frames[from], camera);
  start.nav = alignment->nav;
  start.nav.accel_bias.setZero();
  start.tilt_rad = std::hypot(p.priors.tilt_rad, alignment->tilt_rad);
  start.velocity_mps = 0.15 + 2 * alignment->relative_sigma * alignment->nav.v_w.norm();
  start.gyro_bias_radps = 0.5 * p.priors.gyro_bias_radps;
  start.accel_bias_mps2 = p.priors.accel_bias_mps2;
  Camera seen = camera;
  for (int pass = 0; pass < s.passes; ++pass) {
    Filter filter(p, seen, start);
    int accepted = 0;
    for (size_t i = from; i < frames.size(); ++i) accepted += filter.process(frames[i].corners, imu).accepted;
    const Navigation& end = filter.state().nav;
    if (!end.v_w.allFinite() || end.accel_bias.norm() > s.most_accel_bias_mps2) return std::nullopt;
    if (pass + 1 == s.passes) {
      if (accepted == 0 || filter.gate_sigma() > s.most_gate_px || filter.scale_sigma() > s.scale_sigma ||
          filter.camera_pull() > s.most_camera_pull)
        return std::nullopt;
      return filter;
    }
    // The end's estimate, carried back to the beginning, is where the next pass linearises.
    Navigation begin = end;
    if (!integrate(begin, filter.state().t_ns, start.t_ns, imu, p.gravity_mps2)) return std::nullopt;
    begin.p_w.setZero();
    begin.accel_bias.setZero();  // the prior's: the equations are linear in it
    begin.gyro_axes.setIdentity(), begin.accel_axes.setIdentity();
    start.nav = begin;
  }
  return std::nullopt;
}

}  // namespace odograph::vio
