// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace odograph {

/// Levenshtein distance, case-insensitive in ASCII.
int edit_distance(std::string_view a, std::string_view b);

/// The candidate nearest to `word`, or "" if there are none.
std::string nearest(std::string_view word, const std::vector<std::string>& candidates);

/// ", did you mean 'x'?" if a candidate is close enough, otherwise "".
std::string did_you_mean(std::string_view word, const std::vector<std::string>& candidates);

/// "a, b, c".
std::string join(const std::vector<std::string>& words, std::string_view separator = ", ");

/// The parts of `text` between separators, without empty ones.
std::vector<std::string> split(std::string_view text, char separator);

}  // namespace odograph
