// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sdk/math/rotation.hpp"  // IWYU pragma: export
