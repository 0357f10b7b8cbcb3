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
    // A swinging arm passes the body once a step, where its rate peaks; its other shocks are no steps.
    const bool active = signal_.settled() && signal_.moves() && (!signal_.swings() || signal_.gyro_peaked());
    const auto found = detector_.update(signal_.time_ns(), value, active);
    classify(found);
    if (!found) return std::nullopt;
    const double expected = 1e9 / static_cast<double>(found->t_end_ns - found->t_start_ns);
    const bool turned = heading_.norm() > 0;
    const Step step{*found, frequency_.estimate(expected), std::atan2(heading_.y(), heading_.x()), turned, carrying_};
    heading_.setZero();
    signal_.next_step();
    return step;
  }
  Carrying carrying() const { return carrying_; }

 private:
  /// A walk ends where the sensors lack its energy and the next step is overdue, or where no step came for longer than
  /// a step can take.
  void classify(const std::optional<DetectedStep>& step) {
    const int64_t now_ns = signal_.time_ns();
    if (!signal_.settled()) {
      walks_ns_ = now_ns;
      return;
    }
    if (step) walks_ns_ = step->t_end_ns, due_ns_ = 2 * step->t_end_ns - step->t_start_ns;
    const bool moves = signal_.moves();
    if (!moves && now_ns > due_ns_) walks_ns_ = now_ns;
    if (!(moves || now_ns <= due_ns_) || now_ns - walks_ns_ > detector_.longest_ns())
      carrying_ = Carrying::still;
    else
      carrying_ = signal_.swings() ? Carrying::swinging : Carrying::texting;
  }

  GaitSignal signal_;
  StepDetector detector_;
  StepFrequency frequency_;
  Eigen::Vector3d forward_b_;
  Eigen::Vector2d heading_ = Eigen::Vector2d::Zero();
  Carrying carrying_ = Carrying::unknown;
  int64_t walks_ns_ = 0;        // end of the last step, or when the walk's energy came
  int64_t due_ns_ = INT64_MIN;  // end of the step after it
};

}  // namespace odograph::gait
