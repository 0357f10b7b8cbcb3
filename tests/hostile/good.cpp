// SPDX-License-Identifier: Apache-2.0
// The correct plugin that the others are variations of.
#include "tests/hostile/table.hpp"

extern "C" int32_t ODO_PLUGIN_ENTRY(const odo_host*, odo_plugin* out) { return hostile::fill(out, hostile::table()); }
