// SPDX-License-Identifier: Apache-2.0
// A front-end before a wall: its camera, 1.4 m from a grid of landmarks, moves by 5 cm along the columns of the picture
// from frame to frame.
#define HOSTILE_ID "test/wall_vo"
#include <cmath>

#include "tests/hostile/table.hpp"

#include <odograph/plugin_messages.hpp>

namespace {

struct {
  int64_t last_ns = 0;
  double moved_m = 0;
} state;
odo::PointsWriter points;

int32_t take(const odo_header& message) {
  constexpr double kAhead_m = 1.4, kStep_m = 0.05, kSpacing_m = 0.11, kReach_m = 1.2;
  if (message.type != ODO_TYPE_FRAME) return ODO_OK;
  if (state.last_ns != 0) {
    state.moved_m += kStep_m;
    points.begin(message.t_ns, message.source, 0, true);
    const auto first = static_cast<int64_t>(std::ceil((state.moved_m - kReach_m) / kSpacing_m));
    for (int64_t row = first; row * kSpacing_m < state.moved_m + kReach_m; ++row)
      for (int64_t column = -10; column <= 10; ++column) {
        odo_point point{};
        point.id = static_cast<uint64_t>((row + 1000) * 100 + column + 50), point.age = 5;
        point.p_c[0] = static_cast<float>(column * kSpacing_m);
        point.p_c[1] = static_cast<float>(row * kSpacing_m - state.moved_m), point.p_c[2] = kAhead_m;
        point.covariance[0] = point.covariance[3] = point.covariance[5] = 1e-4f;
        points.add(point);
      }
    hostile::emit(points.message().header);
    odo_vo_motion motion = hostile::motion(state.last_ns, message.t_ns);
    motion.p_c0_c1[1] = kStep_m;
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
