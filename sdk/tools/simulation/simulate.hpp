// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <functional>

#include "sdk/host/base/result.hpp"
#include "sdk/tools/recording/recording.hpp"
#include "sdk/tools/simulation/frame_maker.hpp"
#include "sdk/tools/simulation/scenario.hpp"

namespace odograph {

struct SimulationReport {
  size_t frames = 0;
  double seconds = 0;  ///< wall clock
  unsigned threads = 0;
  FrameMaker::Times times;
  std::vector<float> moving_parts;  ///< for each frame, the fraction that shows moving objects
};

struct SimulationOptions {
  unsigned threads = 0;                          ///< 0: one per core
  std::function<void(size_t, size_t)> progress;  ///< frames done, frames in all; may be empty
  std::filesystem::path city;                    ///< output path for CityJSON of the generated town; empty: none
  bool frames = true;                            ///< false: the other sensors only, without a camera, much faster
  const Recording* walk = nullptr;               ///< a real walk to retrace in the scenario's world (hybrid)
};

/// Latitude and longitude (rad) and ellipsoidal height (m) of the origin of simulated walks and drives.
inline constexpr std::array<double, 3> kSimulatedOrigin = {0.8238, -0.0271, 20.0};

/// Writes the survey of the scenario: for fix/known_object `objects.yaml` (corners as latitude, longitude, ellipsoidal
/// height) and the posters' pictures beside it; for fix/terrain `ground.obj`, n's origin at its zero.
Result<bool> write_known_objects(const Scenario& scenario, uint64_t seed, const std::filesystem::path& folder);

/// Generates an Odograph recording of the scenario: IMU, magnetometer, GNSS, barometer, surveyed marks, camera frames,
/// and the truth: the camera's pose at every frame, the body's state at every IMU sample, steps and modes, the skyline
/// once a second (720 directions), known objects in the frames. The same scenario and seed yield the same bytes for any
/// number of threads.
///
/// With a real walk, the recording contains that walk's sensor samples and waypoints (rotated to its phone's north) and
/// pictures rendered along it; see reconstruct_walk().
Result<SimulationReport> simulate(const Scenario& scenario, uint64_t seed, const std::filesystem::path& output,
                                  const SimulationOptions& options = {});

/// The recording of the scenario without a camera, in memory, single-threaded.
Result<Recording> simulated(const Scenario& scenario, uint64_t seed);

}  // namespace odograph
