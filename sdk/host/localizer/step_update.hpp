// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "sdk/host/localizer/localizer.hpp"
#include "sdk/host/localizer/parameters.hpp"

namespace odograph {

/// Steps: as the motion itself where nothing else moves the track, otherwise compared with the front-end's.
class StepUpdate {
 public:
  explicit StepUpdate(const LocalizerParameters& parameters) : p_(parameters) {}
  void reset() { *this = StepUpdate(p_); }

  /// The walker and how the phone is held have changed by a step. `learns`: what was learnt of him is forgotten slowly.
  void go_on(Localizer& localizer, const odo_step& step, bool learns);
  /// A step in n, horizontal, m.
  struct Stride {
    Eigen::Vector3d d_n, by_factor, by_heading;
    Eigen::Matrix3d noise;
  };
  /// By a share of the step, with the phone's own direction where the step has none.
  Stride stride(const Localizer& localizer, const odo_step& step, double share, double phone_heading_rad) const;
  /// Compared with what the front-end moved meanwhile, up to scale, in o. `metric`: its scale is not for steps to say.
  UpdateResult compare(Localizer& localizer, const odo_step& step, const Eigen::Vector3d& moved_o, bool metric);
  bool any() const { return any_; }

 private:
  double own_sigma(const odo_step& step) const;
  double direction_sigma(const odo_step& step) const;

  LocalizerParameters p_;
  bool any_ = false, loose_ = false;
  int rejected_ = 0;  // in a row
};

}  // namespace odograph
