// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/base/printable.hpp"

#include <cstdio>

namespace odograph {

std::string printable(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    const auto next = i + 1 < text.size() ? static_cast<unsigned char>(text[i + 1]) : 0;
    const bool c1 = byte == 0xC2 && next >= 0x80 && next < 0xA0;
    if (!c1 && (byte == '\n' || (byte >= 0x20 && byte != 0x7F))) {
      out += text[i];
      continue;
    }
    char escaped[8];
    std::snprintf(escaped, sizeof escaped, "\\x%02X", c1 ? next : byte);
    out += escaped;
    if (c1) ++i;
  }
  return out;
}

}  // namespace odograph
