/* SPDX-License-Identifier: Apache-2.0
 *
 * Plugin library for an algorithm in Python (odograph/plugin.py). It runs the Python file in a separate process, sends
 * it each message and emits its events. `python3 PLUGIN.py --describe` writes plugin_description.h, the plugin's table
 * and its hash; a file whose table has changed since is refused. PLUGIN_FILE is the path of the file, PLUGIN_PYTHON
 * that of the interpreter, PLUGIN_PATH the folder of the package.
 */
#define _GNU_SOURCE
#include <fcntl.h>
#include <pthread.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include <odograph/messages.h>
#include <odograph/plugin.h>
#include <odograph/absolute_fixer.h>
#include <odograph/attitude.h>
#include <odograph/scale_source.h>
#include <odograph/step_estimator.h>
#include <odograph/vo_frontend.h>

#include "plugin_description.h"

enum { CREATE = 1, CONFIGURE, MESSAGE, RESET, DESTROY };

struct odo_instance {
  const odo_host* host;
  const odo_sink* sink;
  uint32_t number, key;
};

/* The process, shared by all instances of this library. */
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static int connection = -1;
static uint32_t keys;

extern char** environ;

/* The environment of this process; PYTHONPATH is set to the package unless it is already set. */
static char** with_package(void) {
  static char package[] = "PYTHONPATH=" PLUGIN_PATH;
  size_t count = 0, own = 0;
  char** made;
  while (environ[count]) own |= strncmp(environ[count++], "PYTHONPATH=", 11) == 0;
  made = (char**)calloc(count + 2, sizeof *made);
  if (!made) return NULL;
  memcpy(made, environ, count * sizeof *made);
  if (!own) made[count] = package;
  return made;
}

static int start(void) {
  char** variables = with_package();
  posix_spawn_file_actions_t actions;
  char* arguments[] = {(char*)PLUGIN_PYTHON, (char*)PLUGIN_FILE, (char*)"3", (char*)PLUGIN_DESCRIPTION, NULL};
  int ends[2], failed;
  pid_t child;
  if (!variables || socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) {
    free(variables);
    return -1;
  }
  if (ends[1] == 3) { /* dup2 of a descriptor onto itself does not clear close-on-exec */
    const int other = fcntl(3, F_DUPFD_CLOEXEC, 4);
    close(3);
    ends[1] = other;
  }
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[1], 3);
  failed = posix_spawn(&child, PLUGIN_PYTHON, &actions, NULL, arguments, variables);
  free(variables);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[1]);
  if (failed) close(ends[0]);
  return failed ? -1 : ends[0];
}

static int transfer(int out, void* data, size_t size) {
  char* at = (char*)data;
  while (size > 0) {
    const ssize_t done = out ? send(connection, at, size, MSG_NOSIGNAL) : recv(connection, at, size, 0);
    if (done <= 0) return 0;
    at += done, size -= (size_t)done;
  }
  return 1;
}

static void report(const odo_instance* self, const char* text, size_t size) {
  const odo_report_service* service = (const odo_report_service*)self->host->get_service(
      self->host, ODO_SERVICE_REPORT, sizeof(ODO_SERVICE_REPORT) - 1);
  const odo_string key = {"python", 6}, what = {text, size};
  if (service && service->report) service->report(self->host, self->number, ODO_SEVERITY_ERROR, &key, &what);
}

/* Reads the answer to a request: emits its events, reports its text and returns its status. */
static int32_t ask(odo_instance* self, uint32_t what, const void* data, uint32_t size, const void* more,
                   uint32_t more_size) {
  static const char gone[] = "the plugin's Python process is gone, or could not be started";
  uint32_t request[3] = {what, self->key, size + more_size};
  struct {
    int32_t status;
    uint32_t size;
  } answer = {ODO_E_ERROR, 0};
  char* events = NULL;
  int good;
  pthread_mutex_lock(&lock);
  if (connection < 0) connection = start();
  good = connection >= 0 && transfer(1, request, sizeof request) && transfer(1, (void*)data, size) &&
         transfer(1, (void*)more, more_size) && transfer(0, &answer, sizeof answer);
  if (good && answer.size > 0) good = (events = (char*)malloc(answer.size)) != NULL && transfer(0, events, answer.size);
  if (!good && connection >= 0) close(connection), connection = -1;
  pthread_mutex_unlock(&lock);
  if (!good) {
    report(self, gone, sizeof gone - 1);
    answer.status = ODO_E_ERROR;
  } else if (answer.status == ODO_E_ERROR) {
    report(self, events, answer.size);
  } else {
    uint32_t at = 0;
    while (what == MESSAGE && at + sizeof(odo_header) <= answer.size) {
      const odo_header* event = (const odo_header*)(const void*)(events + at);
      const int32_t status = self->sink->emit(self->sink, event);
      if (status < 0 && status != ODO_E_UNSUPPORTED) answer.status = status;
      at += event->struct_size;
    }
  }
  free(events);
  return answer.status;
}

static int32_t ODO_CALL create(const odo_host* host, uint32_t number, const odo_string* wanted, odo_instance** out) {
  odo_instance* self;
  int32_t status;
  if (!out || !wanted || wanted->size != plugin_kind.size ||
      memcmp(wanted->data, plugin_kind.data, plugin_kind.size) != 0)
    return ODO_E_UNSUPPORTED;
  self = (odo_instance*)calloc(1, sizeof *self);
  if (!self) return ODO_E_MEMORY;
  self->host = host, self->number = number, self->key = __atomic_add_fetch(&keys, 1, __ATOMIC_SEQ_CST);
  status = ask(self, CREATE, NULL, 0, NULL, 0);
  if (status < 0)
    free(self);
  else
    *out = self;
  return status;
}

static int32_t ODO_CALL configure(odo_instance* self, const odo_value* values, uint32_t count, uint32_t stride) {
  char text[4096];
  size_t size = 0;
  uint32_t i;
  for (i = 0; i < count; ++i) { /* the rows of a newer host may be larger */
    const odo_value* value = (const odo_value*)(const void*)((const char*)values + (size_t)i * stride);
    if (!value->reals || value->name.size > 64 || size + 128 > sizeof text) continue;
    size += (size_t)snprintf(text + size, sizeof text - size, "%.*s=%.17g\n", (int)value->name.size, value->name.data,
                             value->reals[0]);
  }
  return ask(self, CONFIGURE, text, (uint32_t)size, NULL, 0);
}

static int32_t ODO_CALL activate(odo_instance* self, const odo_sink* sink) {
  self->sink = sink;
  return ODO_OK;
}

/* Sends a frame and its first plane, row by row without gaps; no plane if the frame has no pixels in memory. */
static int32_t ask_frame(odo_instance* self, const odo_frame* frame) {
  const odo_plane* plane = &frame->planes[0];
  const uint64_t pixel = plane->pixel_stride, row = pixel * frame->width, size = row * frame->height;
  char* pixels = plane->data && pixel >= 1 && pixel <= 4 && size <= 1u << 28 ? (char*)malloc(size ? size : 1) : NULL;
  int32_t status;
  uint32_t y;
  for (y = 0; pixels && y < frame->height; ++y)
    memcpy(pixels + y * row, plane->data + (int64_t)y * plane->row_stride, pixel * (frame->width - 1) + 1);
  status = ask(self, MESSAGE, frame, frame->header.struct_size, pixels, pixels ? (uint32_t)size : 0);
  free(pixels);
  return status;
}

static int32_t ODO_CALL process(odo_instance* self, const odo_batch* batch) {
  int32_t worst = ODO_OK;
  uint32_t i;
  for (i = 0; i < batch->count; ++i) {
    const odo_header* message = batch->messages[i];
    const int32_t status = message->type == ODO_TYPE_FRAME ? ask_frame(self, (const odo_frame*)(const void*)message)
                                                           : ask(self, MESSAGE, message, message->struct_size, NULL, 0);
    if (status < worst) worst = status;
  }
  return worst;
}

static int32_t ODO_CALL reset(odo_instance* self) { return ask(self, RESET, NULL, 0, NULL, 0); }

static void ODO_CALL destroy(odo_instance* self) {
  ask(self, DESTROY, NULL, 0, NULL, 0);
  free(self);
}

int32_t ODO_CALL ODO_PLUGIN_ENTRY(const odo_host* host, odo_plugin* out) {
  static const odo_string refusal = {"the plugin was built for another ABI than the host's", 52};
  odo_plugin table;
  uint32_t size;
  if (!host || !out || out->struct_size < ODO_PLUGIN_SIZE_MIN) return ODO_E_STRUCT_SIZE;
  if (!ODO_HOST_FITS(host)) {
    out->refusal = refusal;
    return ODO_E_VERSION;
  }
  memset(&table, 0, sizeof table);
  table.struct_size = sizeof table;
  table.abi_major = ODO_ABI_MAJOR, table.abi_minor = ODO_ABI_MINOR;
  table.interfaces = &plugin_kind, table.interface_count = 1;
  table.id = plugin_id, table.version = plugin_version, table.summary = plugin_summary;
  table.parameters = parameters, table.parameter_count = PARAMETER_COUNT,
  table.parameter_stride = sizeof(odo_parameter);
  table.create = create, table.configure = configure, table.activate = activate;
  table.process = process, table.reset = reset, table.destroy = destroy;
  size = out->struct_size < table.struct_size ? out->struct_size : table.struct_size; /* of another version */
  memcpy(out, &table, size);
  out->struct_size = size;
  return ODO_OK;
}
