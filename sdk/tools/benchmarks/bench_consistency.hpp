// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

namespace odograph {

/// `odograph bench consistency`.
void add_bench_consistency(CLI::App& bench, int& status);

}  // namespace odograph
