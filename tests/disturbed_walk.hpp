// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sdk/host/messages/messages.hpp"

/// A simulated walk of 125 m up a flight of stairs on which each sensor and each other part of a pipeline does what it
/// seldom does: falls silent for long and for short, repeats itself, jumps, shows nonsense; an odometry that loses its
/// scale, satellites that are reflected, a heading that is off by nearly half a turn. In order of time, with the
/// attitude, steps, motions, poses and fixes that the parts of a pipeline give each other.
struct DisturbedWalk {
  DisturbedWalk();
  std::vector<odograph::AnyMessage> messages;
};
