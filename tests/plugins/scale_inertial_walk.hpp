// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "plugins/scale/inertial/inertial_scale.hpp"
#include "sdk/math/rotation.hpp"
#include "sdk/host/messages/messages.hpp"
#include "sdk/tools/simulation/random.hpp"
#include "sdk/tools/simulation/walker.hpp"

namespace odograph::inertial_scale {

using Eigen::Quaterniond;
using Eigen::Vector3d;

inline int64_t ns(double t_s) { return 1'000'000'000 + std::llround(t_s * 1e9); }

/// Errors besides the walker's steps: sizes of a phone's IMU (data sheet of the BMI270) and of vo/five_point.
struct Errors {
  double noise_m = 0.01, noise_s = 0.25;  ///< position of the odometry relative to its map, Gauss-Markov
  double scale_walk = 0.01;               ///< 1/sqrt(m)
  double tilt_rad = 0.0175, tilt_s = 10;  ///< orientation of the host about a horizontal axis, Gauss-Markov
  double gyro_bias = 0.005, accel_bias = 0.1, gyro_noise = 2e-4, accel_noise = 2e-3;

  static Errors none() { return {0, 1, 0, 0, 1, 0, 0, 0, 0}; }
};

/// A walk with a corner, or any motion, measured with errors.
class Walk {
 public:
  Errors errors;
  double frame_hz = 10;
  Vector3d p_b_c{0.03, 0.06, -0.005};
  std::function<void(double t_s, InertialScale::Motion& motion)> change;
  std::function<bool(double t_s)> imu_missing = [](double) { return false; };

  Walk(Motion phone, uint64_t seed, const Errors& e = {}) : errors(e), phone_(std::move(phone)), random_(seed, 31) {
    gyro_bias_ = errors.gyro_bias * noise();
    accel_bias_ = errors.accel_bias * noise();
  }
  static Walk of_length(double length_m, uint64_t seed, const Errors& e = {}) {
    Scenario s;
    s.route = {{0, 0, 0}, {0.5 * length_m, 0, 0}, {0.8 * length_m, 0.4 * length_m, 0}};
    return Walk(make_walk(s, seed).phone, seed, e);
  }

  struct Answer {
    double t_s;
    Scale scale;
    double log_true;
    double off() const { return std::log(scale.scale) - log_true; }
    double normalised() const { return off() / scale.relative_sigma; }
  };
  /// All results, one per motion.
  std::vector<Answer> run() {
    Parameters p;
    p.scale_walk = errors.scale_walk, p.common_sigma = 0.01;
    InertialScale scale(p);
    std::vector<Answer> answers;
    run([&](const odo_imu& imu) { scale.add_imu(imu.header.t_ns, Vector3d(imu.gyro_b), Vector3d(imu.accel_b)); },
        [&](double t_s, const InertialScale::Motion& motion) {
          scale.set_camera({q_b_c, p_b_c});
          scale.add_motion(motion);
          if (const auto found = scale.scale()) answers.push_back({t_s, *found, -log_inverse_});
        });
    return answers;
  }
  template <class OnImu, class OnMotion>
  void run(const OnImu& on_imu, const OnMotion& on_motion) {
    double next_frame = 0.0123;
    for (double t = 0; t < phone_.duration_s(); t += kImu_s) {
      for (; next_frame < t; next_frame += 1 / frame_hz) {
        if (auto motion = frame(next_frame)) on_motion(next_frame, *motion);
      }
      if (!imu_missing(t)) on_imu(imu(t));
    }
  }

  static inline const Quaterniond q_b_c{0, 1, 0, 0};

 private:
  static constexpr double kImu_s = 0.005;
  Vector3d noise() { return {random_.normal(), random_.normal(), random_.normal()}; }

  odo_imu imu(double t) {
    const auto state = phone_.at(t);
    const double root = 1 / std::sqrt(kImu_s);
    auto sample = make_message<odo_imu>(ODO_TYPE_IMU, ns(t));
    sample.header.flags = ODO_IMU_GYRO | ODO_IMU_ACCEL;
    Vector3d::Map(sample.gyro_b) = state.angular_velocity_b + gyro_bias_ + errors.gyro_noise * root * noise();
    Vector3d::Map(sample.accel_b) = state.specific_force_b() + accel_bias_ + errors.accel_noise * root * noise();
    return sample;
  }

  std::optional<InertialScale::Motion> frame(double t) {
    const auto T = phone_.pose(t);
    const Vector3d p_n_c = T * p_b_c;
    const bool first = last_s_ < 0;
    drift(tilt_, errors.tilt_rad, errors.tilt_s, first ? 1e9 : t - last_s_);
    drift(error_m_, errors.noise_m, errors.noise_s, first ? 1e9 : t - last_s_);
    tilt_.z() = 0;
    std::optional<InertialScale::Motion> motion;
    if (!first) {
      const Vector3d d_n = p_n_c - last_p_n_;
      log_inverse_ += errors.scale_walk * std::sqrt(d_n.norm()) * random_.normal();
      const Vector3d d = std::exp(log_inverse_) * (d_n + error_m_ - last_error_m_);
      const Quaterniond q_c0_c1 = last_q_.conjugate() * Quaterniond(T.linear()) * q_b_c;
      motion = InertialScale::Motion{ns(last_s_), ns(t), last_stated_, q_c0_c1, last_q_.conjugate() * d, 3, true};
      if (change) change(t, *motion);
    }
    last_s_ = t, last_p_n_ = p_n_c, last_error_m_ = error_m_;
    last_q_ = Quaterniond(T.linear()) * q_b_c;
    last_stated_ = exp_rotation(tilt_) * last_q_;
    return motion;
  }

  void drift(Vector3d& state, double sigma, double tau_s, double dt) {
    const double keep = std::exp(-dt / tau_s);
    state = keep * state + std::sqrt(1 - keep * keep) * sigma * noise();
  }

  Motion phone_;
  Random random_;
  Vector3d gyro_bias_, accel_bias_;
  double log_inverse_ = std::log(2.5), last_s_ = -1;
  Vector3d tilt_ = Vector3d::Zero(), error_m_ = Vector3d::Zero(), last_error_m_ = Vector3d::Zero(), last_p_n_;
  Quaterniond last_q_, last_stated_;
};

}  // namespace odograph::inertial_scale
