// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace odograph {

/// Tracking state of a feature-based odometry, and the reason for a failure.
enum class Tracking { tracking, degraded, lost };
enum class FailureReason { none, initialising, too_dark, few_features, no_parallax };

}  // namespace odograph
