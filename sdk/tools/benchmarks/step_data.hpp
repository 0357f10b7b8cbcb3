// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sdk/tools/benchmarks/bench_case.hpp"

namespace odograph {

/// The walks of folders of real data as cases, labelled with the folder's name and the walk's. A folder without walks
/// stands for those of its folders.
Result<std::vector<BenchCase>> step_data_cases(const std::vector<std::string>& folders);
/// A row: count, distance, position, heading, floors, by whom and where the phone was.
Json step_data_row(const Recording& recording, const RunResult& result);
/// Tables by data set, by carrying place and by person, with intervals over people.
std::string step_data_report(const Rows& rows);

}  // namespace odograph
