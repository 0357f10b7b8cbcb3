// SPDX-License-Identifier: Apache-2.0
// A front-end that keeps the last frames as long as possible, and reports with each frame the number kept and the first
// pixel of the oldest one: p_c0_c1 = {kept, pixel, 0}.
#define HOSTILE_ID "test/retaining_vo"
#include <deque>

#include "tests/hostile/table.hpp"

namespace {

constexpr size_t kMax = 3;
std::deque<odo_frame> kept;
int64_t last_ns = 0;

void release_frame(size_t down_to) {
  for (; kept.size() > down_to; kept.pop_front()) kept.front().loan.release(kept.front().loan.owner);
}

int32_t take(const odo_header& message) {
  if (message.type != ODO_TYPE_FRAME) return ODO_OK;
  const auto& frame = reinterpret_cast<const odo_frame&>(message);
  if (frame.loan.retain && frame.loan.retain(frame.loan.owner) >= 0) kept.push_back(frame);
  release_frame(kMax);
  odo_vo_motion motion = hostile::motion(last_ns, message.t_ns);
  motion.p_c0_c1[0] = static_cast<double>(kept.size());
  motion.p_c0_c1[1] = kept.empty() ? -1 : kept.front().planes[0].data[0];
  if (last_ns != 0) hostile::emit(motion.header);
  last_ns = message.t_ns;
  return ODO_OK;
}

}  // namespace

HOSTILE_PLUGIN {
  HOSTILE_SERVES(t, ODO_INTERFACE_VO_FRONTEND);
  t.create = hostile::create_after<[] { kept.clear(), last_ns = 0; }>;
  t.process = hostile::process_each<take>;
  t.destroy = [](odo_instance*) { release_frame(0); };
}
