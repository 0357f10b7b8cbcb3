// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "plugins/vo/odograph/inertial/imu_buffer.hpp"
#include "plugins/vo/odograph/inertial/parameters.hpp"
#include "plugins/vo/odograph/inertial/state.hpp"

namespace odograph::vio {

/// Moves a state without its covariance along the samples between two times, forwards or backwards. False where
/// samples lack.
bool integrate(Navigation& nav, int64_t from_ns, int64_t to_ns, const ImuBuffer& imu, double gravity_mps2);

/// Moves the state and its covariance to a later time. False where samples lack: the state is then moved with what
/// there is, and its velocity's variance grown.
bool propagate(State& state, int64_t to_ns, const ImuBuffer& imu, const FilterParameters& p);

/// How far a stabilised lens shifts the picture from the state's time to `to_ns`, px.
Eigen::Vector2d lens_moves(const State& state, int64_t to_ns, const ImuBuffer& imu, const FilterParameters& p);

/// The camera's pose now becomes a clone. `imu` tells how it moves within the frame's readout.
void augment(State& state, uint32_t id, int64_t frame_ns, const ImuBuffer& imu, const FilterParameters& p);

}  // namespace odograph::vio
