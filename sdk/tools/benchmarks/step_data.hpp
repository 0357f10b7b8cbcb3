// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sdk/tools/benchmarks/bench_case.hpp"

namespace odograph {

/// The walks of real data folders as cases, labelled with the names of folder and walk. A folder without walks stands
/// for its subfolders.
Result<std::vector<BenchCase>> step_data_cases(const std::vector<std::string>& folders);
/// A row: count, distance, position, heading, floors, person and carrying position of the phone.
Json step_data_row(const Recording& recording, const RunResult& result);
/// Tables by data set, carrying position and person, with intervals over people.
std::string step_data_report(const Rows& rows);

}  // namespace odograph
