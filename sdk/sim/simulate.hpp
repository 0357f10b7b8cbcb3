// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>

#include "sdk/base/result.hpp"
#include "sdk/sim/scenario.hpp"

namespace odograph {

/// Makes an Odograph recording of the scenario: IMU, magnetometer, GNSS, barometer, camera frames, the true camera pose
/// at every frame and the true steps. The same scenario and seed give the same bytes.
Result<bool> simulate(const Scenario& scenario, uint64_t seed, const std::filesystem::path& output,
                      const std::function<void(size_t, size_t)>& progress);

}  // namespace odograph
