// SPDX-License-Identifier: Apache-2.0
#pragma once

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
inline Recording recorded(const fs::path& path) {
  auto recording = required(read_recording(path));
  return std::move(*recording);
}

/// The recording of a scenario as read back from its file, which its pictures are read from later.
inline Recording recorded(const Scenario& scenario, uint64_t seed, const fs::path& path,
                          const SimulationOptions& options = {.threads = 1}) {
  const auto made = required(simulate(scenario, seed, path, options));
  return recorded(path);
}

/// The same with a file that is gone: frames have no pictures.
inline Recording recorded(const Scenario& scenario, uint64_t seed, bool frames) {
  const TemporaryFolder folder;
  return recorded(scenario, seed, folder / "x.odo", {.threads = 1, .frames = frames});
}

/// Calls a function with each of the recording's pictures.
template <class Use>
void for_each_picture(const Recording& recording, Use&& use) {
  for (const RecordedMessage& m : recording.messages) {
    if (m.message.header().type != ODO_TYPE_FRAME) continue;
    const auto frame = required(load_frame(m));
    use(*frame);
    frame->loan.release(frame->loan.owner);
  }
}

/// The mean of a grey picture.
inline double mean_grey(const odo_frame& frame) {
  double sum = 0;
  for (uint32_t y = 0; y < frame.height; ++y)
    for (uint32_t x = 0; x < frame.width; ++x) sum += frame.planes[0].data[y * frame.planes[0].row_stride + x];
  return sum / (frame.width * frame.height);
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
inline RunOptions options_of(const fs::path& config) {
  RunOptions options;
  options.config = config.string();
  options.plugin_path = plugin_folder().string();
  return options;
}

inline RunResult run_of(const Recording& recording, const fs::path& config) {
  return run_of(recording, options_of(config));
}

}  // namespace odograph
