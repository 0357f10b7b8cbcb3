// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <utility>

#include <Eigen/Core>
#include <odograph/types.h>

#include "sdk/host/localizer/displacement_reference.hpp"
#include "sdk/host/localizer/measurement.hpp"

namespace odograph {

/// Output of the composer: the newest pose, a correction of earlier poses, a displacement reference for step
/// estimators, and the distance travelled.
class PoseOutput {
 public:
  struct Parameters {
    double announced_jump_m = 0.05;        ///< m: smaller corrections are not reported
    double announced_rotation_rad = 0.01;  ///< rad
    double counted_m = 0.1;                ///< m of path: less may be jitter; empirical
    double reference_scale_sigma = 0.03;   ///< relative: a scale with a larger sigma is no reference for steps
  };

  void reset() { *this = {}; }
  const Parameters& parameters() const { return p_; }

  /// Takes a pose to publish. `shown`: its position is valid. `scale_sigma`: relative, without the help of steps; 0:
  /// unknown.
  void publish(odo_pose pose, bool shown, double scale_sigma);
  /// A measurement has changed the published pose at its own time. Small changes are reported only with `report_small`.
  void correct(const odo_pose& before, odo_pose after, uint32_t reason, bool report_small);
  /// Call after both: adds the path since the previous pose to the distance, excluding its correction.
  void settle();
  /// Adds a displacement to the distance as it is, m.
  void count(double moved_m) { distance_m_ += moved_m, counts_all_ = true; }
  /// Adds a late displacement that also corrects the newest pose, m.
  void catch_up(double moved_m) { distance_m_ += moved_m; }
  void fixed(int64_t t_ns) { displacement_reference_.fixed(t_ns); }

  bool take_pose(odo_pose& pose) { return take(pose_, pose); }
  bool take_correction(Correction& correction, odo_pose& pose) {
    return take(corrected_, pose) && take(correction_, correction);
  }
  bool take_step_reference(odo_fix& reference) { return take(reference_, reference); }
  double distance_m() const { return distance_m_; }
  /// INT64_MIN before the first.
  int64_t last_ns() const { return last_ns_; }
  uint32_t last_state() const { return last_state_; }
  uint32_t last_reason() const { return last_reason_; }

 private:
  template <class T>
  static bool take(std::optional<T>& from, T& out) {
    if (!from) return false;
    out = *std::exchange(from, std::nullopt);
    return true;
  }

  Parameters p_;
  std::optional<odo_pose> pose_, corrected_;
  std::optional<Correction> correction_;
  std::optional<odo_fix> reference_;
  DisplacementReference displacement_reference_;
  int64_t last_ns_ = INT64_MIN;
  uint32_t last_state_ = 0, last_reason_ = 0;
  double distance_m_ = 0;
  bool counts_all_ = false;
  Eigen::Vector3d counted_from_ = Eigen::Vector3d::Zero();
};

}  // namespace odograph
