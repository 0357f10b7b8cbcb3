/* SPDX-License-Identifier: Apache-2.0
 *
 * Messages pushed by the cases, and the walk. */
#include "app.h"

void put_header(void* message, uint32_t size, uint32_t type, int64_t t_ns) {
  odo_header* header = (odo_header*)message;
  memset(message, 0, size);
  header->struct_size = size;
  header->type = type;
  header->t_ns = t_ns;
}

int32_t push(app* self, const void* message) { return odo.session_push(self->session, (const odo_header*)message); }

static void put_imu(void* out, int64_t t_ns) {
  odo_imu* imu = (odo_imu*)out;
  put_header(imu, sizeof *imu, ODO_TYPE_IMU, t_ns);
  imu->header.flags = ODO_IMU_GYRO | ODO_IMU_ACCEL;
  imu->accel_b[2] = -9.81; /* b's axes are n's */
}

int32_t push_rest(app* self, int64_t t_ns) {
  odo_imu imu;
  put_imu(&imu, t_ns);
  return push(self, &imu);
}

void push_rest_between(app* self, int64_t from_ns, int64_t to_ns) {
  for (int64_t t_ns = from_ns; t_ns < to_ns; t_ns += 10 * MS) EXPECT(push_rest(self, t_ns), ODO_OK);
}

void push_set_back(app* self, int64_t from_ns, int64_t to_ns) {
  for (int64_t t_ns = from_ns; t_ns < to_ns; t_ns += 10 * MS) {
    const int32_t status = push_rest(self, t_ns); /* the first ones appear late */
    CHECK(status == ODO_OK || (status == ODO_E_DISCARD && t_ns < from_ns + SECOND),
          "%lld ms after the clock was set back %s", (long long)((t_ns - from_ns) / MS), status_name(status));
  }
  app_flush(self);
}

void put_barometer(void* out, int64_t t_ns) {
  put_header(out, sizeof(odo_barometer), ODO_TYPE_BAROMETER, t_ns);
  ((odo_barometer*)out)->pressure_pa = 101325;
}

int32_t push_barometer(app* self, int64_t t_ns) {
  odo_barometer sample;
  put_barometer(&sample, t_ns);
  return push(self, &sample);
}

static void put_magnetometer(void* out, int64_t t_ns) {
  odo_magnetometer* field = (odo_magnetometer*)out;
  put_header(field, sizeof *field, ODO_TYPE_MAGNETOMETER, t_ns);
  field->field_b[0] = 20e-6, field->field_b[2] = 43e-6;
}

static void put_gnss(void* out, int64_t t_ns) {
  odo_gnss* gnss = (odo_gnss*)out;
  put_header(gnss, sizeof *gnss, ODO_TYPE_GNSS, t_ns);
  gnss->header.flags = ODO_GNSS_POSITION | ODO_GNSS_HEIGHT | ODO_GNSS_COVARIANCE;
  gnss->latitude_rad = 0.83, gnss->longitude_rad = 0.15, gnss->height_m = 400;
  gnss->covariance_n[0] = gnss->covariance_n[4] = gnss->covariance_n[8] = 9;
  gnss->satellites = 12;
}

void put_calibration(odo_calibration* out, uint32_t camera, int64_t t_ns) {
  put_header(out, sizeof *out, ODO_TYPE_CALIBRATION, t_ns);
  out->header.source = camera;
  out->model = ODO_CAMERA_PINHOLE;
  out->width = 64, out->height = 48;
  out->fx = out->fy = 60, out->cx = 31.5, out->cy = 23.5;
  out->q_b_c[0] = 1;
}

static void put_any_calibration(void* out, int64_t t_ns) { put_calibration((odo_calibration*)out, 0, t_ns); }

static void put_imu_noise(void* out, int64_t t_ns) {
  odo_imu_noise* noise = (odo_imu_noise*)out;
  put_header(noise, sizeof *noise, ODO_TYPE_IMU_NOISE, t_ns);
  noise->gyro_noise = 1e-4, noise->gyro_walk = 1e-5, noise->accel_noise = 1e-3, noise->accel_walk = 1e-4;
}

static void put_waypoint(void* out, int64_t t_ns) {
  odo_waypoint* waypoint = (odo_waypoint*)out;
  put_header(waypoint, sizeof *waypoint, ODO_TYPE_WAYPOINT, t_ns);
  waypoint->p_n[0] = 3, waypoint->sigma_m = 0.5;
}

static void put_earth_field(void* out, int64_t t_ns) {
  odo_earth_field* field = (odo_earth_field*)out;
  put_header(field, sizeof *field, ODO_TYPE_EARTH_FIELD, t_ns);
  field->header.flags = ODO_EARTH_FIELD_DECLINATION | ODO_EARTH_FIELD_INCLINATION | ODO_EARTH_FIELD_INTENSITY;
  field->declination_rad = 0.05, field->inclination_rad = 1.1, field->intensity_t = 48e-6;
}

static void put_platform_pose(void* out, int64_t t_ns) {
  odo_platform_pose* pose = (odo_platform_pose*)out;
  put_header(pose, sizeof *pose, ODO_TYPE_PLATFORM_POSE, t_ns);
  pose->header.flags = ODO_PLATFORM_POSE_COVARIANCE;
  pose->q_w[0] = 1;
  for (int i = 0; i < 6; ++i) pose->covariance[7 * i] = 0.01;
  pose->state = ODO_TRACKING;
}

static void put_range(void* out, int64_t t_ns) {
  odo_range* range = (odo_range*)out;
  put_header(range, sizeof *range, ODO_TYPE_RANGE, t_ns);
  range->transmitter = 7, range->range_m = 5, range->sigma_m = 0.1;
}

static void put_system_step(void* out, int64_t t_ns) {
  odo_system_step* step = (odo_system_step*)out;
  put_header(step, sizeof *step, ODO_TYPE_SYSTEM_STEP, t_ns);
  step->header.flags = ODO_SYSTEM_STEP_COUNT | ODO_SYSTEM_STEP_DISTANCE;
  step->count = 20, step->distance_m = 14;
}

#define KIND(type, name, put, field) \
  { ODO_TYPE_##type, sizeof(odo_##name), ODO_##type##_SIZE_MIN, "odo_" #name, put, offsetof(odo_##name, field) }
const sample_kind sample_kinds[] = {KIND(IMU, imu, put_imu, gyro_b),
                                    KIND(MAGNETOMETER, magnetometer, put_magnetometer, field_b),
                                    KIND(BAROMETER, barometer, put_barometer, pressure_pa),
                                    KIND(GNSS, gnss, put_gnss, latitude_rad),
                                    KIND(CALIBRATION, calibration, put_any_calibration, fx),
                                    KIND(IMU_NOISE, imu_noise, put_imu_noise, gyro_noise),
                                    KIND(WAYPOINT, waypoint, put_waypoint, p_n),
                                    KIND(EARTH_FIELD, earth_field, put_earth_field, declination_rad),
                                    KIND(PLATFORM_POSE, platform_pose, put_platform_pose, p_w),
                                    KIND(RANGE, range, put_range, range_m),
                                    KIND(SYSTEM_STEP, system_step, put_system_step, distance_m)};
const size_t sample_kind_count = COUNT_OF(sample_kinds);

void put_frame(odo_frame* out, uint32_t camera, int64_t t_ns) {
  static const uint8_t pixels[64 * 48];
  put_header(out, sizeof *out, ODO_TYPE_FRAME, t_ns);
  out->header.source = camera;
  out->format = ODO_FORMAT_GREY8;
  out->width = 64, out->height = 48;
  out->planes[0].data = pixels;
  out->planes[0].row_stride = 64, out->planes[0].pixel_stride = 1;
}

void put_fix(odo_fix* out, int64_t t_ns, double north_m) {
  put_header(out, sizeof *out, ODO_TYPE_FIX, t_ns);
  out->header.flags = ODO_FIX_NORTH | ODO_FIX_EAST | ODO_FIX_DOWN | ODO_FIX_COVARIANCE;
  out->p_n[0] = north_m;
  out->covariance_n[0] = out->covariance_n[4] = out->covariance_n[8] = 0.01;
}

/* ---- the walk ---- */
odo_fix walk_fix;
static int64_t last_motion_ns;

void walk_reset(void) { last_motion_ns = 0; }

static int32_t answer_imu(odo_instance* instance, const odo_header* message) {
  odo_attitude attitude;
  put_header(&attitude, sizeof attitude, ODO_TYPE_ATTITUDE, message->t_ns);
  attitude.header.flags = ODO_ATTITUDE_COVARIANCE;
  attitude.q_n_b[0] = 1;
  attitude.covariance_n[0] = attitude.covariance_n[4] = attitude.covariance_n[8] = 1e-4;
  return probe_emit(instance, &attitude);
}

static int32_t answer_frame(odo_instance* instance, const odo_header* message) {
  odo_vo_motion motion;
  const int64_t from_ns = last_motion_ns;
  last_motion_ns = message->t_ns;
  if (from_ns == 0) return ODO_OK;
  put_header(&motion, sizeof motion, ODO_TYPE_VO_MOTION, message->t_ns);
  motion.header.flags = ODO_VO_ROTATION | ODO_VO_TRANSLATION | ODO_VO_COVARIANCE | ODO_VO_METRIC;
  motion.t_from_ns = from_ns;
  motion.q_c0_c1[0] = 1;
  motion.p_c0_c1[0] = (double)(message->t_ns - from_ns) * 1e-9;
  for (int i = 0; i < 6; ++i) motion.covariance[7 * i] = 1e-4;
  motion.camera = message->source;
  motion.state = ODO_TRACKING;
  motion.tracked = motion.inliers = 100;
  return probe_emit(instance, &motion);
}

int32_t walk_message(odo_instance* instance, const odo_header* message) {
  if (message->type == ODO_TYPE_IMU && strcmp(instance->kind, ATTITUDE) == 0) return answer_imu(instance, message);
  if (message->type == ODO_TYPE_FRAME && strcmp(instance->kind, FRONTEND) == 0) return answer_frame(instance, message);
  if (message->type == ODO_TYPE_BAROMETER && strcmp(instance->kind, FIXER) == 0 && walk_fix.header.struct_size) {
    odo_fix fix = walk_fix;
    fix.header.t_ns = message->t_ns;
    walk_fix.header.struct_size = 0;
    return probe_emit(instance, &fix);
  }
  return ODO_OK;
}

void walk_second(app* self, int second) {
  const int64_t start_ns = T0 + second * SECOND;
  if (second == 0) {
    odo_calibration calibration;
    put_calibration(&calibration, 0, start_ns);
    calibration.header.flags = ODO_CALIBRATION_EXTRINSICS;
    EXPECT(push(self, &calibration), ODO_OK);
  }
  for (int64_t t_ns = start_ns; t_ns < start_ns + SECOND; t_ns += 10 * MS) {
    EXPECT(push_rest(self, t_ns), ODO_OK);
    if ((t_ns - start_ns) % (100 * MS) == 0) {
      odo_frame frame;
      put_frame(&frame, 0, t_ns);
      if (push(self, &frame) == ODO_E_EXHAUSTED) { /* a live session is slower */
        app_flush(self);
        EXPECT(push(self, &frame), ODO_OK);
      }
    }
  }
}

app* app_walk(int seconds) {
  hooks.on_message = walk_message;
  app* self = app_open(CAMERA_WALK, ODO_RUN_REPLAY);
  for (int second = 0; second < seconds; ++second) walk_second(self, second);
  app_flush(self);
  return self;
}

/* ---- loans ---- */
static int32_t ODO_CALL retain(void* owner) {
  lent* self = (lent*)owner;
  pthread_mutex_lock(&self->lock);
  int32_t status = self->refuse ? ODO_E_EXHAUSTED : ODO_OK;
  if (!self->refuse) ++self->retains;
  pthread_mutex_unlock(&self->lock);
  return status;
}

static void ODO_CALL release(void* owner) {
  lent* self = (lent*)owner;
  pthread_mutex_lock(&self->lock);
  if (++self->releases > self->retains) ++self->strange;
  pthread_mutex_unlock(&self->lock);
}

static const void* ODO_CALL native(void* owner, const char* id, uint64_t id_size) {
  const lent* self = (const lent*)owner;
  return id_size == sizeof ODO_NATIVE_HARDWARE_BUFFER - 1 && memcmp(id, ODO_NATIVE_HARDWARE_BUFFER, id_size) == 0
             ? self->native
             : NULL;
}

void lend(odo_loan* loan, lent* self) {
  loan->owner = self;
  loan->retain = retain;
  loan->release = release;
  loan->native = self->native ? native : NULL;
}

uint8_t lent_pixels[64 * 48];

void put_lent_frame(odo_frame* out, lent* of, int64_t t_ns) {
  put_frame(out, 0, t_ns);
  out->planes[0].data = lent_pixels;
  lend(&out->loan, of);
}

int32_t push_lent(app* self, lent* of, int64_t t_ns) {
  odo_frame frame;
  put_lent_frame(&frame, of, t_ns);
  int32_t status = push(self, &frame);
  memset(&frame, 0xFF, sizeof frame); /* `owner` alone remains */
  return status;
}
