// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace odograph {
/// Library version "major.minor.patch", from the build file.
inline constexpr const char* kVersion = ODOGRAPH_VERSION;
}  // namespace odograph
