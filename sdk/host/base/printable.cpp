// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/base/printable.hpp"

#include <algorithm>
#include <cstdio>

namespace odograph {
namespace {

std::string hexadecimal(unsigned byte) {
  char escaped[8];
  std::snprintf(escaped, sizeof escaped, "\\x%02X", byte & 0xFFu);
  return escaped;
}

}  // namespace

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
    out += hexadecimal(c1 ? next : byte);
    if (c1) ++i;
  }
  return out;
}

size_t utf8_character(std::string_view text) {
  const auto at = [&](size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u; };
  const unsigned first = at(0), second = at(1);
  if (text.empty() || (first >= 0x80 && first < 0xC2) || first >= 0xF5) return 0;
  const size_t bytes = first < 0x80 ? 1 : first < 0xE0 ? 2 : first < 0xF0 ? 3 : 4;
  for (size_t i = 1; i < bytes; ++i)
    if ((at(i) & 0xC0) != 0x80) return 0;
  const bool is_longer_than_needed = (first == 0xE0 && second < 0xA0) || (first == 0xF0 && second < 0x90);
  const bool is_no_character = (first == 0xED && second >= 0xA0) || (first == 0xF4 && second >= 0x90);
  return is_longer_than_needed || is_no_character ? 0 : bytes;
}

std::string_view whole_characters(std::string_view text, size_t longest) {
  if (text.size() <= longest) return text;
  size_t end = longest;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80) --end;
  return text.substr(0, end);
}

std::string one_line(std::string_view text, size_t longest) {
  std::string out;
  while (!text.empty() && out.size() < longest) {
    const size_t bytes = utf8_character(text);
    std::string next(text.substr(0, std::max<size_t>(bytes, 1)));
    if (next == "\n")
      next = " ";
    else if (bytes == 0)
      next = hexadecimal(static_cast<unsigned char>(text[0]));
    else
      next = printable(next);
    text.remove_prefix(std::max<size_t>(bytes, 1));
    if (out.size() + next.size() > longest) break;
    out += next;
  }
  return out;
}

}  // namespace odograph
