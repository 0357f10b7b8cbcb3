/* SPDX-License-Identifier: Apache-2.0
 *
 * An app with statically linked plugins, as on iOS and in a browser: three plugins are linked in and registered, the
 * config is a string, and the program needs no files. It simulates a walk of twenty seconds and prints every pose.
 *
 *   static_c                  the linked plugins
 *   static_c PLUGIN_FOLDER    the same plugins as shared libraries: the same poses to the last digit
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include <odograph/odograph.h>

int32_t ODO_CALL odo_plugin_entry_attitude_vqf(const struct odo_host* host, struct odo_plugin* out);
int32_t ODO_CALL odo_plugin_entry_step_weinberg2002(const struct odo_host* host, struct odo_plugin* out);
int32_t ODO_CALL odo_plugin_entry_fix_waypoint(const struct odo_host* host, struct odo_plugin* out);

static const odo_plugin_entry entries[] = {odo_plugin_entry_attitude_vqf, odo_plugin_entry_step_weinberg2002,
                                           odo_plugin_entry_fix_waypoint};

static const char config[] =
    "odograph: 1\n"
    "attitude: {plugin: attitude/vqf}\n"
    "step_estimator: {plugin: step/weinberg2002, parameters: {k: 0.4}}\n"
    "absolute_fixers: [{plugin: fix/waypoint, parameters: {use: all}}]\n";

static void on_pose(void* user, const odo_header* event) {
  const odo_pose* pose = (const odo_pose*)event;
  ++*(int*)user;
  printf("%lld %.17g %.17g %.17g %.17g %.17g %.17g %.17g\n", (long long)event->t_ns, pose->p_n[0], pose->p_n[1],
         pose->p_n[2], pose->q_n[0], pose->q_n[1], pose->q_n[2], pose->q_n[3]);
}

static int register_all(odo_error* error) {
  for (size_t i = 0; i < sizeof entries / sizeof entries[0]; ++i)
    if (odo_register_plugin(entries[i], error) != ODO_OK) return 0;
  return 1;
}

static void walk(odo_session* session) {
  for (int i = 0; i < 2000; ++i) {
    const double t = i * 0.01;
    const double gyro[3] = {0.02 * sin(6.0 * t), 0.0, 0.05 * sin(3.0 * t)};
    const double accel[3] = {0.0, 9.81 + 2.0 * sin(6.2832 * 2.0 * t), 0.3};
    const int64_t t_ns = 1000000000 + (int64_t)i * 10000000;
    odo_session_push_imu(session, t_ns, gyro, accel);
    if (i % 500 == 250) { /* the user confirms a position */
      odo_waypoint place;
      memset(&place, 0, sizeof place);
      place.header.struct_size = sizeof place;
      place.header.type = ODO_TYPE_WAYPOINT;
      place.header.t_ns = t_ns;
      place.p_n[0] = t;
      place.sigma_m = 0.5;
      odo_session_push(session, &place.header);
    }
  }
  odo_session_flush(session);
}

int main(int argc, char** argv) {
  odo_session_options options;
  odo_session* session = NULL;
  odo_error error;
  const uint32_t wanted = ODO_TYPE_POSE;
  int poses = 0;

  memset(&error, 0, sizeof error);
  error.struct_size = sizeof error;
  memset(&options, 0, sizeof options);
  options.struct_size = sizeof options;
  options.run = ODO_RUN_REPLAY; /* an app on a phone uses ODO_RUN_LIVE */
  options.config_text.data = config;
  options.config_text.size = sizeof config - 1;
  if (argc > 1) {
    options.plugin_path.data = argv[1];
    options.plugin_path.size = strlen(argv[1]);
  } else if (!register_all(&error)) {
    return fprintf(stderr, "%s\n", error.message), 2;
  }
  if (odo_session_create(&options, &session, &error) != ODO_OK) return fprintf(stderr, "%s\n", error.message), 2;
  odo_session_set_callback(session, &wanted, 1, on_pose, &poses);
  walk(session);
  odo_session_destroy(session);
  return poses > 30 ? 0 : 1;
}
