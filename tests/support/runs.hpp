// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <doctest/doctest.h>

#include "sdk/tools/recording/recording.hpp"
#include "sdk/tools/replay/runner.hpp"
#include "sdk/tools/simulation/simulate.hpp"
#include "tests/support/support.hpp"

namespace odograph {

/// A recording of the scenario without a camera; a failure ends the case.
inline Recording recorded_sensors(const Scenario& scenario, uint64_t seed) {
  auto recording = required(simulated(scenario, seed));
  return std::move(*recording);
}

/// A recording that is read from a file or folder; a failure ends the case.
inline Recording recorded(const std::filesystem::path& path) {
  auto recording = required(read_recording(path));
  return std::move(*recording);
}

/// The recording of a scenario as read back from its file, which is gone: frames have no pictures.
inline Recording recorded(const Scenario& scenario, uint64_t seed, bool frames) {
  const TemporaryFolder folder;
  REQUIRE(simulate(scenario, seed, folder / "x.odo", {.threads = 1, .frames = frames}).ok());
  return recorded(folder / "x.odo");
}

/// The messages of a type, in the struct of this version.
template <class Message>
std::vector<Message> messages_of(const Recording& recording, uint32_t type) {
  std::vector<Message> found;
  for (const RecordedMessage& m : recording.messages)
    if (m.message.header().type == type) found.push_back(as<Message>(m.message.header()));
  return found;
}

inline RunResult run_of(const Recording& recording, const RunOptions& options) {
  auto result = required(replay(recording, options));
  return std::move(*result);
}

/// A config's file, with the build's plugins.
inline RunOptions options_of(const std::filesystem::path& config) {
  RunOptions options;
  options.config = config.string();
  options.plugin_path = plugin_folder().string();
  return options;
}

inline RunResult run_of(const Recording& recording, const std::filesystem::path& config) {
  return run_of(recording, options_of(config));
}

}  // namespace odograph
