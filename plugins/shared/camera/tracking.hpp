// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace odograph {

/// How an odometry that follows points fares, and why it fails.
enum class Tracking { tracking, degraded, lost };
enum class FailureReason { none, initialising, too_dark, few_features, no_parallax };

}  // namespace odograph
