// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace odograph {

/// How an odometry that follows points fares, and what troubles it.
enum class Tracking { tracking, degraded, lost };
enum class Trouble { none, initialising, too_dark, few_features, no_parallax };

}  // namespace odograph
