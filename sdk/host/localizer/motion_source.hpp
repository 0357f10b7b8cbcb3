// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <variant>

#include <Eigen/Core>
#include <odograph/types.h>

namespace odograph {

/// What moves the track: one at a time, the best that is alive.
struct NoSource {};      ///< nothing yet, or nothing any more: the track stays
struct StepSource {};    ///< steps, from where the last displacement ended
struct ScaledSource {};  ///< a front-end, times a scale that others give
struct MetricSource {
  bool inertial = false;
};                     ///< a front-end that states metres, with inertia or without
struct LiftSource {};  ///< a lift or an escalator, by the barometer, up or down
using MotionSource = std::variant<NoSource, StepSource, ScaledSource, MetricSource, LiftSource>;

inline const char* describe(const MotionSource& source) {
  constexpr const char* kNames[] = {"nothing moves the track: it stays where it is", "steps move the track",
                                    "the front-end moves the track, times a scale from elsewhere",
                                    "the front-end moves the track, in its own metres",
                                    "a lift or an escalator moves the track up or down, by the barometer"};
  return kNames[source.index()];
}

}  // namespace odograph
