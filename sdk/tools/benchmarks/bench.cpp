// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/benchmarks/benchmarks.hpp"

namespace odograph {

void add_bench(CLI::App& app, int& status) {
  auto* command = app.add_subcommand("bench", "Run configs over many recordings and print a table");
  command->require_subcommand(1);
  for (const auto& make : {bench_walks, bench_walk700, bench_allan, bench_anchors, bench_calibrate, bench_calibrate_imu,
                           bench_canyon, bench_consistency, bench_drive, bench_gait, bench_known_object, bench_stream,
                           bench_vo, bench_steps, bench_tracks})
    add_benchmark(*command, make(), status);
}

void add_bench_city(CLI::App& city, int& status) { add_benchmark(city, bench_city(), status); }

}  // namespace odograph
