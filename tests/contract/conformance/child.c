/* SPDX-License-Identifier: Apache-2.0
 *
 * Runs a case in a separate process (POSIX) and reads its results from a pipe: a line starts with F for a failure, S
 * for a
 * skip, E at the case's end. */
#define _POSIX_C_SOURCE 200809L
#define _DARWIN_C_SOURCE
#include "suite.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdarg.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

static int report_to = -1;
static char folder[256];

double now_s(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

void sleep_ms(unsigned milliseconds) {
  struct timespec left;
  left.tv_sec = milliseconds / 1000;
  left.tv_nsec = (long)(milliseconds % 1000) * 1000000L;
  while (nanosleep(&left, &left) != 0 && errno == EINTR) {
  }
}

const char* case_file(const char* name) {
  static char paths[4][512];
  static int next;
  next = (next + 1) % 4;
  snprintf(paths[next], sizeof paths[next], "%s/%s", folder, name);
  return paths[next];
}

/* ---- in the child ---- */
static void send_line(char kind, const char* file, int line, const char* format, va_list arguments) {
  char text[1024]; /* one write of less than PIPE_BUF: lines of several threads are not mixed */
  const char* slash = file ? strrchr(file, '/') : NULL;
  size_t used = 0;
  text[used++] = kind;
  if (file) used += (size_t)snprintf(text + used, sizeof text - used, "%s:%d: ", slash ? slash + 1 : file, line);
  vsnprintf(text + used, sizeof text - used - 1, format, arguments);
  for (used = 1; text[used]; ++used)
    if (text[used] == '\n') text[used] = ' ';
  text[used++] = '\n';
  if (write(report_to, text, used) < 0) _exit(3);
}

__attribute__((noreturn)) static void send_end(void) {
  if (write(report_to, "E\n", 2) < 0) _exit(3);
  _exit(0);
}

void fail_at(const char* file, int line, const char* format, ...) {
  va_list arguments;
  va_start(arguments, format);
  send_line('F', file, line, format, arguments);
  va_end(arguments);
}

void stop_at(const char* file, int line, const char* format, ...) {
  va_list arguments;
  va_start(arguments, format);
  send_line('F', file, line, format, arguments);
  va_end(arguments);
  send_end();
}

void skip_case(const char* format, ...) {
  va_list arguments;
  va_start(arguments, format);
  send_line('S', NULL, 0, format, arguments);
  va_end(arguments);
  send_end();
}

void expect_equal(const char* file, int line, const char* what, int64_t value, int64_t expected) {
  if (value != expected) fail_at(file, line, "%s is %lld; expected %lld", what, (long long)value, (long long)expected);
}

void expect_status(const char* file, int line, const char* what, int64_t status, int64_t expected) {
  if (status != expected) fail_at(file, line, "%s = %s; expected %s", what, status_name(status), status_name(expected));
}

static void in_child(const conformance_case* chosen, int pipe_end, bool quiet) {
  report_to = pipe_end;
  if (quiet) {
    const int nowhere = open("/dev/null", O_WRONLY);
    if (nowhere >= 0) dup2(nowhere, STDOUT_FILENO), dup2(nowhere, STDERR_FILENO);
  }
  chosen->run(chosen->argument);
  send_end();
}

/* ---- in the parent ---- */
static void add_line(result* out, const char* text, size_t size) {
  const size_t used = strlen(out->text);
  if (++out->lines > MAX_LINES || used + size + 2 > sizeof out->text) return;
  memcpy(out->text + used, text, size);
  out->text[used + size] = '\n';
  out->text[used + size + 1] = 0;
}

static void add_failure(result* out, const char* format, ...) {
  char text[256];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  out->outcome = FAILED;
  add_line(out, text, strlen(text));
}

/* Extracts the complete lines from `buffer`; returns the number of remaining bytes. */
static size_t take_lines(char* buffer, size_t size, result* out, bool* ended) {
  char *line = buffer, *end;
  while ((end = (char*)memchr(line, '\n', size - (size_t)(line - buffer))) != NULL) {
    if (line[0] == 'F') out->outcome = FAILED;
    if (line[0] == 'S' && out->outcome == PASSED) out->outcome = SKIPPED;
    if (line[0] == 'E') *ended = true;
    if (line[0] == 'F' || line[0] == 'S') add_line(out, line + 1, (size_t)(end - line - 1));
    line = end + 1;
  }
  size -= (size_t)(line - buffer);
  memmove(buffer, line, size);
  return size;
}

/* Whether the child closed its pipe before the limit. */
static bool listen_to(int pipe_end, double until_s, result* out, bool* ended) {
  char buffer[8192];
  size_t used = 0;
  for (;;) {
    struct pollfd waiting = {pipe_end, POLLIN, 0};
    const double left_s = until_s - now_s();
    ssize_t got;
    if (left_s <= 0) return false;
    if (poll(&waiting, 1, (int)(left_s * 1000) + 1) <= 0) continue;
    got = read(pipe_end, buffer + used, sizeof buffer - used);
    if (got <= 0) return true;
    used = take_lines(buffer, used + (size_t)got, out, ended);
    if (*ended) return true;
  }
}

static void make_folder(void) {
  const char* top = getenv("TMPDIR");
  snprintf(folder, sizeof folder, "%s/odograph-conformance-XXXXXX", top && strlen(top) < 200 ? top : "/tmp");
  if (!mkdtemp(folder)) folder[0] = 0;
}

static void remove_folder(void) {
  DIR* opened = folder[0] ? opendir(folder) : NULL;
  const struct dirent* entry;
  if (!opened) return;
  while ((entry = readdir(opened)) != NULL) unlink(case_file(entry->d_name));
  closedir(opened);
  rmdir(folder);
}

void run_case(const conformance_case* chosen, double limit_s, bool quiet, result* out) {
  const double start_s = now_s();
  bool ended = false, in_time;
  int ends[2], status = 0;
  pid_t child;
  memset(out, 0, sizeof *out);
  make_folder();
  fflush(NULL);
  if (pipe(ends) != 0 || (child = fork()) < 0) {
    add_failure(out, "no process could be started");
    return;
  }
  if (child == 0) {
    close(ends[0]);
    in_child(chosen, ends[1], quiet);
  }
  close(ends[1]);
  in_time = listen_to(ends[0], start_s + limit_s, out, &ended);
  close(ends[0]);
  if (!in_time) kill(child, SIGKILL);
  waitpid(child, &status, 0);
  if (!in_time)
    add_failure(out, "it did not end within %.0f s", limit_s);
  else if (WIFSIGNALED(status))
    add_failure(out, "it ended by signal %d (%s)", WTERMSIG(status), strsignal(WTERMSIG(status)));
  else if (!ended)
    add_failure(out, "the process ended before the case did (status %d)", WEXITSTATUS(status));
  out->seconds = now_s() - start_s;
  remove_folder();
}
