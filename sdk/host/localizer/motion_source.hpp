// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <variant>

#include <Eigen/Core>
#include <odograph/types.h>

namespace odograph {

/// The source that moves the track: one at a time, the best one active.
struct NoSource {};      ///< no source: the track stays in place
struct StepSource {};    ///< steps, from the end of the last displacement
struct ScaledSource {};  ///< a front-end, multiplied by an external scale
struct MetricSource {
  bool inertial = false;
};                     ///< a metric front-end, with or without inertia
struct LiftSource {};  ///< a lift or an escalator, vertical only, from the barometer
using MotionSource = std::variant<NoSource, StepSource, ScaledSource, MetricSource, LiftSource>;

inline const char* describe(const MotionSource& source) {
  constexpr const char* kNames[] = {"nothing moves the track", "steps move the track",
                                    "the front-end moves the track, with an external scale",
                                    "the front-end moves the track, with its own metric scale",
                                    "a lift or an escalator moves the track up or down, by the barometer"};
  return kNames[source.index()];
}

}  // namespace odograph
