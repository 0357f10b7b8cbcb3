// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace odograph {

/// printf into a string of any length.
std::string text(const char* format, ...) __attribute__((format(printf, 1, 2)));

}  // namespace odograph
