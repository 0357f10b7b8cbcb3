// SPDX-License-Identifier: Apache-2.0
//
// An isolated plugin whose restart takes long: a live session goes on without it and ends without waiting for it.
#include <cerrno>
#include <chrono>
#include <thread>

#include <sys/wait.h>

#include <odograph/attitude.h>
#include <odograph/scale_source.h>

#include "tests/support/obeys.hpp"
#include "tests/support/session_app.hpp"
#include "tests/support/test_plugins.hpp"

TEST_SUITE_BEGIN("slow_restart");

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// The plugin in a folder where the test may put the file that makes it slow.
struct SlowPlugin {
  TemporaryFolder folder;
  SlowPlugin() { copy_plugin(hostile("slow_restart"), folder / (std::string("slow_restart") + ODOGRAPH_LIBRARY)); }
  void slow(const std::string& phase_and_seconds) const { write_text(folder / "slow", phase_and_seconds); }
  void fast() const { std::filesystem::remove(folder / "slow"); }
  std::string path() const { return folder.path().string(); }
};

std::string attitude(const std::string& limits) {
  return "odograph: 1\nattitude: {plugin: test/slow_restart, isolation: process, " + limits +
         "}\nstep_estimator: {plugin: step/renaudin2012}\n";
}

size_t attitudes(const App& app) { return app.all<odo_attitude>(ODO_TYPE_ATTITUDE).size(); }

/// Walks in a live session until the condition holds, at most a minute; returns the next sample.
template <class Condition>
int walk_until(const App& app, int from, Condition&& holds) {
  const auto start = Clock::now();
  for (; !holds() && seconds_since(start) < 60; from += 10) {
    app.run(from, from + 10);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  CHECK(holds());
  return from;
}

bool no_child_left() { return waitpid(-1, nullptr, WNOHANG) == -1 && errno == ECHILD; }

}  // namespace

TEST_CASE("a live session goes on as degraded while an isolated plugin restarts slowly, and then tracks again") {
  for (const char* phase : {"entry", "activate"}) {
    CAPTURE(phase);
    const SlowPlugin plugin;
    RunningApp app(attitude("start_limit: 20 s"), ODO_RUN_LIVE, plugin.path());
    app.run(0, 600);
    REQUIRE(app.pose(ODO_TIME_LATEST).state == ODO_TRACKING);
    plugin.slow(std::string(phase) + " 600");
    app.run(600, 610);
    const size_t before = attitudes(app);
    CHECK(app.run(610, 1500) == ODO_OK);
    // Within its start limit: a second fault would be that it took longer.
    CHECK(app.statistics().plugin_faults == 1);
    CHECK(app.statistics().processed == app.statistics().pushed);
    CHECK(attitudes(app) == before);
    const odo_pose during = app.pose(ODO_TIME_LATEST);
    CHECK(during.state == ODO_DEGRADED);
    CHECK(during.reason == ODO_REASON_PLUGIN_FAILED);
    plugin.fast();
    const int next = walk_until(app, 1500, [&] { return attitudes(app) > before; });
    app.run(next, next + 600);
    CHECK(app.pose(ODO_TIME_LATEST).state == ODO_TRACKING);
    CHECK(app.statistics().plugin_faults == 1);
    CHECK(attitudes(app) > before + 500);
  }
}

TEST_CASE("a restart beyond start_limit is ended and tried again, and the fallback starts beside the session too") {
  const SlowPlugin plugin;
  RunningApp app(
      "odograph: 1\nattitude: {plugin: test/slow_restart, isolation: process, start_limit: 1 s, fallback: "
      "attitude/vqf}\nstep_estimator: {plugin: step/renaudin2012}\n",
      ODO_RUN_LIVE, plugin.path());
  app.run(0, 100);
  plugin.slow("create 600");
  app.run(100, 110);
  const size_t before = attitudes(app);
  walk_until(app, 110, [&] { return attitudes(app) > before; });
  CHECK(app.statistics().plugin_faults == 3);
  CHECK(contains(app.said(), "test/slow_restart: took longer than 1 s in create; restarting"));
  CHECK(contains(app.said(), "attitude/vqf: replaces test/slow_restart"));
}

TEST_CASE("loading and starting an isolated plugin together take start_limit at most") {
  const SlowPlugin plugin;
  plugin.slow("entry+create 1.4");
  RunningApp app(attitude("start_limit: 2 s"), ODO_RUN_REPLAY, plugin.path());
  plugin.fast();
  app.run(0, 10);
  CHECK(contains(app.said(), "took longer than 2 s in "));
  CHECK(attitudes(app) > 0);
}

TEST_CASE("a live session ends at once, and with it the plugin's process, in whatever phase that hangs") {
  for (const char* phase : {"entry", "create", "configure", "activate", "process", "destroy"}) {
    CAPTURE(phase);
    const SlowPlugin plugin;
    RunningApp app(attitude("start_limit: 60 s, time_limit: 60 s"), ODO_RUN_LIVE, plugin.path());
    app.run(0, 100);
    plugin.slow(std::string(phase) + " 600");
    app.walk(100, 120);  // no flush: it would wait for a call of process
    std::this_thread::sleep_for(std::chrono::milliseconds(500));
    const auto start = Clock::now();
    odo_session_destroy(app.session);
    app.session = nullptr;
    CHECK(seconds_since(start) < 10);  // a second on a machine that is not busy
    CHECK(no_child_left());
  }
}

TEST_CASE("a replay waits for a slow restart, so that its results do not depend on it") {
  const auto events = [](const std::string& phase_and_seconds) {
    const SlowPlugin plugin;
    RunningApp app(attitude("start_limit: 20 s"), ODO_RUN_REPLAY, plugin.path());
    app.run(0, 300);
    plugin.slow(phase_and_seconds);
    app.run(300, 600);
    CHECK(app.statistics().plugin_faults == 1);
    return app.events;
  };
  const auto fast = events("create 0"), slow = events("create 1");
  REQUIRE(fast.size() > 500);
  CHECK(fast == slow);
}

TEST_CASE("destroy waits for the running call of a plugin in the app's process, no further one, and reports it") {
  const TestPlugins plugins{"obeys"};
  RunningApp app(
      "odograph: 1\nvo_frontend: {plugin: vo/five_point}\nscale_source: {plugin: test/obeys, time_limit: 0.2 s}\n",
      ODO_RUN_LIVE, plugins.path());
  for (int i = 1; i <= 20; ++i) {
    Order slow = order(1'000'000'000 + i);
    slow.sleep_ms = 1000, slow.emits = 1;
    CHECK(app.push(slow) == ODO_OK);
  }
  char call[64] = {};
  const auto start = Clock::now();
  while (odo_current_plugin_call(call, sizeof call - 1) == 0 && seconds_since(start) < 60) std::this_thread::yield();
  CHECK(contains(call, "test/obeys in process"));
  odo_session_destroy(app.session);
  app.session = nullptr;
  CHECK(app.all<odo_scale>(ODO_TYPE_SCALE).size() <= 2);
  CHECK(contains(app.said(), "test/obeys: took "));
}

TEST_CASE("no pose is tracking while the pipeline is behind the samples by more than max_gap") {
  const TestPlugins plugins{"obeys"};
  RunningApp app(kWalk +
                     "vo_frontend: {plugin: vo/five_point}\nscale_source: {plugin: test/obeys, time_limit: 60 s}\n"
                     "coupling: {type: localizer}\n",
                 ODO_RUN_LIVE, plugins.path());
  app.run(0, 600);
  REQUIRE(app.pose(ODO_TIME_LATEST).state == ODO_TRACKING);
  Order hang = order(7'000'000'000);
  hang.sleep_ms = 1500;
  CHECK(app.push(hang) == ODO_OK);
  app.walk(600, 680);
  CHECK(app.pose(ODO_TIME_LATEST).state == ODO_TRACKING);  // 0.8 s behind
  app.walk(680, 720);
  const odo_pose behind = app.pose(ODO_TIME_LATEST);
  CHECK(behind.state == ODO_DEGRADED);
  CHECK(behind.reason == ODO_REASON_PLUGIN_FAILED);
  CHECK(app.statistics().processed < app.statistics().pushed);
  app.flush();
  CHECK(app.pose(ODO_TIME_LATEST).state == ODO_TRACKING);
}
