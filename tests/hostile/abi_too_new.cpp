// SPDX-License-Identifier: Apache-2.0
#include "tests/hostile/table.hpp"

HOSTILE_PLUGIN { t.abi_major = 3; }
