// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sdk/tools/benchmarks/bench_case.hpp"

namespace odograph {

/// `odograph bench ...`: adds each benchmark as a subcommand; its callback writes the exit status.
void add_bench(CLI::App& app, int& status);
/// `odograph city bench`.
void add_bench_city(CLI::App& city, int& status);

using Benchmarks = std::vector<std::shared_ptr<Benchmark>>;
Benchmarks app_benchmarks();
Benchmarks calibration_benchmarks();
Benchmarks city_benchmarks();
Benchmarks fixes_benchmarks();
Benchmarks papers_benchmarks();
Benchmarks steps_benchmarks();
std::shared_ptr<Benchmark> surfaces_benchmark();
std::shared_ptr<Benchmark> map_benchmark();
Benchmarks tracks_benchmarks();
Benchmarks vo_benchmarks();
std::shared_ptr<Benchmark> walk700_benchmark();
Benchmarks windows_benchmarks();

}  // namespace odograph
