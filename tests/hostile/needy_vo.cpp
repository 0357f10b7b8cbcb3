// SPDX-License-Identifier: Apache-2.0
// A front-end that rejects frames of an uncalibrated camera, loses the calibration on reset, and fails at an exposure
// of 666 ns. Between any two frames it reports 5 cm forward.
#define HOSTILE_ID "test/needy_vo"
#include "tests/hostile/table.hpp"

namespace {

struct {
  bool calibrated = false;
  int64_t last_ns = 0;
} state;

int32_t take(const odo_header& message) {
  if (message.type == ODO_TYPE_CALIBRATION) state.calibrated = true;
  if (message.type != ODO_TYPE_FRAME) return ODO_OK;
  if (reinterpret_cast<const odo_frame&>(message).exposure_ns == 666) return ODO_E_ERROR;
  if (!state.calibrated) return ODO_E_DISCARD;
  if (state.last_ns != 0) {
    odo_vo_motion motion = hostile::motion(state.last_ns, message.t_ns);
    motion.p_c0_c1[2] = 0.05;
    hostile::sink()->emit(hostile::sink(), &motion.header);
  }
  state.last_ns = message.t_ns;
  return ODO_OK;
}

}  // namespace

HOSTILE_PLUGIN {
  HOSTILE_SERVES(t, ODO_INTERFACE_VO_FRONTEND);
  t.create = [](const odo_host*, uint32_t, const odo_string*, odo_instance** out_instance) -> int32_t {
    state = {};
    *out_instance = reinterpret_cast<odo_instance*>(&hostile::instance());
    return ODO_OK;
  };
  t.reset = [](odo_instance*) -> int32_t { return state = {}, ODO_OK; };
  t.process = [](odo_instance*, const odo_batch* batch) -> int32_t {
    for (uint32_t i = 0; i < batch->count; ++i)
      if (const int32_t status = take(*batch->messages[i]); status < 0) return status;
    return ODO_OK;
  };
}
