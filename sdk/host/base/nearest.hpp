// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace odograph {

/// Levenshtein distance, case-insensitive in ASCII.
int edit_distance(std::string_view a, std::string_view b);

/// The candidate nearest to `word`, or "" when there are none.
std::string nearest(std::string_view word, const std::vector<std::string>& candidates);

/// ", did you mean 'x'?" when a candidate is near enough to be meant, otherwise "".
std::string did_you_mean(std::string_view word, const std::vector<std::string>& candidates);

/// "a, b, c".
std::string join(const std::vector<std::string>& words, std::string_view separator = ", ");

/// The parts of `text` between separators; empty parts are dropped.
std::vector<std::string> split(std::string_view text, char separator);

}  // namespace odograph
