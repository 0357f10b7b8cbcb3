/* SPDX-License-Identifier: Apache-2.0
 *
 * An app for the growth matrix, built with today's headers and, with ODO_TEST_GROWN, with those of a later version. It
 * loads the library at run time:
 *   growth_app LIBRARY write RECORDING
 *   growth_app LIBRARY replay RECORDING PLUGIN_FOLDER
 * and prints the result in one line. */
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <odograph/messages.h>
#include <odograph/recording.h>

#define WIFI ODO_TYPE_VENDOR(9, 1)

struct wifi {
  odo_header header;
  double rssi_dbm[300]; /* larger than any message of the library */
};

static struct {
  int attitudes, grown;
  double magnetometer_seen, vendor_size_seen, attitude_grown;
} seen;

static void on_event(void* user, const odo_header* event) {
  const odo_attitude* attitude = (const odo_attitude*)(const void*)event;
  (void)user;
  if (event->type != ODO_TYPE_ATTITUDE) return;
  ++seen.attitudes;
  seen.magnetometer_seen = attitude->gyro_bias_b[1];
  seen.vendor_size_seen = attitude->gyro_bias_b[2];
#ifdef ODO_TEST_GROWN
  if (ODO_HAS(attitude, grown)) {
    ++seen.grown;
    seen.attitude_grown = attitude->grown[0];
  }
#endif
}

static void* load(void* library, const char* name) {
  void* found = dlsym(library, name);
  if (!found) fprintf(stderr, "%s is missing\n", name), exit(2);
  return found;
}
#define LOAD(name) *(void**)(&name) = load(library, "odo_" #name)

static int write_recording(void* library, const char* path) {
  int32_t (*recorder_create)(const odo_string*, odo_recorder**, odo_error*);
  int32_t (*recorder_write)(odo_recorder*, const odo_header*, const void*, uint64_t);
  int32_t (*recorder_close)(odo_recorder*);
  odo_string file;
  odo_recorder* recorder;
  int32_t worst = ODO_OK;
  int i;
  LOAD(recorder_create);
  LOAD(recorder_write);
  LOAD(recorder_close);
  file.data = path, file.size = strlen(path);
  if (recorder_create(&file, &recorder, NULL) != ODO_OK) return 3;
  for (i = 0; i < 300; ++i) {
    odo_imu imu;
    odo_magnetometer field;
    struct wifi wifi;
    memset(&imu, 0, sizeof imu), memset(&field, 0, sizeof field), memset(&wifi, 0, sizeof wifi);
    imu.header.struct_size = sizeof imu, imu.header.type = ODO_TYPE_IMU;
    imu.header.t_ns = 1000000000 + i * (int64_t)10000000;
    imu.header.flags = ODO_IMU_GYRO | ODO_IMU_ACCEL;
    imu.accel_b[2] = 9.81;
    field.header.struct_size = sizeof field, field.header.type = ODO_TYPE_MAGNETOMETER;
    field.header.t_ns = imu.header.t_ns;
    field.field_b[0] = 2e-5;
    wifi.header.struct_size = sizeof wifi, wifi.header.type = WIFI, wifi.header.t_ns = imu.header.t_ns;
#ifdef ODO_TEST_GROWN
    imu.grown[0] = 1.5, field.grown[0] = 2.5;
#endif
    worst |= recorder_write(recorder, &imu.header, NULL, 0);
    worst |= recorder_write(recorder, &field.header, NULL, 0);
    if (i % 50 == 0) worst |= recorder_write(recorder, &wifi.header, NULL, 0);
  }
  return recorder_close(recorder) == ODO_OK && worst == ODO_OK ? 0 : 4;
}

static int replay(void* library, const char* path, const char* plugins) {
  static const char config[] = "odograph: 1\nattitude:\n  plugin: test/growth\n  parameters: {answer: 42}\n";
  int32_t (*recording_open)(const odo_string*, odo_recording**, odo_error*);
  int32_t (*recording_next)(odo_recording*, const odo_header**, const void**, uint64_t*);
  void (*recording_close)(odo_recording*);
  int32_t (*session_create)(const odo_session_options*, odo_session**, odo_error*);
  int32_t (*session_set_callback)(odo_session*, const uint32_t*, uint32_t, odo_callback, void*);
  int32_t (*session_push)(odo_session*, const odo_header*);
  int32_t (*session_flush)(odo_session*);
  int32_t (*session_get_pose)(odo_session*, int64_t, odo_pose*);
  int32_t (*session_get_statistics)(odo_session*, odo_statistics*);
  void (*session_destroy)(odo_session*);
  odo_session_options options;
  odo_error error;
  odo_string file;
  odo_recording* recording;
  odo_session* session;
  odo_statistics statistics;
  odo_pose pose;
  const odo_header* message;
  int32_t worst = ODO_OK;
  LOAD(recording_open);
  LOAD(recording_next);
  LOAD(recording_close);
  LOAD(session_create);
  LOAD(session_set_callback);
  LOAD(session_push);
  LOAD(session_flush);
  LOAD(session_get_pose);
  LOAD(session_get_statistics);
  LOAD(session_destroy);
  memset(&options, 0, sizeof options), memset(&error, 0, sizeof error);
  memset(&statistics, 0, sizeof statistics), memset(&pose, 0, sizeof pose);
  error.struct_size = sizeof error;
  statistics.struct_size = sizeof statistics;
  pose.header.struct_size = sizeof pose;
  options.struct_size = sizeof options, options.run = ODO_RUN_REPLAY;
  options.config_text.data = config, options.config_text.size = sizeof config - 1;
  options.plugin_path.data = plugins, options.plugin_path.size = strlen(plugins);
  file.data = path, file.size = strlen(path);
  if (recording_open(&file, &recording, &error) != ODO_OK || session_create(&options, &session, &error) != ODO_OK) {
    fprintf(stderr, "%s\n", error.message);
    return 3;
  }
  session_set_callback(session, NULL, ODO_ALL_EVENTS, on_event, NULL);
  while (recording_next(recording, &message, NULL, NULL) == ODO_OK) worst |= session_push(session, message);
  session_flush(session);
  session_get_statistics(session, &statistics);
  printf(
      "worst %d, processed %llu, faults %llu, unknown %llu, attitudes %d, field %g, vendor %g, answer %g in %d, pose "
      "%d\n",
      (int)worst, (unsigned long long)statistics.processed, (unsigned long long)statistics.plugin_faults,
      (unsigned long long)statistics.unknown, seen.attitudes, seen.magnetometer_seen, seen.vendor_size_seen,
      seen.attitude_grown, seen.grown, (int)session_get_pose(session, ODO_TIME_LATEST, &pose));
  session_destroy(session);
  recording_close(recording);
  return 0;
}

int main(int argc, char** argv) {
  void* library = argc > 3 ? dlopen(argv[1], RTLD_NOW | RTLD_LOCAL) : NULL;
  if (!library) return fprintf(stderr, "%s\n", argc > 3 ? dlerror() : "usage: see the source"), 2;
  if (strcmp(argv[2], "write") == 0) return write_recording(library, argv[3]);
  return argc > 4 ? replay(library, argv[3], argv[4]) : 2;
}
