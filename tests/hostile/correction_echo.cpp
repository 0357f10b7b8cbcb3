// SPDX-License-Identifier: Apache-2.0
// A fixer that requests corrections: emits a fix 5 m beside the pose after some seconds, and each correction it
// receives as a fix that nobody may use.
#define HOSTILE_ID "test/correction_echo"
#include <odograph/absolute_fixer.h>

#include "tests/hostile/table.hpp"

namespace {

constexpr int kFixedPose = 20;
int poses = 0;

void emit(int64_t t_ns, const double p_n[3], double integrity) {
  auto fix = hostile::make<odo_fix>(ODO_TYPE_FIX, t_ns);
  fix.header.flags = ODO_FIX_NORTH | ODO_FIX_EAST | ODO_FIX_COVARIANCE | ODO_FIX_INTEGRITY;
  for (int k = 0; k < 3; ++k) fix.p_n[k] = p_n[k], fix.covariance_n[4 * k] = 1;
  fix.integrity = integrity;
  hostile::sink()->emit(hostile::sink(), &fix.header);
}

}  // namespace

extern "C" int32_t ODO_PLUGIN_ENTRY(const odo_host*, odo_plugin* out) {
  static const odo_string kind{ODO_INTERFACE_ABSOLUTE_FIXER, sizeof(ODO_INTERFACE_ABSOLUTE_FIXER) - 1};
  static const uint32_t inputs[] = {ODO_TYPE_CORRECTION};
  odo_plugin t = hostile::table();
  t.interfaces = &kind;
  t.inputs = inputs;
  t.input_count = 1;
  t.activate = [](odo_instance*, const odo_sink* s) -> int32_t { return poses = 0, hostile::sink() = s, ODO_OK; };
  t.process = [](odo_instance*, const odo_batch* batch) -> int32_t {
    for (uint32_t i = 0; i < batch->count; ++i) {
      const odo_header& header = *batch->messages[i];
      if (header.type == ODO_TYPE_CORRECTION) emit(header.t_ns, reinterpret_cast<const odo_correction&>(header).p_n, 1);
      if (header.type != ODO_TYPE_POSE || ++poses != kFixedPose) continue;
      const auto& pose = reinterpret_cast<const odo_pose&>(header);
      const double beside[3] = {pose.p_n[0] + 5, pose.p_n[1], pose.p_n[2]};
      emit(header.t_ns, beside, 0.01);
    }
    return ODO_OK;
  };
  return hostile::fill(out, t);
}
