// SPDX-License-Identifier: Apache-2.0
//
// A fixer and a front-end with random events: nothing impossible is accepted, and every pose is valid.
#include "sdk/host/core/pipeline.hpp"
#include "sdk/host/core/world_view.hpp"
#include "tests/support/session_app.hpp"
#include "tests/support/test_plugins.hpp"
#include "tests/support/messages.hpp"

TEST_SUITE_BEGIN("random_events");

namespace {

bool whole(const odo_pose& pose) {
  const auto finite = [](double x) { return std::isfinite(x); };
  return std::all_of(pose.q_n, pose.q_n + 4, finite) && std::all_of(pose.p_n, pose.p_n + 3, finite) &&
         std::all_of(pose.velocity_n, pose.velocity_n + 3, finite) &&
         std::all_of(pose.covariance, pose.covariance + 36, finite) && finite(pose.distance_m);
}

struct Counts {
  size_t poses = 0, broken = 0, accepted = 0, outside = 0, restarts = 0;
};

/// A number of samples with 20 random events each.
Counts run(const std::string& yaml, int samples) {
  const TestPlugins plugins{"random_events"};
  RunningApp app(yaml, ODO_RUN_REPLAY, plugins.path());
  app.push(calibration(64, 48));
  Counts counts;
  for (int from = 0; from < samples; from += 100) {
    app.run(from, from + 100);
    for (const odo_pose& pose : app.all<odo_pose>(ODO_TYPE_POSE)) ++counts.poses, counts.broken += whole(pose) ? 0 : 1;
    odo_pose now{}, smooth{};
    now.header.struct_size = smooth.header.struct_size = sizeof now;
    if (odo_session_get_pose(app.session, ODO_TIME_LATEST, &now) == ODO_OK) counts.broken += whole(now) ? 0 : 1;
    if (odo_session_get_smooth_pose(app.session, ODO_TIME_LATEST, &smooth) == ODO_OK)
      counts.broken += whole(smooth) ? 0 : 1;
    for (const odo_fix& fix : app.all<odo_fix>(ODO_TYPE_FIX)) {
      if ((fix.header.flags & ODO_FLAG_ACCEPTED) == 0) continue;
      ++counts.accepted;
      const uint32_t flags = fix.header.flags;
      bool possible = fix.header.t_ns <= 1'000'000'000 + (from + 100) * 10'000'000LL + 1'000'000'000;
      if (flags & ODO_FIX_GEODETIC)
        possible = possible && std::abs(fix.latitude_rad) <= 1.5708 && std::abs(fix.longitude_rad) <= 6.2832;
      for (int i = 0; i < 2; ++i)
        if (flags & (ODO_FIX_NORTH << i)) possible = possible && std::abs(fix.p_n[i]) <= 1e5;
      if (flags & ODO_FIX_YAW) possible = possible && fix.yaw_sigma_rad > 0 && std::abs(fix.yaw_rad) <= 1e9;
      if (flags & ODO_FIX_NORTH) possible = possible && fix.covariance_n[0] > 0 && fix.covariance_n[0] <= 1e15;
      counts.outside += possible ? 0 : 1;
    }
    app.events.clear();
  }
  for (const odo_report& report : app.reports) counts.restarts += std::string(report.key) == "broken_pose" ? 1 : 0;
  return counts;
}

}  // namespace

TEST_CASE("none of 100,000 random fixes and motions causes a non-finite pose, and no impossible one is accepted") {
  const std::string walk =
      "odograph: 1\nattitude: {plugin: attitude/vqf}\nstep_estimator: {plugin: step/renaudin2012}\n";
  const std::string fixer = "absolute_fixers: [{plugin: test/random_events}]\n", paper = "coupling: {type: paper}\n";
  const std::string camera = "vo_frontend: {plugin: test/random_events}\n";
  Counts all;
  for (const std::string& yaml : {walk + fixer, walk + fixer + paper, walk + camera, walk + camera + paper}) {
    CAPTURE(yaml);
    const Counts counts = run(yaml, 1300);  // 4 x 26,000
    CHECK(counts.poses > 0);
    CHECK(counts.broken == 0);
    CHECK(counts.outside == 0);
    all.poses += counts.poses, all.accepted += counts.accepted, all.restarts += counts.restarts;
  }
  MESSAGE(all.poses << " poses, " << all.accepted << " fixes accepted, started anew " << all.restarts << " times");
  CHECK(all.accepted > 0);
}

TEST_CASE("if the localizer's state becomes non-finite, no such pose is published, and it restarts with a report") {
  const TestPlugins plugins{"echo"};
  const auto config =
      required(read_pipeline_config("odograph: 1\nattitude: {plugin: attitude/vqf}\nvo_frontend: {plugin: test/echo}\n",
                                    "<text>", {plugin_folder(), plugins.path()}));
  std::vector<std::string> said;
  HostServices host(0, {}, [&](const Report& report) { said.push_back(report.key); });
  CameraTable cameras(std::nullopt);
  InputChecks checks(host);
  WorldView world(
      cameras, [] { return 0u; }, 1'000'000'000, 1.7);
  size_t poses = 0, broken = 0;
  auto pipeline = Pipeline::make(
      *config, {host, checks, world.geodesy(), world.poses(), world.anchors(), world.scene(), world.mutex()},
      [&](const odo_header& event) {
        if (event.type != ODO_TYPE_POSE) return;
        ++poses, broken += whole(as<odo_pose>(event)) ? 0 : 1;
      });
  REQUIRE(pipeline.ok());
  int64_t t_ns = 1'000'000'000;
  const auto see = [&](double mounted_m) {  // without the session, which would reject a non-finite mount
    poses = 0;
    auto c = calibration(64, 48);
    c.header.t_ns = t_ns, c.header.flags = ODO_CALIBRATION_EXTRINSICS;
    c.q_b_c[0] = 1, c.p_b_c[0] = mounted_m;
    (*pipeline)->process(c.header);
    for (int i = 0; i < 50; ++i) {
      (*pipeline)->process(imu_at(t_ns += 10'000'000, {0, 0, 0}, {0, 9.81, 0}).header);
      (*pipeline)->process(make_message<odo_frame>(ODO_TYPE_FRAME, t_ns + 1).header);
    }
    odo_pose now{};
    const bool has_pose = world.pose_of(ODO_OF_PIPELINE, ODO_WORLD_CORRECTED, ODO_TIME_LATEST, now) == ODO_OK;
    CHECK((!has_pose || whole(now)));
    return std::count(said.begin(), said.end(), "broken_pose");
  };
  CHECK(see(0.1) == 0);
  CHECK(poses > 0);
  CHECK(see(std::nan("")) == 1);  // once a second
  CHECK(poses == 0);
  CHECK(see(0.1) == 1);
  CHECK(poses > 0);
  CHECK(broken == 0);
}
