// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <optional>

#include <Eigen/Geometry>

#include "plugins/shared/gait/gait_signal.hpp"
#include "plugins/shared/gait/step_detector.hpp"
#include "plugins/shared/gait/step_frequency.hpp"

namespace odograph::gait {

/// A detected step with the inputs of the length models.
struct Step {
  DetectedStep detected;
  double frequency_hz;
  double heading_rad;  ///< of the forward axis in n, averaged over the step
  bool heading_valid;
  Carrying carrying;
};

/// Signal, detector, frequency and heading: the common front part of the step estimators.
class Gait {
 public:
  Gait(const GaitSignal::Parameters& signal, const StepDetector::Parameters& detector, const Eigen::Vector3d& forward_b)
      : signal_(signal), detector_(detector), forward_b_(forward_b.normalized()) {}

  void set_attitude(const Eigen::Quaterniond& q_n_b) {
    const Eigen::Vector3d forward = q_n_b * forward_b_;
    const double horizontal = std::hypot(forward.x(), forward.y());
    if (horizontal > 0.2) heading_ += Eigen::Vector2d(forward.x(), forward.y()) / horizontal;
  }

  std::optional<Step> update(int64_t t_ns, const Eigen::Vector3d& gyro, const Eigen::Vector3d& accel) {
    signal_.update(t_ns, gyro, accel);
    const double value = signal_.value();
    frequency_.add(signal_.time_ns(), value);
    const auto found = detector_.update(signal_.time_ns(), value, signal_.carrying() > Carrying::still);
    if (!found) return std::nullopt;
    const double expected = 1e9 / static_cast<double>(found->t_end_ns - found->t_start_ns);
    const bool turned = heading_.norm() > 0;
    const Step step{*found, frequency_.estimate(expected), std::atan2(heading_.y(), heading_.x()), turned,
                    signal_.carrying()};
    heading_.setZero();
    return step;
  }
  Carrying carrying() const { return signal_.carrying(); }

 private:
  GaitSignal signal_;
  StepDetector detector_;
  StepFrequency frequency_;
  Eigen::Vector3d forward_b_;
  Eigen::Vector2d heading_ = Eigen::Vector2d::Zero();
};

}  // namespace odograph::gait
