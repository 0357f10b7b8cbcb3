// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>

#include "sdk/host/config/pipeline_config.hpp"
#include "sdk/tools/replay/runner.hpp"

namespace odograph {

using SessionHandle = std::unique_ptr<odo_session, void (*)(odo_session*)>;

/// Sets the config and, before the overrides that the options have, those of `set` ("PATH=VALUE") and of the choice:
/// FILE or FILE?PATH=VALUE&PATH=VALUE.
Result<bool> choose_config(RunOptions& options, const std::string& choice, const std::vector<std::string>& set);

/// The pipeline config of the options, with overrides applied.
Result<PipelineConfig> config_of(const RunOptions& options);

/// A deterministic session through the C API, as an app uses it.
Result<SessionHandle> replay_session(const RunOptions& options);

/// Pushes a message of a recording, with a picture's pixels.
std::optional<Failure> push(odo_session* session, const RecordedMessage& message);

}  // namespace odograph
