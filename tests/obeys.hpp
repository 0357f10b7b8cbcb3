// SPDX-License-Identifier: Apache-2.0
//
// A plugin that does what it is told (hostile/obeys.cpp), in the app's process or in one of its own.
#pragma once

#include <odograph/types.h>

namespace odograph {

/// One call of its process function.
struct Order {
  odo_header header;
  int32_t status;      ///< that it returns
  uint32_t sleep_ms;   ///< that it takes
  uint32_t emits;      ///< scales: 1 + what it has learnt; displacement_m: orders since activation or reset
  uint32_t learn;      ///< what it knows from then on and saves; 0: nothing new
  uint32_t ends;       ///< not 0: it ends the process that calls it
  uint32_t rounds_up;  ///< not 0: it leaves that rounding mode behind
};

inline Order order(int64_t t_ns) {
  Order o{};
  o.header.struct_size = sizeof o;
  o.header.type = ODO_TYPE_VENDOR(0, 1);
  o.header.t_ns = t_ns;
  return o;
}

}  // namespace odograph
