// SPDX-License-Identifier: Apache-2.0
//
// A plugin that executes orders (hostile/obeys.cpp), in the app's process or isolated.
#pragma once

#include <odograph/types.h>

namespace odograph {

/// One call of its process function.
struct Order {
  odo_header header;
  int32_t status;      ///< returned
  uint32_t sleep_ms;   ///< duration of the call
  uint32_t emits;      ///< scales: 1 + the learnt number; displacement_m: orders since activation or reset
  uint32_t learn;      ///< number to store and save; 0: none
  uint32_t ends;       ///< nonzero: ends the calling process
  uint32_t rounds_up;  ///< nonzero: leaves that rounding mode set
};

inline Order order(int64_t t_ns) {
  Order o{};
  o.header.struct_size = sizeof o;
  o.header.type = ODO_TYPE_VENDOR(0, 1);
  o.header.t_ns = t_ns;
  return o;
}

}  // namespace odograph
