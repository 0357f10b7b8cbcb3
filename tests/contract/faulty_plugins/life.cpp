// SPDX-License-Identifier: Apache-2.0
//
// Faulty plugins: create to destroy, parallel instances, saved state.
#include <fcntl.h>
#include <unistd.h>

#include <thread>

#include "tests/contract/faulty_plugins/reference_plugin.hpp"

using namespace faulty;

#if defined(FAULTY_life_create_destroy__exit)
TABLE(scale) {
  t.create = [](const odo_host*, uint32_t, const odo_string*, odo_instance**) -> int32_t { std::exit(0); };
}
#elif defined(FAULTY_life_create_destroy__hangs)
TABLE(scale) {
  t.create = [](const odo_host*, uint32_t, const odo_string*, odo_instance**) -> int32_t {
    for (;;) usleep(1000);
  };
}
#elif defined(FAULTY_life_create_destroy__crash_in_destroy)
TABLE(scale) {
  t.destroy = [](odo_instance*) { *reinterpret_cast<volatile int*>(8) = 1; };
}
#elif defined(FAULTY_life_starts__fails)
TABLE(scale) {
  t.activate = [](odo_instance*, const odo_sink*) -> int32_t { return ODO_E_ERROR; };
}
#elif defined(FAULTY_life_not_activated__crashes)
TABLE(scale) {
  t.destroy = [](odo_instance* i) { of(i).steps = of(i).sink->instance, delete &of(i); };
}
#elif defined(FAULTY_life_unknown_kind__takes_any)
TABLE(scale) {
  t.create = [](const odo_host* host, uint32_t n, const odo_string*, odo_instance** out) -> int32_t {
    return create(host, n, &interface_of(), out);
  };
}
#elif defined(FAULTY_life_no_services__insists)
TABLE(scale) {
  t.create = [](const odo_host* host, uint32_t n, const odo_string* id, odo_instance** out) -> int32_t {
    const auto* reports = static_cast<const odo_report_service*>(host->get_service(host, ODO_SERVICE_REPORT, 12));
    const odo_string key = str("hello"), text = str("I am here.");
    reports->report(host, n, ODO_SEVERITY_INFO, &key, &text);
    return create(host, n, id, out);
  };
}
#elif defined(FAULTY_life_independent__global)
INPUT(scale) {
  static double shared = 0;
  s.gain = 1 + 0.3 * std::sin(shared);
  shared = static_cast<double>(m.t_ns % 1000003);
  return ODO_OK;
}
#elif defined(FAULTY_life_many__two)
TABLE(scale) {
  t.activate = [](odo_instance* i, const odo_sink* sink) -> int32_t {
    static int count = 0;
    return of(i).sink = sink, ++count > 10 ? ODO_E_EXHAUSTED : ODO_OK;
  };
}
#elif defined(FAULTY_life_emits_in_process__activate)
TABLE(attitude) {
  t.activate = [](odo_instance* i, const odo_sink* sink) -> int32_t {
    of(i).sink = sink;
    odo_imu first = {};
    answer_imu(of(i), first.header);
    return ODO_OK;
  };
}
#elif defined(FAULTY_life_emits_on_thread__own)
INPUT(attitude) {
  if (s.inputs == 50) std::thread([&] { answer_imu(s, m); }).join();
  return ODO_OK;
}
#elif defined(FAULTY_life_threads__leaves_them)
TABLE(scale) {
  t.create = [](const odo_host* host, uint32_t n, const odo_string* id, odo_instance** out) -> int32_t {
    std::thread([] { pause(); }).detach();
    return create(host, n, id, out);
  };
}
#elif defined(FAULTY_life_files__leaves_them)
TABLE(scale) {
  t.create = [](const odo_host* host, uint32_t n, const odo_string* id, odo_instance** out) -> int32_t {
    (void)open("/dev/null", O_RDONLY);
    return create(host, n, id, out);
  };
}
#elif defined(FAULTY_life_leaks__4_kB)
TABLE(scale) {
  t.destroy = [](odo_instance* i) {
    std::memset(std::malloc(4096), 1, 4096);
    delete &of(i);
  };
}
#elif defined(FAULTY_life_grows__keeps_input)
INPUT(attitude) {
  if (!s.more) s.more = new std::vector<std::vector<char> >;
  static_cast<std::vector<std::vector<char> >*>(s.more)->emplace_back(20000, 'x');
  return ODO_OK;
}
#elif defined(FAULTY_life_extension__any)
TABLE(scale) {
  t.get_interface = [](odo_instance* i, const char*, uint64_t) -> const void* { return i; };
}
#elif defined(FAULTY_state_capacity__writes_anyway)
TABLE(scale) {
  t.save = [](odo_instance* i, void* data, uint64_t) -> int64_t { return data ? save(i, data, 16) : 16; };
}
#elif defined(FAULTY_state_round_trip__forgets)
TABLE(scale) {
  t.load = [](odo_instance* i, const void* data, uint64_t size) -> int32_t {
    const int32_t status = load(i, data, size);
    return of(i).gain = 1.5, status;
  };
}
#elif defined(FAULTY_state_damaged__reads_beyond)
TABLE(scale) {
  t.load = [](odo_instance* i, const void* data, uint64_t) -> int32_t {
    uint64_t offset = 0;
    std::memcpy(&offset, data, 8);
    return of(i).gain = static_cast<const char*>(data)[offset * 4096] ? 1 : 1.1, ODO_OK;
  };
}
#elif defined(FAULTY_state_foreign__takes_all)
TABLE(scale) {
  t.load = [](odo_instance*, const void*, uint64_t) -> int32_t { return ODO_OK; };
}
#else
#error "no plugin of this name"
#endif
