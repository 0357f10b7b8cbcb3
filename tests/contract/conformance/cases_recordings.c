/* SPDX-License-Identifier: Apache-2.0
 *
 * Recordings: written and read back. */
#include "app.h"

#define APPENDS "A message is stored unchanged"

typedef union message {
  odo_header header;
  odo_frame frame;
  unsigned char bytes[4096];
} message;

static odo_recorder* create(const char* path) {
  const odo_string name = string_of(path);
  odo_error error = {sizeof error, 0, ""};
  odo_recorder* recorder = NULL;
  int32_t status = odo.recorder_create(&name, &recorder, &error);
  REQUIRE(status == ODO_OK && recorder, "odo_recorder_create = %s: %s", status_name(status), error.message);
  return recorder;
}

static odo_recording* open_recording(const char* path) {
  const odo_string name = string_of(path);
  odo_error error = {sizeof error, 0, ""};
  odo_recording* recording = NULL;
  const int32_t status = odo.recording_open(&name, &recording, &error);
  REQUIRE(status == ODO_OK && recording, "odo_recording_open = %s: %s", status_name(status), error.message);
  return recording;
}

static void check_no_loss(odo_recording* recording) {
  odo_error loss = {sizeof loss, 1, "x"};
  EXPECT(odo.recording_loss(recording, &loss), ODO_OK);
  CHECK(loss.status == ODO_OK && loss.message[0] == 0, "the loss is %s, \"%s\"", status_name(loss.status),
        loss.message);
}

/* Closes a recording, which is then complete, and opens it. */
static odo_recording* reopened(odo_recorder* recorder, const char* path) {
  EXPECT(odo.recorder_close(recorder), ODO_OK);
  odo_recording* recording = open_recording(path);
  check_no_loss(recording);
  return recording;
}

static void write_barometer(odo_recorder* recorder, int64_t t_ns) {
  odo_barometer sample;
  put_barometer(&sample, t_ns);
  EXPECT(odo.recorder_write(recorder, &sample.header, NULL, 0), ODO_OK);
}

static const odo_header* next(odo_recording* recording) {
  const odo_header* found = NULL;
  const int32_t status = odo.recording_next(recording, &found, NULL, NULL);
  REQUIRE(status == ODO_OK && found, "odo_recording_next = %s", status_name(status));
  return found;
}

/* A message of a type with its number in every byte after the head, except for frames. */
static void put_message(message* out, uint32_t type, uint32_t size, int64_t t_ns) {
  for (size_t i = 0; i < sample_kind_count; ++i)
    if (sample_kinds[i].type == type) {
      sample_kinds[i].put(out, t_ns);
      if (size > sample_kinds[i].size) memset(out->bytes + sample_kinds[i].size, 0x42, size - sample_kinds[i].size);
      out->header.struct_size = size;
      return;
    }
  put_header(out, size, type, t_ns);
  memset(out->bytes + sizeof(odo_header), (int)(type & 0x7F) + 1, size - sizeof(odo_header));
}

static void round_trip(const uint32_t* types, const uint32_t* sizes, size_t count) {
  const char* path = case_file("all.odo");
  odo_recorder* recorder = create(path);
  const odo_header* end;
  message one;
  for (size_t i = 0; i < count; ++i) {
    put_message(&one, types[i], sizes[i], T0 + (int64_t)i * MS);
    expect_status(__FILE__, __LINE__, "odo_recorder_write", odo.recorder_write(recorder, &one.header, NULL, 0), ODO_OK);
  }
  odo_recording* recording = reopened(recorder, path);
  for (size_t i = 0; i < count; ++i) {
    const odo_header* found = next(recording);
    put_message(&one, types[i], sizes[i], T0 + (int64_t)i * MS);
    CHECK(found->type == types[i] && found->struct_size == sizes[i] && memcmp(found, &one, sizes[i]) == 0,
          "message %u of type 0x%x and %u bytes was read as type 0x%x and %u bytes, or with other bytes", (unsigned)i,
          types[i], sizes[i], found->type, found->struct_size);
  }
  EXPECT(odo.recording_next(recording, &end, NULL, NULL), ODO_END);
  odo.recording_close(recording);
}

static void inputs(int more) {
  uint32_t types[16], sizes[16];
  for (size_t i = 0; i < sample_kind_count; ++i) {
    types[i] = sample_kinds[i].type;
    sizes[i] = (more ? sample_kinds[i].size : sample_kinds[i].min_size) + (uint32_t)more;
  }
  round_trip(types, sizes, sample_kind_count);
}
CASE_OF(inputs, 0, "inputs of version 1.0 are recorded and read again", "recording.h", APPENDS);
CASE_OF(inputs, 40, "later inputs are recorded and read with their ends", "recording.h",
        "A recording contains messages in the version of their writer, which may be older or newer than this library, "
        "including vendor messages.");

static void events(int more) {
  /* clang-format off */
#define EVENT(number, type, name, min) if (ODO_IS_EVENT(number)) types[count] = number, sizes[count++] = (more ? (uint32_t)sizeof(type) : min) + (uint32_t)more;
  /* clang-format on */
  uint32_t types[32], sizes[32];
  size_t count = 0;
  ODO_FOR_EACH_MESSAGE(EVENT)
  round_trip(types, sizes, count);
}
CASE_OF(events, 0, "events of version 1.0 are recorded and read again", "recording.h", APPENDS);
CASE_OF(events, 40, "later events are recorded and read with their ends", "recording.h",
        "A recording contains messages in the version of their writer, which may be older or newer than this library, "
        "including vendor messages.");

CASE("unknown inputs and vendors' messages are recorded and read again", "base.h",
     "A host orders inputs and vendor messages of unknown type by time, records them") {
  const uint32_t types[] = {PROBE_NEWER_INPUT, 0x3F0, PROBE_MESSAGE, PROBE_UNDECLARED, ODO_TYPE_VENDOR(0x7FFFF, 0x7FF),
                            PROBE_MESSAGE};
  const uint32_t sizes[] = {200, 32, 2000, 48, 64, sizeof(odo_header)};
  round_trip(types, sizes, COUNT_OF(types));
}

CASE("a reserved type is not recorded, and nothing of the recording is lost", "recording.h",
     "ODO_E_ARGUMENT (reserved type: ODO_IS_RESERVED;") {
  const uint32_t types[] = {0, 0x2000, 0x10000, 0x10001, 0x10003, 0x1FFFF, 0x01000000, 0x7FFFFFFF};
  const char* path = case_file("reserved.odo");
  odo_recorder* recorder = create(path);
  const odo_header* found;
  message one;
  for (size_t i = 0; i < COUNT_OF(types); ++i) {
    put_message(&one, types[i], 64, T0);
    if (odo.recorder_write(recorder, &one.header, NULL, 0) != ODO_E_ARGUMENT)
      fail_at(__FILE__, __LINE__, "odo_recorder_write of type 0x%x is not refused", types[i]);
  }
  write_barometer(recorder, T0);
  odo_recording* recording = reopened(recorder, path);
  CHECK(next(recording)->type == ODO_TYPE_BAROMETER, "the first message is another");
  EXPECT(odo.recording_next(recording, &found, NULL, NULL), ODO_END);
}

static void borrowed_ones(int type) {
  odo_recorder* recorder = create(case_file("borrowed.odo"));
  odo_borrowed one;
  lent memory = NOT_LENT;
  put_header(&one, sizeof one, (uint32_t)type, T0);
  lend(&one.loan, &memory);
  EXPECT(odo.recorder_write(recorder, &one.header, NULL, 0), ODO_E_UNSUPPORTED);
  EXPECT(odo.recorder_close(recorder), ODO_OK);
  CHECK_BALANCED(&memory, 0);
}
CASE_OF(borrowed_ones, (int)PROBE_BORROWED, "a vendor's borrowed message is not recorded", "recording.h",
        "ODO_E_UNSUPPORTED (borrowed message other than a frame)");
CASE_OF(borrowed_ones, PROBE_NEWER_BORROWED, "a later borrowed input is not recorded", "recording.h",
        "ODO_E_UNSUPPORTED (borrowed message other than a frame)");

CASE("a message that is too small is not recorded", "base.h", "A struct smaller than in version 1.0 is rejected.") {
  odo_recorder* recorder = create(case_file("small.odo"));
  message one;
  for (size_t i = 0; i < sample_kind_count; ++i) {
    put_message(&one, sample_kinds[i].type, sample_kinds[i].size, T0);
    one.header.struct_size = sample_kinds[i].min_size - 1;
    EXPECT(odo.recorder_write(recorder, &one.header, NULL, 0), ODO_E_STRUCT_SIZE);
  }
  put_message(&one, PROBE_MESSAGE, 64, T0);
  one.header.struct_size = 31;
  EXPECT(odo.recorder_write(recorder, &one.header, NULL, 0), ODO_E_STRUCT_SIZE);
  EXPECT(odo.recorder_write(recorder, NULL, NULL, 0), ODO_E_ARGUMENT);
  EXPECT(odo.recorder_close(recorder), ODO_OK);
}

static void pictures(int unused) {
  static const char encoded[] = "\x89PNG\r\n\x1a\n and whatever follows";
  const char* path = case_file("pictures.odo");
  odo_recorder* recorder = create(path);
  const odo_header* found;
  const void* picture = NULL;
  uint64_t size = 0;
  odo_frame one;
  lent memory = NOT_LENT;
  put_frame(&one, 2, T0);
  lend(&one.loan, &memory);
  EXPECT(odo.recorder_write(recorder, &one.header, encoded, sizeof encoded), ODO_OK);
  write_barometer(recorder, T0 + MS);
  EXPECT(odo.recorder_close(recorder), ODO_OK);
  CHECK_BALANCED(&memory, 0);
  odo_recording* recording = open_recording(path);
  EXPECT(odo.recording_next(recording, &found, &picture, &size), ODO_OK);
  REQUIRE(found->type == ODO_TYPE_FRAME && found->source == 2, "the first message is of type 0x%x", found->type);
  const odo_frame* frame = (const odo_frame*)(const void*)found;
  CHECK(!frame->planes[0].data && !frame->loan.owner && !frame->loan.retain && !frame->loan.release &&
            !frame->loan.native,
        "a pointer of the writer's is in it");
  CHECK(frame->width == 64 && frame->height == 48, "it is %u x %u", frame->width, frame->height);
  CHECK(picture && size == sizeof encoded && memcmp(picture, encoded, sizeof encoded) == 0,
        "its picture has %llu other bytes", (unsigned long long)size);
  EXPECT(odo.recording_next(recording, &found, &picture, &size), ODO_OK);
  CHECK(found->type == ODO_TYPE_BAROMETER && !picture, "a barometer's sample has a picture");
}
CASE_OF(pictures, 0, "a frame is recorded with its encoded picture and without pointers", "recording.h",
        "For a frame, the planes are null and *picture is the encoded picture; otherwise *picture is null.");

/* Also sizes that a 32-bit number cannot hold: the memory behind them is never read. */
CASE("a picture above the largest is refused whatever its size", "recording.h",
     "Appends a message of any type, and for a frame the encoded picture of at most ODO_LARGEST_PICTURE bytes") {
  const uint64_t largest = ODO_LARGEST_PICTURE;
  const uint64_t sizes[] = {largest + 1, 1ull << 32, (1ull << 32) + 4, UINT64_MAX};
  const char* path = case_file("largest.odo");
  odo_recorder* recorder = create(path);
  const odo_header* found;
  odo_frame one;
  uint64_t size = 0;
  put_frame(&one, 2, T0);
  for (size_t i = 0; i < COUNT_OF(sizes); ++i)
    EXPECT(odo.recorder_write(recorder, &one.header, "picture", sizes[i]), ODO_E_ARGUMENT);
  void* picture = calloc(1, ODO_LARGEST_PICTURE);
  REQUIRE(picture, "no memory for the largest picture");
  EXPECT(odo.recorder_write(recorder, &one.header, picture, largest), ODO_OK);
  odo_recording* recording = reopened(recorder, path);
  EXPECT(odo.recording_next(recording, &found, NULL, &size), ODO_OK);
  EQUAL(size, largest);
  EXPECT(odo.recording_next(recording, &found, NULL, NULL), ODO_END);
  odo.recording_close(recording);
}

CASE("a recording without messages is complete", "recording.h",
     "the status ODO_OK and an empty message if the recording is complete") {
  const char* path = case_file("empty.odo");
  const odo_header* found = (const odo_header*)(const void*)path;
  odo_recording* recording = reopened(create(path), path);
  EXPECT(odo.recording_next(recording, &found, NULL, NULL), ODO_END);
  CHECK(!found, "there is a message in an empty recording");
  odo.recording_close(recording);
}

/* A record that is damaged after the recording was opened. */
CASE("behind a record that cannot be read the next one is, and the loss is stated", "recording.h",
     "ODO_E_DATA for a record that cannot be read: call again for the next one.") {
  const char* path = case_file("unreadable.odo");
  odo_recorder* recorder = create(path);
  odo_error loss = {sizeof loss, 0, ""};
  const odo_header* found;
  FILE* file;
  int good = 0, bad = 0, status = ODO_OK;
  for (int i = 0; i < 10; ++i) write_barometer(recorder, T0 + i * MS);
  odo_recording* recording = reopened(recorder, path);
  file = fopen(path, "r+b");
  REQUIRE(file && fseek(file, 0, SEEK_END) == 0, "%s cannot be changed", path);
  long size = ftell(file);
  REQUIRE(fseek(file, size / 2, SEEK_SET) == 0 && fputc('#', file) == '#' && fclose(file) == 0, "%s cannot be changed",
          path);
  for (int i = 0; i < 20 && status != ODO_END; ++i) {
    status = odo.recording_next(recording, &found, NULL, NULL);
    CHECK((found != NULL) == (status == ODO_OK), "status %s, message %s", status_name(status), found ? "set" : "null");
    good += status == ODO_OK, bad += status == ODO_E_DATA;
  }
  if (good == 10) skip_case("the library has read the file before");
  CHECK(status == ODO_END && good == 9 && bad == 1,
        "%d messages and %d unreadable ones, then %s; expected 9, 1, ODO_END", good, bad, status_name(status));
  EXPECT(odo.recording_loss(recording, &loss), ODO_OK);
  CHECK(loss.status == ODO_E_DATA && loss.message[0], "the loss is %s, \"%s\"", status_name(loss.status), loss.message);
  odo.recording_close(recording);
}

CASE("messages are read in the order of time", "recording.h",
     "Returns the next message in time order, valid until the next call.") {
  const int64_t times[] = {T0 + 30 * MS, T0 + 10 * MS, T0 + 20 * MS, T0};
  const char* path = case_file("order.odo");
  odo_recorder* recorder = create(path);
  int64_t before = INT64_MIN;
  for (size_t i = 0; i < COUNT_OF(times); ++i) write_barometer(recorder, times[i]);
  odo_recording* recording = reopened(recorder, path);
  for (size_t i = 0; i < COUNT_OF(times); ++i) {
    const int64_t t_ns = next(recording)->t_ns;
    CHECK(t_ns >= before, "message %u is earlier than the one before", (unsigned)i);
    before = t_ns;
  }
}
