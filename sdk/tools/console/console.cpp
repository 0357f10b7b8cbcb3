// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/console/console.hpp"

#include <cstdio>

#include <unistd.h>

#include "sdk/host/base/printable.hpp"

namespace odograph {

int print_failure(const Failure& failure) {
  std::fprintf(stderr, "%s\n", printable(failure.text).c_str());
  switch (failure.status) {
    case ODO_E_CONFIG:
    case ODO_E_ARGUMENT:
    case ODO_E_UNSUPPORTED: return kBadUsage;
    case ODO_E_DATA:
    case ODO_E_VERSION:
    case ODO_E_NOT_FOUND:
    case ODO_E_IO: return kBadData;
    default: return kPluginFailure;
  }
}

Result<Recording> open_recording(const std::string& path, const ReadOptions& options) {
  auto recording = read_recording(path, options);
  if (recording)
    for (const auto& warning : recording->warnings)
      std::fprintf(stderr, "%s\n", printable(path + ": " + warning).c_str());
  return recording;
}

int exit_status(const RecordingLoss& loss, int status) {
  return loss.any() && (status == kDone || status == kLostTracking) ? kBadData : status;
}

Progress::Progress(std::string what) : what_(std::move(what)), on_(isatty(STDERR_FILENO) != 0) {}
Progress::~Progress() {
  if (on_ && percent_ >= 0) std::fprintf(stderr, "\r\033[K");
}
void Progress::show(size_t done, size_t all) {
  const int percent = all > 0 ? static_cast<int>(100 * done / all) : 100;
  if (!on_ || percent == percent_) return;
  percent_ = percent;
  std::string bar(static_cast<size_t>(percent) * 3 / 10, '#');
  std::fprintf(stderr, "\r%s [%-30s] %3d %%", what_.c_str(), bar.c_str(), percent);
  std::fflush(stderr);
}

}  // namespace odograph
