/* SPDX-License-Identifier: Apache-2.0
 *
 * The size rule of every input and output struct. */
#include "app.h"

#include <string.h>

#define FILL 0xA5
#define SPARE 64u

/* An output struct: its size, and the call that fills it. */
typedef struct output {
  const char* name;
  uint32_t size, min_size;
  int32_t (*fill)(app* self, void* out);
} output;

static uint64_t anchor_id;
static odo_recording* damaged;

static int32_t fill_pose(app* self, void* out) {
  return odo.session_get_pose(self->session, ODO_TIME_LATEST, (odo_pose*)out);
}
static int32_t fill_smooth(app* self, void* out) {
  return odo.session_get_smooth_pose(self->session, ODO_TIME_LATEST, (odo_pose*)out);
}
static int32_t fill_pose_of(app* self, void* out) {
  return odo.session_get_pose_of(self->session, ODO_OF_BODY, 0, ODO_TIME_LATEST, (odo_pose*)out);
}
static int32_t fill_statistics(app* self, void* out) {
  return odo.session_get_statistics(self->session, (odo_statistics*)out);
}
static int32_t fill_anchor(app* self, void* out) {
  return odo.anchor_get(self->session, anchor_id, ODO_WORLD_CORRECTED, ODO_TIME_LATEST, (odo_anchor*)out);
}
/* Both have content to write. */
static int32_t fill_last_error(app* self, void* out) {
  odo_barometer sample;
  put_barometer(&sample, T0 + SECOND);
  sample.pressure_pa = -1e9;
  CHECK(push(self, &sample) < 0, "a pressure of -1e9 Pa was taken");
  return odo.session_last_error(self->session, (odo_error*)out);
}
static int32_t fill_loss(app* self, void* out) { return odo.recording_loss(damaged, (odo_error*)out); }

static const output outputs[] = {
    {"odo_session_get_pose", sizeof(odo_pose), ODO_POSE_SIZE_MIN, fill_pose},
    {"odo_session_get_smooth_pose", sizeof(odo_pose), ODO_POSE_SIZE_MIN, fill_smooth},
    {"odo_session_get_pose_of", sizeof(odo_pose), ODO_POSE_SIZE_MIN, fill_pose_of},
    {"odo_session_get_statistics", sizeof(odo_statistics), ODO_STATISTICS_SIZE_MIN, fill_statistics},
    {"odo_anchor_get", sizeof(odo_anchor), ODO_ANCHOR_SIZE_MIN, fill_anchor},
    {"odo_session_last_error", sizeof(odo_error), ODO_ERROR_SIZE_MIN, fill_last_error},
    {"odo_recording_loss", sizeof(odo_error), ODO_ERROR_SIZE_MIN, fill_loss}};

static void put_anchor(app* self) {
  NEED(anchor_create);
  NEED(anchor_get);
  odo_anchor_place place = {.struct_size = sizeof place};
  place.kind = ODO_ANCHOR_GEODETIC;
  place.height_above = ODO_HEIGHT_ELLIPSOID;
  EXPECT(odo.anchor_create(self->session, &place, &anchor_id), ODO_OK);
}

static void open_a_recording(void) {
  const odo_string path = string_of(case_file("walk.odo"));
  odo_recorder* recorder;
  odo_barometer sample;
  NEED(recorder_create);
  NEED(recording_loss);
  EXPECT(odo.recorder_create(&path, &recorder, NULL), ODO_OK);
  put_barometer(&sample, T0);
  EXPECT(odo.recorder_write(recorder, &sample.header, NULL, 0), ODO_OK);
  EXPECT(odo.recorder_close(recorder), ODO_OK);
  EXPECT(odo.recording_open(&path, &damaged, NULL), ODO_OK);
}

/* If the call needs more than a session. */
static app* prepare(const output* of) {
  NEED(session_get_pose);
  NEED(session_get_pose_of);
  NEED(session_get_smooth_pose);
  NEED(session_last_error);
  hooks.on_message = walk_message;
  app* self = app_open(CAMERA_WALK, ODO_RUN_REPLAY);
  walk_second(self, 0);
  app_flush(self);
  if (of->fill == fill_anchor) put_anchor(self);
  if (of->fill == fill_loss) open_a_recording();
  return self;
}

static bool untouched(const unsigned char* bytes, size_t from, size_t to) {
  for (size_t i = from; i < to; ++i)
    if (bytes[i] != FILL) return false;
  return true;
}

static void check_capacity(app* self, const output* of, uint32_t capacity, uint32_t min_written, uint32_t max_written) {
  uint64_t aligned[(sizeof(odo_error) + SPARE) / 8 + 1];
  unsigned char* bytes = (unsigned char*)aligned;
  uint32_t written;
  memset(bytes, FILL, sizeof aligned);
  memcpy(bytes, &capacity, sizeof capacity);
  expect_status(__FILE__, __LINE__, of->name, of->fill(self, bytes), ODO_OK);
  memcpy(&written, bytes, sizeof written);
  CHECK(written >= min_written && written <= max_written,
        "%s: struct_size was %u on entry and is %u on return; expected %u to %u", of->name, capacity, written,
        min_written, max_written);
  CHECK(written <= of->size || !untouched(bytes, of->size, written),
        "%s: struct_size is %u on return, but no byte behind the %u known ones was written", of->name, written,
        of->size);
  CHECK(untouched(bytes, written < capacity ? written : capacity, sizeof aligned),
        "%s: bytes behind struct_size were written (capacity %u)", of->name, capacity);
}

static void out_of_this_version(int index) {
  const output* of = &outputs[index];
  check_capacity(prepare(of), of, of->size, of->size, of->size);
}
static void out_of_version_1_0(int index) {
  const output* of = &outputs[index];
  check_capacity(prepare(of), of, of->min_size, of->min_size, of->min_size);
}
static void out_of_later_version(int index) {
  const output* of = &outputs[index];
  check_capacity(prepare(of), of, of->size + SPARE, of->size, of->size + SPARE);
}
static void out_too_small(int index) {
  const output* of = &outputs[index];
  app* self = prepare(of);
  const uint32_t sizes[] = {0, 4, of->min_size - 1};
  uint64_t aligned[sizeof(odo_error) / 8 + 1];
  unsigned char* bytes = (unsigned char*)aligned;
  for (size_t i = 0; i < COUNT_OF(sizes); ++i) {
    memset(bytes, FILL, sizeof aligned);
    memcpy(bytes, &sizes[i], sizeof sizes[i]);
    expect_status(__FILE__, __LINE__, of->name, of->fill(self, bytes), ODO_E_STRUCT_SIZE);
    CHECK(untouched(bytes, 4, sizeof aligned), "%s wrote into a struct of %u bytes", of->name, sizes[i]);
  }
}

static void last_error_too_small(int unused) {
  app* self = app_open(FIXER_ALONE, ODO_RUN_REPLAY);
  odo_error error = {ODO_ERROR_SIZE_MIN - 1, 77, "x"};
  NEED(session_last_error);
  EXPECT(odo.session_last_error(self->session, &error), ODO_E_STRUCT_SIZE);
  CHECK(error.status == 77 && error.message[0] == 'x', "the struct was written");
}

static void error_of_create(int unused) {
  static uint64_t aligned[(sizeof(odo_error) + SPARE) / 8];
  unsigned char* bytes = (unsigned char*)aligned;
  odo_error* error = (odo_error*)(void*)aligned;
  odo_session* session;
  NEED(session_create);
  odo_session_options chosen = {.struct_size = sizeof chosen};
  for (uint32_t capacity = 0; capacity <= sizeof aligned; capacity += 16) {
    memset(bytes, FILL, sizeof aligned);
    error->struct_size = capacity;
    EXPECT(odo.session_create(&chosen, &session, error), ODO_E_ARGUMENT);
    CHECK(untouched(bytes, capacity < 4 ? 4 : capacity, sizeof aligned),
          "bytes behind a struct_size of %u were written", capacity);
    if (capacity < ODO_ERROR_SIZE_MIN) continue;
    CHECK(error->struct_size >= ODO_ERROR_SIZE_MIN && error->struct_size <= capacity,
          "struct_size is %u on return, %u on entry", error->struct_size, capacity);
    CHECK(error->status == ODO_E_ARGUMENT && error->message[0], "no reason was written (capacity %u)", capacity);
  }
}

static void options_sizes(int unused) {
  struct {
    odo_session_options known;
    unsigned char later[SPARE];
  } chosen;
  odo_session* session;
  odo_error error = {sizeof error, 0, ""};
  uint32_t size;
  NEED(session_create);
  NEED(session_destroy);
  need_plugins();
  memset(&chosen, FILL, sizeof chosen);
  chosen.known = app_options(FIXER_ALONE, ODO_RUN_REPLAY);
  for (size = 0; size < ODO_SESSION_OPTIONS_SIZE_MIN; ++size) {
    chosen.known.struct_size = size;
    EXPECT(odo.session_create(&chosen.known, &session, &error), ODO_E_STRUCT_SIZE);
    CHECK(session == NULL, "there is a session of options of %u bytes", size);
  }
  for (; size <= sizeof chosen; size += 8) {
    chosen.known.struct_size = size;
    EXPECT(odo.session_create(&chosen.known, &session, &error), ODO_OK);
    CHECK(session != NULL, "there is no session of options of %u bytes: %s", size, error.message);
    odo.session_destroy(session);
  }
}

static void place_sizes(int unused) {
  struct {
    odo_anchor_place known;
    unsigned char later[SPARE];
  } place;
  app* self = app_open(FIXER_ALONE, ODO_RUN_REPLAY);
  uint64_t id = 0;
  NEED(anchor_create);
  memset(&place, FILL, sizeof place);
  memset(&place.known, 0, sizeof place.known);
  place.known.kind = ODO_ANCHOR_GEODETIC;
  place.known.height_above = ODO_HEIGHT_ELLIPSOID;
  place.known.struct_size = ODO_ANCHOR_PLACE_SIZE_MIN - 1;
  EXPECT(odo.anchor_create(self->session, &place.known, &id), ODO_E_STRUCT_SIZE);
  place.known.struct_size = ODO_ANCHOR_PLACE_SIZE_MIN;
  EXPECT(odo.anchor_create(self->session, &place.known, &id), ODO_OK);
  place.known.struct_size = sizeof place;
  EXPECT(odo.anchor_create(self->session, &place.known, &id), ODO_OK);
}

#define OUTPUT(index, what)                                                                                            \
  {what " of this version is written whole", "base.h",                                                                 \
   "For an output, it is the capacity on entry and the number of bytes written on return.", out_of_this_version,       \
   index},                                                                                                             \
      {what " of version 1.0 is written up to its end", "base.h",                                                      \
       "For an output, it is the capacity on entry and the number of bytes written on return.", out_of_version_1_0,    \
       index},                                                                                                         \
  {                                                                                                                    \
    what " of a later version is written up to what is known", "base.h",                                               \
        "For an output, it is the capacity on entry and the number of bytes written on return.", out_of_later_version, \
        index                                                                                                          \
  }
#define TOO_SMALL(index, what)                                                                           \
  {                                                                                                      \
    what " that is too small is refused", "base.h", "A struct smaller than in version 1.0 is rejected.", \
        out_too_small, index                                                                             \
  }

const conformance_case cases_sizes[] = {
    OUTPUT(0, "a pose"),
    TOO_SMALL(0, "a pose"),
    OUTPUT(1, "a smooth pose"),
    TOO_SMALL(1, "a smooth pose"),
    OUTPUT(2, "a pose of the body"),
    TOO_SMALL(2, "a pose of the body"),
    OUTPUT(3, "a session's statistics"),
    TOO_SMALL(3, "a session's statistics"),
    OUTPUT(4, "an anchor"),
    TOO_SMALL(4, "an anchor"),
    OUTPUT(5, "a last error"),
    OUTPUT(6, "a recording's loss"),
    TOO_SMALL(6, "a recording's loss"),
    {"a last error smaller than 1.0 is refused", "base.h", "A struct smaller than in version 1.0 is rejected.",
     last_error_too_small, 0},
    {"why a session could not be created fits into its struct", "odograph.h",
     "struct_size: capacity in, bytes written out. The message is UTF-8 and terminated.", error_of_create, 0},
    {"options are refused below the size of 1.0 and taken at every larger one", "base.h",
     "A struct smaller than in version 1.0 is rejected. Of a larger one, the part beyond the known fields is forwarded "
     "unread.",
     options_sizes, 0},
    {"an anchor's place is refused below the size of 1.0 and taken at a larger one", "base.h",
     "A struct smaller than in version 1.0 is rejected. Of a larger one, the part beyond the known fields is forwarded "
     "unread.",
     place_sizes, 0},
    {NULL, NULL, NULL, NULL, 0}};
