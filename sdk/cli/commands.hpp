// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

#include "sdk/base/result.hpp"
#include "sdk/recording/recording.hpp"

namespace odograph {

/// Exit statuses of the command line.
enum Exit { kDone = 0, kLostTracking = 1, kBadUsage = 2, kBadData = 3, kPluginFailure = 4 };

/// Each adds its subcommand; its callback writes the exit status.
void add_run(CLI::App& app, int& status);
void add_eval(CLI::App& app, int& status);
void add_sim(CLI::App& app, int& status);
void add_config(CLI::App& app, int& status);
void add_plugins(CLI::App& app, int& status);
void add_convert(CLI::App& app, int& status);
void add_calibrate(CLI::App& app, int& status);
void add_bench(CLI::App& app, int& status);
void add_steps(CLI::App& app, int& status);
void add_compare(CLI::App& app, int& status);
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

/// Prints "odograph: text" on standard error and returns the status that fits the failure.
int complain(const Failure& failure);

/// Reads a recording, and says on standard error what it lacks.
Result<Recording> open_recording(const std::string& path, const ReadOptions& options = {});

/// The status of a command that came to its end over a recording: kBadData where something of it was lost.
int status_over(const RecordingLoss& loss, int status);

/// A progress bar on a terminal, nothing in a pipe.
class Progress {
 public:
  explicit Progress(std::string what);
  ~Progress();
  void show(size_t done, size_t all);

 private:
  std::string what_;
  bool on_;
  int percent_ = -1;
};

}  // namespace odograph
