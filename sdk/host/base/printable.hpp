// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include <odograph/base.h>

namespace odograph {

inline std::string text(const odo_string& s) { return s.size && s.data ? std::string(s.data, s.size) : std::string(); }

/// Makes a text safe for a terminal: control characters except line feed, which may come from files, plugins and file
/// names, become \xNN, including UTF-8 encoded C1 characters.
std::string printable(std::string_view text);

/// Length in bytes of the UTF-8 character (RFC 3629) at the start of the text; 0 if there is none.
size_t utf8_character(std::string_view text);

/// The first `longest` bytes of the text at most, not cut within a character.
std::string_view whole_characters(std::string_view text, size_t longest);

/// Copies a text into a NUL-terminated field of a message.
template <size_t kSize>
void copy_text(char (&field)[kSize], std::string_view text) {
  const auto fitting = whole_characters(text, kSize - 1);
  field[fitting.copy(field, fitting.size())] = 0;
}

/// Makes an untrusted text safe for a report: one line of UTF-8 of at most `longest` bytes. Line feeds become blanks;
/// invalid UTF-8 and control characters become \xNN.
std::string one_line(std::string_view text, size_t longest);

}  // namespace odograph
