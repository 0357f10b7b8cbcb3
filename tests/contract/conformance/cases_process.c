/* SPDX-License-Identifier: Apache-2.0
 *
 * State of the process that a library must not change. */
#define _POSIX_C_SOURCE 200809L
#include "app.h"

#include <fenv.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

static const int fatal[] = {SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT};
static const int others[] = {SIGINT, SIGTERM, SIGPIPE, SIGCHLD, SIGALRM, SIGUSR1, SIGUSR2, SIGHUP};

static bool is_default(int number) {
  struct sigaction action;
  sigaction(number, NULL, &action);
  return !(action.sa_flags & SA_SIGINFO) && action.sa_handler == SIG_DFL;
}

static void set_default(void) {
  for (size_t i = 0; i < COUNT_OF(fatal); ++i) signal(fatal[i], SIG_DFL);
  for (size_t i = 0; i < COUNT_OF(others); ++i) signal(others[i], SIG_DFL);
}

static void run_session(uint32_t flags) {
  odo_session_options chosen = app_options(CAMERA_WALK, ODO_RUN_LIVE);
  hooks.on_message = walk_message;
  chosen.flags = flags;
  app* self = app_open_options(&chosen);
  walk_second(self, 0);
  app_flush(self);
  app_close(self);
}

CASE("no signal handler is set without being asked for", "odograph.h",
     "Without the flag, no signal handler is installed.") {
  set_default();
  run_session(0);
  for (size_t i = 0; i < COUNT_OF(fatal); ++i) CHECK(is_default(fatal[i]), "there is a handler of signal %d", fatal[i]);
  for (size_t i = 0; i < COUNT_OF(others); ++i)
    CHECK(is_default(others[i]), "there is a handler of signal %d", others[i]);
}

static void apps_handler(int number) { (void)number; }

CASE("crash notes set handlers where there are none", "odograph.h",
     "and SIGABRT, unless a handler is already installed.") {
  struct sigaction action;
  set_default();
  signal(SIGFPE, apps_handler);
  run_session(ODO_SESSION_CRASH_NOTES);
  for (size_t i = 0; i < COUNT_OF(fatal); ++i)
    CHECK(!is_default(fatal[i]), "there is no handler of signal %d", fatal[i]);
  for (size_t i = 0; i < COUNT_OF(others); ++i)
    CHECK(is_default(others[i]), "there is a handler of signal %d", others[i]);
  sigaction(SIGFPE, NULL, &action);
  CHECK(!(action.sa_flags & SA_SIGINFO) && action.sa_handler == apps_handler, "the app's own handler was replaced");
}

/* ---- crash notes ---- */
static int32_t crash(odo_instance* instance, const odo_header* message) {
  raise(SIGSEGV);
  return ODO_OK;
}

static int signal_of(pid_t child) {
  int status = 0;
  waitpid(child, &status, 0);
  return WIFSIGNALED(status) ? WTERMSIG(status) : 0;
}

/* SIGSEGV with the library's handler: it writes the note and raises the signal again with its previous action, which
 * ends
 * the process. A grandchild does so. */
CASE("a crash within a plugin is noted, and has its former effect", "odograph.h",
     "they write the plugin and the call to standard error; then the signal takes its previous effect.") {
  char note[512];
  int note_pipe[2], ended_by;
  size_t used = 0;
  ssize_t size;
  need_plugins();
  set_default();
  REQUIRE(pipe(note_pipe) == 0, "no pipe");
  pid_t child = fork();
  if (child == 0) {
    odo_session_options chosen = app_options(FIXER_ALONE, ODO_RUN_REPLAY);
    app* self;
    dup2(note_pipe[1], STDERR_FILENO);
    chosen.flags = ODO_SESSION_CRASH_NOTES;
    hooks.on_message = crash;
    self = app_open_options(&chosen);
    push_barometer(self, T0);
    odo.session_flush(self->session);
    _exit(0);
  }
  close(note_pipe[1]);
  memset(note, 0, sizeof note);
  while (used < sizeof note - 1 && (size = read(note_pipe[0], note + used, sizeof note - 1 - used)) > 0)
    used += (size_t)size;
  CHECK(strstr(note, "conformance/probe") && strstr(note, "process"), "the note is \"%s\"", note);
  ended_by = signal_of(child);
  EQUAL(ended_by, SIGSEGV);
}

/* ---- the rest of the process ---- */
CASE("the rounding mode of the app's thread stays", "plugin.h",
     "Each call must restore the floating-point environment of the host (rounding mode, traps) before it returns.") {
  fesetround(FE_UPWARD);
  run_session(0);
  CHECK(fegetround() == FE_UPWARD, "the rounding mode changed");
  fesetround(FE_TONEAREST);
}

static int open_descriptors(void) {
  int count = 0;
  for (int i = 0; i < 1024; ++i) count += fcntl(i, F_GETFD) != -1;
  return count;
}

CASE("sessions leave no file open", "odograph.h", "Stops the thread of the session, destroys the plugin instances") {
  run_session(0);
  walk_reset();
  int before = open_descriptors();
  for (int i = 0; i < 5; ++i) run_session(0), walk_reset();
  CHECK(open_descriptors() == before, "5 sessions left %d files open", open_descriptors() - before);
}

CASE("a session writes neither to standard output nor to standard error", "odograph.h",
     "they write the plugin and the call to standard error") {
  const char* path = case_file("output.txt");
  const int file = open(path, O_CREAT | O_RDWR, 0600), out = dup(STDOUT_FILENO), err = dup(STDERR_FILENO);
  REQUIRE(file >= 0, "no file could be created");
  fflush(NULL);
  dup2(file, STDOUT_FILENO), dup2(file, STDERR_FILENO);
  run_session(0);
  fflush(NULL);
  dup2(out, STDOUT_FILENO), dup2(err, STDERR_FILENO);
  CHECK(lseek(file, 0, SEEK_END) == 0, "a session wrote to standard output or standard error");
}
