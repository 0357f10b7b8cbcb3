// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "sdk/host/config/manifest.hpp"
#include "sdk/tools/validator/check.hpp"

namespace odograph {

/// What `plugin check` found, as a statement that a vendor publishes (Markdown): plugin, kinds, contract, hash, counts
/// of cases, by which version and on which machine; each case that failed or does not apply. `checks` are all cases.
std::string conformance_statement(const Manifest& manifest, const std::vector<PluginCheck>& checks);

/// The same in a line, as an SVG picture of 20 pixels' height: "odo.scale_source/draft3 | 120 cases passed".
std::string conformance_badge(const Manifest& manifest, const std::vector<PluginCheck>& checks);

}  // namespace odograph
