/* SPDX-License-Identifier: Apache-2.0
 *
 * Runs the C blocks of README.md and docs/embed.md, which the build puts into BLOCKS: twenty seconds of a phone that
 * somebody carries.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include BLOCKS

static int in_front;
static void draw(const odo_anchor* anchor) {
  in_front += anchor->p_view[2] > 0 && strcmp(anchor->name, "a label") == 0;
}

int main(int argc, char** argv) {
  static const char config[] =
      "odograph: 1\nattitude: {plugin: attitude/vqf}\nstep_estimator: {plugin: step/renaudin2012}\n"
      "coupling: {type: inertial}\nnavigation:\n  origin: {latitude: 0.8 rad, longitude: 0.1 rad, height: 300 m}\n"
      "  start: {position: [0 m, 0 m, 0 m], heading: 0 rad}\n";
  odo_session_options options;
  odo_session* session = NULL;
  odo_error error;
  odo_pose pose;
  int i, drawn = 0;
  int64_t t_ns = 0;
  memset(&options, 0, sizeof options);
  memset(&error, 0, sizeof error);
  options.struct_size = sizeof options;
  options.run = ODO_RUN_REPLAY;
  options.config_text.data = config, options.config_text.size = sizeof config - 1;
  options.plugin_path.data = argv[argc - 1], options.plugin_path.size = strlen(argv[argc - 1]);
  error.struct_size = sizeof error;
  if (odo_session_create(&options, &session, &error) != ODO_OK) return fprintf(stderr, "%s\n", error.message), 2;
  for (i = 0; i < 2000; ++i) {
    const double t = i * 0.01;
    const double gyro[3] = {0.02 * sin(6.0 * t), 0.0, 0.05 * sin(3.0 * t)};
    const double accel[3] = {0.0, 9.81 + 2.0 * sin(6.2832 * 2.0 * t), 0.3};
    t_ns = 1000000000 + (int64_t)i * 10000000;
    on_imu(session, t_ns, gyro, accel, t_ns, &pose);
    if (i == 1000 && (label_what_is_ahead(session, t_ns) == 0 || put_up_a_sign(session, 0.8, 0.1) == 0)) return 3;
    if (i > 1000 && i % 2 == 0) drawn += draw_anchors(session, t_ns, draw);
  }
  printf("%d anchors drawn, %d in front\n", drawn, in_front);
  odo_session_destroy(session);
  return drawn == 499 && in_front > 0 && (pose.header.flags & ODO_POSE_METRIC) != 0
             ? 0
             : 1; /* the sign waits for ground that nobody knows */
}
