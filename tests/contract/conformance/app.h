/* SPDX-License-Identifier: Apache-2.0
 *
 * Common app code of the cases: a session with all its events, and samples to push. */
#ifndef CONFORMANCE_APP_H
#define CONFORMANCE_APP_H

#include <pthread.h>

#include "journal.h"

/* Configs. They contain only the suite's plugins. */
#define CONFIG "odograph: 1\n"
#define WITH_ATTITUDE "attitude:\n  plugin: conformance/probe\n"
#define WITH_STEPS "step_estimator:\n  plugin: conformance/probe\n"
#define WITH_FRONTEND "vo_frontend:\n  plugin: conformance/frontend\n"
#define WITH_SEVERAL "vo_frontend:\n  plugin: conformance/several\n"
#define WITH_FIXER "absolute_fixers:\n  - plugin: conformance/probe\n"
#define FIXER_ALONE CONFIG WITH_FIXER
#define CAMERA_WALK CONFIG WITH_ATTITUDE WITH_FRONTEND WITH_FIXER /* with hooks_walk: poses with a metric position */
#define FIXER ODO_INTERFACE_ABSOLUTE_FIXER
#define FRONTEND ODO_INTERFACE_VO_FRONTEND
#define ATTITUDE ODO_INTERFACE_ATTITUDE

#define MS INT64_C(1000000)
#define SECOND INT64_C(1000000000)
#define T0 (100 * SECOND)

typedef struct app {
  odo_session* session;
  pthread_mutex_t lock;
  odo_header** events; /* copies, in order */
  size_t count, capacity;
  pthread_t callback_thread;                                  /* of the newest call */
  void (*on_event)(struct app* app, const odo_header* event); /* within the callback; may be null */
  void* user;
} app;

/* Registers the suite's plugins or finds their folder; skips the case if neither is possible. */
void need_plugins(void);
/* Options with this config and the plugins of the suite. */
odo_session_options app_options(const char* config, uint32_t run);
/* A session whose callback receives all events. Ends the case if it cannot be created. */
app* app_open(const char* config, uint32_t run);
app* app_open_options(const odo_session_options* chosen);
/* Destroys the session; the events stay. */
void app_close(app* self);
size_t app_events(app* self, uint32_t type);
const odo_header* app_event(app* self, uint32_t type, size_t index);
/* Whether there was a report with this key or text. */
bool app_reported(app* self, const char* key_or_text);
odo_statistics app_statistics(app* self);
/* Flushes; a failure ends the case. */
void app_flush(app* self);
/* A push that must be accepted, then a flush. */
#define FLUSHED(self, push) \
  do {                      \
    EXPECT(push, ODO_OK);   \
    app_flush(self);        \
  } while (0)
/* Waits at most 5 s until a live session has emitted `count` events of a type. */
bool app_wait_events(app* self, uint32_t type, size_t count);

/* Initialises *message of `size` bytes: zero, with size, type and time. */
void put_header(void* message, uint32_t size, uint32_t type, int64_t t_ns);
int32_t push(app* self, const void* message);
int32_t push_rest(app* self, int64_t t_ns); /* an inertial sample at rest */
/* Inertial samples at rest, one per 10 ms, `from` to before `to`. All must be accepted. */
void push_rest_between(app* self, int64_t from_ns, int64_t to_ns);
/* The same on a clock that was set back, and flushes. */
void push_set_back(app* self, int64_t from_ns, int64_t to_ns);
void put_barometer(void* out, int64_t t_ns);
int32_t push_barometer(app* self, int64_t t_ns);
void put_calibration(odo_calibration* out, uint32_t camera, int64_t t_ns);
/* A grey frame of 64 x 48 pixels without retain and release. */
void put_frame(odo_frame* out, uint32_t camera, int64_t t_ns);
void put_fix(odo_fix* out, int64_t t_ns, double north_m);

/* A valid message of each input that is copied (not odo_frame). */
typedef struct sample_kind {
  uint32_t type, size, min_size;
  const char* name;
  void (*put)(void* out, int64_t t_ns);
  size_t number_at; /* offset of a double that must be finite */
} sample_kind;
extern const sample_kind sample_kinds[];
extern const size_t sample_kind_count;
typedef union any_sample { /* holds any of them with an extended end */
  odo_header header;
  unsigned char bytes[1024];
} any_sample;

/* Hooks: attitude and front-end answer as in a forward walk at one metre per second. The fixer emits `walk_fix` with
 * the
 * next barometer sample if its struct_size is set. */
int32_t walk_message(odo_instance* instance, const odo_header* message);
extern odo_fix walk_fix;
/* A replay of that many seconds of the walk, flushed. */
app* app_walk(int seconds);
/* One second of the walk: inertial samples every 10 ms, frames every 100 ms. The first call pushes the calibration. */
void walk_second(app* self, int second);
/* Call before another walk in the same case. */
void walk_reset(void);

/* A borrowed message that counts its calls. */
typedef struct lent {
  pthread_mutex_t lock;
  int retains, releases;
  int refuse;  /* retain returns ODO_E_EXHAUSTED */
  int strange; /* calls with an unknown owner */
  const void* native;
} lent;
#define NOT_LENT \
  { .lock = PTHREAD_MUTEX_INITIALIZER }
/* A frame whose pixels are `lent_pixels`, with retain and release. */
extern uint8_t lent_pixels[64 * 48];
void put_lent_frame(odo_frame* out, lent* of, int64_t t_ns);
/* Pushes it; the struct is invalid afterwards. */
int32_t push_lent(app* self, lent* of, int64_t t_ns);
void lend(odo_loan* loan, lent* self);
/* Each retain was followed by one release. */
#define CHECK_BALANCED(self, min_retains)                                                                            \
  do {                                                                                                               \
    CHECK((self)->retains == (self)->releases && (self)->retains >= (min_retains) && (self)->strange == 0,           \
          "retain was called %d times and release %d times (%d with a strange owner); expected as many of each, at " \
          "least %d",                                                                                                \
          (self)->retains, (self)->releases, (self)->strange, (min_retains));                                        \
  } while (0)

#endif
