/* SPDX-License-Identifier: Apache-2.0
 *
 * The host's behaviour as promised by the headers, from the headers alone; abi_mutations.py breaks each promise in a
 * host. behaviour_app PLUGINS_OF_THE_TEST PLUGINS RECORDING prints each broken promise and returns 1 if there are
 * any. */
#define _POSIX_C_SOURCE 200809L
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>

#include <odograph/messages.h>
#include <odograph/recording.h>

static int broken;
static void promise(int kept, const char* what) {
  if (kept) return;
  ++broken;
  printf("broken: %s\n", what);
}

static struct {
  odo_session* session;
  odo_attitude attitude;
  int32_t flush_status;
  int corrections;
  double largest_correction_m, largest_jump_m;
  double expected_n[3];
  int has_pose;
} seen;

static double distance(const double* a, const double* b) {
  return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
}

static void on_correction(const odo_correction* event) {
  const double c = event->q_n[0] * event->q_n[0] - event->q_n[3] * event->q_n[3], s = 2 * event->q_n[0] * event->q_n[3];
  const double* p = seen.expected_n;
  const double moved[3] = {c * p[0] - s * p[1] + event->p_n[0], s * p[0] + c * p[1] + event->p_n[1],
                           p[2] + event->p_n[2]};
  const double by = distance(moved, p);
  ++seen.corrections;
  if (by > seen.largest_correction_m) seen.largest_correction_m = by;
  memcpy(seen.expected_n, moved, sizeof moved);
}

static void ODO_CALL on_event(void* user, const odo_header* event) {
  (void)user;
  seen.flush_status = odo_session_flush(seen.session);
  if (event->type == ODO_TYPE_ATTITUDE) odo_copy(&seen.attitude, sizeof seen.attitude, event);
  if (event->type == ODO_TYPE_CORRECTION) on_correction((const odo_correction*)(const void*)event);
  if (event->type == ODO_TYPE_POSE && (event->flags & ODO_POSE_POSITION)) {
    const odo_pose* pose = (const odo_pose*)(const void*)event;
    const double jump = seen.has_pose ? distance(pose->p_n, seen.expected_n) : 0;
    if (jump > seen.largest_jump_m) seen.largest_jump_m = jump;
    memcpy(seen.expected_n, pose->p_n, sizeof seen.expected_n);
    seen.has_pose = 1;
  }
}

static odo_session* create(const char* config, const char* plugins) {
  odo_session_options options;
  odo_error error;
  odo_session* session = NULL;
  memset(&options, 0, sizeof options), memset(&error, 0, sizeof error), memset(&seen, 0, sizeof seen);
  options.struct_size = sizeof options, options.run = ODO_RUN_REPLAY;
  options.config_text.data = config, options.config_text.size = strlen(config);
  options.plugin_path.data = plugins, options.plugin_path.size = strlen(plugins);
  error.struct_size = sizeof error;
  if (odo_session_create(&options, &session, &error) != ODO_OK) printf("%s\n", error.message);
  seen.session = session;
  if (session) odo_session_set_callback(session, NULL, ODO_ALL_EVENTS, on_event, NULL);
  return session;
}

static void push_imu(odo_session* session, int i) {
  const double t = 0.01 * i, gyro_b[3] = {0, 0, 0};
  const double accel_b[3] = {0.1, 0.4, 9.81 + 2.2 * sin(12 * t)};
  odo_session_push_imu(session, 1000000000 + i * (int64_t)10000000, gyro_b, accel_b);
}

static void check_plugin_border(const char* plugins) {
  odo_session* session = create("odograph: 1\nattitude:\n  plugin: test/behaviour\n", plugins);
  odo_barometer pressure;
  struct {
    odo_statistics known;
    double later[4];
  } statistics;
  int i;
  if (!session) {
    promise(0, "a session is created");
    return;
  }
  memset(&pressure, 0, sizeof pressure), memset(&statistics, 0, sizeof statistics);
  pressure.header.struct_size = sizeof pressure, pressure.header.type = ODO_TYPE_BAROMETER;
  pressure.header.flags = ODO_FLAG_HOST_MASK;
  pressure.header.t_ns = 1000000000, pressure.pressure_pa = 101325;
  promise(odo_session_push(session, &pressure.header) == ODO_OK, "an input with the host's bits is taken");
  for (i = 0; i < 100; ++i) push_imu(session, i);
  odo_session_flush(session);
  promise(seen.attitude.header.type == ODO_TYPE_ATTITUDE && seen.attitude.gyro_bias_b[2] > 0,
          "a plugin's events come out");
  promise(seen.attitude.gyro_bias_b[0] == 0, "the host's bits are cleared on push");
  promise((seen.attitude.header.flags & ODO_FLAG_HOST_MASK) == 0, "the host's bits are cleared on emit");
  promise(seen.attitude.gyro_bias_b[1] == ODO_E_STATE, "emit outside process returns ODO_E_STATE");
  promise(seen.flush_status == ODO_E_STATE, "flush within a callback returns ODO_E_STATE");
  pressure.header.type = ODO_TYPE_POSE;
  promise(odo_session_push(session, &pressure.header) == ODO_E_ARGUMENT, "an event is no input");
  pressure.header.type = 0x2000;
  promise(odo_session_push(session, &pressure.header) == ODO_E_ARGUMENT, "a reserved type is no input");
  statistics.known.struct_size = sizeof statistics;
  promise(odo_session_get_statistics(session, &statistics.known) == ODO_OK &&
              statistics.known.struct_size == sizeof(odo_statistics),
          "struct_size of an output is what was written");
  odo_session_destroy(session);
}

static void check_signals(const char* plugins) {
  struct sigaction action;
  odo_session* session = create("odograph: 1\nattitude:\n  plugin: test/behaviour\n", plugins);
  promise(session && sigaction(SIGSEGV, NULL, &action) == 0 && action.sa_handler == SIG_DFL,
          "no signal handler without the flag");
  odo_session_destroy(session);
}

/* GNSS at the start of a walk, and again after a minute: the track has drifted by metres. */
static void check_corrections(const char* plugins) {
  odo_session* session = create(
      "odograph: 1\nattitude:\n  plugin: attitude/vqf\nstep_estimator:\n  plugin: step/weinberg2002\n"
      "coupling:\n  type: localizer\nabsolute_fixers:\n  - plugin: fix/gnss\n",
      plugins);
  int i;
  if (!session) {
    promise(0, "a session is created");
    return;
  }
  for (i = 0; i < 6000; ++i) {
    odo_gnss gnss;
    push_imu(session, i);
    if (i % 100 || (i > 500 && i < 5000)) continue;
    memset(&gnss, 0, sizeof gnss);
    gnss.header.struct_size = sizeof gnss, gnss.header.type = ODO_TYPE_GNSS;
    gnss.header.t_ns = 1000000000 + i * (int64_t)10000000;
    gnss.header.flags = ODO_GNSS_POSITION | ODO_GNSS_HEIGHT | ODO_GNSS_COVARIANCE;
    gnss.latitude_rad = 0.8 + 0.012 * i / 6.37e6;
    gnss.longitude_rad = 0.1;
    gnss.covariance_n[0] = gnss.covariance_n[4] = gnss.covariance_n[8] = 1;
    odo_session_push(session, &gnss.header);
  }
  odo_session_flush(session);
  printf("%d corrections, the largest %.1f m; the largest step beside them %.2f m\n", seen.corrections,
         seen.largest_correction_m, seen.largest_jump_m);
  promise(seen.largest_correction_m > 1, "a fix corrects the track");
  promise(seen.largest_jump_m < 0.8, "a correction is published before the pose that it moved");
  odo_session_destroy(session);
}

static void check_recorder(const char* path) {
  odo_string file;
  odo_recorder* recorder = NULL;
  odo_header message;
  file.data = path, file.size = strlen(path);
  memset(&message, 0, sizeof message);
  message.struct_size = sizeof message, message.type = 0x1FFFF;
  if (odo_recorder_create(&file, &recorder, NULL) != ODO_OK) {
    promise(0, "a recording is created");
    return;
  }
  promise(odo_recorder_write(recorder, &message, NULL, 0) == ODO_E_ARGUMENT, "a reserved type is not recorded");
  odo_recorder_close(recorder);
}

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  check_signals(argv[1]);
  check_plugin_border(argv[1]);
  check_corrections(argv[2]);
  check_recorder(argv[3]);
  return broken ? 1 : 0;
}
