/* SPDX-License-Identifier: Apache-2.0
 *
 * An app for the growth matrix over every message, built with today's headers and with those of a later version:
 *   growth_app LIBRARY write RECORDING
 *   growth_app LIBRARY replay RECORDING CONFIG PLUGINS STATE HOST PLUGIN RECORDED
 * STATE and the map STATE.map are loaded if the files exist, otherwise written; a library of 1.0 has no maps. The last
 * three are the versions, old or new, of the library, the plugin and the recording. It prints the number of
 * combinations that pass, or those that fail. */
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>

#include <odograph/anchor.h>
#include <odograph/recording.h>

#include "every.h"

#ifdef ODO_TEST_GROWN
enum { kIsNew = 1 };
#else
enum { kIsNew = 0 };
#endif

static struct {
  double grown[MAX_ROWS];
  struct answer answer;
  int reports, elements, held, broken;
} seen;

static void expect(double found, double expected, const char* what) {
  if (found == expected) {
    ++seen.held;
  } else {
    ++seen.broken;
    printf("  %s: found %g, expected %g\n", what, found, expected);
  }
}

static void ODO_CALL on_event(void* user, const odo_header* event) {
  const uint32_t row = row_of(event->type);
  (void)user;
  if (event->type == ANSWER)
    odo_copy(&seen.answer, sizeof seen.answer, event);
  else if (row < MAX_ROWS)
    seen.grown[row] = grown_of(event);
  seen.elements += has_elements(event);
  if (event->type == ODO_TYPE_REPORT)
    seen.reports += strcmp(((const odo_report*)(const void*)event)->key, "every") == 0;
}

static void* library;
static void* load(const char* name) {
  void* found = dlsym(library, name);
  if (!found) fprintf(stderr, "%s is missing\n", name), exit(2);
  return found;
}
/* A function of the library under its own name, as a local. */
#define LOAD(result, name, parameters) \
  result(*name) parameters = NULL;     \
  *(void**)(&name) = load("odo_" #name)

static int write_recording(const char* path) {
  LOAD(int32_t, recorder_create, (const odo_string*, odo_recorder**, odo_error*));
  LOAD(int32_t, recorder_write, (odo_recorder*, const odo_header*, const void*, uint64_t));
  LOAD(int32_t, recorder_close, (odo_recorder*));
  odo_string file;
  odo_recorder* recorder;
  union message m;
  struct large large;
  int32_t worst = ODO_OK;
  file.data = path, file.size = strlen(path);
  if (recorder_create(&file, &recorder, NULL) != ODO_OK) return 3;
  for (int i = 0; i < 100; ++i) {
    const int64_t t_ns = 1000000000 + i * (int64_t)10000000;
    fill(&m, ODO_TYPE_IMU, t_ns), worst |= recorder_write(recorder, &m.header, NULL, 0);
    if (i != 50) continue;
    memset(&large, 0, sizeof large);
    large.header.struct_size = sizeof large, large.header.type = LARGE, large.header.t_ns = t_ns;
    worst |= recorder_write(recorder, &large.header, NULL, 0);
#define ROW(number, type, name, min_size)                                            \
  if (!ODO_IS_EVENT(number) && !ODO_IS_BORROWED(number) && (number) != ODO_TYPE_IMU) \
    fill(&m, number, t_ns), worst |= recorder_write(recorder, &m.header, NULL, 0);
    ODO_FOR_EACH_MESSAGE(ROW)
#undef ROW
  }
  return recorder_close(recorder) == ODO_OK && worst == ODO_OK ? 0 : 4;
}

static int32_t push_rest(int32_t (*push)(odo_session*, const odo_header*), odo_session* session) {
  static unsigned char pixels[64];
  union message m;
  odo_header question;
  int32_t worst = ODO_OK;
  fill(&m, ODO_TYPE_FRAME, 2000000000), m.frame.planes[0].data = pixels;
  worst |= push(session, &m.header);
  memset(&question, 0, sizeof question);
  question.struct_size = sizeof question, question.type = QUESTION, question.t_ns = 2100000000;
  worst |= push(session, &question);
  for (int i = 100; i < 130; ++i)
    fill(&m, ODO_TYPE_IMU, 1000000000 + i * (int64_t)10000000), worst |= push(session, &m.header);
  return worst;
}

static int32_t replay(odo_session* session, const char* path) {
  LOAD(int32_t, recording_open, (const odo_string*, odo_recording**, odo_error*));
  LOAD(int32_t, recording_next, (odo_recording*, const odo_header**, const void**, uint64_t*));
  LOAD(void, recording_close, (odo_recording*));
  LOAD(int32_t, session_push, (odo_session*, const odo_header*));
  LOAD(int32_t, session_flush, (odo_session*));
  const odo_header* message;
  odo_recording* recording;
  odo_string file;
  int32_t worst = ODO_OK;
  file.data = path, file.size = strlen(path);
  if (recording_open(&file, &recording, NULL) != ODO_OK) return ODO_E_DATA;
  while (recording_next(recording, &message, NULL, NULL) == ODO_OK) worst |= session_push(session, message);
  recording_close(recording);
  worst |= push_rest(session_push, session);
  return worst | session_flush(session);
}

typedef int32_t (*load_function)(odo_session*, const void*, uint64_t);
typedef int64_t (*save_function)(odo_session*, void*, uint64_t);

/* Loads a state or map if the file exists, otherwise returns 0. */
static int load_from(const char* path, odo_session* session, load_function load_it) {
  static char data[65536];
  FILE* file = fopen(path, "rb");
  if (!file) return 0;
  size_t size = fread(data, 1, sizeof data, file);
  fclose(file);
  expect(load_it(session, data, size), ODO_OK, path);
  return 1;
}

static void save_to(const char* path, odo_session* session, save_function save_it) {
  static char data[65536];
  FILE* file = fopen(path, "wb");
  const int64_t size = save_it(session, data, sizeof data);
  expect(file && size > 0 && fwrite(data, 1, (size_t)size, file) == (size_t)size, 1, path);
  if (file) fclose(file);
}

/* Outputs: written fields are within the stated size, which is common to both sides. */
static void check_outputs(odo_session* session, int host_is_new) {
  LOAD(int32_t, session_get_pose, (odo_session*, int64_t, odo_pose*));
  LOAD(int32_t, session_get_statistics, (odo_session*, odo_statistics*));
  LOAD(int32_t, session_last_error, (odo_session*, odo_error*));
  LOAD(int32_t, anchor_create, (odo_session*, const odo_anchor_place*, uint64_t*));
  LOAD(int32_t, anchor_get, (odo_session*, uint64_t, uint32_t, int64_t, odo_anchor*));
  const uint32_t added = kIsNew && !host_is_new ? 2 * sizeof(double) : 0;
  odo_pose pose;
  odo_statistics statistics;
  odo_error error;
  odo_anchor_place place;
  odo_anchor anchor;
  uint64_t id = 0;
  memset(&pose, 0, sizeof pose), memset(&statistics, 0, sizeof statistics), memset(&error, 0, sizeof error);
  memset(&place, 0, sizeof place), memset(&anchor, 0, sizeof anchor);
  pose.header.struct_size = sizeof pose, statistics.struct_size = sizeof statistics, error.struct_size = sizeof error;
  place.struct_size = sizeof place, anchor.struct_size = sizeof anchor;
  expect(session_get_pose(session, ODO_TIME_LATEST, &pose), ODO_OK, "odo_session_get_pose");
  expect(pose.header.struct_size, sizeof pose - added, "odo_pose.struct_size");
  expect(session_get_statistics(session, &statistics), ODO_OK, "odo_session_get_statistics");
  expect(statistics.struct_size, sizeof statistics - added, "odo_statistics.struct_size");
  expect((double)statistics.plugin_faults, 0, "plugin_faults");
  expect((double)statistics.unknown, 0, "unknown");
  session_last_error(session, &error);
  expect(error.struct_size, sizeof error - added, "odo_error.struct_size");
  place.kind = ODO_ANCHOR_GEODETIC, place.height_above = ODO_HEIGHT_ELLIPSOID;
  expect(anchor_create(session, &place, &id), ODO_OK, "odo_anchor_create");
  expect(anchor_get(session, id, ODO_WORLD_CORRECTED, ODO_TIME_LATEST, &anchor), ODO_OK, "odo_anchor_get");
  expect(anchor.struct_size, sizeof anchor - added, "odo_anchor.struct_size");
}

static void check_messages(int host_is_new, int plugin_is_new, int recorded_is_new, int has_points) {
  uint32_t row = 0;
#define ROW(number, type, name, min_size)                                                                             \
  if (!ODO_IS_EVENT(number)) {                                                                                        \
    const int writer_is_new = ODO_IS_BORROWED(number) ? kIsNew : recorded_is_new;                                     \
    const double passed = writer_is_new ? 1000.0 + number : -1.0;                                                     \
    if ((number) != ODO_TYPE_IMU) expect(seen.answer.grown[row], plugin_is_new ? passed : 0, #name " to the plugin"); \
  } else if (seen.grown[row] != -2) {                                                                                 \
    const int is_host = number == ODO_TYPE_POSE || number == ODO_TYPE_STATE || number == ODO_TYPE_REPORT;             \
    const double passed = is_host ? (host_is_new ? 0.0 : -1.0) : (plugin_is_new ? 1000.0 + number : -1.0);            \
    expect(seen.grown[row], kIsNew ? passed : 0, #name " to the app");                                                \
  } else if (number != ODO_TYPE_CORRECTION && (number < ODO_TYPE_POINTS || has_points)) {                             \
    expect(0, 1, #name " was given");                                                                                 \
  }                                                                                                                   \
  ++row;
  ODO_FOR_EACH_MESSAGE(ROW)
#undef ROW
}

static int run(char** argv) {
  LOAD(int32_t, session_create, (const odo_session_options*, odo_session**, odo_error*));
  LOAD(int32_t, session_set_callback, (odo_session*, const uint32_t*, uint32_t, odo_callback, void*));
  LOAD(void, session_destroy, (odo_session*));
  LOAD(int32_t, session_load, (odo_session*, const void*, uint64_t));
  LOAD(int64_t, session_save, (odo_session*, void*, uint64_t));
  load_function map_load;
  save_function map_save;
  char map_path[4096];
  const int host_is_new = strcmp(argv[7], "new") == 0, plugin_is_new = strcmp(argv[8], "new") == 0;
  const int recorded_is_new = strcmp(argv[9], "new") == 0;
  const int has_points = plugin_is_new || !getenv("ODO_GROWTH_ARCHIVE"); /* the archived plugin is of 1.0 */
  odo_session_options options;
  odo_error error;
  odo_session* session;
  for (int i = 0; i < (int)MAX_ROWS; ++i) seen.grown[i] = -2;
  memset(&options, 0, sizeof options), memset(&error, 0, sizeof error);
  error.struct_size = sizeof error;
  options.struct_size = sizeof options, options.run = ODO_RUN_REPLAY;
  options.config_text.data = argv[4], options.config_text.size = strlen(argv[4]);
  options.plugin_path.data = argv[5], options.plugin_path.size = strlen(argv[5]);
  if (session_create(&options, &session, &error) != ODO_OK) return printf("  %s\n", error.message), 3;
  session_set_callback(session, NULL, ODO_ALL_EVENTS, on_event, NULL);
  *(void**)(&map_load) = dlsym(library, "odo_map_load"), *(void**)(&map_save) = dlsym(library, "odo_map_save");
  snprintf(map_path, sizeof map_path, "%s.map", argv[6]);
  const int loaded = load_from(argv[6], session, session_load);
  const int map_loaded = map_load && load_from(map_path, session, map_load);
  expect(replay(session, argv[3]), ODO_OK, "the worst status");
  expect(seen.answer.header.type == ANSWER, 1, "an answer came");
  check_messages(host_is_new, plugin_is_new, recorded_is_new, has_points);
  expect(seen.answer.state, loaded ? 7 : 0, "saved state");
  expect(seen.answer.map, map_loaded ? 7 : 0, "saved map");
  /* odo.wake/1 is not offered to a plugin in a separate process. */
  expect(seen.answer.services, strstr(argv[4], "isolation: process") ? 15 : 31, "services");
  expect(seen.answer.large_size, sizeof(struct large), "size of a vendor's message");
  const int finds_surfaces = strstr(argv[4], "surface_finder") != NULL;
  expect(seen.reports, 1, "reports"); /* said once, by however many instances */
  expect(seen.elements, 2 * has_points + finds_surfaces, "an odo_points and each odo_surface with their elements");
  check_outputs(session, host_is_new);
  if (!loaded) save_to(argv[6], session, session_save);
  if (map_save && !has_points)
    expect((double)map_save(session, NULL, 0), 0, "a plugin of 1.0 has no map");
  else if (map_save && !map_loaded)
    save_to(map_path, session, map_save);
  session_destroy(session);
  printf("%d\n", seen.held);
  return seen.broken ? 1 : 0;
}

int main(int argc, char** argv) {
  library = argc > 3 ? dlopen(argv[1], RTLD_NOW | RTLD_LOCAL) : NULL;
  if (!library) return fprintf(stderr, "%s\n", argc > 3 ? dlerror() : "usage: see the source"), 2;
  if (strcmp(argv[2], "write") == 0) return write_recording(argv[3]);
  return argc == 10 ? run(argv) : 2;
}
