// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/text/text.hpp"

#include <algorithm>
#include <cstdarg>
#include <cstdio>

namespace odograph {

std::string text(const char* format, ...) {
  va_list arguments, again;
  va_start(arguments, format);
  va_copy(again, arguments);
  std::string out(static_cast<size_t>(std::max(0, std::vsnprintf(nullptr, 0, format, arguments))) + 1, '\0');
  va_end(arguments);
  std::vsnprintf(out.data(), out.size(), format, again);
  va_end(again);
  out.pop_back();
  return out;
}

}  // namespace odograph
