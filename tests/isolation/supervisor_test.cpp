// SPDX-License-Identifier: Apache-2.0
//
// The supervisor between an isolated plugin and its host: complete termination, report of missing system features, and
// the filtering of reports.
#include <cerrno>
#include <chrono>
#include <thread>

#include <fcntl.h>
#include <sys/ptrace.h>
#include <sys/stat.h>

#include "sdk/host/base/printable.hpp"
#include "sdk/host/plugin_host/process_backend.hpp"
#include "tests/isolation/isolated_plugin.hpp"
#include "tests/isolation/sandboxed.hpp"
#include "tests/support/test_plugins.hpp"

TEST_SUITE_BEGIN("supervisor");

namespace {

const std::string kEscape = "attitude: {plugin: test/escape, isolation: process, time_limit: 60 s}\n";

/// Kills a host whose output goes to `output` while its plugin writes; whether all processes below it end soon.
bool ends_with_host(int output) {
  const TestPlugins plugins{"escape"};
  const AttackTarget target("chatter");
  const pid_t host = fork();
  if (host == 0) {
    dup2(output, 1), dup2(output, 2);
    IsolatedPlugin plugin(kEscape, plugins.path());
    plugin.sample();
    _exit(0);
  }
  for (int i = 0; i < 1000 && descendants(host).size() < 2; ++i)  // emulated, a process takes a second to start
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  std::this_thread::sleep_for(std::chrono::milliseconds(700));  // the receiver's buffer is full by then
  const auto below = descendants(host);
  CHECK(below.size() >= 2);
  kill(host, SIGKILL);
  waitpid(host, nullptr, 0);
  const auto some_live = [&] { return std::any_of(below.begin(), below.end(), is_alive); };
  for (int i = 0; i < 300 && some_live(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  const bool ended = !some_live();
  for (const pid_t each : below)
    if (is_alive(each)) kill(each, SIGKILL);
  return ended;
}

std::string line_of(const std::string& text, const std::string& key) {
  const auto at = text.find(key);
  return at == std::string::npos ? "" : text.substr(at, text.find('\n', at) - at);
}

}  // namespace

TEST_CASE("a writing plugin ends with its host if nobody reads the pipe") {
  int ends[2];
  REQUIRE(pipe(ends) == 0);
  fcntl(ends[1], F_SETPIPE_SZ, 4096);
  CHECK(ends_with_host(ends[1]));
  close(ends[0]), close(ends[1]);
}

TEST_CASE("a writing plugin ends with its host if the terminal accepts no output") {
  const int terminal = posix_openpt(O_RDWR | O_NOCTTY);
  if (terminal < 0) return;  // not available here
  REQUIRE(grantpt(terminal) == 0);
  REQUIRE(unlockpt(terminal) == 0);
  const int output = open(ptsname(terminal), O_RDWR | O_NOCTTY);
  REQUIRE(output >= 0);
  CHECK(ends_with_host(output));
  close(output), close(terminal);
}

TEST_CASE("missing system features are reported before any code of the library runs") {
  const TestPlugins plugins{"escape"};
  const AttackTarget target("forge the start");
  const std::string said = in_a_process([&] {
    refuse_calls({444 /* landlock_create_ruleset */}, ENOSYS);
    const IsolatedPlugin plugin(
        "attitude: {plugin: test/escape, isolation: process, time_limit: 0.5 s, start_limit: 2 s}\n", plugins.path());
    return joined(plugin.said);
  });
  CHECK_MESSAGE(contains(said, "no Landlock"), said);
}

TEST_CASE("no process of a plugin is left to the reaper of orphans, however it ends") {
  const TestPlugins plugins{"escape", "crashing_attitude"};
  const std::string left = in_a_process([&] {
    prctl(PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0);  // as the first process of a container
    { IsolatedPlugin().sample(); }
    {
      const AttackTarget target("outlive");
      IsolatedPlugin hangs("attitude: {plugin: test/escape, isolation: process, time_limit: 0.2 s}\n", plugins.path());
      hangs.sample();
    }
    {
      IsolatedPlugin crashes("attitude: {plugin: test/crashing_attitude, isolation: process}\n", plugins.path());
      for (int i = 0; i < 700; ++i) crashes.sample();
      if (crashes.plugin->faults() < 2) return std::string("no crash");
    }
    int status = 0;
    const pid_t orphan = waitpid(-1, &status, WNOHANG);
    return orphan < 0 && errno == ECHILD ? std::string() : "left: " + std::to_string(orphan);
  });
  CHECK_MESSAGE(left.empty(), left);
}

TEST_CASE("when memory runs short a plugin's process is killed before its host, and it has no huge pages") {
  IsolatedPlugin plugin;
  plugin.sample();
  int found = 0;
  for (const pid_t each : descendants(getpid())) {
    const std::string folder = "/proc/" + std::to_string(each);
    if (line_of(read_all(folder + "/status"), "THP_enabled") != "THP_enabled:\t0") continue;
    ++found;
    CHECK(std::stoi(read_all(folder + "/oom_score_adj")) ==
          std::min(1000, std::stoi(read_all("/proc/self/oom_score_adj")) + 200));
  }
  CHECK(found == 1);
}

TEST_CASE("neither the plugin's process nor its supervisor can be traced by others of its user") {
  const std::string traced = in_a_process([&]() -> std::string {
    constexpr uid_t kSomebody = 65534;
    if (getuid() == 0 && (setgid(kSomebody) != 0 || setuid(kSomebody) != 0)) return "";
    prctl(PR_SET_DUMPABLE, 1, 0, 0, 0);
    if (access(plugin_host_program().c_str(), X_OK) != 0) return "";  // the build folder is not accessible to everybody
    IsolatedPlugin plugin;
    plugin.sample();
    std::string which;
    const auto below = descendants(getpid());
    for (const pid_t each : below)
      if (ptrace(PTRACE_SEIZE, each, nullptr, nullptr) == 0) which += std::to_string(each) + " ";
    return which + (below.size() < 2 ? "too few processes" : "");
  });
  CHECK_MESSAGE(traced.empty(), traced);
}

TEST_CASE("a plugin's report is one line of UTF-8 without control characters") {
  const TestPlugins plugins{"escape"};
  for (const char* isolation : {"none", "process"}) {
    const AttackTarget target("lie");
    std::vector<Report> reports;
    HostServices host{0, {"."}, [&](const Report& report) { reports.push_back(report); }};
    const auto config = required(read_pipeline_config(
        std::string("odograph: 1\nattitude: {plugin: test/escape, isolation: ") + isolation + "}\n", "<text>",
        {plugins.path()}));
    auto made = required(PluginInstance::make(config->attitudes.front(), LibraryCheck::none, 1, host));
    auto imu = make_message<odo_imu>(ODO_TYPE_IMU, 1'000'000'000);
    (*made)->process(imu.header);
    const auto text_of = [&](const std::string& key) {
      for (const Report& report : reports)
        if (report.key == key) return report.text;
      return std::string("none");
    };
    CHECK(text_of("line feed") == "all is well 2026-01-01 host: nothing is wrong");
    CHECK(text_of("escape") == "a\\x1B[2J\\x9B\\x7F\\x0D\\x09b");
    CHECK(text_of("bytes") == "\\xFF\\xC0\\xAF\\xED\\xA0\\x80");
    std::string_view cut = reports.back().text;
    CHECK(cut.size() == 4095);
    while (const size_t bytes = utf8_character(cut)) cut.remove_prefix(bytes);
    CHECK(cut.empty());
  }
}
