// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace odograph {
/// "major.minor.patch" of the library, from the build file.
inline constexpr const char* kVersion = ODOGRAPH_VERSION;
}  // namespace odograph
