/* SPDX-License-Identifier: Apache-2.0
 *
 * Thread-safe functions, called from several threads at once. */
#include "app.h"

typedef struct pusher {
  app* to;
  int sensor; /* 0 to 3 */
  int taken, exhausted, discarded, others;
} pusher;

static volatile int stop, asked;

static void put_sample(int sensor, int i, void* out) {
  const int64_t t_ns = T0 + i * 10 * MS + sensor * MS;
  if (sensor == 0) sample_kinds[0].put(out, t_ns);
  if (sensor == 1) put_barometer((odo_barometer*)out, t_ns);
  if (sensor == 2) sample_kinds[1].put(out, t_ns);
  if (sensor == 3) put_header(out, 64, PROBE_MESSAGE, t_ns);
}

static void* push_sensor(void* user) {
  pusher* self = (pusher*)user;
  any_sample sample;
  for (int i = 0; i < 300 && !stop; ++i) {
    int32_t status;
    put_sample(self->sensor, i, &sample);
    status = push(self->to, &sample);
    self->taken += status == ODO_OK;
    self->exhausted += status == ODO_E_EXHAUSTED;
    self->discarded += status == ODO_E_DISCARD; /* a thread ahead of the others makes them late */
    self->others += status != ODO_OK && status != ODO_E_EXHAUSTED && status != ODO_E_DISCARD;
  }
  return NULL;
}

static void start(pthread_t* thread, void* (*run)(void*), void* user) {
  REQUIRE(pthread_create(thread, NULL, run, user) == 0, "no thread could be started");
}

static void push_from_four(int run) {
  app* self = app_open(FIXER_ALONE "time_ordering:\n  max_wait: 5 s\n", (uint32_t)run);
  pusher pushers[4];
  pthread_t threads[4];
  uint64_t taken = 0, refused = 0;
  memset(pushers, 0, sizeof pushers);
  for (int i = 0; i < 4; ++i) pushers[i].to = self, pushers[i].sensor = i, start(&threads[i], push_sensor, &pushers[i]);
  for (int i = 0; i < 4; ++i) pthread_join(threads[i], NULL);
  app_flush(self);
  odo_statistics counts = app_statistics(self);
  for (int i = 0; i < 4; ++i) {
    taken += (uint64_t)pushers[i].taken;
    refused += (uint64_t)(pushers[i].exhausted + pushers[i].discarded);
    EQUAL(pushers[i].others, 0);
  }
  CHECK(counts.pushed == 1200 && counts.processed == taken &&
            counts.late + counts.overflow + counts.duplicate + counts.invalid == refused,
        "of 1200 samples %llu were taken and %llu refused; pushed is %llu, processed %llu, late %llu, overflow %llu",
        (unsigned long long)taken, (unsigned long long)refused, (unsigned long long)counts.pushed,
        (unsigned long long)counts.processed, (unsigned long long)counts.late, (unsigned long long)counts.overflow);
  EQUAL(refused, 0);
  EQUAL(journal_overlaps(), 0);
}
IN_BOTH_RUNS(push_from_four, "four threads push into ", " at once and nothing is lost", "odograph.h",
             "any thread, several at once");

static int torn;
static void* ask_for_poses(void* user) {
  app* self = (app*)user;
  while (!stop) {
    odo_statistics counts;
    int32_t status;
    double norm = 0;
    odo_pose pose = {.header.struct_size = sizeof pose};
    status = odo.session_get_pose(self->session, ODO_TIME_LATEST, &pose);
    for (int i = 0; i < 4; ++i) norm += pose.q_n[i] * pose.q_n[i];
    torn += status == ODO_OK && (norm < 0.999 || norm > 1.001);
    memset(&counts, 0, sizeof counts);
    counts.struct_size = sizeof counts;
    odo.session_get_statistics(self->session, &counts);
    torn += counts.processed > counts.pushed;
    ++asked;
  }
  return NULL;
}

static void poses_meanwhile(int run) {
  pthread_t thread;
  hooks.on_message = walk_message;
  app* self = app_open(CAMERA_WALK, (uint32_t)run);
  start(&thread, ask_for_poses, self);
  while (asked == 0) sleep_ms(1);
  for (int second = 0; second < 5; ++second) {
    walk_second(self, second);
    app_flush(self);
  }
  stop = 1;
  pthread_join(thread, NULL);
  CHECK(asked > 0 && torn == 0, "%d of %d answers were torn", torn, asked);
}
IN_BOTH_RUNS(poses_meanwhile, "poses and statistics asked for beside ", " are whole", "odograph.h",
             "Takes microseconds and never waits for the pipeline.");

static int32_t linger(odo_instance* instance, const odo_header* message) {
  sleep_ms(5);
  return ODO_OK;
}

/* Frames wait, and one is being processed. */
CASE("a live session is destroyed with frames in flight", "odograph.h",
     "Stops the thread of the session, destroys the plugin instances and releases retained frames.") {
  lent memory = NOT_LENT;
  hooks.on_message = linger;
  app* self = app_open(FIXER_ALONE, ODO_RUN_LIVE);
  for (int i = 0; i < 8; ++i) push_lent(self, &memory, T0 + i * 10 * MS);
  sleep_ms(8);
  app_close(self);
  CHECK_BALANCED(&memory, 1);
  CHECK(journal_count(PROBE_DESTROY, FIXER) == 1 && journal_overlaps() == 0,
        "the instance was not destroyed in its turn");
}

CASE("sessions on several threads are independent", "plugin.h", "Instances are independent of each other") {
  enum { SESSIONS = 3 };
  app* sessions[SESSIONS];
  pusher pushers[SESSIONS];
  pthread_t threads[SESSIONS];
  memset(pushers, 0, sizeof pushers);
  for (int i = 0; i < SESSIONS; ++i) sessions[i] = app_open(FIXER_ALONE, i % 2 ? ODO_RUN_LIVE : ODO_RUN_REPLAY);
  for (int i = 0; i < SESSIONS; ++i) {
    pushers[i].to = sessions[i];
    pushers[i].sensor = 1;
    start(&threads[i], push_sensor, &pushers[i]);
  }
  for (int i = 0; i < SESSIONS; ++i) pthread_join(threads[i], NULL);
  for (int i = 0; i < SESSIONS; ++i) {
    app_flush(sessions[i]);
    CHECK(app_statistics(sessions[i]).processed == 300, "session %d processed %llu samples; expected 300", i,
          (unsigned long long)app_statistics(sessions[i]).processed);
    app_close(sessions[i]);
  }
  EQUAL(given_count(ODO_TYPE_BAROMETER, FIXER), 300 * SESSIONS);
}

/* One thread processes, including what the other pushes meanwhile. */
static int32_t take_long(odo_instance* instance, const odo_header* message) {
  sleep_ms(20);
  return ODO_OK;
}

static void* push_one(void* user) {
  app* self = (app*)user;
  push_rest(self, T0);
  push_rest(self, T0 + 300 * MS);
  push_rest(self, T0 + 600 * MS);
  push_rest(self, T0 + 900 * MS);
  return NULL;
}

CASE("pushes into a replay that is processing do not call plugins at once", "odograph.h",
     "Samples that other threads push meanwhile are processed on the same thread") {
  pthread_t thread;
  hooks.on_message = take_long;
  app* self = app_open(FIXER_ALONE, ODO_RUN_REPLAY);
  start(&thread, push_one, self);
  for (int i = 0; i < 100 && given_count(ODO_TYPE_IMU, FIXER) == 0; ++i) sleep_ms(1);
  push_barometer(self, T0 + 100 * MS);
  pthread_join(thread, NULL);
  app_flush(self);
  CHECK(journal_overlaps() == 0, "calls of one instance overlapped");
}

CASE("poses and statistics do not wait for plugins", "odograph.h",
     "Returns the statistics. Never waits for the pipeline.") {
  double start_s, longest_s = 0;
  pthread_t thread;
  pusher slow = {NULL, 1, 0, 0, 0, 0};
  hooks.on_message = linger;
  app* self = app_open(FIXER_ALONE, ODO_RUN_REPLAY);
  slow.to = self;
  start(&thread, push_sensor, &slow);
  for (int i = 0; i < 200; ++i) {
    odo_pose pose = {.header.struct_size = sizeof pose};
    start_s = now_s();
    odo.session_get_pose(self->session, ODO_TIME_LATEST, &pose);
    app_statistics(self);
    if (now_s() - start_s < 0.004) ++asked; /* tolerates occasional delays on a busy machine */
    if (now_s() - start_s > longest_s) longest_s = now_s() - start_s;
    sleep_ms(1);
  }
  stop = 1;
  pthread_join(thread, NULL);
  CHECK(asked > 150, "%d of 200 calls took less than 4 ms while plugins took 5 ms; the longest %.1f ms", asked,
        1e3 * longest_s);
}
