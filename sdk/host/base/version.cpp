// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/base/version.hpp"

namespace odograph {

const char* const kVersion = ODOGRAPH_VERSION;

}  // namespace odograph
