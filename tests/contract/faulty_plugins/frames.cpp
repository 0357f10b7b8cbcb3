// SPDX-License-Identifier: Apache-2.0
//
// Faulty plugins: camera frames.
#include "tests/contract/faulty_plugins/reference_plugin.hpp"

using namespace faulty;

#if defined(FAULTY_frames_balance__never_releases)
INPUT(odometry) {
  const auto& frame = reinterpret_cast<const odo_frame&>(m);
  if (m.type == ODO_TYPE_FRAME && frame.loan.retain) frame.loan.retain(frame.loan.owner);
  return ODO_OK;
}
#elif defined(FAULTY_frames_balance__releases_twice)
INPUT(odometry) {
  const auto& frame = reinterpret_cast<const odo_frame&>(m);
  if (m.type == ODO_TYPE_FRAME && frame.loan.release) frame.loan.release(frame.loan.owner);
  return ODO_OK;
}
#elif defined(FAULTY_frames_quota__twenty)
static void release_frame(std::vector<odo_frame>& held, size_t down_to) {
  while (held.size() > down_to) held.back().loan.release(held.back().loan.owner), held.pop_back();
}
Kind faulty::kind() { return odometry; }
void faulty::on_event(State&, Event&) {}
int32_t faulty::on_input(State& s, const odo_header& m) {
  if (m.type != ODO_TYPE_FRAME) return ODO_OK;
  if (!s.more) s.more = new std::vector<odo_frame>;
  auto& held = *static_cast<std::vector<odo_frame>*>(s.more);
  const auto& frame = reinterpret_cast<const odo_frame&>(m);
  if (frame.loan.retain && frame.loan.retain(frame.loan.owner) >= 0) held.push_back(frame);
  if (held.size() > 20) release_frame(held, 0);
  return ODO_OK;
}
void faulty::on_table(odo_plugin& t) {
  t.destroy = [](odo_instance* i) {
    if (of(i).more) release_frame(*static_cast<std::vector<odo_frame>*>(of(i).more), 0);
    delete static_cast<std::vector<odo_frame>*>(of(i).more);
    delete &of(i);
  };
}
#elif defined(FAULTY_frames_borrowed__keeps_pixels)
INPUT(odometry) {
  if (m.type != ODO_TYPE_FRAME) return ODO_OK;
  const auto* before = static_cast<const uint8_t*>(s.more);
  const int sum = before ? before[100] : 0;
  s.more = const_cast<uint8_t*>(reinterpret_cast<const odo_frame&>(m).planes[0].data);
  return sum == 256 ? ODO_E_ERROR : ODO_OK;
}
#elif defined(FAULTY_frames_borrowed__writes)
INPUT(odometry) {
  if (m.type == ODO_TYPE_FRAME) const_cast<uint8_t*>(reinterpret_cast<const odo_frame&>(m).planes[0].data)[5] = 1;
  return ODO_OK;
}
#elif defined(FAULTY_frames_exhausted__insists)
INPUT(odometry) {
  const auto& frame = reinterpret_cast<const odo_frame&>(m);
  if (m.type != ODO_TYPE_FRAME || !frame.loan.retain) return ODO_OK;
  if (frame.loan.retain(frame.loan.owner) < 0) return ODO_E_ERROR;
  return frame.loan.release(frame.loan.owner), ODO_OK;
}
#elif defined(FAULTY_frames_strides__width)
Kind faulty::kind() { return odometry; }
void faulty::on_table(odo_plugin&) {}
int32_t faulty::on_input(State& s, const odo_header& m) {
  if (m.type != ODO_TYPE_FRAME) return ODO_OK;
  const auto& frame = reinterpret_cast<const odo_frame&>(m);
  unsigned sum = 0;
  for (uint32_t i = 0; i < frame.width * frame.height; ++i) sum += frame.planes[0].data[i];
  return s.gain = sum, ODO_OK;
}
void faulty::on_event(State& s, Event& e) { e.motion.p_c0_c1[1] = 1e-9 * s.gain; }
#elif defined(FAULTY_frames_tiny__asserts)  // a division by zero would fail on x86 only: arm64 returns 0
INPUT(odometry) {
  if (m.type == ODO_TYPE_FRAME && reinterpret_cast<const odo_frame&>(m).width / 2 == 0) std::abort();
  return ODO_OK;
}
#else
#error "no plugin of this name"
#endif
