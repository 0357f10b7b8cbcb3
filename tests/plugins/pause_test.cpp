// SPDX-License-Identifier: Apache-2.0
//
// Silence of all sensors for any time, anywhere in a run: it is an event, not an interval to integrate.
#include <ctime>
#include <random>

#include "tests/support/session_app.hpp"
#include "tests/support/messages.hpp"

TEST_SUITE_BEGIN("pause");

namespace {

const std::string kHead = "odograph: 1\nwalker: {height: 1.7 m}\n";
const std::string kLocalizer = "coupling: {type: localizer}\n";
const std::string kOdograph =
    kHead +
    "attitude: {plugin: attitude/vqf}\nstep_estimator: {plugin: step/odograph}\nvo_frontend: {plugin: vo/odograph}\n";
const std::string kPipelines[] = {
    kHead + kLocalizer + "attitude: {plugin: attitude/vqf}\nstep_estimator: {plugin: step/odograph}\n",
    kHead +
        "attitude: {plugin: attitude/magyq}\nstep_estimator: {plugin: step/renaudin2012}\ncoupling: {type: paper}\n",
    kHead +
        "attitude: {plugin: attitude/vqf}\nstep_estimator: {plugin: step/weinberg2002}\n"
        "vo_frontend: {plugin: vo/five_point}\nscale_source: {plugin: scale/fixed_step}\ncoupling: {type: paper}\n",
    kHead + kLocalizer +
        "attitude: {plugin: attitude/vqf}\nstep_estimator: {plugin: step/kim2004}\n"
        "vo_frontend: {plugin: vo/five_point}\nscale_source: {plugin: scale/step_length}\n",
    kOdograph + kLocalizer,
    kHead + kLocalizer +
        "attitude: {plugin: attitude/vqf}\nstep_estimator: {plugin: step/tian2016}\n"
        "vo_frontend: {plugin: vo/five_point}\nscale_source: {plugin: scale/inertial}\n",
    kHead +
        "attitude: {plugin: attitude/vqf}\nstep_estimator: {plugin: step/scarlett2007}\n"
        "vo_frontend: {plugin: vo/five_point}\nscale_source: {plugin: scale/step_fit}\ncoupling: {type: paper}\n",
};

/// A walk past a textured wall, sample by sample.
class Walk {
 public:
  explicit Walk(const std::string& yaml) : app(yaml) {
    REQUIRE_MESSAGE(app.status == ODO_OK, app.message);
    auto c = calibration(kWidth, kHeight);
    c.header.flags = ODO_CALIBRATION_EXTRINSICS;
    c.q_b_c[0] = 1;
    app.push(c);
    std::mt19937 random(1);
    for (auto& pixel : wall_) pixel = static_cast<uint8_t>(random());
  }
  void go(double s) {
    for (int i = 0; i < static_cast<int>(s * 100); ++i) sample();
  }
  void wait(double s) { t_ns_ += static_cast<int64_t>(s * 1e9); }
  void flush() {
    timed([&] { app.flush(); });
  }

  App app;
  double slowest_s = 0;
  bool has_camera = true;

 private:
  static constexpr uint32_t kWidth = 160, kHeight = 120;
  template <class Work>
  void timed(Work&& work) {
    const double start_s = thread_s();
    work();
    slowest_s = std::max(slowest_s, thread_s() - start_s);
  }
  /// Processor time, so that a loaded machine is not taken for a hang.
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
    if (!has_camera || count_ % 10 != 0) return;
    auto f = grey_frame_at(t_ns_ + 1, wall_ + (count_ / 5) % 1000, kWidth, kHeight);
    timed([&] { app.push(f); });
  }
  inline static uint8_t wall_[kWidth * kHeight + 1000];
  int64_t t_ns_ = 1'000'000'000;
  int count_ = 0;
};

struct End {
  double distance_m, known_s, lost_s;
};

End end_of(const Walk& walk) {
  const auto s = walk.app.statistics();
  return {s.distance_m, s.tracking_s + s.degraded_s, s.lost_s};
}

double sigma_m(const odo_pose& pose) { return std::sqrt(std::max(pose.covariance[21], pose.covariance[28])); }

}  // namespace

TEST_CASE("a front-end that loses its scale after an early pause moves nothing by kilometres") {
  for (const double before_s : {0.7, 0.74}) {
    Walk walk(kOdograph);
    walk.go(before_s);
    walk.wait(6);
    walk.go(9 - before_s);
    walk.flush();
    CHECK(end_of(walk).distance_m < 15);  // was 361 km without a limit for displacements without scale
  }
}

namespace {

constexpr double kAll_s = 9, kFastest_mps = 2, kFarthest_m = 100e3;  // coupling.fastest, and the range of n

struct Pause {
  size_t pipeline;
  double all_s, before_s, pause_s;
  bool camera_after;
};

Pause random_pause(std::mt19937& random, size_t pipeline) {
  std::uniform_real_distribution<double> share(0, 1);
  constexpr double kHundredYears_s = 3.156e9;
  Pause pause{pipeline, 3 + share(random) * (kAll_s - 3), 0, 0.1 * std::pow(kHundredYears_s / 0.1, share(random)),
              share(random) < 0.7};
  pause.before_s = std::round(share(random) * pause.all_s * 100) / 100;
  return pause;
}

/// For each displacement between two poses after the pause: largest ratio to the allowed one.
double check_poses(const std::vector<odo_pose>& poses, size_t before, double pause_s) {
  double largest = 0;
  const bool placed = before > 0 && (poses[before - 1].header.flags & ODO_POSE_POSITION) != 0;
  const int64_t last_ns = before > 0 ? poses[before - 1].header.t_ns : 0;
  for (size_t i = 0; i < poses.size(); ++i) {
    const odo_pose& pose = poses[i];
    CHECK(std::isfinite(pose.p_n[0] + pose.covariance[0] + pose.covariance[21] + pose.q_n[0]));
    if ((pose.header.flags & ODO_POSE_VELOCITY) != 0)  // the localizer's limit (FusionState::Parameters)
      CHECK(std::hypot(pose.velocity_n[0], pose.velocity_n[1]) < 5 * kFastest_mps + 0.01);
    const double since_s = static_cast<double>(pose.header.t_ns - last_ns) * 1e-9;
    if (placed && pause_s > 2 && since_s > pause_s)  // it may have been carried anywhere
      CHECK_MESSAGE(sigma_m(pose) > 0.9 * std::min(kFastest_mps * pause_s, kFarthest_m), "pose " << i);
    if (i == 0 || i + 1 < before || !(poses[i - 1].header.flags & pose.header.flags & ODO_POSE_POSITION)) continue;
    const double moved_m = std::hypot(pose.p_n[0] - poses[i - 1].p_n[0], pose.p_n[1] - poses[i - 1].p_n[1]);
    const double s = std::min(2.0, static_cast<double>(pose.header.t_ns - poses[i - 1].header.t_ns) * 1e-9);
    const double allowed_m = 3 * std::max(sigma_m(pose), sigma_m(poses[i - 1])) + 0.5 + 2.5 * s;
    largest = std::max(largest, moved_m / allowed_m);
    CHECK_MESSAGE(moved_m <= allowed_m, "pose " << i << " of " << poses.size());
  }
  return largest;
}

/// Tracking and distance equal those of a walk without a pause, by camera or by steps.
void check_end(const Walk& walk, const End& whole) {
  const End end = end_of(walk);
  double stepped_m = 0;
  for (const odo_step& step : walk.app.all<odo_step>(ODO_TYPE_STEP)) stepped_m += step.length_m;
  CHECK(walk.slowest_s < 1.0);
  CHECK(end.known_s < whole.known_s + 2.5);  // the shortest pauses are bridged gaps
  CHECK(end.distance_m < std::max(whole.distance_m, stepped_m) + 2 * 2.5);
}

}  // namespace

TEST_CASE("a pause of any length anywhere causes no displacement beyond the covariance, no tracking and no distance") {
  const char *wanted = std::getenv("ODOGRAPH_PAUSES"), *seed = std::getenv("ODOGRAPH_PAUSES_SEED");
  const int runs = wanted ? std::atoi(wanted) : 70;
  std::mt19937 random(seed ? static_cast<uint32_t>(std::atoi(seed)) : 7);
  std::vector<End> whole;
  for (const std::string& yaml : kPipelines) {
    Walk walk(yaml);
    walk.go(kAll_s);
    walk.flush();
    whole.push_back(end_of(walk));
  }
  double slowest_s = 0, largest = 0;
  for (int run = 0; run < runs; ++run) {
    const Pause pause = random_pause(random, static_cast<size_t>(run) % std::size(kPipelines));
    CAPTURE(kPipelines[pause.pipeline]);
    CAPTURE(pause.all_s);
    CAPTURE(pause.before_s);
    CAPTURE(pause.pause_s);
    CAPTURE(pause.camera_after);
    Walk walk(kPipelines[pause.pipeline]);
    walk.go(pause.before_s);
    const size_t before = walk.app.all<odo_pose>(ODO_TYPE_POSE).size();
    walk.wait(pause.pause_s);
    walk.has_camera = pause.camera_after;
    walk.go(pause.all_s - pause.before_s);
    walk.flush();
    check_end(walk, whole[pause.pipeline]);
    largest = std::max(largest, check_poses(walk.app.all<odo_pose>(ODO_TYPE_POSE), before, pause.pause_s));
    slowest_s = std::max(slowest_s, walk.slowest_s);
  }
  MESSAGE(runs << " pauses: slowest call " << slowest_s << " s, largest displacement " << largest
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

TEST_CASE("a clock at zero before the time since boot has no effect") {
  Walk walk(kOdograph);
  walk.go(0.01);
  walk.wait(1e6);
  walk.go(6);
  walk.flush();
  CHECK(walk.slowest_s < 1.0);
  CHECK(walk.app.pose(ODO_TIME_LATEST).state != ODO_LOST);
}
