// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <odograph/attitude.h>

#include "tests/hostile/table.hpp"

namespace hostile {

/// The answer of a good attitude plugin to an IMU sample: a horizontal attitude, whatever the sample.
inline int32_t emit_horizontal_attitude(const odo_header& sample) {
  odo_attitude a;
  std::memset(static_cast<void*>(&a), 0, sizeof a);
  a.header = sample;
  a.header.struct_size = sizeof a, a.header.type = ODO_TYPE_ATTITUDE, a.header.flags = 0;
  a.q_n_b[0] = a.q_n_b[1] = 0.70710678118654757;  // the phone's y points up
  for (int i = 0; i < 3; ++i) a.covariance_n[4 * i] = 1e-3;
  return emit(a.header);
}

}  // namespace hostile
