// SPDX-License-Identifier: Apache-2.0
//
// Attitude, steps, planes, and the host with a camera and the inertial estimator allocate nothing once a session has
// run for a while: every malloc of the process is counted.
#include <atomic>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>

#include <odograph/odograph.h>
#include "plugins/surface/planes/plane_finder.hpp"
#include "tests/support/replay_session.hpp"

extern "C" {
void* __libc_malloc(size_t size);
void* __libc_calloc(size_t count, size_t size);
void* __libc_realloc(void* pointer, size_t size);
}

namespace {

std::atomic<long> allocations{0};

long walk(odo_session* session, int from, int to) {
  const long before = allocations;
  for (int i = from; i < to; ++i) {
    const double t = 0.01 * i;
    const double gyro[3] = {0.05 * std::sin(6 * t), 0.01, 0.1 * std::sin(3 * t)};
    const double accel[3] = {0.1, 9.81 + 2.2 * std::sin(2 * 3.14159265 * 1.9 * t), 0.4};
    odo_session_push_imu(session, static_cast<int64_t>(t * 1e9) + 1'000'000'000, gyro, accel);
  }
  return allocations - before;
}

int check(const std::string& attitude, const std::string& steps, const std::string& plugins) {
  const std::string yaml =
      "odograph: 1\nattitude: {plugin: " + attitude + "}\nstep_estimator: {plugin: " + steps + "}\n";
  const long before = allocations;
  odo_session* session = odograph::open_session(odograph::replay_options(yaml, plugins));
  if (!session) return 1;
  const long created = allocations - before;  // shows that allocations are counted, in the host and below
  long events = 0;
  odo_session_set_callback(
      session, nullptr, ODO_ALL_EVENTS, [](void* user, const odo_header*) { ++*static_cast<long*>(user); }, &events);
  const long first = walk(session, 0, 1500);
  const long events_before = events;
  const long later = walk(session, 1500, 6000);
  odo_statistics statistics{};
  statistics.struct_size = sizeof statistics;
  odo_session_get_statistics(session, &statistics);
  const auto stepped = static_cast<unsigned long long>(statistics.steps);
  std::printf(
      "%s, %s: %ld allocations to create it, %ld in 15 s of starting, %ld in 45 s after them, %llu steps, %ld events\n",
      attitude.c_str(), steps.c_str(), created, first, later, stepped, events - events_before);
  odo_session_destroy(session);
  return created > 100 && later == 0 && stepped > 80 && events - events_before > 4000 ? 0 : 1;
}

/// A session with an allocation-free front-end, polled for poses like an app.
int check_camera(const std::string& plugins) {
  const std::string yaml =
      "odograph: 1\nattitude: {plugin: attitude/vqf}\nstep_estimator: {plugin: step/odograph}\n"
      "vo_frontend: {plugin: test/needy_vo}\ncoupling: {type: localizer}\n";
  odo_session* session = odograph::open_session(odograph::replay_options(yaml, plugins));
  if (!session) return 1;
  static long poses, points;
  odo_session_set_callback(
      session, nullptr, ODO_ALL_EVENTS,
      [](void*, const odo_header* event) {
        poses += event->type == ODO_TYPE_POSE;
        const auto* with_points = reinterpret_cast<const odo_points*>(event);
        points += event->type == ODO_TYPE_POINTS && ODO_POINTS_AT(with_points, 299);
      },
      nullptr);
  odo_calibration calibration{};
  calibration.header.struct_size = sizeof calibration;
  calibration.header.type = ODO_TYPE_CALIBRATION;
  calibration.model = ODO_CAMERA_PINHOLE;
  calibration.width = 64, calibration.height = 48;
  calibration.fx = calibration.fy = 64, calibration.cx = 32, calibration.cy = 24;
  odo_session_push(session, &calibration.header);
  static const unsigned char pixels[64 * 48] = {};
  odo_frame frame{};
  frame.header.struct_size = sizeof frame;
  frame.header.type = ODO_TYPE_FRAME;
  frame.format = ODO_FORMAT_GREY8;
  frame.width = 64, frame.height = 48;
  frame.planes[0] = {pixels, 64, 1, 0};
  const auto go = [&](int from, int to) {
    const long before = allocations;
    for (int i = from; i < to; i += 10) {
      walk(session, i, i + 10);
      frame.header.t_ns = static_cast<int64_t>(i) * 10'000'000 + 1'000'000'000;
      odo_session_push(session, &frame.header);
      odo_pose pose{};
      pose.header.struct_size = sizeof pose;
      odo_session_get_pose(session, frame.header.t_ns + 30'000'000, &pose);
      odo_session_get_smooth_pose(session, frame.header.t_ns + 30'000'000, &pose);
      odo_statistics statistics{};
      statistics.struct_size = sizeof statistics;
      odo_session_get_statistics(session, &statistics);
    }
    return allocations - before;
  };
  const long first = go(0, 1500), poses_before = poses, later = go(1500, 6000);
  std::printf(
      "camera with points and inertial estimator: %ld allocations in 15 s of starting, %ld in 45 s after them, %ld "
      "poses, %ld times 300 points\n",
      first, later, poses - poses_before, points);
  odo_session_destroy(session);
  return later == 0 && poses - poses_before > 400 && points > 500 ? 0 : 1;
}

}  // namespace

extern "C" {
void* malloc(size_t size) { return ++allocations, __libc_malloc(size); }
void* calloc(size_t count, size_t size) { return ++allocations, __libc_calloc(count, size); }
void* realloc(void* pointer, size_t size) { return ++allocations, __libc_realloc(pointer, size); }
}

/// A search of planes among landmarks that are seen again and again: on a floor, a table, a wall, and anywhere.
int check_planes() {
  using Eigen::Vector3d;
  odograph::planes::PlaneFinder finder;
  std::mt19937 random;
  const auto uniform = [&] { return std::uniform_real_distribution<double>()(random); };
  const Vector3d patches[][3] = {{{-1, -2, 0}, {3, 0, 0}, {0, 4, 0}},
                                 {{1, 0.3, -0.75}, {0.8, 0, 0}, {0, 0.6, 0}},
                                 {{2.5, -2, -2.5}, {0, 4, 0}, {0, 0, 2.4}}};
  long later = 0;
  for (int second = 0; second < 60; ++second) {
    odograph::MapPoint point;
    point.covariance = Eigen::Matrix3f::Identity() * 1e-4f, point.scale_sigma = 0.02f;
    point.t_ns = second * 1'000'000'000LL;
    random.seed(1);
    for (int i = 0; i < 1000; ++i) {
      const auto& [corner, u, v] = patches[i % 3];
      point.p = corner + uniform() * u;
      point.p += uniform() * (i % 20 ? v : Vector3d(1, 1, -1));
      finder.add(point);
    }
    const long before = allocations;
    finder.search(point.t_ns, {0, 0, -1.4}, 0.02);
    if (second >= 30) later += allocations - before;
  }
  std::printf("planes: %zu found, %ld allocations in 30 later searches\n", finder.planes().size(), later);
  return finder.planes().size() >= 3 && later == 0 ? 0 : 1;
}

int main(int, char** arguments) {
  int failed = 0;
  for (const char* attitude : {"attitude/vqf", "attitude/magyq"})
    for (const char* steps : {"step/odograph", "step/renaudin2012", "step/weinberg2002"})
      failed += check(attitude, steps, arguments[1]);
  return failed + check_planes() + check_camera(std::string(arguments[1]) + ":" + arguments[2]);
}
