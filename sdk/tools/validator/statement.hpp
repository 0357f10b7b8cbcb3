// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "sdk/host/config/manifest.hpp"
#include "sdk/tools/validator/check.hpp"

namespace odograph {

/// Result of `plugin check` as a statement for publication (Markdown): plugin, kinds, contract, hash, number of cases,
/// version and machine of the test; each case that failed or does not apply. `checks` must contain all cases.
std::string conformance_statement(const Manifest& manifest, const std::vector<PluginCheck>& checks);

/// The same in one line, as an SVG picture of 20 pixels' height: "odo.scale_source/1 | 120 cases passed".
std::string conformance_badge(const Manifest& manifest, const std::vector<PluginCheck>& checks);

}  // namespace odograph
