// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "sdk/host/messages/messages.hpp"

namespace odograph {

/// Makes position fixes for the step estimator out of poses whose scale does not come from steps, so that a walker's
/// step length is learnt wherever the camera knows the metre: one for each stretch that was metric from end to end.
/// Positions from outside say more; for a minute after one of them there is nothing to add.
class DisplacementReference {
 public:
  struct Parameters {
    double stretch_m = 20;  ///< of displacement between two of them: long beside a step, short beside a walk; judgement
    double drift = 0.01;    ///< of a stretch: what a scaled odometry may err by (docs/accuracy.md: 0.8 % in nine walks)
    int64_t fixes_rule_ns = 60'000'000'000;  ///< after a fix, for which it says more of the walker; judgement
  };

  /// A true fix was used at this time.
  void fixed(int64_t t_ns) { fixed_ns_ = t_ns; }

  /// The camera's pose, and whether the displacement since the one before was metric without the help of steps.
  std::optional<odo_fix> see(const odo_pose& pose, bool metric) {
    const double step_m = std::hypot(pose.p_n[0] - last_[0], pose.p_n[1] - last_[1]);
    last_[0] = pose.p_n[0], last_[1] = pose.p_n[1];
    if (!metric || pose.state == ODO_LOST) {
      path_m_ = -1;
      return {};
    }
    const bool begins = path_m_ < 0;
    path_m_ = begins ? 0 : path_m_ + step_m;
    if (!begins && path_m_ < p_.stretch_m) return {};
    if (!begins) path_m_ = 0;
    if (fixed_ns_ != INT64_MIN && pose.header.t_ns - fixed_ns_ < p_.fixes_rule_ns) return {};
    auto fix = make_message<odo_fix>(ODO_TYPE_FIX, pose.header.t_ns);
    fix.header.flags = ODO_FIX_NORTH | ODO_FIX_EAST;
    std::copy(pose.p_n, pose.p_n + 3, fix.p_n);
    const double sigma_m = p_.drift * p_.stretch_m;
    fix.covariance_n[0] = fix.covariance_n[4] = fix.covariance_n[8] = sigma_m * sigma_m;
    return fix;
  }
  void reset() { *this = DisplacementReference(); }

 private:
  Parameters p_;
  double path_m_ = -1, last_[2] = {0, 0};
  int64_t fixed_ns_ = INT64_MIN;
};

}  // namespace odograph
