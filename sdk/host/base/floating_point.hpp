// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cfenv>

namespace odograph {

/// Sets the default floating-point environment for its lifetime (round to nearest, no traps, denormals kept), then
/// restores the caller's. A session's output must depend only on its input.
class DefaultFloatingPoint {
 public:
  DefaultFloatingPoint() {
    std::fegetenv(&before_);
    restore();
  }
  ~DefaultFloatingPoint() { std::fesetenv(&before_); }
  DefaultFloatingPoint(const DefaultFloatingPoint&) = delete;
  DefaultFloatingPoint& operator=(const DefaultFloatingPoint&) = delete;

  /// Sets it again, after foreign code has run.
  static void restore() { std::fesetenv(FE_DFL_ENV); }
  static bool rounds_to_nearest() { return std::fegetround() == FE_TONEAREST; }

 private:
  std::fenv_t before_;
};

}  // namespace odograph
