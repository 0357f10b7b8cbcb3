// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/benchmarks/benchmarks.hpp"

namespace odograph {

void add_bench(CLI::App& app, int& status) {
  auto* command = app.add_subcommand("bench", "Run configs over many recordings and print a table");
  command->require_subcommand(1);
  for (const auto& group : {steps_benchmarks, papers_benchmarks, vo_benchmarks, windows_benchmarks, app_benchmarks,
                            fixes_benchmarks, calibration_benchmarks, tracks_benchmarks})
    for (const auto& benchmark : group()) add_benchmark(*command, benchmark, status);
}

void add_bench_city(CLI::App& city, int& status) {
  for (const auto& benchmark : city_benchmarks()) add_benchmark(city, benchmark, status);
}

}  // namespace odograph
