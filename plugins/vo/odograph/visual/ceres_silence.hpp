// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mutex>

#include <glog/logging.h>

namespace odograph::vo {

#if defined(CERCES_INTERNAL_MINIGLOG_GLOG_LOGGING_H_)

/// Ceres has a small log of its own here, whose level was chosen when Ceres was built (MINIGLOG_MAX_LOG_LEVEL).
class CeresSilence {
 public:
  CeresSilence() {}
  ~CeresSilence() {}
};

#else

/// While one lives, nothing below a fatal error comes out of Ceres' log (glog): `logging_type = SILENT` leaves its
/// warnings of steps that could not be computed, and without an app that sets glog up they go to the terminal. What
/// failed is in the solver's summary. glog has one level for the whole process, so an app that logs by the same
/// libglog misses its own lines below fatal for the milliseconds of an adjustment. Any thread; they may overlap.
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
