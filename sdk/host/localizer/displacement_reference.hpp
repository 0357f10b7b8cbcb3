// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "sdk/host/messages/messages.hpp"

namespace odograph {

/// Makes position fixes for the step estimator out of poses whose scale does not come from steps, so that a walker's
/// step length is learnt wherever the camera knows metres: one for each stretch that was metric from end to end.
/// Positions from outside say more; for a minute after one of them there is nothing to add.
class DisplacementReference {
 public:
  struct Parameters {
    double stretch_m = 5;      ///< of displacement between two of them: seven steps; judgement
    double alike_m = 20;       ///< over which the scale's error is the same one; judgement
    double min_sigma = 0.01;   ///< relative: what a scaled odometry may err by (docs/accuracy.md: 0.8 % in nine walks)
    double fixes_rule_s = 60;  ///< after a fix, for which it says more of the walker; judgement
  };

  DisplacementReference() = default;
  explicit DisplacementReference(const Parameters& parameters) : p_(parameters) {}
  void reset() { *this = DisplacementReference(p_); }

  /// A true fix was used at this time.
  void fixed(int64_t t_ns) { fixed_ns_ = t_ns; }

  /// The camera's pose, and the relative sigma of the displacement since the one before; 0: not metric without steps.
  std::optional<odo_fix> see(const odo_pose& pose, double scale_sigma) {
    const double step_m = std::hypot(pose.p_n[0] - last_[0], pose.p_n[1] - last_[1]);
    last_[0] = pose.p_n[0], last_[1] = pose.p_n[1];
    if (!(scale_sigma > 0) || pose.state == ODO_LOST) {
      path_m_ = -1;
      return {};
    }
    const bool begins = path_m_ < 0;
    path_m_ = begins ? 0 : path_m_ + step_m;
    if (!begins && path_m_ < p_.stretch_m) return {};
    path_m_ = 0;
    if (fixed_ns_ != INT64_MIN && static_cast<double>(pose.header.t_ns - fixed_ns_) * 1e-9 < p_.fixes_rule_s) return {};
    auto fix = make_message<odo_fix>(ODO_TYPE_FIX, pose.header.t_ns);
    fix.header.flags = ODO_FIX_NORTH | ODO_FIX_EAST | ODO_FIX_COVARIANCE;
    std::copy(pose.p_n, pose.p_n + 3, fix.p_n);
    const double sigma_m =
        std::max(p_.min_sigma, scale_sigma) * std::sqrt(p_.stretch_m * std::max(p_.stretch_m, p_.alike_m));
    fix.covariance_n[0] = fix.covariance_n[4] = fix.covariance_n[8] = sigma_m * sigma_m;
    return fix;
  }

 private:
  Parameters p_;
  double path_m_ = -1, last_[2] = {0, 0};
  int64_t fixed_ns_ = INT64_MIN;
};

}  // namespace odograph
