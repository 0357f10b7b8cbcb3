/* SPDX-License-Identifier: Apache-2.0
 *
 * Every message of the ABI with values that a host accepts, and fields added by a later version, for app.c and
 * plugin.c. Built with today's headers and, with ODO_TEST_GROWN, with those of a later version. */
#ifndef ODOGRAPH_TESTS_GROWTH_EVERY_H
#define ODOGRAPH_TESTS_GROWTH_EVERY_H

#include <stddef.h>
#include <string.h>

#include <odograph/messages.h>

#define ANSWER ODO_TYPE_VENDOR(9, ODO_VENDOR_EVENT | 2)
#define QUESTION ODO_TYPE_VENDOR(9, 1)
#define LARGE ODO_TYPE_VENDOR(9, 3)
#define MAX_ROWS 32u

/* What the plugin received, in a message of its own. */
struct answer {
  odo_header header;
  double grown[MAX_ROWS]; /* by row of ODO_FOR_EACH_MESSAGE: what a later version added, -1 absent, -2 not received */
  double services;        /* a bit each */
  double seed;
  double state;      /* the loaded state */
  double large_size; /* of the newest LARGE */
  double map;        /* the loaded map */
};

/* Larger than any message of the library. */
struct large {
  odo_header header;
  double values[300];
};

struct landmarks {
  odo_points message;
  odo_point elements[2];
};

struct patch {
  odo_surface message;
  odo_vertex elements[3];
};

union message {
  odo_header header;
#define ROW(number, type, name, min_size) type name;
  ODO_FOR_EACH_MESSAGE(ROW)
#undef ROW
  struct landmarks landmarks;
  struct patch patch;
};

static uint32_t row_of(uint32_t number) {
  uint32_t row = 0;
#define ROW(value, type, name, min_size) \
  if (number == (value)) return row;     \
  ++row;
  ODO_FOR_EACH_MESSAGE(ROW)
#undef ROW
  return row;
}

/* Fields of a message from a later version: -1 if absent, 0 if unknown to this version. */
static double grown_of(const odo_header* message) {
#ifdef ODO_TEST_GROWN
  const odo_points* points = (const odo_points*)(const void*)message;
  const odo_surface* surface = (const odo_surface*)(const void*)message;
  if (message->type == ODO_TYPE_POINTS && points->offset < sizeof *points) return -1; /* elements lie there */
  if (message->type == ODO_TYPE_SURFACE && surface->offset < sizeof *surface) return -1;
  switch (message->type) {
#define ROW(number, type, name, min_size) \
  case number:                            \
    return ODO_HAS((const type*)(const void*)message, grown) ? ((const type*)(const void*)message)->grown[0] : -1;
    ODO_FOR_EACH_MESSAGE(ROW)
#undef ROW
    default: break;
  }
#endif
  (void)message;
  return 0;
}

static void unit(double* q) { q[0] = 1; }

static void fill_points(struct landmarks* m) {
  m->message.count = m->message.total = 2, m->message.stride = sizeof(odo_point);
  m->message.offset = (uint32_t)offsetof(struct landmarks, elements);
  m->message.header.struct_size = sizeof *m;
  for (int i = 0; i < 2; ++i) m->elements[i].id = (uint64_t)(7 + i);
}

static void fill_surface(struct patch* m) {
  m->message.id = 5, m->message.kind = ODO_SURFACE_FLOOR, m->message.state = ODO_SURFACE_PRESENT;
  m->message.count = 3, m->message.stride = sizeof(odo_vertex);
  m->message.offset = (uint32_t)offsetof(struct patch, elements);
  m->message.header.struct_size = sizeof *m;
  m->message.sigma_m = m->message.tilt_sigma_rad = 0.1, unit(m->message.q_n);
  m->elements[1].p[0] = 7, m->elements[2].p[1] = 8;
}

static void begin(union message* m, uint32_t number, int64_t t_ns) {
  memset(m, 0, sizeof *m);
  switch (number) {
#ifdef ODO_TEST_GROWN
#define ROW(value, type, name, min_size)                                             \
  case value:                                                                        \
    m->header.struct_size = sizeof(type), m->name.grown[0] = (double)(1000 + value); \
    break;
#else
#define ROW(value, type, name, min_size)  \
  case value:                             \
    m->header.struct_size = sizeof(type); \
    break;
#endif
    ODO_FOR_EACH_MESSAGE(ROW)
#undef ROW
    default: break;
  }
  m->header.type = number, m->header.t_ns = t_ns;
}

/* A message whose fields a host accepts. */
static void fill(union message* m, uint32_t number, int64_t t_ns) {
  begin(m, number, t_ns);
  switch (number) {
    case ODO_TYPE_IMU: m->header.flags = ODO_IMU_GYRO | ODO_IMU_ACCEL, m->imu.accel_b[2] = 9.81; break;
    case ODO_TYPE_MAGNETOMETER: m->magnetometer.field_b[0] = 2e-5; break;
    case ODO_TYPE_BAROMETER: m->barometer.pressure_pa = 101325; break;
    case ODO_TYPE_CALIBRATION:
      m->calibration.model = ODO_CAMERA_PINHOLE, m->calibration.width = 8, m->calibration.height = 8;
      m->calibration.fx = m->calibration.fy = 8, unit(m->calibration.q_b_c);
      break;
    case ODO_TYPE_IMU_NOISE:
      m->imu_noise.gyro_noise = m->imu_noise.gyro_walk = m->imu_noise.accel_noise = m->imu_noise.accel_walk = 1e-3;
      break;
    case ODO_TYPE_WAYPOINT: m->waypoint.sigma_m = 1; break;
    case ODO_TYPE_PLATFORM_POSE: unit(m->platform_pose.q_w), m->platform_pose.state = ODO_TRACKING; break;
    case ODO_TYPE_RANGE: m->range.range_m = m->range.sigma_m = m->range.transmitter_sigma_m = 1; break;
    case ODO_TYPE_FRAME:
      m->frame.format = ODO_FORMAT_GREY8, m->frame.width = m->frame.height = 8;
      m->frame.planes[0].row_stride = 8, m->frame.planes[0].pixel_stride = 1;
      break;
    case ODO_TYPE_ATTITUDE: unit(m->attitude.q_n_b); break;
    case ODO_TYPE_STEP:
      m->step.t_start_ns = t_ns - 500000000, m->step.t_end_ns = t_ns, m->step.length_m = 0.7, m->step.sigma_m = 0.1;
      m->step.frequency_hz = 2;
      break;
    case ODO_TYPE_MOTION_MODE: m->motion_mode.mode = ODO_MODE_STATIC; break;
    case ODO_TYPE_VO_MOTION:
      m->vo_motion.t_from_ns = t_ns - 100000000;
      m->vo_motion.state = ODO_LOST, m->vo_motion.reason = ODO_REASON_TOO_DARK;
      break;
    case ODO_TYPE_SCALE: m->scale.valid_to_ns = t_ns, m->scale.scale = 1, m->scale.sigma = 0.1; break;
    case ODO_TYPE_REFINED:
      m->refined.model = ODO_CAMERA_PINHOLE, m->refined.width = m->refined.height = 8;
      m->refined.fx = m->refined.fy = 8, unit(m->refined.q_b_c);
      break;
    case ODO_TYPE_RELATIVE_POSE:
      m->relative_pose.t_from_ns = t_ns - 1000000000, unit(m->relative_pose.q_b0_b1);
      m->relative_pose.covariance[0] = m->relative_pose.covariance[7] = m->relative_pose.covariance[14] = 1;
      m->relative_pose.covariance[21] = m->relative_pose.covariance[28] = m->relative_pose.covariance[35] = 1;
      break;
    case ODO_TYPE_KEY_FRAME: m->key_frame.id = 1; break;
    case ODO_TYPE_MAP_POSE: {
      int i;
      m->map_pose.map = 1, unit(m->map_pose.q_m_b);
      for (i = 0; i < 6; ++i) m->map_pose.covariance[7 * i] = 1;
      break;
    }
    case ODO_TYPE_POINTS: fill_points(&m->landmarks); break;
    case ODO_TYPE_SURFACE: fill_surface(&m->patch); break;
    default: break;
  }
}

/* Whether the elements of an odo_points or an odo_surface from fill() arrive, by this version's stride or another's. */
static int has_elements(const odo_header* message) {
  const odo_points* points = (const odo_points*)(const void*)message;
  const odo_surface* surface = (const odo_surface*)(const void*)message;
  if (message->type == ODO_TYPE_POINTS) {
    const odo_point *first = ODO_POINTS_AT(points, 0), *second = ODO_POINTS_AT(points, 1);
    return first && second && first->id == 7 && second->id == 8 && !ODO_POINTS_AT(points, 2);
  }
  if (message->type == ODO_TYPE_SURFACE) {
    const odo_vertex *second = ODO_VERTEX_AT(surface, 1), *third = ODO_VERTEX_AT(surface, 2);
    return second && third && second->p[0] == 7 && third->p[1] == 8 && !ODO_VERTEX_AT(surface, 3);
  }
  return 0;
}

#endif
