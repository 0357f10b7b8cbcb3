// SPDX-License-Identifier: Apache-2.0
//
// samples/plugins_c/vo_platform_pose: the platform's tracking as an odometry.
#include "tests/samples/corridor_walk.hpp"

using Eigen::Vector3d;

TEST_SUITE_BEGIN("platform_pose");

namespace {

/// Changes a pose before it is pushed; false: skips it.
using Change = std::function<bool(double t, odo_platform_pose&)>;

void walk(App& app, double from_s, double to_s, CorridorWalk& truth, const CorridorWalk::Platform& platform = {},
          const Change& change = {}, int frame_every = 0) {
  REQUIRE_MESSAGE(app.session != nullptr, app.message);
  if (from_s == 0) CorridorWalk::calibration(app);
  for (int i = static_cast<int>(from_s * 100); i < static_cast<int>(to_s * 100); ++i) {
    const double t = 0.01 * i;
    CorridorWalk::imu(app, t);
    if (frame_every && i % frame_every == 0) CHECK(app.frame(CorridorWalk::ns(t)) == ODO_OK);
    if (i % 5) continue;
    odo_platform_pose pose = truth.platform_pose(t, platform);
    if (!change || change(t, pose)) CHECK(app.push(pose) == ODO_OK);
  }
  app.flush();
}

std::vector<odo_vo_motion> motions(const App& app) { return app.all<odo_vo_motion>(ODO_TYPE_VO_MOTION); }

/// The motion that ends at a time.
odo_vo_motion motion_at(const App& app, double t) {
  for (const odo_vo_motion& motion : motions(app))
    if (motion.header.t_ns == CorridorWalk::ns(t)) return motion;
  FAIL("no motion at " << t << " s");
  return {};
}

constexpr uint32_t kWhole = ODO_VO_ROTATION | ODO_VO_TRANSLATION;

}  // namespace

TEST_CASE("platform poses of camera or body give the track to within half a percent") {
  for (const bool of_body : {false, true}) {
    App app(platform_config(""), ODO_RUN_REPLAY, sample_plugins());
    CorridorWalk truth;
    walk(app, 0, 120, truth, {1, 0, of_body, 20});
    const double error = CorridorWalk::error(app, 119.5), path = CorridorWalk::along(119.5);
    MESSAGE(std::string(of_body ? "body: " : "camera: ") << error << " m of " << path << " m");
    CHECK(error < 0.005 * path);
    const odo_pose last = app.pose(CorridorWalk::ns(119.5));
    CHECK(last.state == ODO_TRACKING);
    CHECK((last.header.flags & ODO_POSE_METRIC) != 0);
    CHECK(app.statistics().plugin_faults == 0);
  }
}

TEST_CASE("each pose gives one motion, and with frames at most one per frame") {
  App poses(platform_config(""), ODO_RUN_REPLAY, sample_plugins());
  CorridorWalk truth, again;
  walk(poses, 0, 10, truth);
  CHECK(motions(poses).size() == 199);
  App frames(platform_config(""), ODO_RUN_REPLAY, sample_plugins());
  walk(frames, 0, 10, again, {}, {}, 10);
  const auto all = motions(frames);
  CHECK(all.size() == 99);
  for (size_t i = 0; i < all.size(); ++i) {
    CHECK(all[i].t_from_ns == CorridorWalk::ns(0.1 * static_cast<double>(i)));
    CHECK(all[i].header.t_ns == CorridorWalk::ns(0.1 * static_cast<double>(i + 1)));
  }
}

TEST_CASE("motions are metric with a scale sigma, and follow the platform's state") {
  App app(platform_config(""), ODO_RUN_REPLAY, sample_plugins());
  CorridorWalk truth;
  walk(app, 0, 10, truth, {}, [](double t, odo_platform_pose& pose) {
    if (t > 4.99 && t < 5.01) pose.state = ODO_DEGRADED;
    if (t > 5.99 && t < 6.01) pose.state = ODO_LOST;
    if (t > 6.99 && t < 7.01) pose.state = 77;  // of a newer list
    if (t > 7.99) pose.p_w[0] += 100;           // relocalised
    return true;
  });
  for (const odo_vo_motion& motion : motions(app)) {
    CHECK((motion.header.flags & ODO_VO_METRIC) != 0);
    CHECK(motion.scale_sigma == 0.02);
    CHECK(motion.scale_group == 0);
    CHECK((motion.state == ODO_TRACKING) == ((motion.header.flags & kWhole) == kWhole));
    CHECK((motion.state == ODO_TRACKING) == (motion.reason == ODO_REASON_NONE));
  }
  CHECK(motion_at(app, 4.95).state == ODO_TRACKING);
  for (const double t : {5.0, 5.05, 8.0}) {  // rotation only: from and to a degraded pose, and over a jump
    CHECK(motion_at(app, t).state == ODO_DEGRADED);
    CHECK((motion_at(app, t).header.flags & kWhole) == ODO_VO_ROTATION);
  }
  for (const double t : {6.0, 7.0}) {
    CHECK(motion_at(app, t).state == ODO_LOST);
    CHECK((motion_at(app, t).header.flags & kWhole) == 0);
  }
  CHECK(motion_at(app, 8.05).state == ODO_TRACKING);
}

TEST_CASE("the host uses the stated uncertainty of the platform's scale") {
  for (const auto& [stated, expected] : {std::pair{"0.01", 0.01}, std::pair{"0.08", 0.08}}) {
    std::string config = platform_config("");
    const std::string plain = "{plugin: vo/platform_pose}";
    config.replace(config.find(plain), plain.size(),
                   std::string("{plugin: vo/platform_pose, parameters: {scale_sigma: ") + stated + "}}");
    App app(config, ODO_RUN_REPLAY, sample_plugins());
    CorridorWalk truth;
    walk(app, 0, 10, truth);
    CHECK(app.statistics().scale_sigma == Between{0.7 * expected, 1.3 * expected});
  }
}

TEST_CASE("a new world of the platform starts a new scale group, and the track continues") {
  App app(platform_config(""), ODO_RUN_REPLAY, sample_plugins());
  CorridorWalk truth;
  const Eigen::Quaterniond turned(Eigen::AngleAxisd(2.0, Vector3d::UnitZ()));
  walk(app, 0, 60, truth, {}, [&](double t, odo_platform_pose& pose) {
    if (t < 29.99) return true;
    pose.world = 2;
    const Eigen::Quaterniond q = turned * Eigen::Quaterniond(pose.q_w[0], pose.q_w[1], pose.q_w[2], pose.q_w[3]);
    pose.q_w[0] = q.w(), pose.q_w[1] = q.x(), pose.q_w[2] = q.y(), pose.q_w[3] = q.z();
    Vector3d::Map(pose.p_w) = turned * Vector3d(pose.p_w) + Vector3d(50, 60, 70);
    return true;
  });
  CHECK(motion_at(app, 29.95).scale_group == 0);
  CHECK(motion_at(app, 30.0).scale_group == 1);
  CHECK((motion_at(app, 30.0).header.flags & kWhole) == 0);
  CHECK(motion_at(app, 30.05).scale_group == 1);
  CHECK(motion_at(app, 30.05).state == ODO_TRACKING);
  const double error = CorridorWalk::error(app, 59.5);
  MESSAGE(error << " m after a change of world");
  CHECK(error < 0.5);
}
