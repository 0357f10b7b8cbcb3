/* SPDX-License-Identifier: Apache-2.0
 *
 * Truncated and damaged recordings, and files that are not recordings. */
#include "app.h"

/* Ten barometer samples, numbered by their pressure; closed or not. */
static odo_recorder* write_ten(const char* path, bool closed) {
  const odo_string name = string_of(path);
  odo_recorder* recorder = NULL;
  odo_barometer sample;
  EXPECT(odo.recorder_create(&name, &recorder, NULL), ODO_OK);
  for (int i = 0; i < 10; ++i) {
    put_barometer(&sample, T0 + i * MS);
    EXPECT(odo.recorder_write(recorder, &sample.header, NULL, 0), ODO_OK);
  }
  if (!closed) return recorder;
  EXPECT(odo.recorder_close(recorder), ODO_OK);
  return NULL;
}

typedef struct file {
  unsigned char bytes[16384];
  size_t size;
} file;

static void read_file(const char* path, file* out) {
  FILE* opened = fopen(path, "rb");
  REQUIRE(opened, "there is no file %s", path);
  out->size = fread(out->bytes, 1, sizeof out->bytes, opened);
  fclose(opened);
}

static void write_file(const char* path, const file* from, size_t size) {
  FILE* opened = fopen(path, "wb");
  REQUIRE(opened && fwrite(from->bytes, 1, size, opened) == size, "%s could not be written", path);
  fclose(opened);
}

/* Number of readable messages; -1 if the file cannot be opened. *loss is the reason, or the status of the loss. */
static int read_all(const char* path, int32_t* loss) {
  const odo_string name = string_of(path);
  odo_error words = {sizeof words, 0, ""};
  odo_recording* recording = NULL;
  const odo_header* found;
  int count = 0;
  *loss = odo.recording_open(&name, &recording, &words);
  if (*loss != ODO_OK) return -1;
  while (odo.recording_next(recording, &found, NULL, NULL) == ODO_OK) {
    CHECK(found->type == ODO_TYPE_BAROMETER && found->struct_size == sizeof(odo_barometer),
          "a message of type 0x%x was read", found->type);
    ++count;
  }
  words.struct_size = sizeof words;
  EXPECT(odo.recording_loss(recording, &words), ODO_OK);
  *loss = words.status;
  CHECK((*loss == ODO_OK) == (words.message[0] == 0), "odo_recording_loss = %s, \"%s\"", status_name(*loss),
        words.message);
  odo.recording_close(recording);
  return count;
}

CASE("a recording that was cut off has a loss, and its whole records are read", "recording.h",
     "After a crash of the process, everything up to the last complete message can be read.") {
  const char* path = case_file("cut.odo");
  file whole;
  int32_t loss;
  int before = -1;
  write_ten(path, true);
  read_file(path, &whole);
  CHECK(read_all(path, &loss) == 10 && loss == ODO_OK, "the whole recording has a loss");
  for (size_t size = 0; size < whole.size; ++size) {
    int count;
    write_file(path, &whole, size);
    count = read_all(path, &loss);
    CHECK(loss == ODO_E_DATA, "cut to %u of %u bytes the loss is %s", (unsigned)size, (unsigned)whole.size,
          status_name(loss));
    CHECK(count >= before, "cut to %u bytes %d messages can be read; %d with fewer bytes", (unsigned)size, count,
          before);
    if (count > before) before = count;
  }
  EQUAL(before, 10);
}

CASE("a changed byte costs one message at most and is reported", "recording.h",
     "indexes its messages, without damaged ones (odo_recording_loss)") {
  const char* path = case_file("changed.odo");
  file whole;
  int32_t loss;
  write_ten(path, true);
  read_file(path, &whole);
  for (size_t at = 0; at < whole.size; ++at) {
    int count;
    whole.bytes[at] ^= 0x10;
    write_file(path, &whole, whole.size);
    count = read_all(path, &loss);
    CHECK(count == -1 || count >= 9, "with byte %u changed %d of 10 messages could be read", (unsigned)at, count);
    CHECK(count != -1 || at < 64, "with byte %u changed it could not be opened", (unsigned)at);
    CHECK(loss < 0 || at < 16, "with byte %u changed nothing is reported as lost", (unsigned)at);
    whole.bytes[at] ^= 0x10;
  }
}

CASE("a recording that was never closed can be read and has a loss", "recording.h",
     "Closes the recording and marks it as complete.") {
  const char* path = case_file("open.odo");
  int32_t loss;
  write_ten(path, false); /* there was no file of the name: it is written in place */
  int count = read_all(path, &loss);
  CHECK(count == 10 || count == -1 || loss == ODO_E_DATA,
        "of a recording that is being written %d messages could be read", count);
  EXPECT(loss, ODO_E_DATA);
  EQUAL(count, 10);
}

CASE("a recording of the same name stays until the new one is closed", "recording.h",
     "If a file of that name exists, the recording is written to NAME.part and replaces it when closed") {
  const char *path = case_file("kept.odo"), *part = case_file("kept.odo.part");
  FILE* beside;
  int32_t loss;
  write_ten(path, true);
  odo_recorder* recorder = write_ten(path, false);
  beside = fopen(part, "rb");
  CHECK(beside, "the new one does not lie beside the old one as NAME.part");
  if (beside) fclose(beside);
  CHECK(read_all(path, &loss) == 10 && loss == ODO_OK, "the old one is gone before the new one is closed");
  EXPECT(odo.recorder_close(recorder), ODO_OK);
  CHECK(read_all(path, &loss) == 10 && loss == ODO_OK, "the new one cannot be read");
  beside = fopen(part, "rb");
  CHECK(!beside, "NAME.part is left");
}

/* What the operating system refuses: a folder in place of a file, a folder that is not there, a full disk. */
CASE("what the system refuses to create, read or write is an error of input and output", "base.h",
     "a file could not be created, read or written") {
  odo_error error = {sizeof error, 0, ""};
  odo_recording* recording = NULL;
  odo_recorder* recorder = NULL;
  odo_barometer sample;
  FILE* full;
  odo_string path = string_of(case_file(""));
  EXPECT(odo.recording_open(&path, &recording, &error), ODO_E_IO);
  CHECK(!recording && error.message[0], "there is a recording, or no reason");
  for (int i = 0; i < 2; ++i) {
    error.struct_size = sizeof error, error.message[0] = 0;
    EXPECT(odo.recorder_create(&path, &recorder, &error), ODO_E_IO);
    CHECK(!recorder && error.message[0], "there is a recorder, or no reason");
    path = string_of(case_file("no_folder/walk.odo"));
  }
  full = fopen("/dev/full", "wb");
  if (!full) skip_case("the system has no /dev/full");
  fclose(full);
  path = string_of("/dev/full");
  EXPECT(odo.recorder_create(&path, &recorder, NULL), ODO_OK);
  put_barometer(&sample, T0);
  EXPECT(odo.recorder_write(recorder, &sample.header, NULL, 0), ODO_E_IO);
  EXPECT(odo.recorder_close(recorder), ODO_E_IO);
}

CASE("files that are no recordings are refused with a reason", "recording.h",
     "On failure *recording is null and `error`, which may be null, has the reason: ODO_E_NOT_FOUND, ODO_E_IO, "
     "ODO_E_DATA, ODO_E_VERSION.") {
  static const char* const texts[] = {"", "hello", "ODOREC1\n", "PK\3\4 and so on and so on"};
  odo_string nowhere;
  odo_error error = {sizeof error, 0, ""};
  odo_recording* recording = NULL;
  file content;
  int32_t loss;
  nowhere = string_of(case_file("nowhere.odo"));
  EXPECT(odo.recording_open(&nowhere, &recording, &error), ODO_E_NOT_FOUND);
  CHECK(!recording && error.message[0], "there is a recording, or no reason");
  for (size_t i = 0; i < COUNT_OF(texts); ++i) {
    const char* path = case_file("text.odo");
    memcpy(content.bytes, texts[i], strlen(texts[i]));
    write_file(path, &content, strlen(texts[i]));
    CHECK(read_all(path, &loss) <= 0 && loss == ODO_E_DATA, "\"%s\" is a recording: %s", texts[i], status_name(loss));
  }
}

CASE("closing null does nothing", "recording.h", "Null is allowed.") {
  odo.recording_close(NULL);
  EXPECT(odo.recorder_close(NULL), ODO_OK);
  EXPECT(odo.recording_open(NULL, NULL, NULL), ODO_E_ARGUMENT);
  EXPECT(odo.recorder_create(NULL, NULL, NULL), ODO_E_ARGUMENT);
}
