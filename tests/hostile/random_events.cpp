// SPDX-License-Identifier: Apache-2.0
// A fixer, or a front-end, whose events have random numbers in all fields, plausible and absurd ones.
#define HOSTILE_ID "test/random_events"
#include <cmath>
#include <cstdint>

#include <odograph/absolute_fixer.h>
#include <odograph/vo_frontend.h>

#include "tests/hostile/table.hpp"

namespace {

uint64_t state = 1;
uint64_t draw() {  // SplitMix64
  uint64_t z = (state += 0x9e3779b97f4a7c15u);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}
double share() { return static_cast<double>(draw() >> 11) / 9007199254740992.0; }
double number() {
  static const double odd[] = {0,    -0.0, 1,    -1,      1e-300, -1e-300, 1e300, -1e300, 1e150,    1e9, 2e7,
                               48.1, 11.6, 1.57, 3.14159, 1e-12,  1e15,    1e5,   -1e4,   INFINITY, NAN, 5e-324};
  if (draw() % 8 == 0) return odd[draw() % (sizeof odd / sizeof odd[0])];
  return (2 * share() - 1) * std::pow(10.0, 6 * share() - 3);
}
void fill(double* values, size_t count) {
  for (size_t i = 0; i < count; ++i) values[i] = number();
}
/// Usually a valid rotation or covariance of any size, so that it passes the first checks.
void rotation(double* q) {
  fill(q, 4);
  const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  for (int i = 0; i < 4 && draw() % 16 != 0; ++i) q[i] /= norm;
}
void covariance(double* c, size_t rows) {
  if (draw() % 8 == 0) return fill(c, rows * rows);
  for (size_t i = 0; i < rows * rows; ++i) c[i] = 0;
  for (size_t i = 0; i < rows; ++i) c[i * (rows + 1)] = draw() % 16 == 0 ? number() : std::pow(10.0, 30 * share() - 13);
}
void direction(double* v) {
  fill(v, 3);
  const double norm = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  for (int i = 0; i < 3; ++i) v[i] /= norm;
}
int64_t time(int64_t now_ns) {
  static const int64_t off_ns[] = {0, 0, 0, 0, 0, 0, -100'000'000, -5'000'000'000, 900'000'000, 3'600'000'000'000};
  if (draw() % 64 == 0) return static_cast<int64_t>(draw());
  return now_ns + off_ns[draw() % 10];
}

void emit_random_fix(int64_t now_ns) {
  odo_fix f = {};
  f.header = {sizeof f, ODO_TYPE_FIX, time(now_ns), 0, static_cast<uint32_t>(draw()) & 0x1FFFu};
  f.header.flags |= ODO_FIX_COVARIANCE;
  if (f.header.flags & ODO_FIX_ORIENTATION) f.header.flags |= ODO_FIX_ORIENTATION_COVARIANCE;
  fill(f.p_n, 3), covariance(f.covariance_n, 3), rotation(f.q_n_b), covariance(f.orientation_cov_n, 3);
  f.yaw_rad = number(), f.yaw_sigma_rad = number(), f.latitude_rad = number(), f.longitude_rad = number();
  f.height_m = number(), f.integrity = share(), f.slant_distance_m = number(), f.slant_sigma_m = number();
  fill(f.landmark_n, 3), fill(f.lever_b, 3), fill(f.cross_covariance_n, 9), direction(f.yaw_axis_b);
  if (draw() % 2) f.latitude_rad = 1.5 * (2 * share() - 1), f.longitude_rad = 3 * (2 * share() - 1);
  hostile::emit(f.header);
}

void emit_random_motion(int64_t now_ns) {
  odo_vo_motion m = {};
  m.header = {sizeof m, ODO_TYPE_VO_MOTION, time(now_ns), 0, static_cast<uint32_t>(draw()) & 0xFFFFu};
  m.t_from_ns = draw() % 8 == 0 ? time(m.header.t_ns) : m.header.t_ns - static_cast<int64_t>(draw() % 1'000'000'000);
  m.state = 1 + static_cast<uint32_t>(draw() % 3), m.scale_group = static_cast<uint32_t>(draw() % 3);
  m.tracked = m.inliers = static_cast<uint32_t>(draw());
  rotation(m.q_c0_c1), fill(m.p_c0_c1, 3), covariance(m.covariance, 6);
  m.scale_sigma = number(), fill(m.velocity_c1, 3), direction(m.gravity_c1), fill(m.gyro_bias_b, 3);
  fill(m.accel_bias_b, 3);
  hostile::emit(m.header);
}

bool is_front_end = false;

}  // namespace

HOSTILE_PLUGIN {
  static const odo_string interfaces[] = {{ODO_INTERFACE_ABSOLUTE_FIXER, sizeof(ODO_INTERFACE_ABSOLUTE_FIXER) - 1},
                                          {ODO_INTERFACE_VO_FRONTEND, sizeof(ODO_INTERFACE_VO_FRONTEND) - 1}};
  static const uint32_t inputs[] = {ODO_TYPE_IMU};
  t.interfaces = interfaces, t.interface_count = 2;
  t.inputs = inputs, t.input_count = 1;
  t.create = [](const odo_host*, uint32_t, const odo_string* id, odo_instance** instance) -> int32_t {
    is_front_end = id->size == sizeof(ODO_INTERFACE_VO_FRONTEND) - 1 &&
                   std::memcmp(id->data, ODO_INTERFACE_VO_FRONTEND, static_cast<size_t>(id->size)) == 0;
    *instance = reinterpret_cast<odo_instance*>(&hostile::instance());
    return ODO_OK;
  };
  t.process = [](odo_instance*, const odo_batch* batch) -> int32_t {
    for (uint32_t i = 0; i < batch->count; ++i)
      for (int k = 0; k < 20 && batch->messages[i]->type == ODO_TYPE_IMU; ++k)
        (is_front_end ? emit_random_motion : emit_random_fix)(batch->messages[i]->t_ns);
    return ODO_OK;
  };
}
