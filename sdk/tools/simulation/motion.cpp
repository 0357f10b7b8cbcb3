// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/simulation/motion.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "sdk/math/gravity.hpp"
#include "sdk/math/rotation.hpp"

namespace odograph {
namespace {

/// Weights of the degree + 1 control points at fraction x of an interval (Cox & de Boor, uniform).
template <int degree>
std::array<double, degree + 1> weights(double x) {
  std::array<double, degree + 1> w{1.0};
  for (int k = 1; k <= degree; ++k)
    for (int j = k; j >= 0; --j) {
      const double older = j > 0 ? w[static_cast<size_t>(j - 1)] : 0.0, same = j < k ? w[static_cast<size_t>(j)] : 0.0;
      w[static_cast<size_t>(j)] = ((x + k - j) * older + (1 + j - x) * same) / k;
    }
  return w;
}

}  // namespace

Eigen::Vector3d Motion::State::specific_force_b() const {
  return T_n_b.linear().transpose() * (acceleration_n - Eigen::Vector3d(0, 0, kStandardGravity_mps2));
}

Motion::Motion(double rate_hz, std::vector<Eigen::Vector3d> p_n, std::vector<Eigen::Quaterniond> q_n_b)
    : rate_hz_(rate_hz), count_(p_n.size()), p_(std::move(p_n)), q_(std::move(q_n_b)) {
  // The motion goes on evenly beyond both ends: a stop there would be an acceleration of the first and last samples.
  const size_t n = p_.size(), near = std::min<size_t>(1, n - 1);
  std::vector<Eigen::Vector3d> before, after;
  std::vector<Eigen::Quaterniond> turned_before, turned_after;
  for (long k = 1; k <= kBeyond; ++k) {
    before.insert(before.begin(), p_[0] + static_cast<double>(k) * (p_[0] - p_[near]));
    after.push_back(p_[n - 1] + static_cast<double>(k) * (p_[n - 1] - p_[n - 1 - near]));
    turned_before.insert(turned_before.begin(),
                         q_[0] * exp_rotation(static_cast<double>(k) * log_rotation(q_[near].conjugate() * q_[0])));
    turned_after.push_back(
        q_[n - 1] * exp_rotation(static_cast<double>(k) * log_rotation(q_[n - 1 - near].conjugate() * q_[n - 1])));
  }
  p_.insert(p_.begin(), before.begin(), before.end()), p_.insert(p_.end(), after.begin(), after.end());
  q_.insert(q_.begin(), turned_before.begin(), turned_before.end());
  q_.insert(q_.end(), turned_after.begin(), turned_after.end());
}

double Motion::duration_s() const { return count_ == 0 ? 0.0 : static_cast<double>(count_ - 1) / rate_hz_; }

size_t Motion::index(long i) const {
  return static_cast<size_t>(std::clamp(i + kBeyond, 0L, static_cast<long>(p_.size()) - 1));
}

Motion::State Motion::at(double t_s) const {
  const double u = t_s * rate_hz_, whole = std::floor(u), x = u - whole;
  const auto i = static_cast<long>(std::clamp(whole, -1e9, 1e9));
  State s;
  // Differences are relative to the nearest control point, to keep precision far from the origin.
  const Eigen::Vector3d base = p_[index(i)];
  std::array<Eigen::Vector3d, 6> c;
  for (long j = 0; j < 6; ++j) c[static_cast<size_t>(j)] = p_[index(i - 2 + j)] - base;
  const auto w5 = weights<5>(x);
  const auto w4 = weights<4>(x);
  const auto w3 = weights<3>(x);
  Eigen::Vector3d p = Eigen::Vector3d::Zero(), v = p, a = p;
  for (size_t j = 0; j < 6; ++j) p += w5[j] * c[j];
  for (size_t j = 0; j < 5; ++j) v += w4[j] * (c[j + 1] - c[j]);
  for (size_t j = 0; j < 4; ++j) a += w3[j] * (c[j + 2] - 2 * c[j + 1] + c[j]);
  s.velocity_n = rate_hz_ * v;
  s.acceleration_n = rate_hz_ * rate_hz_ * a;

  const auto w2 = weights<2>(x);
  Eigen::Quaterniond q = q_[index(i - 1)];
  Eigen::Vector3d omega = Eigen::Vector3d::Zero();
  double tail = 1.0;
  for (size_t j = 1; j <= 3; ++j) {
    tail -= w3[j - 1];
    const auto k = static_cast<long>(j);
    const Eigen::Vector3d d = log_rotation(q_[index(i - 2 + k)].conjugate() * q_[index(i - 1 + k)]);
    const Eigen::Quaterniond rotation = exp_rotation(tail * d);
    omega = rotation.conjugate() * omega + rate_hz_ * w2[j - 1] * d;
    q = q * rotation;
  }
  s.angular_velocity_b = omega;
  s.T_n_b.setIdentity();
  s.T_n_b.linear() = q.normalized().toRotationMatrix();
  s.T_n_b.translation() = base + p;
  return s;
}

}  // namespace odograph
