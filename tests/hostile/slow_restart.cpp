// SPDX-License-Identifier: Apache-2.0
// A horizontal attitude that is good until a file `slow` lies beside it, with the name of a phase and seconds
// ("create 20", or "entry+create 20" for two). Then its process ends at the next sample, and the next one sleeps in
// that phase: so long, or until the file is gone. In "process" and "destroy" it does not end before it sleeps.
#define HOSTILE_ID "test/slow_restart"
#include <dlfcn.h>
#include <time.h>
#include <unistd.h>

#include <fstream>
#include <string>

#include "tests/hostile/horizontal_attitude.hpp"

namespace {

void here() {}

/// The phase in which to sleep, and for how long; no phase without the file.
struct Sleep {
  std::string phase;
  double seconds = 0;
};

Sleep sleep_now() {
  Dl_info info{};
  dladdr(reinterpret_cast<const void*>(&here), &info);
  const std::string path = info.dli_fname ? info.dli_fname : "";
  std::ifstream file(path.substr(0, path.rfind('/') + 1) + "slow");
  Sleep read;
  file >> read.phase >> read.seconds;
  return read;
}

double now_s() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

void sleep_in(const char* phase) {
  const timespec step{0, 10'000'000};
  const double start_s = now_s();
  const auto sleeps = [&] {
    const Sleep sleep = sleep_now();
    return sleep.phase.find(phase) != std::string::npos && now_s() - start_s < sleep.seconds;
  };
  while (sleeps()) nanosleep(&step, nullptr);
}

bool restarted = false;

}  // namespace

extern "C" int32_t ODO_PLUGIN_ENTRY(const odo_host*, odo_plugin* out) {
  restarted = !sleep_now().phase.empty();
  sleep_in("entry");
  odo_plugin t = hostile::table();
  HOSTILE_SERVES(t, ODO_INTERFACE_ATTITUDE);
  t.create = hostile::create_after<[] { sleep_in("create"); }>;
  t.configure = [](odo_instance*, const odo_value*, uint32_t, uint32_t) -> int32_t {
    return sleep_in("configure"), ODO_OK;
  };
  t.activate = [](odo_instance*, const odo_sink* s) -> int32_t {
    sleep_in("activate");
    hostile::sink() = s;
    return ODO_OK;
  };
  t.destroy = [](odo_instance*) { sleep_in("destroy"); };
  t.process = [](odo_instance*, const odo_batch* batch) -> int32_t {
    if (batch->messages[0]->type != ODO_TYPE_IMU) return ODO_OK;
    const std::string phase = sleep_now().phase;
    if (!restarted && !phase.empty() && phase != "process" && phase != "destroy") _exit(1);
    sleep_in("process");
    return hostile::emit_horizontal_attitude(*batch->messages[0]);
  };
  return hostile::fill(out, t);
}
