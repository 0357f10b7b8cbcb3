// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mutex>

#include <glog/logging.h>

namespace odograph::vo {

#if defined(CERCES_INTERNAL_MINIGLOG_GLOG_LOGGING_H_)

/// Ceres built with its own miniglog: the log level is fixed at build time (MINIGLOG_MAX_LOG_LEVEL).
class CeresSilence {
 public:
  CeresSilence() {}
  ~CeresSilence() {}
};

#else

/// Suppresses Ceres' glog messages below FATAL while an instance lives. `logging_type = SILENT` does not suppress the
/// warnings of failed steps, which reach the terminal unless the app initialises glog. The solver's summary has the
/// cause of a failure. glog has one level per process: an app that uses the same libglog loses its own messages below
/// FATAL during an adjustment, some milliseconds. Thread-safe; instances may overlap.
class CeresSilence {
 public:
  CeresSilence() {
    const std::lock_guard lock(mutex());
    if (alive()++ > 0) return;
    level() = FLAGS_minloglevel;
    FLAGS_minloglevel = google::GLOG_FATAL;
  }
  ~CeresSilence() {
    const std::lock_guard lock(mutex());
    if (--alive() == 0) FLAGS_minloglevel = level();
  }
  CeresSilence(const CeresSilence&) = delete;
  CeresSilence& operator=(const CeresSilence&) = delete;

 private:
  static std::mutex& mutex() {
    static std::mutex one;
    return one;
  }
  static int& alive() {
    static int count = 0;
    return count;
  }
  static int& level() {
    static int before = 0;
    return before;
  }
};

#endif

}  // namespace odograph::vo
