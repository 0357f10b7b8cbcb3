/* SPDX-License-Identifier: Apache-2.0
 *
 * A live app as on a phone, in C99: separate gyroscope at 200 Hz and accelerometer at 104 Hz, a camera that starts a
 * second late, moves its autofocus and fails for two seconds, borrowed pictures without copies, poses predicted 30 ms
 * ahead for the screen, reports for the user, and estimates saved for the next run.
 *
 *   live pipeline.yaml [recording.odo]     # the second: records everything that is pushed
 */
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <odograph/anchor.h>
#include <odograph/recording.h>

#define WIDTH 64
#define HEIGHT 48
#define SECONDS 12

static int steps, reports; /* written on the library's thread, read after a flush */
static int lent;           /* under the lock */
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;

/* Called on the library's own thread. */
static void on_event(void* user, const odo_header* event) {
  (void)user;
  if (event->type == ODO_TYPE_STEP) ++steps;
  if (event->type == ODO_TYPE_REPORT) {
    const odo_report* report = (const odo_report*)(const void*)event;
    ++reports;
    printf("%s: %s\n", report->plugin, report->text);
  }
}

/* A picture of the camera's pool; the library returns it on any thread. */
struct picture {
  int holds;
  uint8_t pixels[WIDTH * HEIGHT];
};

static int32_t retain(void* owner) {
  pthread_mutex_lock(&lock);
  ++((struct picture*)owner)->holds;
  pthread_mutex_unlock(&lock);
  return ODO_OK;
}

static void release(void* owner) {
  struct picture* picture = (struct picture*)owner;
  int last;
  pthread_mutex_lock(&lock);
  last = --picture->holds == 0;
  lent -= last;
  pthread_mutex_unlock(&lock);
  if (last) free(picture);
}

static void push(odo_session* session, odo_recorder* recorder, const odo_header* sample) {
  odo_session_push(session, sample);
  if (recorder) odo_recorder_write(recorder, sample, NULL, 0); /* a frame's picture would be encoded here */
}

static void push_inertial(odo_session* session, odo_recorder* recorder, int64_t t_ns, uint32_t which, double t) {
  odo_imu imu;
  memset(&imu, 0, sizeof imu);
  imu.header.struct_size = sizeof imu;
  imu.header.type = ODO_TYPE_IMU;
  imu.header.t_ns = t_ns;
  imu.header.flags = which;
  imu.gyro_b[2] = 0.1 * sin(3 * t);
  imu.accel_b[1] = 9.81 + 2.2 * sin(12 * t);
  push(session, recorder, &imu.header);
}

static void push_frame(odo_session* session, odo_recorder* recorder, int64_t t_ns, int number) {
  struct picture* picture = (struct picture*)malloc(sizeof *picture);
  odo_frame frame;
  if (!picture) return;
  memset(picture->pixels, 90 + number % 50, sizeof picture->pixels);
  picture->holds = 1;
  pthread_mutex_lock(&lock);
  ++lent;
  pthread_mutex_unlock(&lock);
  memset(&frame, 0, sizeof frame);
  frame.header.struct_size = sizeof frame;
  frame.header.type = ODO_TYPE_FRAME;
  frame.header.t_ns = t_ns;
  frame.header.flags = ODO_FRAME_INTRINSICS;
  frame.format = ODO_FORMAT_GREY8;
  frame.width = WIDTH, frame.height = HEIGHT;
  frame.planes[0].data = picture->pixels;
  frame.planes[0].row_stride = WIDTH, frame.planes[0].pixel_stride = 1;
  frame.fx = frame.fy = 60 * (1 + 0.03 * sin(0.2 * number)); /* per frame, as from ARCore and ARKit */
  frame.cx = 31.5, frame.cy = 23.5;
  frame.loan.owner = picture;
  frame.loan.retain = retain;
  frame.loan.release = release;
  push(session, recorder, &frame.header);
  release(picture); /* the app's own reference */
}

static void push_calibration(odo_session* session, odo_recorder* recorder, int64_t t_ns) {
  odo_calibration calibration;
  memset(&calibration, 0, sizeof calibration);
  calibration.header.struct_size = sizeof calibration;
  calibration.header.type = ODO_TYPE_CALIBRATION;
  calibration.header.t_ns = t_ns;
  calibration.model = ODO_CAMERA_PINHOLE;
  calibration.width = WIDTH, calibration.height = HEIGHT;
  calibration.fx = calibration.fy = 60, calibration.cx = 31.5, calibration.cy = 23.5;
  push(session, recorder, &calibration.header);
}

/* Saves what the session has estimated to memory; the app keeps it in a file for each user. */
static void* learnt(odo_session* session, int64_t* size) {
  void* data;
  *size = odo_session_save(session, NULL, 0);
  data = *size > 0 ? malloc((size_t)*size) : NULL;
  if (data && odo_session_save(session, data, (uint64_t)*size) != *size) *size = 0;
  return data;
}

/* Places the app's sign 2 m above the ground at a geodetic position, unless odo_session_load restored it.
 * Returns the number of anchors. */
static int64_t put_up_sign(odo_session* session) {
  uint64_t ids[8], id;
  const int64_t count = odo_anchor_list(session, ids, 8);
  odo_anchor anchor;
  odo_anchor_place place;
  int64_t i;
  for (i = 0; i < count && i < 8; ++i) {
    memset(&anchor, 0, sizeof anchor);
    anchor.struct_size = sizeof anchor;
    if (odo_anchor_get(session, ids[i], ODO_WORLD_CORRECTED, ODO_TIME_LATEST, &anchor) == ODO_OK &&
        strcmp(anchor.name, "the sign") == 0)
      return count;
  }
  memset(&place, 0, sizeof place);
  place.struct_size = sizeof place;
  place.kind = ODO_ANCHOR_GEODETIC;
  place.latitude_rad = 0.84, place.longitude_rad = 0.2, place.height_m = 2;
  place.height_above = ODO_HEIGHT_TERRAIN;
  place.name.data = "the sign", place.name.size = 8;
  odo_anchor_create(session, &place, &id);
  return odo_anchor_list(session, NULL, 0);
}

static int run(odo_session* session, odo_recorder* recorder) {
  int64_t t_ns, next_gyro = 0, next_accel = 0, next_frame = 1000000000; /* the camera starts late */
  int frames = 0, poses = 0;
  for (t_ns = 0; t_ns < SECONDS * (int64_t)1000000000; t_ns += 1000000) { /* in an app the sensors call */
    const double t = 1e-9 * (double)t_ns;
    if (t_ns >= next_gyro) push_inertial(session, recorder, t_ns, ODO_IMU_GYRO, t), next_gyro += 5000000;
    if (t_ns >= next_accel) push_inertial(session, recorder, t_ns, ODO_IMU_ACCEL, t), next_accel += 9615385;
    if (t_ns >= next_frame) {
      const int failed = t > 6 && t < 8; /* another app uses the camera */
      if (frames == 0) push_calibration(session, recorder, t_ns);
      if (!failed) push_frame(session, recorder, t_ns, frames++);
      next_frame += 33333333;
    }
    if (t_ns % 16000000 == 0) { /* screen refresh */
      odo_pose pose;
      memset(&pose, 0, sizeof pose);
      pose.header.struct_size = sizeof pose;
      if (odo_session_get_smooth_pose(session, t_ns + 30000000, &pose) == ODO_OK) ++poses;
    }
    if (t_ns % 500000000 == 0)
      odo_session_flush(session); /* simulated time does not wait: a live app never needs this */
  }
  odo_session_flush(session);
  printf("%d frames, %d poses for the screen, %d steps, %d reports\n", frames, poses, steps, reports);
  return poses > 0 && frames > 0;
}

int main(int argc, char** argv) {
  const uint32_t wanted[] = {ODO_TYPE_STEP, ODO_TYPE_REPORT};
  odo_session_options options;
  odo_session* session;
  odo_recorder* recorder = NULL;
  odo_error error;
  odo_string file;
  void* state;
  int64_t size;
  int good;

  if (argc < 2) return fprintf(stderr, "usage: %s pipeline.yaml [recording.odo]\n", argv[0]), 2;
  memset(&options, 0, sizeof options);
  options.struct_size = sizeof options;
  options.run = ODO_RUN_LIVE;
  options.config_path.data = argv[1], options.config_path.size = strlen(argv[1]);
  memset(&error, 0, sizeof error);
  error.struct_size = sizeof error;
  if (odo_session_create(&options, &session, &error) != ODO_OK) return fprintf(stderr, "%s\n", error.message), 2;
  odo_session_set_callback(session, wanted, 2, on_event, NULL);
  if (argc > 2) {
    file.data = argv[2], file.size = strlen(argv[2]);
    if (odo_recorder_create(&file, &recorder, &error) != ODO_OK) fprintf(stderr, "%s\n", error.message);
  }
  good = run(session, recorder);
  odo_recorder_close(recorder);

  if (put_up_sign(session) != 1) good = 0;
  state = learnt(session, &size);
  odo_session_destroy(session);
  if (state && odo_session_create(&options, &session, &error) == ODO_OK) { /* the next run */
    if (odo_session_load(session, state, (uint64_t)size) != ODO_OK) good = 0;
    if (put_up_sign(session) != 1) good = 0; /* it was restored */
    odo_session_destroy(session);
  }
  free(state);
  printf("%d bytes of saved state, %d pictures still borrowed\n", (int)size, lent);
  return good && lent == 0 ? 0 : 1;
}
