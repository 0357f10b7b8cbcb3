// SPDX-License-Identifier: Apache-2.0
// A good plugin that needs the library neighbour.so in its folder ($ORIGIN).
#include "tests/hostile/table.hpp"

extern "C" int hostile_neighbour();

extern "C" int32_t ODO_PLUGIN_ENTRY(const odo_host*, odo_plugin* out) {
  return hostile_neighbour() == 7 ? hostile::fill(out, hostile::table()) : ODO_E_ERROR;
}
