// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cfenv>

namespace odograph {

/// Rounds to the nearest, traps nothing and keeps denormal numbers, whatever the caller's thread does, until its end:
/// then the caller's environment is back. What a session gives depends on its input alone.
class DefaultFloatingPoint {
 public:
  DefaultFloatingPoint() {
    std::fegetenv(&before_);
    restore();
  }
  ~DefaultFloatingPoint() { std::fesetenv(&before_); }
  DefaultFloatingPoint(const DefaultFloatingPoint&) = delete;
  DefaultFloatingPoint& operator=(const DefaultFloatingPoint&) = delete;

  /// Again, after code of others has run.
  static void restore() { std::fesetenv(FE_DFL_ENV); }
  static bool rounds_to_nearest() { return std::fegetround() == FE_TONEAREST; }

 private:
  std::fenv_t before_;
};

}  // namespace odograph
