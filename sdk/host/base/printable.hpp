// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace odograph {

/// A text as a terminal may be shown it: control characters but the line feed, which files, plugins and file names may
/// hold, become \xNN, the C1 ones in UTF-8 too.
std::string printable(std::string_view text);

/// How many bytes the character has that the text begins with, by UTF-8 (RFC 3629); 0 where it begins with none.
size_t utf8_character(std::string_view text);

/// The text's beginning of at most `longest` bytes, not cut within a character.
std::string_view whole_characters(std::string_view text, size_t longest);

/// Into a field of a message, with a NUL behind it.
template <size_t kSize>
void copy_text(char (&field)[kSize], std::string_view text) {
  const auto fitting = whole_characters(text, kSize - 1);
  field[fitting.copy(field, fitting.size())] = 0;
}

/// What a stranger says, as a report may have it: one line of UTF-8 of at most `longest` bytes. Line feeds become
/// blanks, what is no UTF-8 becomes \xNN as control characters do.
std::string one_line(std::string_view text, size_t longest);

}  // namespace odograph
