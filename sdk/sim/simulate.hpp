// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>

#include "sdk/base/result.hpp"
#include "sdk/sim/frame_maker.hpp"
#include "sdk/sim/scenario.hpp"

namespace odograph {

struct SimulationReport {
  size_t frames = 0;
  double seconds = 0;  ///< wall clock
  unsigned threads = 0;
  FrameMaker::Times times;
};

/// Makes an Odograph recording of the scenario: IMU, magnetometer, GNSS, barometer, surveyed marks, camera frames, and
/// the truth: the camera's pose at every frame, the body's state at every IMU sample, steps and modes. The same
/// scenario and seed give the same bytes, whatever the number of threads (0: as many as cores).
Result<SimulationReport> simulate(const Scenario& scenario, uint64_t seed, const std::filesystem::path& output,
                                  const std::function<void(size_t, size_t)>& progress, unsigned threads = 0);

}  // namespace odograph
