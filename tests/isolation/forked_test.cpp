// SPDX-License-Identifier: Apache-2.0
//
// Use of inherited objects by a forked child of the app's process.
#include <csignal>

#include <sys/wait.h>
#include <unistd.h>

#include "sdk/host/base/output_file.hpp"
#include "tests/support/session_app.hpp"

TEST_SUITE_BEGIN("forked");

TEST_CASE("flush in a child forked beside a live session returns an error and does not wait for the missing thread") {
  RunningApp app(kWalk, ODO_RUN_LIVE);
  app.run(0, 100);
  const pid_t child = fork();
  if (child == 0) {
    alarm(5);
    _exit(app.flush() == ODO_E_STATE ? 0 : 1);
  }
  int status = -1;
  waitpid(child, &status, 0);
  CHECK(status == 0);
  CHECK(app.flush() == ODO_OK);
}

TEST_CASE("a forked child that destroys its copy of a live session leaves the parent's isolated plugin running") {
  RunningApp app("odograph: 1\nattitude: {plugin: attitude/vqf, isolation: process}\n", ODO_RUN_LIVE);
  app.run(0, 100);
  const pid_t child = fork();
  if (child == 0) {
    alarm(60);
    odo_session_destroy(app.session);
    _exit(0);
  }
  int status = -1;
  waitpid(child, &status, 0);
  CHECK(status == 0);
  app.run(100, 200);
  CHECK(app.statistics().plugin_faults == 0);
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
