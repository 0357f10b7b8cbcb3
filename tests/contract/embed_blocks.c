/* SPDX-License-Identifier: Apache-2.0
 *
 * Runs the C blocks of README.md and docs/embed.md, which the build puts into BLOCKS, on twenty seconds of a walk.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include BLOCKS

/* Without fix/map in the config there is nothing to save, and a file of something else is refused. */
static int maps_are_refused(odo_session* session) {
  return !save_place(session, "no_map") && !load_place(session, "no map", 6);
}

static int in_front; /* without a camera the pose is the body's, whose z axis points to the user */
static void draw(const odo_anchor* anchor) {
  in_front += anchor->p_view[2] < 0 && strcmp(anchor->name, "a label") == 0;
}

/* Rotation matrix of a unit quaternion w, x, y, z, row by row. */
static void matrix_of(const double* q, double* R) {
  const double w = q[0], x = q[1], y = q[2], z = q[3];
  const double m[9] = {1 - 2 * (y * y + z * z), 2 * (x * y - w * z),     2 * (x * z + w * y),
                       2 * (x * y + w * z),     1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                       2 * (x * z - w * y),     2 * (y * z + w * x),     1 - 2 * (x * x + y * y)};
  memcpy(R, m, sizeof m);
}

/* The platform's rotation with exchanged world rows and the camera's y and z reversed, by matrices. */
static int platform_poses_are_converted(void) {
  static const double quaternions[3][4] = {{1, 0, 0, 0}, {0.5, -0.5, 0.1, 0.7}, {0.2, 0.8, -0.4, 0.4}};
  const double p[3] = {1, 2, 3};
  int k, i, c;
  for (k = 0; k < 3; ++k) {
    odo_platform_pose pose;
    double R[9], converted[9];
    memset(&pose, 0, sizeof pose);
    set_platform_pose(&pose, quaternions[k], p);
    matrix_of(quaternions[k], R);
    matrix_of(pose.q_w, converted);
    for (i = 0; i < 3; ++i)
      for (c = 0; c < 3; ++c) {
        const double exchanged = i == 0 ? -R[6 + c] : i == 1 ? R[c] : -R[3 + c];
        if (fabs(converted[3 * i + c] - (c == 0 ? exchanged : -exchanged)) > 1e-12) return 0;
      }
    if (pose.p_w[0] != -3 || pose.p_w[1] != 1 || pose.p_w[2] != -2) return 0;
  }
  return 1;
}

int main(int argc, char** argv) {
  static const char config[] =
      "odograph: 1\nattitude: {plugin: attitude/vqf}\nstep_estimator: {plugin: step/renaudin2012}\n"
      "coupling: {type: localizer}\nnavigation:\n  origin: {latitude: 0.8 rad, longitude: 0.1 rad, height: 300 m}\n"
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
    const double turning = i > 1100 && i <= 1300 ? 1.5708 : 0.0; /* by 180 degrees: the label is behind at first */
    const double gyro[3] = {0.02 * sin(6.0 * t), turning, 0.05 * sin(3.0 * t)};
    const double accel[3] = {0.0, 9.81 + 2.0 * sin(6.2832 * 2.0 * t), 0.3};
    t_ns = 1000000000 + (int64_t)i * 10000000;
    on_imu(session, t_ns, gyro, accel, t_ns, &pose);
    if (i == 1000 && place_where_touched(session, t_ns, 10, 10) != 0) return 4; /* there is no camera */
    if (i == 1000 && (label_what_is_ahead(session, t_ns) == 0 || put_up_a_sign(session, 0.8, 0.1) == 0)) return 3;
    if (i == 1001 && put_up_a_sign(session, 0.8, 0.1) != find_anchor(session, "the sign")) return 4;
    if (i > 1000 && i % 2 == 0) drawn += draw_anchors(session, t_ns, draw);
  }
  printf("%d anchors drawn, %d in front\n", drawn, in_front);
  if (odo_anchor_list(session, NULL, 0) != 2 || !platform_poses_are_converted()) return 5;
  if (!maps_are_refused(session)) return 6;
  odo_session_destroy(session);
  return drawn > 10 && drawn < 490 && in_front == drawn && (pose.header.flags & ODO_POSE_METRIC) != 0
             ? 0
             : 1; /* the sign waits for ground, which is unknown */
}
