// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sdk/host/config/manifest.hpp"

namespace odograph {

/// Registers a plugin that is linked into the program. Registering the same entry again has no effect. ODO_E_CONFIG if
/// another entry has its id. [any]
Result<bool> add_linked_plugin(const Manifest& manifest);

/// All registered plugins, in order of registration. [any]
std::vector<Manifest> linked_plugins();

}  // namespace odograph
