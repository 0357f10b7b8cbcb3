// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "sdk/host/base/result.hpp"
#include "sdk/tools/recording/recording.hpp"

namespace odograph {

/// Exit statuses of the command line.
enum Exit { kDone = 0, kLostTracking = 1, kBadUsage = 2, kBadData = 3, kPluginFailure = 4 };

/// Prints "odograph: text" on standard error and returns the exit status for the failure.
int print_failure(const Failure& failure);

/// Reads a recording, and reports on standard error what is missing from it.
Result<Recording> open_recording(const std::string& path, const ReadOptions& options = {});

/// Exit status of a command that completed on a recording: kBadData if part of the recording was lost.
int exit_status(const RecordingLoss& loss, int status);

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
