// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sdk/tools/benchmarks/bench_case.hpp"

namespace odograph {

/// `odograph bench ...`: each benchmark a subcommand; its callback writes the exit status.
void add_bench(CLI::App& app, int& status);
/// `odograph city bench`.
void add_bench_city(CLI::App& city, int& status);

std::shared_ptr<Benchmark> bench_allan();
std::shared_ptr<Benchmark> bench_anchors();
std::shared_ptr<Benchmark> bench_calibrate();
std::shared_ptr<Benchmark> bench_calibrate_imu();
std::shared_ptr<Benchmark> bench_canyon();
std::shared_ptr<Benchmark> bench_city();
std::shared_ptr<Benchmark> bench_consistency();
std::shared_ptr<Benchmark> bench_drive();
std::shared_ptr<Benchmark> bench_gait();
std::shared_ptr<Benchmark> bench_known_object();
std::shared_ptr<Benchmark> bench_steps();
std::shared_ptr<Benchmark> bench_stream();
std::shared_ptr<Benchmark> bench_tracks();
std::shared_ptr<Benchmark> bench_vo();
std::shared_ptr<Benchmark> bench_walk700();
std::shared_ptr<Benchmark> bench_walks();

}  // namespace odograph
