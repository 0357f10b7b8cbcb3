// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "sdk/tools/simulation/motion.hpp"
#include "sdk/tools/simulation/random.hpp"

/// An idealised walk for unit tests with a known answer: sines locked to the step's phase, no heel strike, no hand.
/// Benchmarks evaluate the estimators on realistic walkers.
struct PlainWalk {
  struct Step {
    double t_start_s, t_end_s;
  };
  odograph::Motion phone;
  std::vector<Step> steps;

  PlainWalk(double speed_mps, double length_m, uint64_t seed, double stand_s = 2, double straight_m = 18) {
    constexpr double kPi = 3.14159265358979323846, kRate = 400;
    odograph::Random random(seed, 1);
    double tremor_phase[5];
    for (double& phase : tremor_phase) phase = random.uniform(0, 2 * kPi);
    const double arc = 4.8, radius = 4, whole = 2 * straight_m + arc, walk_s = whole / speed_mps;
    const auto ramp = [](double x) { return x = std::clamp(x, 0.0, 1.0), x * x * x * (x * (6 * x - 15) + 10); };
    const auto ramp_integral = [](double x) {
      return x <= 0 ? 0.0 : x >= 1 ? x - 0.5 : x * x * x * x * (x * (x - 3) + 2.5);
    };
    const auto gone = [&](double t) {
      return speed_mps * (ramp_integral(t - stand_s) - ramp_integral(t - stand_s - walk_s));
    };
    std::vector<Eigen::Vector3d> p;
    std::vector<Eigen::Quaterniond> q;
    Eigen::Matrix3d axes;
    axes << 0, 0, -1, 1, 0, 0, 0, -1, 0;
    double last = stand_s;
    const double end = 2 * stand_s + walk_s + 1;
    for (double t = 0; t < end; t += 1 / kRate) {
      const double s = gone(t), v = ramp(t - stand_s) - ramp(t - stand_s - walk_s), phase = s / length_m;
      if (phase >= static_cast<double>(steps.size() + 1)) {
        steps.push_back({last, t});
        last = t;
      }
      const double turned = std::clamp(s - straight_m, 0.0, arc) / radius;
      const double before = std::min(s, straight_m), after = std::max(0.0, s - straight_m - arc);
      const auto tremor = [&](int i, double hz) { return std::sin(2 * kPi * hz * t + tremor_phase[i]); };
      const double forward = 0.012 * v * std::sin(2 * kPi * phase + 0.6), c = std::cos(turned), n = std::sin(turned);
      const double right = 0.018 * v * std::sin(kPi * phase) + 0.004 * tremor(0, 0.31);
      const double up =
          1.4 - 0.022 * v * std::cos(2 * kPi * phase) + 0.001 * v * std::cos(4 * kPi * phase) + 0.003 * tremor(1, 0.23);
      p.emplace_back(before + radius * n + after * c + forward * c - right * n,
                     radius * (1 - c) + after * n + forward * n + right * c, -up);
      const double yaw = turned + 0.035 * v * std::sin(kPi * phase + 0.4) + 0.01 * tremor(2, 0.37);
      const double pitch = -0.2 + 0.012 * v * std::sin(2 * kPi * phase + 1.1) + 0.008 * tremor(3, 0.29);
      const double roll = 0.02 * v * std::sin(kPi * phase + 0.9) + 0.008 * tremor(4, 0.41);
      q.push_back(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) *
                  Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitY()) *
                  Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitX()) * Eigen::Quaterniond(axes));
    }
    phone = odograph::Motion(kRate, std::move(p), std::move(q));
  }
};
