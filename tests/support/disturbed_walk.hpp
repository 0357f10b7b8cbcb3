// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sdk/host/messages/messages.hpp"

/// A simulated walk of 125 m up a flight of stairs with rare faults of each sensor and plugin: long and short
/// interruptions, repetitions, jumps, nonsense values; an odometry that loses its scale, reflected GNSS signals, a
/// heading that is off by nearly half a turn. In time order, with the attitude, steps, motions, poses and fixes that
/// the parts of a pipeline exchange.
struct DisturbedWalk {
  DisturbedWalk();
  std::vector<odograph::AnyMessage> messages;
};
