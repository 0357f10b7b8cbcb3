/* SPDX-License-Identifier: Apache-2.0
 *
 * Creating a session, and querying its poses and counts. */
#include "app.h"

static int32_t try_config(const char* config, odo_error* error) {
  odo_session_options chosen = app_options(config, ODO_RUN_REPLAY);
  odo_session* session = NULL;
  memset(error, 0, sizeof *error);
  error->struct_size = sizeof *error;
  int32_t status = odo.session_create(&chosen, &session, error);
  CHECK((session == NULL) == (status != ODO_OK), "status %s, session %p", status_name(status), (void*)session);
  return status;
}

CASE("a bad config is refused with its place, and no session is made", "odograph.h",
     "file:line:column of an error in the config, path and reason of a plugin that does not load.") {
  odo_error error;
  need_plugins();
  EXPECT(try_config("odograph: 1\nattitud:\n  plugin: conformance/probe\n", &error), ODO_E_CONFIG);
  CHECK(strstr(error.message, ":2:1") && strstr(error.message, "attitud"), "the reason names neither place nor key: %s",
        error.message);
  CHECK(try_config("odograph: 1\nattitude:\n  plugin: nobody/nothing\n", &error) < 0,
        "a plugin that is nowhere was found");
  CHECK(strstr(error.message, "nobody/nothing"), "the reason does not name the plugin: %s", error.message);
  CHECK(try_config("{", &error) < 0 && error.message[0], "half a document was taken");
  CHECK(try_config("", &error) == ODO_E_ARGUMENT, "neither path nor text is no argument error");
}

CASE("a config is a path or a text, not both", "odograph.h", "set exactly one of config_path and config_text") {
  odo_session_options chosen = app_options(FIXER_ALONE, ODO_RUN_REPLAY);
  odo_session* session;
  odo_error error = {sizeof error, 0, ""};
  chosen.config_path = string_of("/nowhere/pipeline.yaml");
  EXPECT(odo.session_create(&chosen, &session, &error), ODO_E_ARGUMENT);
  memset(&chosen.config_text, 0, sizeof chosen.config_text);
  EXPECT(odo.session_create(&chosen, &session, &error), ODO_E_NOT_FOUND);
  CHECK(strstr(error.message, "/nowhere/pipeline.yaml"), "the reason does not name the file: %s", error.message);
  CHECK(session == NULL, "*session is not null after a failure");
}

CASE("a config's text ends by its size", "base.h", "A UTF-8 string, neither terminated nor owned.") {
  static const char text[] = FIXER_ALONE "this: is behind the end";
  odo_session_options chosen = app_options(text, ODO_RUN_REPLAY);
  chosen.config_text.size = strlen(FIXER_ALONE);
  app_close(app_open_options(&chosen));
}

/* ---- poses ---- */
static int32_t pose_at(app* self, int64_t t_ns, odo_pose* pose) {
  memset(pose, 0, sizeof *pose);
  pose->header.struct_size = sizeof *pose;
  return odo.session_get_pose(self->session, t_ns, pose);
}

CASE("poses are interpolated, carried on and flagged", "odograph.h", "Between two poses it is interpolated") {
  odo_pose pose;
  hooks.on_message = walk_message;
  app* self = app_open(CAMERA_WALK, ODO_RUN_REPLAY);
  EXPECT(pose_at(self, ODO_TIME_LATEST, &pose), ODO_NOT_READY);
  walk_second(self, 0);
  walk_second(self, 1);
  app_flush(self);
  EXPECT(pose_at(self, ODO_TIME_LATEST, &pose), ODO_OK);
  CHECK(pose.header.type == ODO_TYPE_POSE && pose.header.flags & ODO_POSE_CAMERA &&
            pose.header.flags & ODO_POSE_METRIC && pose.header.flags & ODO_POSE_ORIENTATION &&
            pose.header.flags & ODO_POSE_POSITION,
        "the newest pose has flags 0x%x", pose.header.flags);
  EXPECT(pose_at(self, T0 + 1550 * MS, &pose), ODO_OK);
  CHECK(pose.header.t_ns == T0 + 1550 * MS, "a pose between two is of another time");
  CHECK(fabs(pose.p_n[0] - 1.55) < 0.05, "1.55 s into a walk of 1 m/s it is %g m to the north", pose.p_n[0]);
  CHECK((pose.header.flags & ODO_POSE_EXTRAPOLATED) == 0, "a pose between two is flagged as extrapolated");
  EXPECT(pose_at(self, T0 + 2050 * MS, &pose), ODO_OK);
  CHECK(pose.header.flags & ODO_POSE_EXTRAPOLATED, "a pose ahead is not flagged as extrapolated");
  EXPECT(pose_at(self, T0 + 60 * SECOND, &pose), ODO_E_NOT_FOUND);
  EXPECT(pose_at(self, T0 - 60 * SECOND, &pose), ODO_E_NOT_FOUND);
  odo_pose body = {.header.struct_size = sizeof body};
  EXPECT(odo.session_get_pose_of(self->session, ODO_OF_BODY, 0, ODO_TIME_LATEST, &body), ODO_OK);
  CHECK((body.header.flags & ODO_POSE_CAMERA) == 0, "the body's pose is flagged as the camera's");
  body.header.struct_size = sizeof body;
  EXPECT(odo.session_get_pose_of(self->session, 3, 0, ODO_TIME_LATEST, &body), ODO_E_ARGUMENT);
}

/* ---- counts ---- */
static void sums_hold(int run) {
  app* self = app_open(FIXER_ALONE, (uint32_t)run);
  odo_barometer sample;
  const double nan3[3] = {(double)NAN, 0, 0}, zero[3] = {0, 0, 0}, wild[3] = {1e6, 0, 0};
  push_rest_between(self, T0, T0 + SECOND);
  app_flush(self);
  for (int i = 0; i < 3; ++i) odo.session_push_imu(self->session, T0 + 2 * SECOND, nan3, zero);
  for (int i = 0; i < 4; ++i) odo.session_push_imu(self->session, T0 + 2 * SECOND, wild, zero);
  for (int i = 0; i < 5; ++i) {
    put_barometer(&sample, T0 + i * MS); /* late */
    push(self, &sample);
  }
  put_barometer(&sample, T0 + 1100 * MS);
  for (int i = 0; i < 7; ++i) push(self, &sample); /* one, and six times the same */
  put_header(&sample, sizeof sample, PROBE_UNDECLARED, T0 + 1100 * MS);
  push(self, &sample);
  put_header(&sample, sizeof sample, ODO_TYPE_POSE, T0 + 1100 * MS);
  push(self, &sample);
  app_flush(self);
  odo_statistics counts = app_statistics(self);
  uint64_t dropped = counts.late + counts.duplicate + counts.invalid + counts.overflow + counts.wild;
  CHECK(counts.late == 5 && counts.duplicate == 6 && counts.wild == 4 && counts.invalid >= 3 && counts.unknown == 1,
        "late is %llu, duplicate %llu, wild %llu, invalid %llu, unknown %llu; expected 5, 6, 4, 3 or 4, 1",
        (unsigned long long)counts.late, (unsigned long long)counts.duplicate, (unsigned long long)counts.wild,
        (unsigned long long)counts.invalid, (unsigned long long)counts.unknown);
  EQUAL(counts.processed, 102);
  CHECK(counts.pushed == counts.processed + dropped, "pushed is %llu; processed and dropped together %llu",
        (unsigned long long)counts.pushed, (unsigned long long)(counts.processed + dropped));
}
IN_BOTH_RUNS(sums_hold, "what ", " was given was processed or dropped for one reason", "odograph.h",
             "messages passed to the pipeline");

CASE("frames, distance and time of a walk are counted", "odograph.h", "Statistics of a session since its creation.") {
  app* self = app_walk(2);
  odo_statistics counts = app_statistics(self);
  EQUAL(counts.frames, 20);
  CHECK(fabs(counts.distance_m - 1.9) < 0.1, "distance_m is %g; expected 1.9", counts.distance_m);
  CHECK(counts.tracking_s + counts.degraded_s + counts.lost_s > 1.5, "the time in all states is %g s",
        counts.tracking_s + counts.degraded_s + counts.lost_s);
  CHECK(app_events(self, ODO_TYPE_STATE) >= 1, "no state was published");
}

CASE("the last error is given once, with the field", "odograph.h",
     "Writes the latest error or warning of a push or a plugin since the last call; error->status is ODO_OK if there "
     "is "
     "none.") {
  app* self = app_open(FIXER_ALONE, ODO_RUN_REPLAY);
  odo_error error = {sizeof error, 0, ""};
  odo_barometer sample;
  error.status = ODO_E_DATA;
  EXPECT(odo.session_last_error(self->session, &error), ODO_OK);
  EXPECT(error.status, ODO_OK);
  put_barometer(&sample, T0);
  sample.pressure_pa = (double)NAN;
  EXPECT(push(self, &sample), ODO_E_DISCARD);
  error.struct_size = sizeof error;
  EXPECT(odo.session_last_error(self->session, &error), ODO_OK);
  EXPECT(error.status, ODO_E_DISCARD);
  CHECK(strstr(error.message, "pressure_pa"), "it does not name the field: %s", error.message);
  error.struct_size = sizeof error;
  EXPECT(odo.session_last_error(self->session, &error), ODO_OK);
  CHECK(error.status == ODO_OK && !error.message[0], "the second time it is %s, \"%s\"", status_name(error.status),
        error.message);
}

CASE("places go to the Earth and back, where the origin is known", "odograph.h",
     "ODO_NOT_READY while the origin of n is unknown") {
  app* self =
      app_open(FIXER_ALONE "navigation:\n  origin: {latitude: 0.83, longitude: 0.15, height: 400 m}\n", ODO_RUN_REPLAY);
  const double p[3] = {1000, -2000, 30};
  double geodetic[3], back[3];
  EXPECT(odo.session_to_geodetic(self->session, p, geodetic), ODO_OK);
  CHECK(fabs(geodetic[0] - 0.83) < 1e-3 && fabs(geodetic[1] - 0.15) < 1e-3 && fabs(geodetic[2] - 370) < 1,
        "1000 m to the north and -2000 m to the east it is %g, %g, %g", geodetic[0], geodetic[1], geodetic[2]);
  EXPECT(odo.session_from_geodetic(self->session, geodetic, back), ODO_OK);
  for (int i = 0; i < 3; ++i) CHECK(fabs(back[i] - p[i]) < 1e-6, "component %d came back as %.9g", i, back[i]);
  self = app_open(FIXER_ALONE, ODO_RUN_REPLAY);
  EXPECT(odo.session_to_geodetic(self->session, p, geodetic), ODO_NOT_READY);
  EXPECT(odo.session_from_geodetic(self->session, geodetic, back), ODO_NOT_READY);
}

CASE("a replay gives the same bytes again", "odograph.h",
     "samples are processed within push, on the thread of the caller: deterministic.") {
  app* sessions[2];
  hooks.on_message = walk_message;
  for (int n = 0; n < 2; ++n) {
    sessions[n] = app_open(CAMERA_WALK, ODO_RUN_REPLAY);
    walk_second(sessions[n], 0);
    app_flush(sessions[n]);
    walk_reset();
  }
  REQUIRE(sessions[0]->count == sessions[1]->count, "%u and %u events", (unsigned)sessions[0]->count,
          (unsigned)sessions[1]->count);
  for (size_t i = 0; i < sessions[0]->count; ++i) {
    const odo_header *one = sessions[0]->events[i], *other = sessions[1]->events[i];
    REQUIRE(one->struct_size == other->struct_size && memcmp(one, other, one->struct_size) == 0,
            "event %u of type 0x%x differs", (unsigned)i, one->type);
  }
}
