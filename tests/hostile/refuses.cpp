// SPDX-License-Identifier: Apache-2.0
#include "tests/hostile/table.hpp"

extern "C" int32_t ODO_PLUGIN_ENTRY(const odo_host*, odo_plugin* out) {
  static const char why[] = "the licence has expired";
  out->refusal = {why, sizeof why - 1};
  return ODO_E_UNSUPPORTED;
}
