// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "sdk/host/messages/messages.hpp"
#include "sdk/math/time.hpp"

namespace odograph {

/// Derives position fixes for the step estimator from poses whose scale does not depend on steps, so that the walker's
/// step length is estimated wherever the camera has metric scale. One fix for each stretch that is metric throughout.
/// External position fixes carry more information: for a minute after one, this emits nothing.
class DisplacementReference {
 public:
  struct Parameters {
    double spacing_m = 5;        ///< displacement between two references: seven steps; judgement
    double correlation_m = 20;   ///< distance over which the scale error is fully correlated; judgement
    double min_sigma = 0.01;     ///< relative error of a scaled odometry (docs/accuracy.md: 0.8 % in nine walks)
    double fix_priority_s = 60;  ///< after an external fix, which is the better reference; judgement
  };

  /// An external fix was used at this time.
  void fixed(int64_t t_ns) { fixed_ = t_ns; }

  /// Takes the camera's pose and the relative sigma of the displacement since the previous pose; 0: not metric without
  /// steps.
  std::optional<odo_fix> add_pose(const odo_pose& pose, double scale_sigma) {
    const double step_m = std::hypot(pose.p_n[0] - last_[0], pose.p_n[1] - last_[1]);
    last_[0] = pose.p_n[0], last_[1] = pose.p_n[1];
    if (!(scale_sigma > 0) || pose.state == ODO_LOST) {
      path_m_ = -1;
      return {};
    }
    const bool begins = path_m_ < 0;
    path_m_ = begins ? 0 : path_m_ + step_m;
    if (!begins && path_m_ < p_.spacing_m) return {};
    path_m_ = 0;
    if (fixed_ && seconds(pose.header.t_ns - *fixed_) < p_.fix_priority_s) return {};
    auto fix = make_message<odo_fix>(ODO_TYPE_FIX, pose.header.t_ns);
    fix.header.flags = ODO_FIX_NORTH | ODO_FIX_EAST | ODO_FIX_COVARIANCE;
    std::copy(pose.p_n, pose.p_n + 3, fix.p_n);
    const double sigma_m =
        std::max(p_.min_sigma, scale_sigma) * std::sqrt(p_.spacing_m * std::max(p_.spacing_m, p_.correlation_m));
    fix.covariance_n[0] = fix.covariance_n[4] = fix.covariance_n[8] = sigma_m * sigma_m;
    return fix;
  }

 private:
  Parameters p_;
  double path_m_ = -1, last_[2] = {0, 0};
  Instant fixed_;
};

}  // namespace odograph
