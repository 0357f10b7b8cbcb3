// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace odograph {
/// Library version "major.minor.patch", from the build file.
extern const char* const kVersion;
}  // namespace odograph
