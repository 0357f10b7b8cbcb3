// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "sdk/host/config/pipeline_config.hpp"
#include "sdk/tools/replay/runner.hpp"

namespace odograph {

using SessionHandle = std::unique_ptr<odo_session, void (*)(odo_session*)>;

/// The pipeline config that the options come to, with their overrides in it.
Result<PipelineConfig> config_of(const RunOptions& options);

/// A session through the C API, as an app has it, that gives the same bytes each time.
Result<SessionHandle> replay_session(const RunOptions& options);

/// Hands in a message of a recording, a picture with its pixels.
std::optional<Failure> push(odo_session* session, const RecordedMessage& message);

}  // namespace odograph
