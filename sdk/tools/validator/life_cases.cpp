// SPDX-License-Identifier: Apache-2.0
//
// Instances, threads, leaks, and saved state.
#include <algorithm>
#include <limits>
#include <thread>

#if defined(__GLIBC__)
#include <malloc.h>
#endif
#include <unistd.h>

#include "sdk/tools/validator/case_fixture.hpp"
#include "sdk/tools/validator/child.hpp"

namespace odograph {
CASES(life)
namespace {

std::string status_text(const char* what, int32_t status) {
  return std::string(what) + " gave status " + std::to_string(status);
}
Verdict no_violation_of(CaseFixture& fixture, const char* beginning) {
  const auto driver = fixture.start_instance();
  driver->process(fixture.input);
  if (fixture.table().reset) driver->reset();
  driver->destroy();
  usleep(20'000);  // for its own threads
  for (const std::string& violation : driver->violations)
    if (violation.starts_with(beginning)) return violation;
  return "";
}

/// Returns freed memory to the system; leaks would hide in it.
void trim_heap() {
#if defined(__GLIBC__)
  malloc_trim(0);
#endif
}

// ---- save and load -------------------------------------------------------------------------------------------------

/// Throws a Verdict if saving fails.
std::vector<uint8_t> saved(const CaseFixture& fixture, const PluginDriver& driver) {
  note_phase("save");
  const auto save = fixture.table().save;
  const int64_t needed = save(driver.instance(), nullptr, 0);
  if (needed < 0 || needed > int64_t{ODO_LARGEST_STATE})
    throw Verdict(status_text("save", static_cast<int32_t>(needed)));
  std::vector<uint8_t> bytes(static_cast<size_t>(needed) + 64, 0x5A);
  if (save(driver.instance(), bytes.data(), static_cast<uint64_t>(needed)) != needed)
    throw Verdict("save returned another size when called again");
  for (size_t i = static_cast<size_t>(needed); i < bytes.size(); ++i)
    if (bytes[i] != 0x5A) throw Verdict("save wrote beyond the capacity");
  bytes.resize(static_cast<size_t>(needed));
  return bytes;
}

CASE(life, "life.create_destroy", "is created and destroyed", 10, 0) {
  const auto driver = fixture.driver();
  const int32_t status = driver->create();
  return status >= 0 ? "" : status_text("create", status);
}

CASE(life, "life.starts", "starts with its default parameters", 20, 0) {
  fixture.start_instance();
  return {};
}

CASE(life, "life.not_activated", "is destroyed before it was activated", 10, 0) {
  const auto driver = fixture.driver();
  int32_t status = driver->create();
  if (status >= 0) status = driver->configure(fixture.values);
  return status >= 0 ? "" : status_text("configure", status);
}

CASE(life, "life.unknown_kind", "refuses a kind that it does not serve", 10, 0) {
  note_phase("create");
  odo_instance* instance = nullptr;
  const std::string unknown_id = "odo.of_a_later_version/7";
  const odo_string id{unknown_id.data(), unknown_id.size()};
  const int32_t status = fixture.table().create(&fixture.host, 1, &id, &instance);
  if (status >= 0) return "it created an instance of '" + unknown_id + "'; expected ODO_E_UNSUPPORTED";
  return instance ? "it refused and left an instance behind" : "";
}

CASE(life, "life.every_kind", "starts as each of its kinds", 20, 0) {
  for (uint32_t i = 0; i < fixture.table().interface_count; ++i) {
    const odo_string& kind = fixture.table().interfaces[i];
    PluginDriver driver(fixture.table(), fixture.host, {kind.data, static_cast<size_t>(kind.size)});
    if (const int32_t status = driver.start(fixture.values); status < 0)
      return "interfaces[" + std::to_string(i) + "]: " + status_text("starting", status);
  }
  return "";
}

CASE(life, "life.no_services", "works with a host that offers no services", 20, 2) {
  odo_host bare = fixture.host;
  bare.get_service = [](const odo_host*, const char*, uint64_t) -> const void* { return nullptr; };
  PluginDriver driver(fixture.table(), bare, fixture.interface_id);
  const int32_t status = driver.start(fixture.values);
  if (status == ODO_E_CONFIG || status == ODO_E_NOT_FOUND) return "";  // it needs a file and cannot ask for it
  if (status < 0) return status_text("starting", status);
  const int32_t worst = driver.process(fixture.input);
  return worst >= 0 ? "" : status_text("process", worst);
}

/// Sequentially and in parallel: the output of one instance must not depend on others.
CASE(life, "life.independent", "does not depend on the input of other instances", 20, 2) {
  const auto alone = fixture.run(fixture.input, {});
  const auto one = fixture.start_instance(), other = fixture.start_instance();
  for (const AnyMessage& message : fixture.input) {
    one->process({message});
    AnyMessage later = message;
    later.header().t_ns += 123'456'789;
    if (later.header().type == ODO_TYPE_IMU) reinterpret_cast<odo_imu&>(later.header()).gyro_b[0] = 0.7;
    if (later.header().type != ODO_TYPE_VO_MOTION && later.header().type != ODO_TYPE_STEP) other->process({later});
  }
  return difference(alone, one->bytes());
}

CASE(life, "life.many", "supports twenty instances at once", 30, 0) {
  std::vector<std::unique_ptr<PluginDriver>> all;
  for (int i = 0; i < 20; ++i) all.push_back(fixture.start_instance());
  return {};
}

CASE(life, "life.other_thread", "works on another thread than the one that created it", 20, 2) {
  const auto here = fixture.run(fixture.input, {});
  const auto driver = fixture.start_instance();
  std::thread([&] { driver->process(fixture.input); }).join();
  return difference(here, driver->bytes());
}

CASE(life, "life.emits_in_process", "emits only within process", 10, 3) { return no_violation_of(fixture, "phase"); }

CASE(life, "life.emits_on_thread", "emits on the thread that called it", 10, 3) {
  return no_violation_of(fixture, "thread");
}

CASE(life, "life.threads", "leaves no thread behind", 30, 1) {
  fixture.run(fixture.input, {});  // excludes what a library starts once for all instances
  const size_t before = entries_of("/proc/self/task");
  for (int i = 0; i < 5; ++i) fixture.run(fixture.input, {});
  const size_t after = entries_of("/proc/self/task");
  return after <= before ? "" : std::to_string(after - before) + " threads more after five instances";
}

CASE(life, "life.files", "leaves no file open", 30, 1) {
  fixture.run(fixture.input, {});
  const size_t before = entries_of("/proc/self/fd");
  for (int i = 0; i < 5; ++i) fixture.run(fixture.input, {});
  const size_t after = entries_of("/proc/self/fd");
  return after <= before ? "" : std::to_string(after - before) + " files more are open after five instances";
}

/// A hundred instances to warm up, then four times 250. A leak grows in each round, the allocator's pools only
/// occasionally; so the smallest growth counts, times four. A leak of 2 kB per instance shows as 2 MB.
CASE(life, "life.leaks", "leaves no memory behind in 1,000 instances", 120, 0) {
  constexpr int rounds = 4, instances = 250;
  const auto cycle = [&](int count) {
    for (int i = 0; i < count; ++i) fixture.run({}, {});
    trim_heap();
    return resident_mb();
  };
  double before = cycle(100), smallest = std::numeric_limits<double>::infinity();
  for (int round = 0; round < rounds; ++round) {
    const double now = cycle(instances);
    smallest = std::min(smallest, now - before), before = now;
  }
  const double more = rounds * smallest;
  return more < 2.0 ? "" : std::to_string(more) + " MB more after 1000 instances; expected less than 2";
}

CASE(life, "life.grows", "does not need more memory the longer it runs", 60, 5) {
  const auto driver = fixture.start_instance();
  const auto walk = [&](int round) {
    MessageLayout later;
    later.change = [=](AnyMessage& message) { shift(message, round * 20'000'000'000); };
    driver->process(fixture.input, later);
    driver->events.clear();
    driver->events.shrink_to_fit();
    driver->call_s.clear();
  };
  for (int round = 0; round < 3; ++round) walk(round);
  const double before = resident_mb();
  for (int round = 3; round < 9; ++round) walk(round);
  const double more = resident_mb() - before;
  return more < 16.0 ? "" : std::to_string(more) + " MB more after six walks of 5 s; expected less than 16";
}

CASE(life, "life.extension", "has no table for an unknown extension", 10, 0) {
  if (!fixture.table().get_interface) return not_applicable("it has no get_interface");
  const auto driver = fixture.start_instance();
  note_phase("get_interface");
  return fixture.table().get_interface(driver->instance(), "vendor.none/1", 13)
             ? "it returned a table for an unknown id"
             : "";
}

CASE(life, "state.capacity", "saves within the capacity or not at all", 20, 3) {
  if (!fixture.table().save) return not_applicable("it saves nothing");
  const auto driver = fixture.start_instance();
  driver->process(fixture.input);
  const auto bytes = saved(fixture, *driver);
  if (bytes.empty()) return {};
  std::vector<uint8_t> small(bytes.size(), 0x5A);
  fixture.table().save(driver->instance(), small.data(), bytes.size() - 1);
  return std::all_of(small.begin(), small.end(), [](uint8_t b) { return b == 0x5A; })
             ? ""
             : "save wrote although the capacity was too small";
}

CASE(life, "state.round_trip", "loads what it saved", 20, 3) {
  if (!fixture.table().save || !fixture.table().load) return not_applicable("it saves nothing");
  const auto one = fixture.start_instance(), other = fixture.start_instance();
  one->process(fixture.input);
  const auto bytes = saved(fixture, *one);
  if (bytes.empty()) return not_applicable("it has nothing to save");
  note_phase("load");
  if (const int32_t status = fixture.table().load(other->instance(), bytes.data(), bytes.size()); status < 0)
    return status_text("loading what it saved", status);
  return saved(fixture, *other) == bytes ? "" : "after loading, it saves a different state";
}

CASE(life, "state.damaged", "survives 300 damaged states", 20, 2) {
  if (!fixture.table().load) return not_applicable("it loads nothing");
  const auto driver = fixture.start_instance();
  auto bytes = fixture.table().save ? saved(fixture, *driver) : std::vector<uint8_t>();
  uint32_t random = 12345;
  for (int i = 0; i < 300; ++i) {
    auto bad = bytes;
    random = random * 1664525u + 1013904223u;
    if (i % 3 == 0) bad.resize(random % (bytes.size() + 64), 0xFF);
    for (uint32_t k = 0; k <= random % 4 && !bad.empty(); ++k)
      bad[(random >> 8 ^ k * 7919) % bad.size()] ^= static_cast<uint8_t>(1 + i);
    note_phase("load", "of a damaged state");
    fixture.table().load(driver->instance(), bad.data(), bad.size());
  }
  const int32_t status = driver->process(fixture.input);
  if (status <= ODO_E_ERROR) return status_text("after damaged states process", status);
  for (const std::string& violation : driver->violations)
    if (violation.starts_with("numbers")) return "after damaged states it " + violation.substr(9);
  return {};
}

CASE(life, "state.foreign", "refuses what it did not save", 10, 0) {
  if (!fixture.table().load || !fixture.table().save) return not_applicable("it saves nothing");
  const auto driver = fixture.start_instance();
  if (saved(fixture, *driver).empty()) return not_applicable("it has nothing to save");
  const char text[] = "this was saved by somebody else, long ago and in another format";
  note_phase("load");
  return fixture.table().load(driver->instance(), text, sizeof text) < 0 ? "" : "it accepted a text as a saved state";
}

}  // namespace

}  // namespace odograph
