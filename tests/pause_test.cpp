// SPDX-License-Identifier: Apache-2.0
//
// Silence of all sensors, of any length, anywhere in a run: an event and no interval to integrate over.
#include <doctest/doctest.h>

#include <cmath>
#include <cstdlib>
#include <ctime>
#include <random>

#include "tests/session_app.hpp"

using namespace odograph;

TEST_SUITE_BEGIN("pause");

namespace {

const std::string kHead = "odograph: 1\nwalker: {height: 1.7 m}\n";
const std::string kPipelines[] = {
    kHead + "attitude: {plugin: attitude/vqf}\nstep_estimator: {plugin: step/odograph}\n",
    kHead +
        "attitude: {plugin: attitude/magyq}\nstep_estimator: {plugin: step/renaudin2012}\ncoupling: {type: paper}\n",
    kHead +
        "attitude: {plugin: attitude/vqf}\nstep_estimator: {plugin: step/weinberg2002}\n"
        "vo_frontend: {plugin: vo/five_point}\nscale_source: {plugin: scale/fixed_step}\ncoupling: {type: paper}\n",
    kHead +
        "attitude: {plugin: attitude/vqf}\nstep_estimator: {plugin: step/kim2004}\n"
        "vo_frontend: {plugin: vo/five_point}\nscale_source: {plugin: scale/step_length}\n",
    kHead +
        "attitude: {plugin: attitude/vqf}\nstep_estimator: {plugin: step/odograph}\n"
        "vo_frontend: {plugin: vo/odograph}\n",
    kHead +
        "attitude: {plugin: attitude/vqf}\nstep_estimator: {plugin: step/tian2016}\n"
        "vo_frontend: {plugin: vo/five_point}\nscale_source: {plugin: scale/inertial}\n",
    kHead +
        "attitude: {plugin: attitude/vqf}\nstep_estimator: {plugin: step/scarlett2007}\n"
        "vo_frontend: {plugin: vo/five_point}\nscale_source: {plugin: scale/step_fit}\ncoupling: {type: paper}\n",
};

/// A walk with a textured wall that passes by, sample by sample.
class Walk {
 public:
  explicit Walk(const std::string& yaml) : app(yaml) {
    REQUIRE_MESSAGE(app.status == ODO_OK, app.message);
    auto c = calibration(kWidth, kHeight);
    c.header.flags = ODO_CALIBRATION_EXTRINSICS;
    c.q_b_c[0] = 1;
    odo_session_push(app.session, &c.header);
    std::mt19937 random(1);
    for (auto& pixel : wall_) pixel = static_cast<uint8_t>(random());
  }
  void go(double s) {
    for (int i = 0; i < static_cast<int>(s * 100); ++i) sample();
  }
  void wait(double s) { t_ns_ += static_cast<int64_t>(s * 1e9); }
  void flush() {
    timed([&] { odo_session_flush(app.session); });
  }

  App app;
  double slowest_s = 0;

 private:
  static constexpr uint32_t kWidth = 160, kHeight = 120;
  template <class Work>
  void timed(Work&& work) {
    const double start_s = thread_s();
    work();
    slowest_s = std::max(slowest_s, thread_s() - start_s);
  }
  /// Processor time: a loaded machine is no hang.
  static double thread_s() {
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
  }
  void sample() {
    t_ns_ += 10'000'000;
    const double phase = 2 * 3.14159265 * 1.8 * ++count_ * 0.01;
    const double gyro[3] = {0.1 * std::sin(phase), 0.1 * std::cos(phase), 0.02};
    const double accel[3] = {std::sin(phase), 9.8 + 3.5 * std::sin(phase), std::cos(phase)};
    timed([&] { odo_session_push_imu(app.session, t_ns_, gyro, accel); });
    if (count_ % 10 != 0) return;
    auto f = make_message<odo_frame>(ODO_TYPE_FRAME, t_ns_ + 1);
    f.format = ODO_FORMAT_GREY8;
    f.width = kWidth, f.height = kHeight;
    f.planes[0] = {wall_ + (count_ / 5) % 1000, kWidth, 1, 0};
    timed([&] { odo_session_push(app.session, &f.header); });
  }
  inline static uint8_t wall_[kWidth * kHeight + 1000];
  int64_t t_ns_ = 1'000'000'000;
  int count_ = 0;
};

struct End {
  double distance_m, known_s, lost_s;
};

End end_of(Walk& walk) {
  const auto s = walk.app.statistics();
  return {s.distance_m, s.tracking_s + s.degraded_s, s.lost_s};
}

double sigma_m(const odo_pose& pose) { return std::sqrt(std::max(pose.covariance[21], pose.covariance[28])); }

}  // namespace

TEST_CASE("a front-end that loses its unit after a pause at its start moves nothing by kilometres") {
  for (const double before_s : {0.7, 0.74}) {
    Walk walk(kPipelines[4]);
    walk.go(before_s);
    walk.wait(6);
    walk.go(9 - before_s);
    walk.flush();
    CHECK(end_of(walk).distance_m < 15);  // 361 km when a displacement without a scale had no bound
  }
}

TEST_CASE("a pause of any length anywhere is no displacement beyond the covariance, no tracking and no distance") {
  const char* wanted = std::getenv("ODOGRAPH_PAUSES");
  const int runs = wanted ? std::atoi(wanted) : 70;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> share(0, 1);
  constexpr double kAll_s = 9, kHundredYears_s = 3.156e9;
  std::vector<End> whole;
  for (const std::string& yaml : kPipelines) {
    Walk walk(yaml);
    walk.go(kAll_s);
    walk.flush();
    whole.push_back(end_of(walk));
  }
  double slowest_s = 0, largest_jump = 0;
  for (int run = 0; run < runs; ++run) {
    const size_t pipeline = static_cast<size_t>(run) % std::size(kPipelines);
    const double before_s = std::round(share(random) * kAll_s * 100) / 100;
    const double pause_s = 0.1 * std::pow(kHundredYears_s / 0.1, share(random));
    CAPTURE(kPipelines[pipeline]);
    CAPTURE(before_s);
    CAPTURE(pause_s);
    Walk walk(kPipelines[pipeline]);
    walk.go(before_s);
    const size_t events_before = walk.app.all<odo_pose>(ODO_TYPE_POSE).size();
    walk.wait(pause_s);
    walk.go(kAll_s - before_s);
    walk.flush();
    slowest_s = std::max(slowest_s, walk.slowest_s);
    CHECK(walk.slowest_s < 1.0);
    const End end = end_of(walk);
    CHECK(end.known_s < whole[pipeline].known_s + 2.5);  // the shortest pauses are gaps that are carried over
    CHECK(end.distance_m < whole[pipeline].distance_m + 2 * 2.5);
    const auto poses = walk.app.all<odo_pose>(ODO_TYPE_POSE);
    for (size_t i = 0; i < poses.size(); ++i) {
      CHECK(std::isfinite(poses[i].p_n[0] + poses[i].covariance[0] + poses[i].covariance[21] + poses[i].q_n[0]));
      if ((poses[i].header.flags & ODO_POSE_VELOCITY) != 0)
        CHECK(std::hypot(poses[i].velocity_n[0], poses[i].velocity_n[1]) < 5);
      if (i == 0 || i + 1 < events_before || !(poses[i - 1].header.flags & poses[i].header.flags & ODO_POSE_POSITION))
        continue;
      const double moved_m = std::hypot(poses[i].p_n[0] - poses[i - 1].p_n[0], poses[i].p_n[1] - poses[i - 1].p_n[1]);
      const double s = std::min(2.0, static_cast<double>(poses[i].header.t_ns - poses[i - 1].header.t_ns) * 1e-9);
      const double allowed_m = 3 * sigma_m(poses[i]) + 0.5 + 2.5 * s;
      largest_jump = std::max(largest_jump, moved_m / allowed_m);
      CHECK_MESSAGE(moved_m <= allowed_m, "pose " << i << " of " << poses.size());
    }
  }
  MESSAGE(runs << " pauses: slowest call " << slowest_s << " s, largest displacement " << largest_jump
               << " of what is allowed");
}

TEST_CASE("after a pause the state is lost, with a reason, until the next pose") {
  Walk walk(kPipelines[0]);
  walk.go(8);
  CHECK(walk.app.pose(ODO_TIME_LATEST).state == ODO_TRACKING);
  const auto before = end_of(walk);
  walk.wait(3600);
  walk.go(0.4);
  walk.flush();
  const auto states = walk.app.all<odo_state>(ODO_TYPE_STATE);
  REQUIRE_FALSE(states.empty());
  CHECK(states.back().state == ODO_LOST);
  CHECK(states.back().reason == ODO_REASON_SENSOR_SILENT);
  walk.go(4);
  walk.flush();
  CHECK(walk.app.pose(ODO_TIME_LATEST).state == ODO_TRACKING);
  CHECK(end_of(walk).known_s < before.known_s + 5);
  CHECK(end_of(walk).lost_s > 3599);
  CHECK(sigma_m(walk.app.pose(ODO_TIME_LATEST)) > 1000);  // it may have been carried anywhere
}

TEST_CASE("a clock's zero before the time since boot costs nothing") {
  Walk walk(kPipelines[4]);
  walk.go(0.01);
  walk.wait(1e6);
  walk.go(6);
  walk.flush();
  CHECK(walk.slowest_s < 1.0);
  CHECK(walk.app.pose(ODO_TIME_LATEST).state != ODO_LOST);
}

TEST_SUITE_END();
