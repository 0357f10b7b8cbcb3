// SPDX-License-Identifier: Apache-2.0
//
// Checks that repetition neither leaks nor breaks. `ctest` runs a little of each; docs/security.md has the long runs.
// Exits with status 1 if memory, threads or files grow.
// odograph-endurance unloads N LIBRARY     loads, uses and unloads a library, N times
// odograph-endurance loads N PLUGINS       the host loads, starts, feeds and destroys each of our plugins
// odograph-endurance pipelines N PLUGINS   a session with every kind of plugin
// odograph-endurance hours H PLUGINS       H hours of a walker's sensor time, with a barometer and GNSS
// odograph-endurance record H FILE         the same samples as a recording
#include <dlfcn.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <thread>

#include <odograph/attitude.h>
#include <odograph/odograph.h>
#include <odograph/recording.h>

#include "sdk/host/config/manifest.hpp"
#include "sdk/host/messages/messages.hpp"
#include "sdk/host/plugin_host/instance.hpp"
#include "tests/support/messages.hpp"
#include "tests/support/replay_session.hpp"

using namespace odograph;
namespace fs = std::filesystem;

namespace {

constexpr int64_t kSecond_ns = 1'000'000'000;
constexpr double kRevolutions_per_s = 0.01;  // of a walker in circles

double resident_mb() {
  std::ifstream file("/proc/self/statm");
  long pages = 0, resident = 0;
  file >> pages >> resident;
  return static_cast<double>(resident * sysconf(_SC_PAGESIZE)) / (1 << 20);
}

long entries(const char* folder) { return std::distance(fs::directory_iterator(folder), fs::directory_iterator()); }

/// Memory, threads and files since its construction.
class Growth {
 public:
  /// Prints the growth, and returns whether it is at most `allowed_mb`.
  bool flat(const char* what, double allowed_mb) const {
    const double grown_mb = resident_mb() - resident_mb_;
    long threads = entries("/proc/self/task") - threads_;
    for (int i = 0; i < 100 && threads > 0; ++i, threads = entries("/proc/self/task") - threads_)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));  // a joined thread is listed until the kernel ends it
    const long files = entries("/proc/self/fd") - files_;
    std::printf("%s: %.2f MB resident, %+.2f MB since the start of the count, %+ld threads, %+ld files\n", what,
                resident_mb(), grown_mb, threads, files);
    return grown_mb <= allowed_mb && threads <= 0 && files <= 0;
  }

 private:
  double resident_mb_ = resident_mb();
  long threads_ = entries("/proc/self/task"), files_ = entries("/proc/self/fd");
};

int failed(const std::string& why) {
  std::printf("FAILED: %s\n", why.c_str());
  return 1;
}

odo_imu walking(int64_t t_ns) {
  auto imu = make_message<odo_imu>(ODO_TYPE_IMU, t_ns);
  const double t = static_cast<double>(t_ns % (1000 * kSecond_ns)) * 1e-9;
  imu.header.flags = ODO_IMU_GYRO | ODO_IMU_ACCEL;
  imu.gyro_b[0] = 0.05 * std::sin(6 * t), imu.gyro_b[1] = 2 * M_PI * kRevolutions_per_s,
  imu.gyro_b[2] = 0.1 * std::sin(3 * t);
  imu.accel_b[0] = 0.1, imu.accel_b[1] = 9.81 + 2.2 * std::sin(2 * M_PI * 1.9 * t), imu.accel_b[2] = 0.4;
  return imu;
}

odo_barometer pressure(int64_t t_ns) {
  return pressure_at(t_ns, 95000 + 10 * std::sin(static_cast<double>(t_ns % (600 * kSecond_ns)) * 1e-11));
}

odo_gnss position(int64_t t_ns) {
  auto gnss = make_message<odo_gnss>(ODO_TYPE_GNSS, t_ns);
  const double angle = 2 * M_PI * kRevolutions_per_s * 1e-9 * static_cast<double>(t_ns % (100 * kSecond_ns));
  gnss.header.flags = ODO_GNSS_POSITION | ODO_GNSS_HEIGHT | ODO_GNSS_COVARIANCE;
  gnss.latitude_rad = 0.826 + 20 / 6.37e6 * std::sin(angle), gnss.longitude_rad = 0.149 + 30 / 6.37e6 * std::cos(angle);
  gnss.height_m = 430;
  for (int i = 0; i < 3; ++i) gnss.covariance_n[4 * i] = i < 2 ? 9 : 36;
  return gnss;
}

/// Passes the samples of `hours` to `take` in time order, starting at one second.
template <class Take>
void walk(double hours, Take&& take) {
  const auto end_ns = static_cast<int64_t>(hours * 3600) * kSecond_ns;
  for (int64_t t = 0; t < end_ns; t += kSecond_ns / 100) {
    take(walking(t + kSecond_ns).header);
    if (t % (kSecond_ns / 10) == 0) take(pressure(t + kSecond_ns).header);
    if (t % kSecond_ns == 0) take(position(t + kSecond_ns).header);
  }
}

odo_session* open(const std::string& yaml, const std::string& plugins) {
  return open_session(replay_options(yaml, plugins));
}

int unloads(long times, const std::string& library) {
  HostServices host(0, {}, nullptr);
  const odo_sink sink = [] {
    odo_sink s{};
    s.struct_size = sizeof s;
    s.emit = [](const odo_sink*, const odo_header*) -> int32_t { return ODO_OK; };
    return s;
  }();
  const auto cycle = [&] {
    void* handle = dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (!handle) return false;
    const auto entry = reinterpret_cast<odo_plugin_entry>(dlsym(handle, ODO_PLUGIN_ENTRY_SYMBOL));
    odo_plugin table{};
    table.struct_size = sizeof table;
    bool good = entry && entry(&host, &table) == ODO_OK;
    odo_instance* instance = nullptr;
    good = good && table.create(&host, 1, table.interfaces, &instance) >= 0 &&
           table.configure(instance, nullptr, 0, sizeof(odo_value)) >= 0 && table.activate(instance, &sink) >= 0;
    const odo_imu imu = walking(kSecond_ns);
    const odo_header* messages[] = {&imu.header};
    const odo_batch batch{sizeof(odo_batch), 1, messages};
    good = good && table.process(instance, &batch) >= 0;
    if (instance) table.destroy(instance);
    dlclose(handle);
    return good && dlopen(library.c_str(), RTLD_NOW | RTLD_NOLOAD) == nullptr;  // it is unloaded
  };
  for (int i = 0; i < 100; ++i)
    if (!cycle()) return failed(library + " cannot be loaded, used and unloaded");
  const Growth growth;
  for (long i = 0; i < times; ++i)
    if (!cycle()) return failed("cycle " + std::to_string(i));
  return growth.flat((std::to_string(times) + " times " + fs::path(library).filename().string()).c_str(), 0.5) ? 0 : 1;
}

/// Every plugin that does not need a file.
int loads(long times, const std::string& plugins) {
  HostServices host(0, {}, nullptr);
  int bad = 0;
  for (const auto& entry : fs::directory_iterator(plugins)) {
    if (entry.path().extension() != ".json") continue;
    const auto manifest = read_manifest(entry.path());
    if (!manifest) return failed(manifest.failure().text);
    PluginChoice choice;
    choice.manifest = *manifest;
    choice.interface_id = manifest->interfaces.front();
    for (const Spec& spec : manifest->parameters) choice.parameters.emplace_back(spec, default_value(spec));
    const auto cycle = [&] {
      auto made = PluginInstance::make(choice, LibraryCheck::none, 1, host);
      if (!made) return std::printf("%s\n", made.failure().text.c_str()), false;
      for (int k = 0; k < 10; ++k) (*made)->process(walking(kSecond_ns + k * kSecond_ns / 100).header);
      return true;
    };
    if (!cycle()) continue;  // it needs a file and has reported that
    for (int i = 0; i < 20; ++i) cycle();
    const Growth growth;
    bool good = true;
    for (long i = 0; i < times && good; ++i) good = cycle();
    bad += good && growth.flat((std::to_string(times) + " times " + manifest->id).c_str(), 2) ? 0 : 1;
  }
  return bad;
}

int pipelines(long times, const std::string& plugins) {
  const std::string yaml =
      "odograph: 1\nattitude: {plugin: attitude/vqf}\nstep_estimator: {plugin: step/odograph}\n"
      "vo_frontend: {plugin: vo/odograph}\nscale_source: {plugin: scale/step_length}\n"
      "absolute_fixers: [{plugin: fix/gnss}, {plugin: fix/waypoint}, {plugin: fix/barometer}]\n"
      "coupling: {type: localizer}\n";
  const auto cycle = [&] {
    odo_session* session = open(yaml, plugins);
    if (!session) return false;
    for (int k = 0; k < 200; ++k) {
      const odo_imu imu = walking(kSecond_ns + k * kSecond_ns / 100);
      odo_session_push(session, &imu.header);
    }
    odo_session_flush(session);
    odo_session_destroy(session);
    return true;
  };
  for (int i = 0; i < 20; ++i)
    if (!cycle()) return 1;
  const Growth growth;
  for (long i = 0; i < times; ++i)
    if (!cycle()) return 1;
  return growth.flat((std::to_string(times) + " pipelines").c_str(), 2) ? 0 : 1;
}

int hours(double time_h, const std::string& plugins) {
  odo_session* session = open(
      "odograph: 1\nattitude: {plugin: attitude/vqf}\nstep_estimator: {plugin: step/odograph}\n"
      "absolute_fixers: [{plugin: fix/gnss}, {plugin: fix/barometer}]\n",
      plugins);
  if (!session) return 1;
  std::map<uint32_t, uint64_t> events;
  odo_session_set_callback(
      session, nullptr, ODO_ALL_EVENTS,
      [](void* user, const odo_header* event) { ++(*static_cast<std::map<uint32_t, uint64_t>*>(user))[event->type]; },
      &events);
  uint64_t pushed = 0, imu = 0, first_steps = 0;
  const auto push = [&](const odo_header& sample) {
    imu += sample.type == ODO_TYPE_IMU ? 1 : 0;
    ++pushed;
    odo_session_push(session, &sample);
  };
  const auto statistics = [&] {
    odo_statistics s{};
    s.struct_size = sizeof s;
    odo_session_get_statistics(session, &s);
    return s;
  };
  std::unique_ptr<Growth> growth;  // since the first hour, or a tenth of the whole
  const double warm_h = std::min(1.0, time_h / 10);
  walk(time_h, [&](const odo_header& sample) {
    if (!growth && static_cast<double>(sample.t_ns) > warm_h * 3600e9) {
      growth = std::make_unique<Growth>();
      first_steps = statistics().steps;
    }
    push(sample);
  });
  odo_session_flush(session);
  const odo_statistics s = statistics();
  std::printf("%.3g h: %llu samples, %llu processed, %llu steps, %llu attitudes, %llu fixes, %.0f s in states\n",
              time_h, static_cast<unsigned long long>(pushed), static_cast<unsigned long long>(s.processed),
              static_cast<unsigned long long>(s.steps), static_cast<unsigned long long>(events[ODO_TYPE_ATTITUDE]),
              static_cast<unsigned long long>(events[ODO_TYPE_FIX]), s.tracking_s + s.degraded_s + s.lost_s);
  int bad = growth->flat("memory after the first hour", 1) ? 0 : 1;
  if (s.pushed != pushed || s.processed != pushed) bad += failed("a sample was lost");
  if (s.late + s.duplicate + s.invalid + s.overflow + s.wild + s.events_dropped + s.unknown + s.plugin_faults > 0)
    bad += failed("something was dropped");
  if (events[ODO_TYPE_ATTITUDE] != imu) bad += failed("an attitude was lost");
  if (events[ODO_TYPE_STEP] != s.steps) bad += failed("a step was lost");
  if (events[ODO_TYPE_FIX] != s.fixes_accepted + s.fixes_rejected) bad += failed("a fix was lost");
  if (s.steps <= first_steps) bad += failed("no steps after the first hour");
  odo_session_destroy(session);
  return bad;
}

int record(double time_h, const std::string& file) {
  const odo_string path{file.data(), file.size()};
  odo_recorder* recorder = nullptr;
  if (odo_recorder_create(&path, &recorder, nullptr) < 0) return failed("no recording at " + file);
  int32_t worst = ODO_OK;
  walk(time_h,
       [&](const odo_header& sample) { worst = std::min(worst, odo_recorder_write(recorder, &sample, nullptr, 0)); });
  return odo_recorder_close(recorder) < 0 || worst < 0 ? failed("could not be written") : 0;
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 4) return failed("expected unloads|loads|pipelines|hours|record, a number, and what to work on");
  const std::string what = arguments[1], on = arguments[3];
  const double number = std::atof(arguments[2]);
  const auto times = static_cast<long>(number);
  if (what == "unloads") return unloads(times, on);
  if (what == "loads") return loads(times, on);
  if (what == "pipelines") return pipelines(times, on);
  if (what == "hours") return hours(number, on);
  if (what == "record") return record(number, on);
  return failed("no '" + what + "'");
}
