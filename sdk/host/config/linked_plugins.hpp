// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sdk/host/config/manifest.hpp"

namespace odograph {

/// Adds a plugin to those of this process that are linked into the program. Adding an entry again changes nothing.
/// ODO_E_CONFIG when another entry has its id. [any]
Result<bool> add_linked_plugin(const Manifest& manifest);

/// All of them, in the order in which they were added. [any]
std::vector<Manifest> linked_plugins();

}  // namespace odograph
