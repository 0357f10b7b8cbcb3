// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>

#include <odograph/odograph.h>

#include "sdk/tools/recording/recording.hpp"

namespace odograph {

using SessionHandle = std::unique_ptr<odo_session, void (*)(odo_session*)>;

/// A session through the C API, as an app has it, that gives the same bytes each time.
Result<SessionHandle> replay_session(const std::string& config);

/// Hands in a message of a recording, a picture with its pixels.
std::optional<Failure> push(odo_session* session, const RecordedMessage& message);

}  // namespace odograph
