// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/simulation/sensors.hpp"

#include <algorithm>
#include <cmath>

#include "sdk/math/atmosphere.hpp"
#include "sdk/math/gravity.hpp"

namespace odograph {
namespace {

using Eigen::Vector3d;

Vector3d normal3(Random& random, double sigma) {
  const double z = random.normal(), y = random.normal(), x = random.normal();
  return sigma * Vector3d(x, y, z);
}

Eigen::Matrix3d normal33(Random& random, double sigma) {
  Eigen::Matrix3d m;
  for (int i = 0; i < 3; ++i) m.row(i) = normal3(random, sigma).transpose();
  return m;
}

/// One step of a first-order Gauss-Markov process of unit variance.
double gauss_markov(double value, double dt_s, double constant_s, Random& random) {
  const double keep = std::exp(-dt_s / constant_s);
  return keep * value + std::sqrt(1 - keep * keep) * random.normal();
}

}  // namespace

SimTriad::SimTriad(Random random, const Errors& errors, double rate_hz)
    : random_(random), e_(errors), rate_hz_(rate_hz) {
  distortion_ = Eigen::Matrix3d::Identity() + normal33(random_, e_.misalignment);
  for (int i = 0; i < 3; ++i) distortion_(i, i) = 1 + e_.scale * random_.normal();
  bias_ = normal3(random_, e_.bias);
}

Vector3d SimTriad::measure(const Vector3d& truth) {
  bias_ += normal3(random_, e_.walk / std::sqrt(rate_hz_));
  Vector3d m = distortion_ * truth + bias_ + normal3(random_, e_.noise * std::sqrt(rate_hz_));
  for (double& x : m) {
    x = std::clamp(x, -e_.range, e_.range);
    if (e_.step > 0) x = e_.step * std::round(x / e_.step);
  }
  return m;
}

SimGyroErrors::SimGyroErrors(const Scenario::Imu& c, uint64_t seed) {
  Random random(seed, 84);
  per_kelvin_ = normal3(random, c.gyro_warming);
  per_force_ = normal33(random, c.gyro_by_g / kStandardGravity_mps2);
}

Vector3d SimGyroErrors::at(double t, const Vector3d& force) const {
  constexpr double kWarming_K = 10, kWarming_s = 300;
  return kWarming_K * (1 - std::exp(-t / kWarming_s)) * per_kelvin_ + per_force_ * force;
}

SimStamps::SimStamps(const Scenario::Imu& c, uint64_t seed) : c_(c), random_(seed, 85) {
  stall_s_ = c_.gap_s > 0 ? -c_.gap_interval_s * std::log(1 - random_.uniform()) : 1e300;
}

double SimStamps::of(double t) {
  if (c_.jitter_s <= 0 && c_.gap_s <= 0) return t;
  constexpr double kBurst_s = 0.2e-3;  // spacing of samples that arrive at once
  if (t >= stall_s_) {
    stall_end_s_ = stall_s_ + random_.uniform(0.3, 1) * c_.gap_s;
    stall_s_ = stall_end_s_ - c_.gap_interval_s * std::log(1 - random_.uniform());
  }
  const double stamp = t < stall_end_s_ ? stall_end_s_ : t + c_.jitter_s * random_.normal();
  return last_s_ = std::max(stamp, last_s_ + kBurst_s);
}

SimOutliers::SimOutliers(const Scenario::Imu& c, uint64_t seed) : c_(c), random_(seed, 86) {
  if (c_.outlier_interval_s > 0) draw_next(0);
}

void SimOutliers::draw_next(double after_s) {
  next_s_ = after_s - c_.outlier_interval_s * std::log(1 - random_.uniform());
}

void SimOutliers::apply(double t, Vector3d& gyro, Vector3d& accel) {
  if (t < next_s_) return;
  const bool outside = count_++ % 2 == 0;  // far outside the range
  const double part = outside ? 1e3 : 0.9;
  const auto axis = static_cast<int>(random_.next() % 3);
  const double sign = random_.uniform() < 0.5 ? -1 : 1;
  if (random_.uniform() < 0.5)
    gyro[axis] = sign * part * c_.gyro_range;
  else
    accel[axis] = sign * part * c_.accel_range;
  draw_next(t);
}

SimMagnetometer::SimMagnetometer(const Scenario::Magnetometer& m, uint64_t seed) : c_(m), random_(seed, 80) {
  soft_ = Eigen::Matrix3d::Identity() + normal33(random_, c_.soft_iron);
  hard_ = normal3(random_, c_.hard_iron);
  for (int k = 0; k < 8; ++k) {
    const double length = random_.uniform(4, 25);
    waves_.push_back({normal3(random_, 1).normalized() * 6.283185307179586 / length,
                      normal3(random_, c_.disturbance * std::sqrt(2.0 / 8)), random_.uniform(0, 6.283185307179586)});
  }
}

Vector3d SimMagnetometer::field_n(const Vector3d& p) const {
  Vector3d field(21e-6, 0.0, 43e-6);  // central Europe; magnetic north is the north of n
  for (const Wave& w : waves_) field += w.amplitude * std::sin(w.direction.dot(p) + w.phase);
  return field;
}

Vector3d SimMagnetometer::measure(const Eigen::Isometry3d& T) {
  return soft_ * (T.linear().transpose() * field_n(T.translation())) + hard_ + normal3(random_, c_.noise);
}

SimBarometer::SimBarometer(const Scenario::Barometer& b, uint64_t seed) : c_(b), random_(seed, 81) {}

double SimBarometer::measure(double up) {
  drift_ += c_.drift_pa / 60 * random_.normal();  // a random walk reaches its sigma after 3600 steps
  wind_ = gauss_markov(wind_, 1, 4, random_);
  return pressure_at_pa(up) + drift_ + c_.wind_pa * wind_ + c_.noise_pa * random_.normal();
}

SimGnss::SimGnss(const Scenario& scenario, uint64_t seed)
    : c_(scenario.gnss),
      indoors_(scenario.is_indoors()),
      random_(seed, 82),
      error_(normal3(random_, 1)),
      narrow_(random_.normal()) {}

SimGnss::Fix SimGnss::measure(const Vector3d& p) {
  for (double& e : error_) e = gauss_markov(e, 1, c_.correlation_s, random_);
  narrow_ = gauss_markov(narrow_, 1, 40, random_);
  const double hidden = 0.5 + 0.5 * std::erf(narrow_ / std::sqrt(2.0));  // uniform between 0 and 1
  const double sigma = c_.sigma_m * std::pow(c_.canyon_sigma_m / c_.sigma_m, hidden);
  // Outages last 12 s on average; their rate follows from the availability.
  const double out = 1 / 12.0, in = out * (1 - c_.availability) / std::max(1e-6, c_.availability);
  available_ = available_ ? random_.uniform() >= in : random_.uniform() < out;
  if (c_.availability >= 1) available_ = true;
  return {available_ && !indoors_ && c_.availability > 0,
          p + Vector3d(sigma * error_.x(), sigma * error_.y(), 2 * sigma * error_.z()), 0.7 * sigma};
}

}  // namespace odograph
