// SPDX-License-Identifier: Apache-2.0
//
// Faulty plugins: crashes of the host, differences when run again, faulty sensors, cost.
#include <pthread.h>
#include <unistd.h>

#include <stdexcept>

#include "tests/contract/faulty_plugins/reference_plugin.hpp"

using namespace faulty;

// ---- what ends the host --------------------------------------------------------------------------------------------
#if defined(FAULTY_process_works__error)
INPUT(scale) { return s.inputs == 40 ? ODO_E_ERROR : ODO_OK; }
#elif defined(FAULTY_process_works__abort)
INPUT(scale) { return s.inputs == 40 ? (std::abort(), 0) : ODO_OK; }
#elif defined(FAULTY_process_works__segfault)
INPUT(scale) { return s.inputs == 40 ? *reinterpret_cast<volatile int*>(8) : ODO_OK; }
#elif defined(FAULTY_process_works__exit)
INPUT(scale) { return s.inputs == 40 ? (std::exit(0), 0) : ODO_OK; }
#elif defined(FAULTY_process_works__hangs)
INPUT(scale) {
  while (s.inputs == 40) usleep(1000);
  return ODO_OK;
}
#elif defined(FAULTY_process_works__stack_overflow)
static int deep(volatile char* above) {
  volatile char storage[4096];
  storage[0] = above[0];
  return deep(storage) + storage[0];
}
INPUT(scale) {
  volatile char storage[1] = {1};
  return s.inputs == 40 ? deep(storage) : ODO_OK;
}
#elif defined(FAULTY_process_works__pthread_exit)
INPUT(scale) {
  if (s.inputs == 40) pthread_exit(nullptr);
  return ODO_OK;
}
#elif defined(FAULTY_process_works__throws)
INPUT(scale) {
  if (s.inputs == 40) throw std::runtime_error("the fortieth sample is unlucky");
  return ODO_OK;
}
#elif defined(FAULTY_process_status__77)
TABLE(scale) {
  t.process = [](odo_instance*, const odo_batch*) -> int32_t { return 77; };
}
#elif defined(FAULTY_process_flags__gnss_height)
INPUT(fixer) {
  if (m.type != ODO_TYPE_GNSS) return ODO_OK;
  Event event;
  event.fix.header.flags = ODO_FIX_DOWN | ODO_FIX_COVARIANCE;
  event.fix.p_n[2] = -reinterpret_cast<const odo_gnss&>(m).height_m;
  for (int i = 0; i < 3; ++i) event.fix.covariance_n[4 * i] = 1;
  emit(s, event, ODO_TYPE_FIX, sizeof(odo_fix), m.t_ns);
  return ODO_OK;
}
#elif defined(FAULTY_process_flags__heading)
INPUT(scale) {
  if (m.type == ODO_TYPE_STEP) s.gain = 1 + 1e-3 * std::cos(reinterpret_cast<const odo_step&>(m).heading_rad);
  return ODO_OK;
}

// ---- faults and cost -----------------------------------------------------------------------------------------------
#elif defined(FAULTY_faults_huge__index)
INPUT(steps) {
  static int bins[64];
  const double x = m.type == ODO_TYPE_IMU ? reinterpret_cast<const odo_imu&>(m).accel_b[2] : 0;
  if (std::abs(x) > 1e6) bins[static_cast<int64_t>(std::fmod(x, 1e12)) | int64_t(1) << 40]++;
  return ODO_OK;
}
#elif defined(FAULTY_faults_vendor__believes_the_count)
Kind faulty::kind() { return attitude; }
void faulty::on_event(State&, Event&) {}
void faulty::on_table(odo_plugin& t) {
  static const uint32_t inputs[] = {ODO_TYPE_VENDOR(1, 1)};
  t.inputs = inputs, t.input_count = 1;
}
int32_t faulty::on_input(State& s, const odo_header& m) {
  static double seen[16];
  if (m.type != ODO_TYPE_VENDOR(1, 1) || m.struct_size < sizeof(odo_header) + 8) return ODO_OK;
  uint32_t count = 0;
  std::memcpy(&count, &m + 1, sizeof count);
  for (uint32_t i = 0; i < count; ++i) seen[i] += s.gain;
  return ODO_OK;
}
#elif defined(FAULTY_faults_long_steps__overflow)
INPUT(scale) {
  static float table[4];
  if (m.type == ODO_TYPE_STEP)
    table[static_cast<int64_t>(reinterpret_cast<const odo_step&>(m).length_m) * 100'000'000] = 1;
  return ODO_OK;
}
#elif defined(FAULTY_faults_gap_1h__loops)
INPUT(attitude) {
  int64_t& last = s.last_step_ns;
  if (m.type == ODO_TYPE_IMU && last)
    for (; last < m.t_ns; last += 1000) s.gain += 1e-12;
  last = m.t_ns;
  return ODO_OK;
}
#elif defined(FAULTY_cost_motion__sleeps)
INPUT(scale) { return m.type == ODO_TYPE_VO_MOTION ? usleep(20'000), ODO_OK : ODO_OK; }
#elif defined(FAULTY_cost_imu__120_ms)
INPUT(attitude) { return m.type == ODO_TYPE_IMU ? usleep(120'000), ODO_OK : ODO_OK; }
#elif defined(FAULTY_cost_memory__600_MB)
INPUT(scale) {
  if (!s.more) std::memset(s.more = std::malloc(size_t(600) << 20), 1, size_t(600) << 20);
  return ODO_OK;
}
// ---- the same again ------------------------------------------------------------------------------------------------
#elif defined(FAULTY_repeat_instance__counts_on)
EVENT(scale) {
  static int count = 0;
  e.scale.scale += 1e-6 * ++count;
}
#elif defined(FAULTY_repeat_process__pid)
EVENT(scale) { e.scale.scale += 1e-6 * getpid(); }
#elif defined(FAULTY_repeat_batches_of_17__first_of_batch)
TABLE(scale) {
  t.process = [](odo_instance* i, const odo_batch* batch) -> int32_t {
    odo_batch first = *batch;
    first.count = batch->count < 3 ? batch->count : 1;
    return process(i, &first);
  };
}
#elif defined(FAULTY_repeat_reset__keeps_count)
TABLE(steps) {
  t.reset = [](odo_instance* i) -> int32_t {
    const uint32_t kept = of(i).steps;
    return reset(i), of(i).steps = kept, ODO_OK;
  };
}
#elif defined(FAULTY_batch_empty__error)
TABLE(scale) {
  t.process = [](odo_instance* i, const odo_batch* batch) -> int32_t {
    return batch->count ? process(i, batch) : ODO_E_ARGUMENT;
  };
}
#elif defined(FAULTY_batch_read_only__writes)
INPUT(scale) {
  const_cast<odo_header&>(m).reserved = 1;
  return ODO_OK;
}
#elif defined(FAULTY_batch_read_only__keeps)
INPUT(attitude) {
  const odo_header* before = static_cast<const odo_header*>(std::exchange(s.more, const_cast<odo_header*>(&m)));
  return before && before->t_ns == 42 ? ODO_E_ERROR : ODO_OK;
}
#elif defined(FAULTY_growth_newer_type__aborts)
INPUT(scale) { return m.type > 0x10 && m.type < 0x1000 ? (std::abort(), 0) : ODO_OK; }
#elif defined(FAULTY_growth_vendor_type__error)
INPUT(scale) { return ODO_IS_VENDOR(m.type) ? ODO_E_ERROR : ODO_OK; }
#elif defined(FAULTY_growth_newer_messages__exact)
INPUT(attitude) { return m.type == ODO_TYPE_IMU && m.struct_size != sizeof(odo_imu) ? ODO_E_STRUCT_SIZE : ODO_OK; }
#elif defined(FAULTY_growth_newer_host__exact)
TABLE(scale) {
  t.activate = [](odo_instance* i, const odo_sink* sink) -> int32_t {
    return of(i).sink = sink, sink->struct_size == sizeof *sink ? ODO_OK : ODO_E_STRUCT_SIZE;
  };
}
#elif defined(FAULTY_growth_newer_batch__exact)
TABLE(scale) {
  t.process = [](odo_instance* i, const odo_batch* batch) -> int32_t {
    return batch->struct_size == sizeof *batch ? process(i, batch) : ODO_E_STRUCT_SIZE;
  };
}
#else
#error "no plugin of this name"
#endif
