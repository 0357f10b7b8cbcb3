// SPDX-License-Identifier: Apache-2.0
//
// Faulty plugins: loading, the entry, the table and the parameters.
#include <fcntl.h>
#include <unistd.h>

#include <chrono>
#include <stdexcept>
#include <thread>

#include "tests/contract/faulty_plugins/reference_plugin.hpp"

using namespace faulty;

// ---- loading and the entry -----------------------------------------------------------------------------------------
#if defined(FAULTY_entry_loads__exit_in_static)
TABLE(scale) {}
struct Ends {
  Ends() { std::exit(0); }
} ends;
#elif defined(FAULTY_entry_loads__abort_in_static)
TABLE(scale) {}
struct Ends {
  Ends() { std::abort(); }
} ends;
#elif defined(FAULTY_entry_loads__no_entry)
OWN_ENTRY(scale) {}
#elif defined(FAULTY_entry_fills_table__exit)
TABLE(scale) { std::exit(0); }
#elif defined(FAULTY_entry_fills_table__no_process)
TABLE(scale) { t.process = nullptr; }
#elif defined(FAULTY_entry_fills_table__throws)
TABLE(scale) { throw std::runtime_error("the licence server is down"); }
#elif defined(FAULTY_entry_quick__sleeps)
TABLE(scale) { std::this_thread::sleep_for(std::chrono::milliseconds(2200)); }
#elif defined(FAULTY_entry_other_major__takes_any)
OWN_ENTRY(scale) {}
extern "C" ODO_EXPORT int32_t ODO_PLUGIN_ENTRY(const odo_host* host, odo_plugin* out) {
  odo_host mine = *host;
  mine.abi_major_min = mine.abi_major_max = ODO_ABI_MAJOR;
  mine.abi_minor = ODO_ABI_MINOR;
  return good_entry(&mine, out);
}
#elif defined(FAULTY_entry_null__crashes)
OWN_ENTRY(scale) {}
extern "C" ODO_EXPORT int32_t ODO_PLUGIN_ENTRY(const odo_host* host, odo_plugin* out) {
  return host->struct_size > 0 ? good_entry(host, out) : ODO_E_ERROR;
}
#elif defined(FAULTY_entry_small_table__fills_all)
OWN_ENTRY(scale) {}
extern "C" ODO_EXPORT int32_t ODO_PLUGIN_ENTRY(const odo_host* host, odo_plugin* out) {
  if (!host || !out) return ODO_E_ARGUMENT;
  out->struct_size = sizeof *out;
  return good_entry(host, out);
}
#elif defined(FAULTY_entry_twice__another)
TABLE(scale) {
  static int calls = 0;
  if (++calls > 1) t.id = str("test/another");
}
#elif defined(FAULTY_entry_no_side_effects__thread)
TABLE(scale) {
  std::thread([] { pause(); }).detach();
}
#elif defined(FAULTY_entry_no_side_effects__file)
TABLE(scale) { (void)open("/dev/null", O_RDONLY); }

// ---- the table and the parameters ----------------------------------------------------------------------------------
#elif defined(FAULTY_table_id__upper)
TABLE(scale) { t.id = str("ACME Scale"); }
#elif defined(FAULTY_table_version__words)
TABLE(scale) { t.version = str("the newest"); }
#elif defined(FAULTY_table_texts__latin1)
TABLE(scale) { t.summary = str("L\344nge"); }
#elif defined(FAULTY_table_kinds__twice)
TABLE(scale) {
  static const odo_string both[] = {interface_of(), interface_of()};
  t.interfaces = both, t.interface_count = 2;
}
#elif defined(FAULTY_table_types__emits_imu)
TABLE(scale) {
  static const uint32_t outputs[] = {ODO_TYPE_IMU};
  t.outputs = outputs, t.output_count = 1;
}
#elif defined(FAULTY_parameters_names__twice)
TABLE(scale) { parameters()[1] = parameters()[0]; }
#elif defined(FAULTY_parameters_units__feet)
TABLE(scale) { parameters()[0].unit = str("feet"); }
#elif defined(FAULTY_parameters_help__none)
TABLE(scale) { parameters()[0].help = str(""); }
#elif defined(FAULTY_parameters_ranges__turned)
TABLE(scale) { parameters()[0].min = 3; }
#elif defined(FAULTY_parameters_defaults__outside)
TABLE(scale) { parameters()[0].default_text = str("5"); }
#elif defined(FAULTY_parameters_choices__default_is_none)
TABLE(scale) { parameters()[1].default_text = str("green"); }
#elif defined(FAULTY_parameters_counts__none)
TABLE(scale) {
  parameters()[0].type = ODO_PARAMETER_REALS, parameters()[0].count = 0, parameters()[0].default_text = str("[]");
}
#elif defined(FAULTY_parameters_ends__refuses_silently)
TABLE(scale) {
  t.configure = [](odo_instance*, const odo_value* v, uint32_t count, uint32_t) -> int32_t {
    return count > 0 && v->reals && v->reals[0] == 2.0 ? ODO_E_CONFIG : ODO_OK;
  };
}
#elif defined(FAULTY_parameters_unknown__aborts)
TABLE(scale) {
  t.configure = [](odo_instance*, const odo_value* v, uint32_t count, uint32_t) -> int32_t {
    for (uint32_t i = 0; i < count; ++i)
      if (v[i].name.size > 6) std::abort();
    return ODO_OK;
  };
}
#elif defined(FAULTY_parameters_order__by_place)
TABLE(scale) {
  t.configure = [](odo_instance* i, const odo_value* v, uint32_t, uint32_t) -> int32_t {
    return of(i).gain = v[0].reals ? v[0].reals[0] : 2, ODO_OK;
  };
}
#elif defined(FAULTY_parameters_larger_rows__sizeof)
TABLE(scale) {
  t.configure = [](odo_instance* i, const odo_value* v, uint32_t count, uint32_t) -> int32_t {
    for (uint32_t k = 0; k < count; ++k)
      if (v[k].type != ODO_PARAMETER_REAL && v[k].type != ODO_PARAMETER_CHOICE) of(i).gain = 2;
    return ODO_OK;
  };
}
#elif defined(FAULTY_parameters_copied__keeps_pointer)
TABLE(scale) {
  t.configure = [](odo_instance* i, const odo_value* v, uint32_t, uint32_t) -> int32_t {
    return of(i).more = const_cast<double*>(v[0].reals), ODO_OK;
  };
  t.activate = [](odo_instance* i, const odo_sink* sink) -> int32_t {
    of(i).gain = *static_cast<const double*>(of(i).more);
    return of(i).sink = sink, ODO_OK;
  };
}
#else
#error "no plugin of this name"
#endif
