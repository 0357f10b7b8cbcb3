// SPDX-License-Identifier: Apache-2.0
//
// Bad plugins, each bad in one way: built once for each name, with ZOO_name defined. The name of the library is the
// case of `odograph plugin check` that must find it.
#include <fcntl.h>
#include <pthread.h>
#include <unistd.h>

#include <chrono>
#include <stdexcept>
#include <thread>

#include "tests/zoo/animal.hpp"

using namespace zoo;

#define TABLE(k)                                                 \
  Kind zoo::kind() { return k; }                                 \
  void zoo::on_event(State&, Event&) {}                          \
  int32_t zoo::on_input(State&, const odo_header&) { return 0; } \
  void zoo::on_table([[maybe_unused]] odo_plugin& t)
#define EVENT(k)                                                 \
  Kind zoo::kind() { return k; }                                 \
  void zoo::on_table(odo_plugin&) {}                             \
  int32_t zoo::on_input(State&, const odo_header&) { return 0; } \
  void zoo::on_event([[maybe_unused]] State& s, [[maybe_unused]] Event& e)
#define INPUT(k)                        \
  Kind zoo::kind() { return k; }        \
  void zoo::on_table(odo_plugin&) {}    \
  void zoo::on_event(State&, Event&) {} \
  int32_t zoo::on_input([[maybe_unused]] State& s, [[maybe_unused]] const odo_header& m)
#define GOOD_ENTRY                                                                        \
  extern "C" ODO_EXPORT int32_t ODO_PLUGIN_ENTRY(const odo_host* host, odo_plugin* out) { \
    return good_entry(host, out);                                                         \
  }

// ---- the good ones, which must pass all -----------------------------------------------------------------------------
#if defined(ZOO_good_attitude)
TABLE(attitude) {}
GOOD_ENTRY
#elif defined(ZOO_good_steps)
TABLE(steps) {}
GOOD_ENTRY
#elif defined(ZOO_good_odometry)
TABLE(odometry) {}
GOOD_ENTRY
#elif defined(ZOO_good_scale)
TABLE(scale) {}
GOOD_ENTRY
#elif defined(ZOO_good_fixer)
TABLE(fixer) {}
GOOD_ENTRY

// ---- loading and the entry ------------------------------------------------------------------------------------------
#elif defined(ZOO_entry_loads__exit_in_static)
TABLE(scale) {}
struct Ends {
  Ends() { std::exit(0); }
} ends;
GOOD_ENTRY
#elif defined(ZOO_entry_loads__abort_in_static)
TABLE(scale) {}
struct Ends {
  Ends() { std::abort(); }
} ends;
GOOD_ENTRY
#elif defined(ZOO_entry_loads__no_entry)
TABLE(scale) {}
#elif defined(ZOO_entry_fills_table__exit)
TABLE(scale) { std::exit(0); }
GOOD_ENTRY
#elif defined(ZOO_entry_fills_table__no_process)
TABLE(scale) { t.process = nullptr; }
GOOD_ENTRY
#elif defined(ZOO_entry_fills_table__throws)
TABLE(scale) { throw std::runtime_error("the licence server is down"); }
GOOD_ENTRY
#elif defined(ZOO_entry_quick__sleeps)
TABLE(scale) { std::this_thread::sleep_for(std::chrono::milliseconds(2200)); }
GOOD_ENTRY
#elif defined(ZOO_entry_other_major__takes_any) || defined(ZOO_entry_other_draft__takes_any)
TABLE(scale) {}
extern "C" ODO_EXPORT int32_t ODO_PLUGIN_ENTRY(const odo_host* host, odo_plugin* out) {
  odo_host mine = *host;
  mine.abi_major_min = mine.abi_major_max = ODO_ABI_MAJOR;
  mine.abi_minor = ODO_ABI_MINOR;
  return good_entry(&mine, out);
}
#elif defined(ZOO_entry_null__crashes)
TABLE(scale) {}
extern "C" ODO_EXPORT int32_t ODO_PLUGIN_ENTRY(const odo_host* host, odo_plugin* out) {
  return host->struct_size > 0 ? good_entry(host, out) : ODO_E_ERROR;
}
#elif defined(ZOO_entry_small_table__fills_all)
TABLE(scale) {}
extern "C" ODO_EXPORT int32_t ODO_PLUGIN_ENTRY(const odo_host* host, odo_plugin* out) {
  if (!host || !out) return ODO_E_ARGUMENT;
  out->struct_size = sizeof *out;
  return good_entry(host, out);
}
#elif defined(ZOO_entry_table_end__writes_all)
TABLE(scale) {}
extern "C" ODO_EXPORT int32_t ODO_PLUGIN_ENTRY(const odo_host* host, odo_plugin* out) {
  const int32_t status = good_entry(host, out);
  if (status == ODO_OK) *out = good_table();
  return status;
}
#elif defined(ZOO_entry_twice__another)
TABLE(scale) {
  static int calls = 0;
  if (++calls > 1) t.id = str("zoo/another");
}
GOOD_ENTRY
#elif defined(ZOO_entry_no_side_effects__thread)
TABLE(scale) {
  std::thread([] { pause(); }).detach();
}
GOOD_ENTRY
#elif defined(ZOO_entry_no_side_effects__file)
TABLE(scale) { (void)open("/dev/null", O_RDONLY); }
GOOD_ENTRY

// ---- the table and the parameters -----------------------------------------------------------------------------------
#elif defined(ZOO_table_id__upper)
TABLE(scale) { t.id = str("ACME Scale"); }
GOOD_ENTRY
#elif defined(ZOO_table_version__words)
TABLE(scale) { t.version = str("the newest"); }
GOOD_ENTRY
#elif defined(ZOO_table_texts__latin1)
TABLE(scale) { t.summary = str("L\344nge"); }
GOOD_ENTRY
#elif defined(ZOO_table_kinds__twice)
TABLE(scale) {
  static const odo_string both[] = {interface_of(), interface_of()};
  t.interfaces = both, t.interface_count = 2;
}
GOOD_ENTRY
#elif defined(ZOO_table_types__emits_imu)
TABLE(scale) {
  static const uint32_t outputs[] = {ODO_TYPE_IMU};
  t.outputs = outputs, t.output_count = 1;
}
GOOD_ENTRY
#elif defined(ZOO_parameters_names__twice)
TABLE(scale) { parameters()[1] = parameters()[0]; }
GOOD_ENTRY
#elif defined(ZOO_parameters_units__feet)
TABLE(scale) { parameters()[0].unit = str("feet"); }
GOOD_ENTRY
#elif defined(ZOO_parameters_help__none)
TABLE(scale) { parameters()[0].help = str(""); }
GOOD_ENTRY
#elif defined(ZOO_parameters_ranges__turned)
TABLE(scale) { parameters()[0].min = 3; }
GOOD_ENTRY
#elif defined(ZOO_parameters_defaults__outside)
TABLE(scale) { parameters()[0].default_text = str("5"); }
GOOD_ENTRY
#elif defined(ZOO_parameters_choices__default_is_none)
TABLE(scale) { parameters()[1].default_text = str("green"); }
GOOD_ENTRY
#elif defined(ZOO_parameters_counts__none)
TABLE(scale) {
  parameters()[0].type = ODO_PARAMETER_REALS, parameters()[0].count = 0, parameters()[0].default_text = str("[]");
}
GOOD_ENTRY
#elif defined(ZOO_parameters_ends__refuses_silently)
TABLE(scale) {
  t.configure = [](odo_instance*, const odo_value* v, uint32_t count, uint32_t) -> int32_t {
    return count > 0 && v->reals && v->reals[0] == 2.0 ? ODO_E_CONFIG : ODO_OK;
  };
}
GOOD_ENTRY
#elif defined(ZOO_parameters_unknown__aborts)
TABLE(scale) {
  t.configure = [](odo_instance*, const odo_value* v, uint32_t count, uint32_t) -> int32_t {
    for (uint32_t i = 0; i < count; ++i)
      if (v[i].name.size > 6) std::abort();
    return ODO_OK;
  };
}
GOOD_ENTRY
#elif defined(ZOO_parameters_order__by_place)
TABLE(scale) {
  t.configure = [](odo_instance* i, const odo_value* v, uint32_t, uint32_t) -> int32_t {
    return of(i).gain = v[0].reals ? v[0].reals[0] : 2, ODO_OK;
  };
}
GOOD_ENTRY
#elif defined(ZOO_parameters_larger_rows__sizeof)
TABLE(scale) {
  t.configure = [](odo_instance* i, const odo_value* v, uint32_t count, uint32_t) -> int32_t {
    for (uint32_t k = 0; k < count; ++k)
      if (v[k].type != ODO_PARAMETER_REAL && v[k].type != ODO_PARAMETER_CHOICE) of(i).gain = 2;
    return ODO_OK;
  };
}
GOOD_ENTRY
#elif defined(ZOO_parameters_copied__keeps_pointer)
TABLE(scale) {
  t.configure = [](odo_instance* i, const odo_value* v, uint32_t, uint32_t) -> int32_t {
    return of(i).more = const_cast<double*>(v[0].reals), ODO_OK;
  };
  t.activate = [](odo_instance* i, const odo_sink* sink) -> int32_t {
    of(i).gain = *static_cast<const double*>(of(i).more);
    return of(i).sink = sink, ODO_OK;
  };
}
GOOD_ENTRY

// ---- life -----------------------------------------------------------------------------------------------------------
#elif defined(ZOO_life_create_destroy__exit)
TABLE(scale) {
  t.create = [](const odo_host*, uint32_t, const odo_string*, odo_instance**) -> int32_t { std::exit(0); };
}
GOOD_ENTRY
#elif defined(ZOO_life_create_destroy__crash_in_destroy)
TABLE(scale) {
  t.destroy = [](odo_instance*) { *reinterpret_cast<volatile int*>(8) = 1; };
}
GOOD_ENTRY
#elif defined(ZOO_life_starts__fails)
TABLE(scale) {
  t.activate = [](odo_instance*, const odo_sink*) -> int32_t { return ODO_E_ERROR; };
}
GOOD_ENTRY
#elif defined(ZOO_life_not_activated__crashes)
TABLE(scale) {
  t.destroy = [](odo_instance* i) { of(i).steps = of(i).sink->instance, delete &of(i); };
}
GOOD_ENTRY
#elif defined(ZOO_life_unknown_kind__takes_any)
TABLE(scale) {
  t.create = [](const odo_host* host, uint32_t n, const odo_string*, odo_instance** out) -> int32_t {
    return create(host, n, &interface_of(), out);
  };
}
GOOD_ENTRY
#elif defined(ZOO_life_no_services__insists)
TABLE(scale) {
  t.create = [](const odo_host* host, uint32_t n, const odo_string* id, odo_instance** out) -> int32_t {
    const auto* reports = static_cast<const odo_report_service*>(host->get_service(host, ODO_SERVICE_REPORT, 12));
    const odo_string key = str("hello"), text = str("I am here.");
    reports->report(host, n, ODO_SEVERITY_INFO, &key, &text);
    return create(host, n, id, out);
  };
}
GOOD_ENTRY
#elif defined(ZOO_life_independent__global)
INPUT(scale) {
  static double shared = 0;
  s.gain = 1 + 0.3 * std::sin(shared);
  shared = static_cast<double>(m.t_ns % 1000003);
  return ODO_OK;
}
GOOD_ENTRY
#elif defined(ZOO_life_many__two)
TABLE(scale) {
  t.activate = [](odo_instance* i, const odo_sink* sink) -> int32_t {
    static int count = 0;
    return of(i).sink = sink, ++count > 10 ? ODO_E_EXHAUSTED : ODO_OK;
  };
}
GOOD_ENTRY
#elif defined(ZOO_life_emits_in_process__activate)
TABLE(attitude) {
  t.activate = [](odo_instance* i, const odo_sink* sink) -> int32_t {
    of(i).sink = sink;
    odo_imu first = {};
    answer_imu(of(i), first.header);
    return ODO_OK;
  };
}
GOOD_ENTRY
#elif defined(ZOO_life_emits_on_thread__own)
INPUT(attitude) {
  if (s.inputs == 50) std::thread([&] { answer_imu(s, m); }).join();
  return ODO_OK;
}
GOOD_ENTRY
#elif defined(ZOO_life_threads__leaves_them)
TABLE(scale) {
  t.create = [](const odo_host* host, uint32_t n, const odo_string* id, odo_instance** out) -> int32_t {
    std::thread([] { pause(); }).detach();
    return create(host, n, id, out);
  };
}
GOOD_ENTRY
#elif defined(ZOO_life_files__leaves_them)
TABLE(scale) {
  t.create = [](const odo_host* host, uint32_t n, const odo_string* id, odo_instance** out) -> int32_t {
    (void)open("/dev/null", O_RDONLY);
    return create(host, n, id, out);
  };
}
GOOD_ENTRY
#elif defined(ZOO_life_leaks__4_kB)
TABLE(scale) {
  t.destroy = [](odo_instance* i) {
    std::memset(std::malloc(4096), 1, 4096);
    delete &of(i);
  };
}
GOOD_ENTRY
#elif defined(ZOO_life_grows__keeps_input)
INPUT(attitude) {
  if (!s.more) s.more = new std::vector<std::vector<char> >;
  static_cast<std::vector<std::vector<char> >*>(s.more)->emplace_back(20000, 'x');
  return ODO_OK;
}
GOOD_ENTRY
#elif defined(ZOO_life_extension__any)
TABLE(scale) {
  t.get_interface = [](odo_instance* i, const char*, uint64_t) -> const void* { return i; };
}
GOOD_ENTRY
#elif defined(ZOO_state_capacity__writes_anyway)
TABLE(scale) {
  t.save = [](odo_instance* i, void* data, uint64_t) -> int64_t { return data ? save(i, data, 16) : 16; };
}
GOOD_ENTRY
#elif defined(ZOO_state_round_trip__forgets)
TABLE(scale) {
  t.load = [](odo_instance* i, const void* data, uint64_t size) -> int32_t {
    const int32_t status = load(i, data, size);
    return of(i).gain = 1.5, status;
  };
}
GOOD_ENTRY
#elif defined(ZOO_state_damaged__reads_beyond)
TABLE(scale) {
  t.load = [](odo_instance* i, const void* data, uint64_t) -> int32_t {
    uint64_t offset = 0;
    std::memcpy(&offset, data, 8);
    return of(i).gain = static_cast<const char*>(data)[offset * 4096] ? 1 : 1.1, ODO_OK;
  };
}
GOOD_ENTRY
#elif defined(ZOO_state_foreign__takes_all)
TABLE(scale) {
  t.load = [](odo_instance*, const void*, uint64_t) -> int32_t { return ODO_OK; };
}
GOOD_ENTRY

// ---- process: what ends the host (C11) ------------------------------------------------------------------------------
#elif defined(ZOO_process_works__error)
INPUT(scale) { return s.inputs == 40 ? ODO_E_ERROR : ODO_OK; }
GOOD_ENTRY
#elif defined(ZOO_process_works__abort)
INPUT(scale) { return s.inputs == 40 ? (std::abort(), 0) : ODO_OK; }
GOOD_ENTRY
#elif defined(ZOO_process_works__segfault)
INPUT(scale) { return s.inputs == 40 ? *reinterpret_cast<volatile int*>(8) : ODO_OK; }
GOOD_ENTRY
#elif defined(ZOO_process_works__exit)
INPUT(scale) { return s.inputs == 40 ? (std::exit(0), 0) : ODO_OK; }
GOOD_ENTRY
#elif defined(ZOO_process_works__hangs)
INPUT(scale) {
  while (s.inputs == 40) usleep(1000);
  return ODO_OK;
}
GOOD_ENTRY
#elif defined(ZOO_process_works__stack_overflow)
static int deep(volatile char* above) {
  volatile char room[4096];
  room[0] = above[0];
  return deep(room) + room[0];
}
INPUT(scale) {
  volatile char room[1] = {1};
  return s.inputs == 40 ? deep(room) : ODO_OK;
}
GOOD_ENTRY
#elif defined(ZOO_process_works__pthread_exit)
INPUT(scale) {
  if (s.inputs == 40) pthread_exit(nullptr);
  return ODO_OK;
}
GOOD_ENTRY
#elif defined(ZOO_process_works__throws)
INPUT(scale) {
  if (s.inputs == 40) throw std::runtime_error("the fortieth sample is unlucky");
  return ODO_OK;
}
GOOD_ENTRY
#elif defined(ZOO_process_status__77)
TABLE(scale) {
  t.process = [](odo_instance*, const odo_batch*) -> int32_t { return 77; };
}
GOOD_ENTRY

// ---- events (B3) ----------------------------------------------------------------------------------------------------
#elif defined(ZOO_events_some__none)
INPUT(attitude) { return ODO_E_DISCARD; }
GOOD_ENTRY
#elif defined(ZOO_events_type__pose)
EVENT(scale) { e.header.type = ODO_TYPE_POSE; }
GOOD_ENTRY
#elif defined(ZOO_events_size__zero)
EVENT(scale) { e.header.struct_size = 0; }
GOOD_ENTRY
#elif defined(ZOO_events_size__header_only)
EVENT(scale) { e.header.struct_size = 32; }
GOOD_ENTRY
#elif defined(ZOO_events_numbers__nan)
EVENT(scale) { e.scale.metres_per_unit = std::nan(""); }
GOOD_ENTRY
#elif defined(ZOO_events_numbers__no_quaternion)
EVENT(attitude) { e.attitude.q_n_b[1] = 0; }
GOOD_ENTRY
#elif defined(ZOO_events_count__400)
INPUT(attitude) {
  if (m.type == ODO_TYPE_IMU)
    for (int i = 0; i < 400; ++i) answer_imu(s, m);
  return ODO_OK;
}
GOOD_ENTRY
#elif defined(ZOO_events_quality__percent)
EVENT(scale) { e.header.quality = 80; }
GOOD_ENTRY
#elif defined(ZOO_events_reserved__used)
EVENT(scale) { e.header.reserved = 7; }
GOOD_ENTRY
#elif defined(ZOO_events_flags__host_s_own)
EVENT(fixer) { e.header.flags |= ODO_FIX_ACCEPTED; }
GOOD_ENTRY
#elif defined(ZOO_events_flags__unknown)
EVENT(scale) { e.header.flags = 1u << 20; }
GOOD_ENTRY
#elif defined(ZOO_events_time_order__back_and_forth)
EVENT(attitude) { e.header.t_ns -= s.inputs % 2 ? 30'000'000 : 0; }
GOOD_ENTRY
#elif defined(ZOO_events_time_known__wall_clock)
EVENT(scale) { e.header.t_ns = std::chrono::system_clock::now().time_since_epoch().count(); }
GOOD_ENTRY
#elif defined(ZOO_events_time_known__seconds)
EVENT(scale) { e.header.t_ns = -5'000'000'000 + e.header.t_ns / 1'000'000'000; }
GOOD_ENTRY
#elif defined(ZOO_events_covariance__not_symmetric)
EVENT(odometry) { e.motion.covariance[1] = 1e-5; }
GOOD_ENTRY
#elif defined(ZOO_events_uncertainty__sure)
EVENT(fixer) { e.fix.covariance_n[0] = 0; }
GOOD_ENTRY
#elif defined(ZOO_events_lists__mode_42)
EVENT(steps) {
  if (e.header.type == ODO_TYPE_STEP) e.step.mode = 42;
}
GOOD_ENTRY

// ---- what they mean -------------------------------------------------------------------------------------------------
#elif defined(ZOO_attitude_each_sample__every_second)
INPUT(attitude) { return s.inputs % 2 ? ODO_OK : ODO_E_DISCARD; }
GOOD_ENTRY
#elif defined(ZOO_attitude_up__down)
EVENT(attitude) { e.attitude.q_n_b[1] = 0, e.attitude.q_n_b[0] = 1; }
GOOD_ENTRY
#elif defined(ZOO_step_length__millimetres)
EVENT(steps) {
  if (e.header.type == ODO_TYPE_STEP) e.step.length_m *= 1000;
}
GOOD_ENTRY
#elif defined(ZOO_step_frequency__a_minute)
EVENT(steps) {
  if (e.header.type == ODO_TYPE_STEP) e.step.frequency_hz *= 60;
}
GOOD_ENTRY
#elif defined(ZOO_step_order__overlap)
EVENT(steps) {
  if (e.header.type == ODO_TYPE_STEP) e.step.t_start_ns -= 100'000'000;
}
GOOD_ENTRY
#elif defined(ZOO_step_times__to_come)
EVENT(steps) {
  if (e.header.type == ODO_TYPE_STEP) e.step.t_end_ns += 100'000'000;
}
GOOD_ENTRY
#elif defined(ZOO_step_late__two_seconds)
EVENT(steps) {
  if (e.header.type == ODO_TYPE_STEP) e.step.t_start_ns -= 2'000'000'000, e.step.t_end_ns -= 2'000'000'000;
}
GOOD_ENTRY
#elif defined(ZOO_step_late__three_at_once)
INPUT(steps) {  // keeps two steps of a walk back until the third
  static int64_t held_ns[2];
  static int held = 0;
  if (m.type != ODO_TYPE_IMU || s.last_step_ns == 0 || m.t_ns - s.last_step_ns < 500'000'000) return ODO_OK;
  if (held < 2) {
    held_ns[held++] = s.last_step_ns = m.t_ns;
    return ODO_OK;
  }
  s.last_step_ns = held_ns[0] - 500'000'000;
  for (held = 0; held < 2; ++held) {
    odo_header then = m;
    then.t_ns = held_ns[held];
    answer_walk(s, then);
  }
  held = 0;
  return ODO_OK;
}
GOOD_ENTRY
#elif defined(ZOO_step_index__from_1)
EVENT(steps) {
  if (e.header.type == ODO_TYPE_STEP) ++e.step.index;
}
GOOD_ENTRY
#elif defined(ZOO_mode_changes__always)
INPUT(steps) {
  s.mode_said = false;
  return ODO_OK;
}
GOOD_ENTRY
#elif defined(ZOO_motion_each_frame__every_second)
INPUT(odometry) { return m.type == ODO_TYPE_FRAME && m.t_ns / 100'000'000 % 2 ? ODO_E_DISCARD : ODO_OK; }
GOOD_ENTRY
#elif defined(ZOO_motion_reason__none)
EVENT(odometry) { e.motion.state = ODO_LOST; }
GOOD_ENTRY
#elif defined(ZOO_motion_speed__millimetres)
EVENT(odometry) { e.motion.header.flags |= ODO_VO_METRIC, e.motion.p_c0_c1[0] = 140; }
GOOD_ENTRY
#elif defined(ZOO_motion_camera__other)
EVENT(odometry) { e.motion.camera = 5; }
GOOD_ENTRY
#elif defined(ZOO_scale_unit__millimetres)
EVENT(scale) { e.scale.metres_per_unit *= 1000; }
GOOD_ENTRY
#elif defined(ZOO_scale_group__foreign)
EVENT(scale) { e.scale.scale_group = 77; }
GOOD_ENTRY
#elif defined(ZOO_scale_interval__turned)
EVENT(scale) { std::swap(e.scale.valid_from_ns, e.scale.valid_to_ns); }
GOOD_ENTRY
#elif defined(ZOO_scale_sigma__negative)
EVENT(scale) { e.scale.sigma = -1; }
GOOD_ENTRY
#elif defined(ZOO_fix_says_something__nothing)
EVENT(fixer) { e.header.flags = 0; }
GOOD_ENTRY
#elif defined(ZOO_fix_place__moon)
EVENT(fixer) { e.fix.p_n[0] = 3.8e8; }
GOOD_ENTRY
#elif defined(ZOO_fix_no_echo__poses)
INPUT(fixer) {
  if (m.type == ODO_TYPE_POSE) answer_waypoint(s, m);
  return ODO_OK;
}
GOOD_ENTRY

// ---- the same again -------------------------------------------------------------------------------------------------
#elif defined(ZOO_repeat_instance__counts_on)
EVENT(scale) {
  static int count = 0;
  e.scale.metres_per_unit += 1e-6 * ++count;
}
GOOD_ENTRY
#elif defined(ZOO_repeat_process__pid)
EVENT(scale) { e.scale.metres_per_unit += 1e-6 * getpid(); }
GOOD_ENTRY
#elif defined(ZOO_repeat_batches_of_17__first_of_batch)
TABLE(scale) {
  t.process = [](odo_instance* i, const odo_batch* batch) -> int32_t {
    odo_batch first = *batch;
    first.count = batch->count < 3 ? batch->count : 1;
    return process(i, &first);
  };
}
GOOD_ENTRY
#elif defined(ZOO_repeat_reset__keeps_count)
TABLE(steps) {
  t.reset = [](odo_instance* i) -> int32_t {
    const uint32_t kept = of(i).steps;
    return reset(i), of(i).steps = kept, ODO_OK;
  };
}
GOOD_ENTRY
#elif defined(ZOO_batch_empty__error)
TABLE(scale) {
  t.process = [](odo_instance* i, const odo_batch* batch) -> int32_t {
    return batch->count ? process(i, batch) : ODO_E_ARGUMENT;
  };
}
GOOD_ENTRY
#elif defined(ZOO_batch_read_only__writes)
INPUT(scale) {
  const_cast<odo_header&>(m).reserved = 1;
  return ODO_OK;
}
GOOD_ENTRY
#elif defined(ZOO_batch_read_only__keeps)
INPUT(attitude) {
  const odo_header* before = static_cast<const odo_header*>(std::exchange(s.more, const_cast<odo_header*>(&m)));
  return before && before->t_ns == 42 ? ODO_E_ERROR : ODO_OK;
}
GOOD_ENTRY
#elif defined(ZOO_growth_newer_type__aborts)
INPUT(scale) { return m.type > 0x10 && m.type < 0x1000 ? (std::abort(), 0) : ODO_OK; }
GOOD_ENTRY
#elif defined(ZOO_growth_vendor_type__error)
INPUT(scale) { return ODO_IS_VENDOR(m.type) ? ODO_E_ERROR : ODO_OK; }
GOOD_ENTRY
#elif defined(ZOO_growth_older_messages__sizeof)
INPUT(attitude) {
  return m.type == ODO_TYPE_MAGNETOMETER && m.struct_size < sizeof(odo_magnetometer) ? ODO_E_STRUCT_SIZE : ODO_OK;
}
GOOD_ENTRY
#elif defined(ZOO_growth_newer_messages__exact)
INPUT(attitude) { return m.type == ODO_TYPE_IMU && m.struct_size != sizeof(odo_imu) ? ODO_E_STRUCT_SIZE : ODO_OK; }
GOOD_ENTRY
#elif defined(ZOO_growth_newer_host__exact)
TABLE(scale) {
  t.activate = [](odo_instance* i, const odo_sink* sink) -> int32_t {
    return of(i).sink = sink, sink->struct_size == sizeof *sink ? ODO_OK : ODO_E_STRUCT_SIZE;
  };
}
GOOD_ENTRY
#elif defined(ZOO_growth_newer_batch__exact)
TABLE(scale) {
  t.process = [](odo_instance* i, const odo_batch* batch) -> int32_t {
    return batch->struct_size == sizeof *batch ? process(i, batch) : ODO_E_STRUCT_SIZE;
  };
}
GOOD_ENTRY

// ---- frames ---------------------------------------------------------------------------------------------------------
#elif defined(ZOO_frames_balance__never_releases)
INPUT(odometry) {
  const auto& frame = reinterpret_cast<const odo_frame&>(m);
  if (m.type == ODO_TYPE_FRAME && frame.retain) frame.retain(&frame);
  return ODO_OK;
}
GOOD_ENTRY
#elif defined(ZOO_frames_balance__releases_twice)
INPUT(odometry) {
  const auto& frame = reinterpret_cast<const odo_frame&>(m);
  if (m.type == ODO_TYPE_FRAME && frame.release) frame.release(&frame);
  return ODO_OK;
}
GOOD_ENTRY
#elif defined(ZOO_frames_quota__twenty)
static void let_go(std::vector<odo_frame>& held, size_t down_to) {
  while (held.size() > down_to) held.back().release(&held.back()), held.pop_back();
}
Kind zoo::kind() { return odometry; }
void zoo::on_event(State&, Event&) {}
int32_t zoo::on_input(State& s, const odo_header& m) {
  if (m.type != ODO_TYPE_FRAME) return ODO_OK;
  if (!s.more) s.more = new std::vector<odo_frame>;
  auto& held = *static_cast<std::vector<odo_frame>*>(s.more);
  const auto& frame = reinterpret_cast<const odo_frame&>(m);
  if (frame.retain && frame.retain(&frame) >= 0) held.push_back(frame);
  if (held.size() > 20) let_go(held, 0);
  return ODO_OK;
}
void zoo::on_table(odo_plugin& t) {
  t.destroy = [](odo_instance* i) {
    if (of(i).more) let_go(*static_cast<std::vector<odo_frame>*>(of(i).more), 0);
    delete static_cast<std::vector<odo_frame>*>(of(i).more);
    delete &of(i);
  };
}
GOOD_ENTRY
#elif defined(ZOO_frames_borrowed__keeps_pixels)
INPUT(odometry) {
  if (m.type != ODO_TYPE_FRAME) return ODO_OK;
  const auto* before = static_cast<const uint8_t*>(s.more);
  const int sum = before ? before[100] : 0;
  s.more = const_cast<uint8_t*>(reinterpret_cast<const odo_frame&>(m).planes[0].data);
  return sum == 256 ? ODO_E_ERROR : ODO_OK;
}
GOOD_ENTRY
#elif defined(ZOO_frames_borrowed__writes)
INPUT(odometry) {
  if (m.type == ODO_TYPE_FRAME) const_cast<uint8_t*>(reinterpret_cast<const odo_frame&>(m).planes[0].data)[5] = 1;
  return ODO_OK;
}
GOOD_ENTRY
#elif defined(ZOO_frames_exhausted__insists)
INPUT(odometry) {
  const auto& frame = reinterpret_cast<const odo_frame&>(m);
  if (m.type != ODO_TYPE_FRAME || !frame.retain) return ODO_OK;
  if (frame.retain(&frame) < 0) return ODO_E_ERROR;
  return frame.release(&frame), ODO_OK;
}
GOOD_ENTRY
#elif defined(ZOO_frames_strides__width)
Kind zoo::kind() { return odometry; }
void zoo::on_table(odo_plugin&) {}
int32_t zoo::on_input(State& s, const odo_header& m) {
  if (m.type != ODO_TYPE_FRAME) return ODO_OK;
  const auto& frame = reinterpret_cast<const odo_frame&>(m);
  unsigned sum = 0;
  for (uint32_t i = 0; i < frame.width * frame.height; ++i) sum += frame.planes[0].data[i];
  return s.gain = sum, ODO_OK;
}
void zoo::on_event(State& s, Event& e) { e.motion.p_c0_c1[1] = 1e-9 * s.gain; }
GOOD_ENTRY
#elif defined(ZOO_frames_tiny__divides)
INPUT(odometry) {
  if (m.type != ODO_TYPE_FRAME) return ODO_OK;
  volatile uint32_t half = reinterpret_cast<const odo_frame&>(m).width / 2;
  return half ? ODO_OK : static_cast<int32_t>(100 / half);
}
GOOD_ENTRY

// ---- faults and cost ------------------------------------------------------------------------------------------------
#elif defined(ZOO_faults_huge__index)
INPUT(steps) {
  static int bins[64];
  const double x = m.type == ODO_TYPE_IMU ? reinterpret_cast<const odo_imu&>(m).accel_b[2] : 0;
  if (std::abs(x) > 1e6) bins[static_cast<int64_t>(std::fmod(x, 1e12)) | int64_t(1) << 40]++;
  return ODO_OK;
}
GOOD_ENTRY
#elif defined(ZOO_faults_vendor__believes_the_count)
Kind zoo::kind() { return attitude; }
void zoo::on_event(State&, Event&) {}
void zoo::on_table(odo_plugin& t) {
  static const uint32_t inputs[] = {ODO_TYPE_VENDOR(1, 1)};
  t.inputs = inputs, t.input_count = 1;
}
int32_t zoo::on_input(State& s, const odo_header& m) {
  static double seen[16];
  if (m.type != ODO_TYPE_VENDOR(1, 1) || m.struct_size < sizeof(odo_header) + 8) return ODO_OK;
  uint32_t count = 0;
  std::memcpy(&count, &m + 1, sizeof count);
  for (uint32_t i = 0; i < count; ++i) seen[i] += s.gain;
  return ODO_OK;
}
GOOD_ENTRY
#elif defined(ZOO_faults_long_steps__overflow)
INPUT(scale) {
  static float table[4];
  if (m.type == ODO_TYPE_STEP)
    table[static_cast<int64_t>(reinterpret_cast<const odo_step&>(m).length_m) * 100'000'000] = 1;
  return ODO_OK;
}
GOOD_ENTRY
#elif defined(ZOO_faults_gap_1h__loops)
INPUT(attitude) {
  int64_t& last = s.last_step_ns;
  if (m.type == ODO_TYPE_IMU && last)
    for (; last < m.t_ns; last += 1000) s.gain += 1e-12;
  last = m.t_ns;
  return ODO_OK;
}
GOOD_ENTRY
#elif defined(ZOO_cost_motion__sleeps)
INPUT(scale) { return m.type == ODO_TYPE_VO_MOTION ? usleep(20'000), ODO_OK : ODO_OK; }
GOOD_ENTRY
#elif defined(ZOO_cost_imu__120_ms)
INPUT(attitude) { return m.type == ODO_TYPE_IMU ? usleep(120'000), ODO_OK : ODO_OK; }
GOOD_ENTRY
#elif defined(ZOO_cost_memory__600_MB)
INPUT(scale) {
  if (!s.more) std::memset(s.more = std::malloc(size_t(600) << 20), 1, size_t(600) << 20);
  return ODO_OK;
}
GOOD_ENTRY
#else
#error "no animal of this name"
#endif
