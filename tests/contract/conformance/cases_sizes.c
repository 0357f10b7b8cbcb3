/* SPDX-License-Identifier: Apache-2.0
 *
 * The size rule of every input and output struct. */
#include "app.h"

#define FILL 0xA5
#define SPARE 64u

#define SMALLER "A struct smaller than in version 1.0 is rejected."
#define LARGER "Of a larger one, the part beyond the known fields is forwarded unread."
#define CAPACITY "For an output, it is the capacity on entry and the number of bytes written on return."

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
  odo_anchor_place place = {.struct_size = sizeof place};
  place.kind = ODO_ANCHOR_GEODETIC;
  place.height_above = ODO_HEIGHT_ELLIPSOID;
  EXPECT(odo.anchor_create(self->session, &place, &anchor_id), ODO_OK);
}

static void open_a_recording(void) {
  const odo_string path = string_of(case_file("walk.odo"));
  odo_recorder* recorder;
  odo_barometer sample;
  EXPECT(odo.recorder_create(&path, &recorder, NULL), ODO_OK);
  put_barometer(&sample, T0);
  EXPECT(odo.recorder_write(recorder, &sample.header, NULL, 0), ODO_OK);
  EXPECT(odo.recorder_close(recorder), ODO_OK);
  EXPECT(odo.recording_open(&path, &damaged, NULL), ODO_OK);
}

/* If the call needs more than a session. */
static app* prepare(const output* of) {
  app* self = app_walk(1);
  if (of->fill == fill_anchor) put_anchor(self);
  if (of->fill == fill_loss) open_a_recording();
  return self;
}

static bool untouched(const unsigned char* bytes, size_t from, size_t to) {
  for (size_t i = from; i < to; ++i)
    if (bytes[i] != FILL) return false;
  return true;
}

static void check_capacity(const output* of, uint32_t capacity) {
  app* self = prepare(of);
  uint64_t aligned[(sizeof(odo_error) + SPARE) / 8 + 1];
  unsigned char* bytes = (unsigned char*)aligned;
  const uint32_t min_written = capacity < of->size ? capacity : of->size;
  uint32_t written;
  memset(bytes, FILL, sizeof aligned);
  memcpy(bytes, &capacity, sizeof capacity);
  expect_status(__FILE__, __LINE__, of->name, of->fill(self, bytes), ODO_OK);
  memcpy(&written, bytes, sizeof written);
  CHECK(written >= min_written && written <= capacity,
        "%s: struct_size was %u on entry and is %u on return; expected %u to %u", of->name, capacity, written,
        min_written, capacity);
  CHECK(written <= of->size || !untouched(bytes, of->size, written),
        "%s: struct_size is %u on return, but no byte behind the %u known ones was written", of->name, written,
        of->size);
  CHECK(untouched(bytes, written, sizeof aligned), "%s: bytes behind struct_size were written (capacity %u)", of->name,
        capacity);
}

static void out_of_this_version(int index) { check_capacity(&outputs[index], outputs[index].size); }
static void out_of_version_1_0(int index) { check_capacity(&outputs[index], outputs[index].min_size); }
static void out_of_later_version(int index) { check_capacity(&outputs[index], outputs[index].size + SPARE); }
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

#define OUTPUT(index, what)                                                                                            \
  CASE_OF(out_of_this_version, index, what " of this version is written whole", "base.h", CAPACITY);                   \
  CASE_OF(out_of_version_1_0, index, what " of version 1.0 is written up to its end", "base.h", CAPACITY);             \
  CASE_OF(out_of_later_version, index, what " of a later version is written up to what is known", "base.h", CAPACITY); \
  CASE_OF(out_too_small, index, what " that is too small is refused", "base.h", SMALLER)
OUTPUT(0, "a pose");
OUTPUT(1, "a smooth pose");
OUTPUT(2, "a pose of the body");
OUTPUT(3, "a session's statistics");
OUTPUT(4, "an anchor");
OUTPUT(5, "a last error");
OUTPUT(6, "a recording's loss");

CASE("why a session could not be created fits into its struct", "odograph.h",
     "struct_size: capacity in, bytes written out. The message is UTF-8 and terminated.") {
  static uint64_t aligned[(sizeof(odo_error) + SPARE) / 8];
  unsigned char* bytes = (unsigned char*)aligned;
  odo_error* error = (odo_error*)(void*)aligned;
  odo_session* session;
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

CASE("options are refused below the size of 1.0 and taken at every larger one", "base.h", SMALLER " " LARGER) {
  struct {
    odo_session_options known;
    unsigned char later[SPARE];
  } chosen;
  odo_session* session;
  odo_error error = {sizeof error, 0, ""};
  uint32_t size;
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

CASE("an anchor's place is refused below the size of 1.0 and taken at a larger one", "base.h", SMALLER " " LARGER) {
  struct {
    odo_anchor_place known;
    unsigned char later[SPARE];
  } place;
  app* self = app_open(FIXER_ALONE, ODO_RUN_REPLAY);
  uint64_t id = 0;
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
