// SPDX-License-Identifier: Apache-2.0
// Ends after `destroy`: the optional functions are not there. That is allowed.
#include "tests/hostile/table.hpp"

extern "C" int32_t ODO_PLUGIN_ENTRY(const odo_host*, odo_plugin* out) {
  return hostile::fill(out, hostile::table(), offsetof(odo_plugin, reset));
}
