// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/platform/crash.hpp"

#include <cstdio>

namespace odograph {

void set_crash_handler(const CrashHandler&, int) {}

void ensure_signal_stack() {}

void write_error(const char* text, size_t size) noexcept { (void)!std::fwrite(text, 1, size, stderr); }

}  // namespace odograph
