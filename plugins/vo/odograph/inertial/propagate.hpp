// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "plugins/vo/odograph/inertial/imu_buffer.hpp"
#include "plugins/vo/odograph/inertial/parameters.hpp"
#include "plugins/vo/odograph/inertial/state.hpp"

namespace odograph::vio {

/// Propagates a state, without its covariance, along the samples between two times, forwards or backwards. False if
/// samples are missing.
bool integrate(Navigation& nav, int64_t from_ns, int64_t to_ns, const ImuBuffer& imu, double gravity_mps2);

/// Propagates the state and its covariance to a later time. False if samples are missing: the state then uses the
/// available samples, and the variance of its velocity is increased.
bool propagate(State& state, int64_t to_ns, const ImuBuffer& imu, const FilterParameters& p);

/// Shift of the picture by a stabilised lens from the state's time to `to_ns`, px.
Eigen::Vector2d predict_lens_shift(const State& state, int64_t to_ns, const ImuBuffer& imu, const FilterParameters& p);

/// Adds the present camera pose as a clone. `imu` gives its motion within the readout of the frame.
void augment(State& state, uint32_t id, int64_t frame_ns, const ImuBuffer& imu, const FilterParameters& p);

}  // namespace odograph::vio
