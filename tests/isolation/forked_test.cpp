// SPDX-License-Identifier: Apache-2.0
//
// Use of inherited objects by a forked child of the app's process.
#include <doctest/doctest.h>

#include <csignal>

#include <sys/wait.h>
#include <unistd.h>

#include "sdk/host/base/output_file.hpp"
#include "tests/support/session_app.hpp"
#include "tests/support/support.hpp"

using namespace odograph;
namespace fs = std::filesystem;

TEST_SUITE_BEGIN("forked");

TEST_CASE("flush in a child forked beside a live session returns an error and does not wait for the missing thread") {
  RunningApp app(kWalk, ODO_RUN_LIVE);
  app.walk(0, 100);
  odo_session_flush(app.session);
  const pid_t child = fork();
  if (child == 0) {
    alarm(5);
    _exit(odo_session_flush(app.session) == ODO_E_STATE ? 0 : 1);
  }
  int status = -1;
  waitpid(child, &status, 0);
  CHECK(status == 0);
  CHECK(odo_session_flush(app.session) == ODO_OK);
}

TEST_CASE("files left by a terminated writer lock nobody out, and neither does a child forked meanwhile") {
  const TemporaryFolder folder;
  const fs::path file = write_text(folder / "out.txt", "old");
  write_text(folder / "out.txt.part", "left by a crash");
  pid_t child = -1;
  {
    auto out = required(OutputFile::create(file));
    child = fork();
    if (child == 0) {
      pause();
      _exit(0);
    }
    out->stream() << "new";
    REQUIRE(out->commit().ok());
  }
  CHECK(write_whole_file(file, "newer").ok());
  CHECK(read_text(file) == "newer");
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
}

TEST_SUITE_END();
