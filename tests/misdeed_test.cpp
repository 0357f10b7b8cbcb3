// SPDX-License-Identifier: Apache-2.0
//
// Every means to end or stop a program, at every moment of a plugin's life: in a process of its own, on a thread of its
// own, and in the app's thread.
#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <map>
#include <mutex>
#include <set>
#include <thread>

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <odograph/attitude.h>
#include <odograph/odograph.h>

#include "sdk/host/plugin_host/breadcrumb.hpp"
#include "sdk/host/plugin_host/hang_watch.hpp"
#include "tests/session_app.hpp"
#include "tests/test_plugins.hpp"

using namespace odograph;
namespace fs = std::filesystem;

TEST_SUITE_BEGIN("misdeed");

namespace {

const char* const kMoments[] = {"entry", "create", "configure", "activate", "process", "destroy"};
const char* const kDeeds[] = {
    "abort",      "exit",         "quick_exit",  "segfault", "null_call",       "stack_overflow", "illegal_instruction",
    "arithmetic", "kill",         "terminate",   "throws",   "throws_a_number", "thread_exit",    "hangs",
    "sleeps",     "closes_files", "eats_memory", "scribbles"};
/// What no one can name: the process is gone before anybody runs.
const std::set<std::string> kUnnamed = {"kill", "quick_exit"};
/// What an app survives: on a thread of the plugin's own, and in its own thread.
const std::map<std::string, std::set<std::string>> kSurvived = {
    {"thread", {"throws", "throws_a_number", "thread_exit", "hangs", "sleeps", "closes_files"}},
    {"none", {"throws", "throws_a_number", "closes_files"}}};

/// The plugin under a name that says what it does.
std::string install(const TemporaryFolder& folder, const std::string& name) {
  return install_unasked(folder, fs::path(ODOGRAPH_BUILD) / "tests/hostile/misdeed.so", name, "test/misdeed",
                         ODO_INTERFACE_ATTITUDE);
}

std::string pipeline(const std::string& isolation) {
  return "odograph: 1\nattitude:\n  - plugin: attitude/vqf\n  - {plugin: test/misdeed, isolation: " + isolation +
         ", time_limit: 0.05 s, start_limit: 0.5 s, memory_limit: 256}\nstep_estimator:\n  plugin: step/renaudin2012\n";
}

struct Outcome {
  bool opened = false;
  int32_t status = 0;
  size_t poses = 0;
  std::string said;
};

/// Two seconds of walking beside the plugin, and its end.
Outcome walk(const std::string& isolation, const std::string& plugins) {
  Outcome out;
  {
    App app(pipeline(isolation), ODO_RUN_REPLAY, plugins);
    out.opened = app.session != nullptr;
    out.status = app.status;
    out.said = app.message + "\n";
    if (!app.session) return out;
    app.walk(0, 200);
    odo_session_flush(app.session);
    out.poses = app.all<odo_pose>(ODO_TYPE_POSE).size();
    out.said += app.said();
  }
  return out;
}

/// The same in a program of its own, which writes its standard error to a file.
pid_t start_app(const std::string& isolation, const std::string& plugins, const fs::path& said_file, bool eats_memory) {
  const std::string folders = plugin_folder().string() + ":" + plugins;
  const std::string program = fs::path(ODOGRAPH_BUILD) / "tests/misdeed_app";
  const pid_t child = fork();
  if (child == 0) {
    const int fd = open(said_file.c_str(), O_CREAT | O_WRONLY | O_TRUNC, 0600);
    dup2(fd, STDERR_FILENO);
    const rlimit no_core{0, 0};
    setrlimit(RLIMIT_CORE, &no_core);
    const rlimit memory{512 << 20, 512 << 20};  // the machine's is for others too
    if (eats_memory) setrlimit(RLIMIT_AS, &memory);
    execl(program.c_str(), program.c_str(), isolation.c_str(), folders.c_str(), nullptr);
    _exit(1);
  }
  return child;
}

}  // namespace

TEST_CASE("every misdeed at every moment, in a process of its own: the host goes on and gives poses") {
  size_t runs = 0, told = 0;
  for (const std::string deed : kDeeds)
    for (const std::string moment : kMoments) {
      const TemporaryFolder folder;
      const std::string plugins = install(folder, deed + "__" + moment);
      CAPTURE(deed);
      CAPTURE(moment);
      const Outcome out = walk("process", plugins);
      CAPTURE(out.said);
      ++runs;
      if (out.opened) CHECK(out.poses > 0);
      // An exception in entry or create is a refusal in words; all else is opened and named.
      if (!out.opened) CHECK(out.said.find(deed + "__" + moment) != std::string::npos);
      if (!out.opened) CHECK(deed.find("throws") == 0);
      told += out.said.find("test/misdeed: ") != std::string::npos || !out.opened ? 1 : 0;
    }
  MESSAGE(runs << " plugins, " << told << " named before the end");
  CHECK(runs == 108);
  CHECK(told >= 75);  // not those in destroy, which nobody is left to hear, and what does no harm there
}

TEST_CASE("every misdeed at every moment, in the app's process: survived, or named with the call") {
  for (const std::string isolation : {"thread", "none"}) {
    size_t survived = 0, named = 0, runs = 0;
    for (const std::string deed : kDeeds) {
      if (deed == "eats_memory" && !kMemoryLimited) continue;
      std::map<std::string, TemporaryFolder> folders;
      std::map<std::string, pid_t> apps;  // side by side: those that hang take their time
      for (const std::string moment : kMoments) {
        const TemporaryFolder& folder = folders[moment];
        const std::string plugins = install(folder, deed + "__" + moment);
        apps[moment] = start_app(isolation, plugins, folder / "said", deed == "eats_memory");
      }
      for (const std::string moment : kMoments) {
        int status = 0;
        waitpid(apps[moment], &status, 0);
        const std::string said = read_text(folders[moment] / "said");
        CAPTURE(isolation);
        CAPTURE(deed);
        CAPTURE(moment);
        CAPTURE(said);
        ++runs;
        const bool lived = WIFEXITED(status) && WEXITSTATUS(status) == 77;
        survived += lived;
        if (kSurvived.at(isolation).count(deed) > 0) CHECK(lived);
        CHECK_FALSE((WIFEXITED(status) && WEXITSTATUS(status) == 0 && deed != "quick_exit"));
        if (lived || kUnnamed.count(deed) > 0 || deed == "scribbles") continue;
        const std::string call = moment == "entry" ? "load" : moment;
        const bool names = said.find("test/misdeed in " + call) != std::string::npos;
        CHECK(names);
        named += names;
      }
    }
    MESSAGE("isolation: " << isolation << ": " << runs << " plugins, " << survived << " survived, of the rest " << named
                          << " named");
    CHECK(runs == (kMemoryLimited ? 108 : 102));
    CHECK(survived >= kSurvived.at(isolation).size() * std::size(kMoments));
  }
}

TEST_CASE("the same bytes come out of a plugin on a thread of its own") {
  const auto events = [](const std::string& isolation) {
    App app(kCamera + isolation);
    REQUIRE_MESSAGE(app.status == ODO_OK, app.message);
    const auto c = calibration(64, 48);
    odo_session_push(app.session, &c.header);
    for (int i = 0; i < 60; ++i) app.walk(20 * i, 20 * i + 20), app.frame(1'000'000'000 + 200'000'000LL * i);
    odo_session_flush(app.session);
    return app.events;
  };
  const auto inside = events(""), apart = events("plugins:\n  isolation: thread\n");
  REQUIRE(inside.size() > 1000);
  CHECK(inside == apart);
}

TEST_CASE("a plugin that hangs on its thread is named and gives way to its fallback within the time limit") {
  const TemporaryFolder folder;
  const std::string plugins = install(folder, "sleeps__process");
  App app(
      "odograph: 1\nattitude: {plugin: test/misdeed, isolation: thread, time_limit: 0.05 s, fallback: attitude/vqf}\n"
      "step_estimator: {plugin: step/renaudin2012}\n",
      ODO_RUN_REPLAY, plugins);
  REQUIRE_MESSAGE(app.status == ODO_OK, app.message);
  const auto start = std::chrono::steady_clock::now();
  app.walk(0, 1000);
  odo_session_flush(app.session);
  const std::string said = app.said();
  CAPTURE(said);
  CHECK(said.find("test/misdeed: took longer than 0.05 s in process") != std::string::npos);
  CHECK(said.find("attitude/vqf: takes the place of test/misdeed") != std::string::npos);
  CHECK(app.poses > 0);
  CHECK(std::chrono::steady_clock::now() - start < std::chrono::seconds(30));
}

TEST_CASE("a call that does not come back in the app's own thread is named once, while it lasts") {
  std::mutex mutex;
  std::vector<std::string> said;
  HostServices host(0, {}, [&](const Report& report) {
    const std::lock_guard lock(mutex);
    said.push_back(report.text);
  });
  const HangWatch watch(host, {.longest_call_s = 0.05, .period_s = 0.01});
  {
    const Breadcrumb crumb("acme/slow", "process");
    std::this_thread::sleep_for(std::chrono::milliseconds(1500));  // reports of a kind come once a second
  }
  const std::lock_guard lock(mutex);  // other tests have left calls behind, which are told too
  CHECK(std::count_if(said.begin(), said.end(), [](const std::string& text) {
          return text.find("plugin acme/slow in process for ") != std::string::npos;
        }) == 1);
}

TEST_CASE("a late call in the app's own thread is named when it comes back, and nothing else changes") {
  const TemporaryFolder folder;
  const fs::path library = folder / "cost_imu__120_ms.so";
  fs::copy_file(fs::path(ODOGRAPH_BUILD) / "tests/zoo/cost_imu__120_ms.so", library);
  REQUIRE(write_manifest_beside(library).ok());
  App app("odograph: 1\nattitude: {plugin: zoo/animal, time_limit: 0.05 s}\n", ODO_RUN_REPLAY, folder.path().string());
  REQUIRE_MESSAGE(app.status == ODO_OK, app.message);
  app.walk(0, 3);
  odo_session_flush(app.session);
  REQUIRE_FALSE(app.reports.empty());
  CHECK(std::string(app.reports[0].key) == "late");
  CHECK(std::string(app.reports[0].text).find("s in process; expected at most 0.05 s (time_limit)") !=
        std::string::npos);
  CHECK(app.all<odo_attitude>(ODO_TYPE_ATTITUDE).size() == 3);
  CHECK(app.statistics().plugin_faults == 0);
}

TEST_CASE("a plugin that never comes back is left out for good after eight calls") {
  const TemporaryFolder folder;
  const std::string plugins = install(folder, "sleeps__activate");
  App app(
      "odograph: 1\nattitude:\n  - {plugin: test/misdeed, isolation: thread, start_limit: 0.02 s}\n"
      "  - plugin: attitude/vqf\nstep_estimator: {plugin: step/renaudin2012}\n",
      ODO_RUN_REPLAY, plugins);
  REQUIRE_MESSAGE(app.status == ODO_OK, app.message);
  app.walk(0, 6000);  // a minute: waits of 0.1 to 10 s
  odo_session_flush(app.session);
  const std::string said = app.said();
  CHECK_MESSAGE(said.find("test/misdeed: is left out from now on") != std::string::npos, said);
  CHECK(app.poses > 0);
}

TEST_SUITE_END();
