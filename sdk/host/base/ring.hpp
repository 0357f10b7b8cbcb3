// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sdk/math/ring.hpp"  // IWYU pragma: export
