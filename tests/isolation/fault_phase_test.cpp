// SPDX-License-Identifier: Apache-2.0
//
// Every fault that ends or stops a program, in every phase of a plugin's life: isolated, and in the app's thread.
#include <chrono>
#include <csignal>
#include <mutex>
#include <thread>

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <odograph/attitude.h>
#include <odograph/odograph.h>

#include "sdk/host/plugin_host/plugin_call.hpp"
#include "sdk/host/plugin_host/call_watchdog.hpp"
#include "tests/support/obeys.hpp"
#include "tests/support/session_app.hpp"
#include "tests/support/test_plugins.hpp"

TEST_SUITE_BEGIN("fault_phase");

namespace {

const char* const kPhases[] = {"entry", "create", "configure", "activate", "process", "destroy"};
const char* const kFaults[] = {"abort",
                               "exit",
                               "quick_exit",
                               "segfault",
                               "null_call",
                               "stack_overflow",
                               "illegal_instruction",
                               "arithmetic",
                               "kill",
                               "terminate",
                               "throws",
                               "throws_a_number",
                               "thread_exit",
                               "hangs",
                               "sleeps",
                               "closes_files",
                               "eats_memory",
                               "scribbles",
                               "answers_unasked",
                               "takes_no_question"};
/// Cannot be named: the process ends before a handler can run.
const std::set<std::string> kUnnamed = {"kill", "quick_exit"};
/// Faults that an app survives in its own thread.
const std::set<std::string> kSurvived = {"throws", "throws_a_number", "closes_files", "answers_unasked",
                                         "takes_no_question"};

/// A forged answer in the library's place gives no reason why it did not load.
const std::set<std::string> kForged = {"answers_unasked", "takes_no_question"};

/// Installs the plugin under a name that selects its fault.
std::string install(const TemporaryFolder& folder, const std::string& name) {
  return install_with_manifest(folder, built("tests/hostile/fault_phase.so"), name, "test/fault_phase",
                               ODO_INTERFACE_ATTITUDE);
}

struct Outcome {
  bool opened = false;
  int32_t status = 0;
  size_t poses = 0;
  std::string said;
};

/// Two seconds of walking beside the isolated plugin, and its end.
Outcome walk(const std::string& plugins) {
  Outcome out;
  {
    App app(
        "odograph: 1\nattitude:\n  - plugin: attitude/vqf\n  - {plugin: test/fault_phase, isolation: process, "
        "time_limit: 0.05 s, start_limit: 0.5 s, memory_limit: 256}\nstep_estimator:\n  plugin: step/renaudin2012\n",
        ODO_RUN_REPLAY, plugins);
    out.opened = app.session != nullptr;
    out.status = app.status;
    out.said = app.message + "\n";
    if (!app.session) return out;
    app.run(0, 200);
    out.poses = app.all<odo_pose>(ODO_TYPE_POSE).size();
    out.said += app.said();
  }
  return out;
}

/// The same in the thread of a separate program, which writes its standard error to a file.
pid_t start_app(const std::string& plugins, const fs::path& said_file, bool eats_memory) {
  const std::string folders = plugin_folder().string() + ":" + plugins;
  const std::string program = built("tests/fault_phase_app");
  const pid_t child = fork();
  if (child == 0) {
    const int fd = open(said_file.c_str(), O_CREAT | O_WRONLY | O_TRUNC, 0600);
    dup2(fd, STDERR_FILENO);
    const rlimit no_core{0, 0};
    setrlimit(RLIMIT_CORE, &no_core);
    const rlimit memory{512 << 20, 512 << 20};  // the machine is shared
    if (eats_memory) setrlimit(RLIMIT_AS, &memory);
    execl(program.c_str(), program.c_str(), folders.c_str(), nullptr);
    _exit(1);
  }
  return child;
}

enum class HostEnd { timed_out, without_report, with_report };

/// A host that asks an isolated plugin more than a socket holds; it is killed if it does not end.
HostEnd run_long_walk(const std::string& plugins, const std::string& words) {
  const pid_t host = fork();
  if (host == 0) {
    App app(
        "odograph: 1\nattitude:\n  - plugin: attitude/vqf\n  - {plugin: test/fault_phase, isolation: process}\n"
        "step_estimator:\n  plugin: step/renaudin2012\n",
        ODO_RUN_REPLAY, plugins);
    app.run(0, 6000);
    _exit(contains(app.said(), words) ? 0 : 1);
  }
  constexpr int kLongest_s = 60;
  int status = 0;
  for (int i = 0; i < 100 * kLongest_s; ++i) {
    if (waitpid(host, &status, WNOHANG) == host)
      return WIFEXITED(status) && WEXITSTATUS(status) == 0 ? HostEnd::with_report : HostEnd::without_report;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  kill(host, SIGKILL);
  waitpid(host, &status, 0);
  return HostEnd::timed_out;
}

}  // namespace

TEST_CASE("the host continues and publishes poses for every fault in every phase of an isolated plugin") {
  size_t runs = 0, named_count = 0;
  for (const std::string fault : kFaults)
    for (const std::string phase : kPhases) {
      const TemporaryFolder folder;
      const std::string plugins = install(folder, fault + "__" + phase);
      CAPTURE(fault);
      CAPTURE(phase);
      const Outcome out = walk(plugins);
      CAPTURE(out.said);
      ++runs;
      if (out.opened) CHECK(out.poses > 0);
      // An exception in entry or create is a refusal with a reason; all else is opened and named.
      if (!out.opened) CHECK(contains(out.said, fault + "__" + phase));
      if (!out.opened) CHECK((fault.find("throws") == 0 || kForged.count(fault) > 0));
      named_count += contains(out.said, "test/fault_phase: ") || !out.opened ? 1 : 0;
    }
  MESSAGE(runs << " plugins, " << named_count << " named before the end");
  CHECK(runs == 120);
  CHECK(named_count >= 75);  // except those in destroy, after which nobody listens, and harmless ones
}

TEST_CASE("a plugin that reads no question delays its host by one call at most, however it answers") {
  for (const auto& [fault, words] : {std::pair{"answers_unasked", "broke the protocol: an unrequested answer"},
                                     {"takes_no_question", "does not accept requests"}}) {
    const std::string plugin = std::string(fault) + "__process";
    CAPTURE(plugin);
    const TemporaryFolder folder;
    const std::string plugins = install(folder, plugin);
    bool named_count = false;
    for (int i = 0; i < 8 && !named_count;
         ++i) {  // on a busy machine its first forged answer may come too late to be complete
      const auto how = run_long_walk(plugins, words);
      REQUIRE_MESSAGE(how != HostEnd::timed_out, "the host waits for ever");
      named_count = how == HostEnd::with_report;
    }
    CHECK(named_count);
  }
}

TEST_CASE("every fault in every phase in the app's thread is survived or named with the call") {
  size_t survived = 0, named = 0, runs = 0;
  for (const std::string fault : kFaults) {
    if (fault == "eats_memory" && !kMemoryLimited) continue;
    std::map<std::string, TemporaryFolder> folders;
    std::map<std::string, pid_t> apps;  // in parallel: hanging ones take time
    for (const std::string phase : kPhases) {
      const TemporaryFolder& folder = folders[phase];
      const std::string plugins = install(folder, fault + "__" + phase);
      apps[phase] = start_app(plugins, folder / "said", fault == "eats_memory");
    }
    for (const std::string phase : kPhases) {
      int status = 0;
      waitpid(apps[phase], &status, 0);
      const std::string said = read_text(folders[phase] / "said");
      CAPTURE(fault);
      CAPTURE(phase);
      CAPTURE(said);
      ++runs;
      const bool lived = WIFEXITED(status) && WEXITSTATUS(status) == 77;
      survived += lived;
      if (kSurvived.count(fault) > 0) CHECK(lived);
      CHECK_FALSE((WIFEXITED(status) && WEXITSTATUS(status) == 0 && fault != "quick_exit"));
      if (lived || kUnnamed.count(fault) > 0 || fault == "scribbles") continue;
      const std::string call = phase == "entry" ? "load" : phase;
      const bool names = contains(said, "test/fault_phase in " + call);
      CHECK(names);
      named += names;
    }
  }
  MESSAGE(runs << " plugins, " << survived << " survived, of the rest " << named << " named");
  CHECK(runs == (kMemoryLimited ? 120 : 114));
  CHECK(survived >= kSurvived.size() * std::size(kPhases));
}

TEST_CASE("a hanging call in the app's thread is reported once, while it lasts") {
  std::mutex mutex;
  std::vector<std::string> said;
  HostServices host(0, {}, [&](const Report& report) {
    const std::lock_guard lock(mutex);
    said.push_back(report.text);
  });
  const CallWatchdog watch(host, {.longest_call_s = 0.05, .period_s = 0.01});
  {
    const PluginCallScope scope("acme/slow", "process");
    std::this_thread::sleep_for(std::chrono::milliseconds(1500));  // reports of a kind are limited to one per second
  }
  const std::lock_guard lock(mutex);
  CHECK(std::count_if(said.begin(), said.end(),
                      [](const std::string& text) { return contains(text, "plugin acme/slow in process for "); }) == 1);
}

TEST_CASE("a late call in the app's thread is reported when it returns, and nothing else changes") {
  const TemporaryFolder folder;
  const fs::path library = folder / "cost_imu__120_ms.so";
  copy_plugin(built("tests/faulty_plugins/cost_imu__120_ms.so"), library);
  RunningApp app("odograph: 1\nattitude: {plugin: test/faulty, time_limit: 0.05 s}\n", ODO_RUN_REPLAY,
                 folder.path().string());
  app.run(0, 3);
  REQUIRE_FALSE(app.reports.empty());
  CHECK(std::string(app.reports[0].key) == "late");
  CHECK(contains(std::string(app.reports[0].text), "s in process; expected at most 0.05 s (time_limit)"));
  CHECK(app.all<odo_attitude>(ODO_TYPE_ATTITUDE).size() == 3);
  CHECK(app.statistics().plugin_faults == 0);
}

TEST_CASE("an app can query a hanging call in a session's thread while it lasts") {
  const TestPlugins plugins{"obeys"};
  const RunningApp app(
      "odograph: 1\nvo_frontend: {plugin: vo/five_point}\nscale_source: {plugin: test/obeys, time_limit: 600 s}\n",
      ODO_RUN_LIVE, plugins.path());
  Order hang = order(1'000'000'000);
  hang.sleep_ms = 9000;
  const auto start = std::chrono::steady_clock::now();
  CHECK(app.push(hang) == ODO_OK);
  odo_error error{sizeof error, ODO_OK, {}};
  const auto named = [&] {
    odo_session_last_error(app.session, &error);
    return contains(error.message, "plugin test/obeys in process for ");
  };
  bool is_named = named();
  while (!is_named && std::chrono::steady_clock::now() - start < std::chrono::seconds(9)) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    is_named = named();
  }
  CHECK(is_named);
}
