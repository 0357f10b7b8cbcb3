// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

namespace odograph {

/// `odograph bench ...`: each adds its subcommand; its callback writes the exit status.
void add_bench(CLI::App& app, int& status);
void add_bench_walk700(CLI::App& bench, int& status);
void add_bench_allan(CLI::App& bench, int& status);
void add_bench_anchors(CLI::App& bench, int& status);
void add_bench_calibrate(CLI::App& bench, int& status);
void add_bench_canyon(CLI::App& bench, int& status);
void add_bench_calibrate_imu(CLI::App& bench, int& status);
void add_bench_drive(CLI::App& bench, int& status);
void add_bench_steps(CLI::App& bench, int& status);
void add_bench_tracks(CLI::App& bench, int& status);
void add_bench_gait(CLI::App& bench, int& status);
void add_bench_known_object(CLI::App& bench, int& status);
void add_bench_stream(CLI::App& bench, int& status);
void add_bench_vo(CLI::App& bench, int& status);
/// `odograph city bench`.
void add_bench_city(CLI::App& city, int& status);

}  // namespace odograph
