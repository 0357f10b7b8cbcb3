// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

#include "sdk/tools/recording/recording.hpp"

namespace odograph {

/// A file's text, or why there is none.
Result<std::string> text_of(const std::filesystem::path& file);

/// The recording of a scenario and seed in the folder `keep`, made now unless it is kept there from an earlier run of
/// the same scenario by the same simulator. `first_m` above 0: only that much of the path. Shows progress.
Result<std::filesystem::path> kept_recording(const std::filesystem::path& scenario, uint64_t seed,
                                             const std::filesystem::path& keep, double first_m);

/// The folder beside a kept recording with what belongs to it: the generated town's model, `city.json`.
std::filesystem::path assets_of(const std::filesystem::path& recording);

/// The recordings that a benchmark goes through: given ones, or simulated ones that are kept.
struct RecordingChoice {
  std::vector<std::string> recordings;
  std::string scenario = "samples/scenarios/street_short.yaml", keep = "out/bench";
  uint64_t seeds = 1, first_seed = 1;

  /// `what`: of the recordings, for the help text.
  void add_options(CLI::App& command, const std::string& what);
  /// Renders what is not kept yet.
  Result<std::vector<std::filesystem::path>> files() const;
};

}  // namespace odograph
