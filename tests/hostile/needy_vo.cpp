// SPDX-License-Identifier: Apache-2.0
// A front-end that rejects frames of an uncalibrated camera, loses the calibration on reset, and fails at an exposure
// of 666 ns. Between any two frames it reports 300 points and 5 cm forward.
#define HOSTILE_ID "test/needy_vo"
#include "tests/hostile/table.hpp"

#include <odograph/plugin_messages.hpp>

namespace {

struct {
  bool calibrated = false;
  int64_t last_ns = 0;
} state;
odo::PointsWriter points;

int32_t take(const odo_header& message) {
  if (message.type == ODO_TYPE_CALIBRATION) state.calibrated = true;
  if (message.type != ODO_TYPE_FRAME) return ODO_OK;
  if (reinterpret_cast<const odo_frame&>(message).exposure_ns == 666) return ODO_E_ERROR;
  if (!state.calibrated) return ODO_E_DISCARD;
  if (state.last_ns != 0) {
    points.begin(message.t_ns, message.source, 0, false);
    for (uint64_t id = 1; id <= 300; ++id) {
      odo_point point{};
      point.id = id, point.p_c[2] = 2, point.covariance[0] = point.covariance[3] = point.covariance[5] = 0.01f;
      points.add(point);
    }
    hostile::emit(points.message().header);
    odo_vo_motion motion = hostile::motion(state.last_ns, message.t_ns);
    motion.p_c0_c1[2] = 0.05;
    hostile::emit(motion.header);
  }
  state.last_ns = message.t_ns;
  return ODO_OK;
}

}  // namespace

HOSTILE_PLUGIN {
  HOSTILE_SERVES(t, ODO_INTERFACE_VO_FRONTEND);
  t.create = hostile::create_after<[] { state = {}; }>;
  static const uint32_t outputs[] = {ODO_TYPE_POINTS};
  t.outputs = outputs, t.output_count = 1;
  t.reset = [](odo_instance*) -> int32_t { return state = {}, ODO_OK; };
  t.process = hostile::process_each<take>;
}
