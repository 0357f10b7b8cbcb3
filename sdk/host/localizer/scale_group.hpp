// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <utility>

#include <Eigen/Core>
#include <odograph/types.h>

#include "sdk/host/localizer/timed_positions.hpp"

namespace odograph {

/// Motions of a front-end that share one scale (odo_vo_motion.scale_group), and their path in o, up to that scale.
struct ScaleGroup {
  uint32_t id = 0;
  bool any = false, metric = false, inertial = false;
  bool scale_converged = false;  ///< its scale has been better known than step lengths vary between walkers
  int64_t began_ns = INT64_MIN;
  int64_t unscaled_ns = INT64_MIN;  ///< since when motions wait for their scale

  void begin(const odo_vo_motion& motion, bool in_metres) {
    *this = {};
    any = true, id = motion.scale_group, metric = in_metres, began_ns = motion.t_from_ns;
    path_.add(began_ns, y_o_);
  }
  void add(int64_t t_ns, const Eigen::Vector3d& d_o) { path_.add(t_ns, y_o_ += d_o); }
  /// The motion from that time on has no scale yet.
  void add_unscaled(int64_t from_ns, const Eigen::Vector3d& d_o) {
    if (unscaled_o_.isZero()) unscaled_ns = from_ns;
    unscaled_o_ += d_o;
  }
  /// Returns the waiting displacement once.
  Eigen::Vector3d take_unscaled() { return std::exchange(unscaled_o_, Eigen::Vector3d::Zero()); }
  /// Nothing for a time that is no longer stored or precedes the group.
  std::optional<Eigen::Vector3d> displacement(int64_t from_ns, int64_t to_ns) const {
    const auto from = path_.at(from_ns), to = path_.at(to_ns);
    return from && to ? std::optional<Eigen::Vector3d>(*to - *from) : std::nullopt;
  }
  /// Path over the second before t, in the group's units; nothing if the group is younger.
  std::optional<double> moved_in_a_second(int64_t t_ns) const {
    const auto before = path_.at(t_ns - 1'000'000'000);
    return before ? std::optional((y_o_ - *before).norm()) : std::nullopt;
  }

 private:
  Eigen::Vector3d y_o_ = Eigen::Vector3d::Zero(), unscaled_o_ = Eigen::Vector3d::Zero();
  TimedPositions path_;
};

}  // namespace odograph
