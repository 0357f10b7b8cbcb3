// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace odograph {

/// A text as a terminal may be shown it: control characters but the line feed, which files, plugins and file names may
/// hold, become \xNN, the C1 ones in UTF-8 too.
std::string printable(std::string_view text);

}  // namespace odograph
