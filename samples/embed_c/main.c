/* SPDX-License-Identifier: Apache-2.0
 *
 * The smallest app: creates a session from a YAML file, pushes IMU samples and prints poses and steps. The samples are
 * twenty seconds of a phone that bobs twice a second, as in a walk.
 *
 *   embed_c pipeline.yaml
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include <odograph/layout.h>
#include <odograph/odograph.h>

static void on_event(void* user, const odo_header* event) {
  if (event->type == ODO_TYPE_STEP) {
    const odo_step* step = (const odo_step*)event;
    ++*(int*)user;
    printf("step %u: %.2f m, %.2f Hz, %s\n", step->index, step->length_m, step->frequency_hz,
           odo_mode_text(step->mode));
  }
}

int main(int argc, char** argv) {
  odo_session_options options;
  odo_session* session = NULL;
  odo_error error;
  const uint32_t wanted = ODO_TYPE_STEP;
  odo_pose pose;
  int steps = 0;
  int i;

  if (argc != 2) {
    fprintf(stderr, "usage: %s pipeline.yaml\n", argv[0]);
    return 2;
  }
  memset(&options, 0, sizeof options);
  options.struct_size = sizeof options;
  options.run = ODO_RUN_REPLAY; /* an app on a phone uses ODO_RUN_LIVE */
  options.config_path.data = argv[1];
  options.config_path.size = strlen(argv[1]);
  memset(&error, 0, sizeof error);
  error.struct_size = sizeof error;
  if (odo_session_create(&options, &session, &error) != ODO_OK) {
    fprintf(stderr, "%s\n", error.message);
    return 2;
  }
  odo_session_set_callback(session, &wanted, 1, on_event, &steps);

  for (i = 0; i < 2000; ++i) {
    const double t = i * 0.01;
    const double gyro[3] = {0.02 * sin(6.0 * t), 0.0, 0.05 * sin(3.0 * t)};
    const double accel[3] = {0.0, 9.81 + 2.0 * sin(6.2832 * 2.0 * t), 0.3};
    odo_session_push_imu(session, 1000000000 + (int64_t)i * 10000000, gyro, accel);
  }
  odo_session_flush(session);

  memset(&pose, 0, sizeof pose);
  pose.header.struct_size = sizeof pose;
  if (odo_session_get_pose(session, ODO_TIME_LATEST, &pose) == ODO_OK)
    printf("Odograph %s: %s at north %.2f m, east %.2f m after %.2f m\n", odo_version(), odo_state_text(pose.state),
           pose.p_n[0], pose.p_n[1], pose.distance_m);
  odo_session_destroy(session);
  return steps > 30 && pose.distance_m > 15.0 ? 0 : 1;
}
