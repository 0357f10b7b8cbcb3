// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <utility>

#include <Eigen/Core>
#include <odograph/types.h>

#include "sdk/host/fusion/pose_filter.hpp"
#include "sdk/math/time.hpp"
#include "sdk/math/timed_ring.hpp"

namespace odograph {

/// Motions of a front-end that share one scale (odo_vo_motion.scale_group), and their path in o, up to that scale.
struct ScaleGroup {
  uint32_t id = 0;
  bool any = false, metric = false, inertial = false;
  bool scale_converged = false;  ///< its scale has been better known than step lengths vary between walkers
  int64_t began_ns = 0;
  int64_t unscaled_ns = 0;  ///< since when motions wait for their scale

  void begin(const odo_vo_motion& motion, bool in_metres) {
    *this = {};
    any = true, id = motion.scale_group, metric = in_metres, began_ns = motion.t_from_ns;
    path_.push({began_ns, y_o_});
  }
  void add(int64_t t_ns, const Eigen::Vector3d& d_o) { path_.push({t_ns, y_o_ += d_o}); }
  /// The motion from that time on has no scale yet.
  void add_unscaled(int64_t from_ns, const Eigen::Vector3d& d_o) {
    if (unscaled_o_.isZero()) unscaled_ns = from_ns;
    unscaled_o_ += d_o;
  }
  /// Returns the waiting displacement once.
  Eigen::Vector3d take_unscaled() { return std::exchange(unscaled_o_, Eigen::Vector3d::Zero()); }
  /// Nothing for a time that is no longer stored or precedes the group.
  std::optional<Eigen::Vector3d> displacement(int64_t from_ns, int64_t to_ns) const {
    const auto from = at(from_ns), to = at(to_ns);
    return from && to ? std::optional<Eigen::Vector3d>(*to - *from) : std::nullopt;
  }
  /// Path over the second before t, in the group's units; nothing if the group is younger.
  std::optional<double> moved_in_a_second(int64_t t_ns) const {
    const auto before = at(t_ns - kSecond_ns);
    return before ? std::optional((y_o_ - *before).norm()) : std::nullopt;
  }

 private:
  struct Place {
    int64_t t_ns;
    Eigen::Vector3d y_o;
  };
  /// Interpolated; nothing before the oldest or after the newest.
  std::optional<Eigen::Vector3d> at(int64_t t_ns) const {
    const size_t later = path_.later_than(t_ns);
    if (later == path_.size() || (later == 0 && path_.back(0).t_ns != t_ns)) return std::nullopt;
    const Place& place = path_.back(later);
    if (place.t_ns == t_ns) return place.y_o;
    const Place& next = path_.back(later - 1);
    return place.y_o + weight_between(place, next, t_ns) * (next.y_o - place.y_o);
  }

  Eigen::Vector3d y_o_ = Eigen::Vector3d::Zero(), unscaled_o_ = Eigen::Vector3d::Zero();
  TimedRing<Place, 256> path_;
};

/// Metric scale of a front-end's displacements, stated by the front-end or by scale sources. Errors of successive
/// statements are not independent: each counts only for the information it adds to the previous ones.
class Scale {
 public:
  struct Parameters {
    double unknown_sigma = 1.0;     ///< of log-scale, prior, and upper clamp of a stated sigma
    double known_sigma = 0.15;      ///< of log-scale, below which steps have determined the scale
    double min_sigma = 1e-3;        ///< lower clamp of a stated sigma; empirical
    double lost_confidence = 0.25;  ///< ratio of stated information below which a front-end has lost its scale again
    double memory_s = 20;           ///< s for which a source repeats the same error
    int min_steps = 3;              ///< before steps determine the scale; empirical
  };

  /// Starts a scale group with unknown scale.
  void begin_group(PoseFilter& filter);
  /// Takes the front-end's own statement, relative sigma. `is_walking`: the camera moves. A camera at rest is uncertain
  /// of its displacement, not its scale.
  void use_front_end(PoseFilter& filter, double sigma, bool is_walking);
  /// Takes a scale source's statement at a time.
  UpdateResult use(PoseFilter& filter, const odo_scale& scale);
  /// Adds the information gained from comparing steps with the front-end, 1/variance.
  void add_steps(double gained) { by_steps_ += gained, ++steps_; }

  bool known() const { return known_; }
  /// Accepts the scale from steps alone: at least min_steps, and a small enough sigma.
  void confirm_by_steps(const PoseFilter& filter);
  /// Information on log-scale without the help of steps, 1/variance; 0: none.
  double own_information() const { return own_; }
  ScaleKnowledge knowledge(const PoseFilter& filter) const;

 private:
  Parameters p_;
  bool known_ = false;
  double own_ = 0, stated_ = 0, by_steps_ = 0;
  int steps_ = 0;
  Instant stated_at_;
};

}  // namespace odograph
