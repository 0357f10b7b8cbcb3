// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <nlohmann/json.hpp>

namespace odograph {

/// Prints rows of `bench vo` as two tables, the metre and the shape, each with medians where a config has several
/// rows, and what the columns mean.
void print_vo_tables(const std::vector<nlohmann::ordered_json>& rows);

}  // namespace odograph
