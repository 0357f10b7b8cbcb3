// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <odograph/odograph.h>

#include "sdk/recording/recording.hpp"

namespace odograph {

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

using SessionHandle = std::unique_ptr<odo_session, void (*)(odo_session*)>;

/// A session through the C API, as an app has it, that gives the same bytes each time.
Result<SessionHandle> replay_session(const std::string& config);

/// Hands in a message of a recording, a picture with its pixels.
std::optional<Failure> push(odo_session* session, const RecordedMessage& message);

}  // namespace odograph
