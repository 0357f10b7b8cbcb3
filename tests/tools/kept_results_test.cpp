// SPDX-License-Identifier: Apache-2.0
//
// Kept results: the output of pipelines and simulator, compared with the last reviewed one. Any change of a number
// shows, intended ones too: ODOGRAPH_KEEP_RESULTS=1 writes the files again, and the commit with them gives the reason.
#include "sdk/tools/replay/anchor_walk.hpp"
#include "sdk/tools/replay/app_stream.hpp"
#include "tests/support/kept.hpp"
#include "tests/support/runs.hpp"

namespace {

/// Tolerances: for identical pictures and sensors the last stored digit; for rendered pictures, which differ in single
/// grey levels between machines, as measured with other vector instructions.
constexpr Tolerance kSame = {1e-6, false}, kRendered = {0.1, true};

/// Times are relative to the start of a run: absolute ones would hide the other digits of a column.
struct Clock {
  int64_t start_ns;
  double operator()(int64_t t_ns) const { return static_cast<double>(t_ns - start_ns) * 1e-9; }
};

void add_pose(Digest& digest, const odo_pose& x, const Clock& seconds) {
  digest.add("pose.t_s", seconds(x.header.t_ns));
  digest.add("pose.q_n", x.q_n, 4);
  digest.add("pose.p_n", x.p_n, 3);
  digest.add("pose.velocity_n", x.velocity_n, 3);
  digest.add("pose.covariance", x.covariance, 6, 7);
  digest.add("pose.covariance_height_by_east", x.covariance[4 * 6 + 5]);
  digest.add("pose.covariance_north_by_yaw", x.covariance[3 * 6 + 2]);
  digest.add("pose.scale", x.scale);
  digest.add("pose.scale_sigma", x.scale_sigma);
  digest.add("pose.distance_m", x.distance_m);
  digest.add("pose.state", x.state);
  digest.add("pose.reason", x.reason);
  digest.add("pose.angular_velocity", x.angular_velocity, 3);
  digest.add("pose.velocity_covariance", x.velocity_covariance, 9);
}

void add_step(Digest& digest, const odo_step& x, const Clock& seconds) {
  digest.add("step.t_start_s", seconds(x.t_start_ns));
  digest.add("step.t_end_s", seconds(x.t_end_ns));
  digest.add("step.length_m", x.length_m);
  digest.add("step.sigma_m", x.sigma_m);
  digest.add("step.frequency_hz", x.frequency_hz);
  digest.add("step.heading_rad", x.heading_rad);
  digest.add("step.mode", x.mode);
}

void add_motion(Digest& digest, const odo_vo_motion& x) {
  digest.add("motion.q_c0_c1", x.q_c0_c1, 4);
  digest.add("motion.p_c0_c1", x.p_c0_c1, 3);
  digest.add("motion.covariance", x.covariance, 6, 7);
  digest.add("motion.state", x.state);
  digest.add("motion.reason", x.reason);
  digest.add("motion.scale_group", x.scale_group);
  digest.add("motion.tracked", x.tracked);
  digest.add("motion.inliers", x.inliers);
  digest.add("motion.scale_sigma", x.scale_sigma);
  digest.add("motion.velocity_c1", x.velocity_c1, 3);
  digest.add("motion.gravity_c1", x.gravity_c1, 3);
  digest.add("motion.gyro_bias_b", x.gyro_bias_b, 3);
  digest.add("motion.accel_bias_b", x.accel_bias_b, 3);
}

/// Separate columns for each source, whose values differ in meaning and size.
void add_fix(Digest& digest, const RunResult::Fix& f, const Clock& seconds) {
  const odo_fix& x = f.fix;
  const std::string fix = "fix_" + std::to_string(x.header.source);
  digest.add(fix + ".t_s", seconds(x.header.t_ns));
  digest.add(fix + ".accepted", f.accepted);
  digest.add(fix + ".p_n", x.p_n, 3);
  digest.add(fix + ".covariance_n", x.covariance_n, 9);
  digest.add(fix + ".q_n_b", x.q_n_b, 4);
  digest.add(fix + ".orientation_cov_n", x.orientation_cov_n, 9);
  digest.add(fix + ".yaw_rad", x.yaw_rad);
  digest.add(fix + ".yaw_sigma_rad", x.yaw_sigma_rad);
  digest.add(fix + ".integrity", x.integrity);
  digest.add(fix + ".slant_distance_m", x.slant_distance_m);
}

std::string digest_of(const RunResult& result) {
  Digest digest;
  const Clock seconds{result.poses.empty() ? 0 : result.poses.front().header.t_ns};
  for (const odo_pose& x : result.poses) add_pose(digest, x, seconds);
  for (const odo_step& x : result.steps) add_step(digest, x, seconds);
  for (const odo_vo_motion& x : result.motions) add_motion(digest, x);
  for (const RunResult::Fix& x : result.fixes) add_fix(digest, x, seconds);
  for (const odo_scale& x : result.scales) {
    digest.add("scale.scale", x.scale);
    digest.add("scale.sigma", x.sigma);
    digest.add("scale.displacement_m", x.displacement_m);
    digest.add("scale.valid_s", seconds(seconds.start_ns + x.valid_to_ns - x.valid_from_ns));
  }
  for (const odo_attitude& x : result.attitudes) {
    digest.add("attitude.q_n_b", x.q_n_b, 4);
    digest.add("attitude.covariance_n", x.covariance_n, 9);
    digest.add("attitude.gyro_bias_b", x.gyro_bias_b, 3);
    digest.add("attitude.flags", x.header.flags);
  }
  for (const odo_motion_mode& x : result.modes) digest.add("mode", x.mode);
  return digest.text();
}

std::string digest_of(const Recording& recording) {
  Digest digest;
  const Clock seconds{recording.messages.front().message.header().t_ns};
  constexpr double kEarth_m = 6378137;  // positions are kept in metres from their nominal values
  for (const RecordedMessage& message : recording.messages) {
    const odo_header& header = message.message.header();
    switch (header.type) {
      case ODO_TYPE_IMU:
        digest.add("imu.t_s", seconds(header.t_ns));
        digest.add("imu.gyro_b", as<odo_imu>(header).gyro_b, 3);
        digest.add("imu.accel_b", as<odo_imu>(header).accel_b, 3);
        break;
      case ODO_TYPE_MAGNETOMETER: digest.add("magnetometer.field_b", as<odo_magnetometer>(header).field_b, 3); break;
      case ODO_TYPE_BAROMETER: digest.add("barometer.pressure_pa", as<odo_barometer>(header).pressure_pa); break;
      case ODO_TYPE_GNSS:
        digest.add("gnss.t_s", seconds(header.t_ns));
        digest.add("gnss.north_m", (as<odo_gnss>(header).latitude_rad - kSimulatedOrigin[0]) * kEarth_m);
        digest.add("gnss.east_m", (as<odo_gnss>(header).longitude_rad - kSimulatedOrigin[1]) * kEarth_m);
        digest.add("gnss.height_m", as<odo_gnss>(header).height_m);
        digest.add("gnss.covariance_n", as<odo_gnss>(header).covariance_n, 3, 4);
        digest.add("gnss.velocity_n", as<odo_gnss>(header).velocity_n, 3);
        break;
      default: digest.add("type", header.type);
    }
  }
  for (const StampedPose& x : recording.truth) {
    digest.add("truth.p", x.p.data(), 3);
    digest.add("truth.q", x.q.coeffs().data(), 4);
  }
  return digest.text();
}

/// From a scenario file, without pictures.
Recording sensors_of(const std::string& scenario, uint64_t seed) {
  const auto drawn = required(read_scenario(source(scenario).string()));
  return recorded_sensors(*drawn, seed);
}

/// With pictures; the folder gets the survey of buildings and objects.
Recording rendered(const std::string& scenario, uint64_t seed, const TemporaryFolder& folder) {
  const auto drawn = required(read_scenario(source(scenario).string()));
  const auto report = required(simulate(*drawn, seed, folder / "made.odo", {.city = folder / "city.json"}));
  if (!drawn->objects.empty()) REQUIRE(write_known_objects(*drawn, seed, folder.path()));
  return recorded(folder / "made.odo");
}

RunOptions pipeline(const std::string& config, const std::string& assets = "") {
  RunOptions options = options_of(source(config));
  options.asset_path = assets;
  options.collect_poses = options.collect_attitudes = true;
  return options;
}

/// A sample config on a real recording.
void check(const std::string& config, const std::string& recording_name, const std::filesystem::path& recording) {
  compare_kept(recording_name + "_" + config,
               digest_of(run_of(recorded(recording), pipeline("samples/configs/" + config + ".yaml"))), kSame);
}

}  // namespace

TEST_SUITE_BEGIN("kept_results");

TEST_CASE("simulated sensors are as kept") {
  if (!kept_for_this_machine()) return;
  compare_kept("sensors_wild", digest_of(sensors_of("samples/scenarios/sensors_wild.yaml", 11)), kSame);
}

TEST_CASE("every source of positions gives the kept results on a walk without a camera") {
  if (!kept_for_this_machine()) return;
  const Recording recording = sensors_of("tests/kept_results/walk.yaml", 13);
  const RunOptions options = pipeline("tests/kept_results/all_fixes.yaml", source("tests/kept_results").string());
  compare_kept("walk_all_fixes", digest_of(run_of(recording, options)), kSame);
}

TEST_CASE("a rendered walk past known objects gives the kept results as played by an app") {
  if (!kept_for_this_machine()) return;
  const TemporaryFolder folder;
  const Recording recording = rendered("tests/kept_results/walk.yaml", 14, folder);
  const RunOptions options = pipeline("samples/configs/walk_known_objects.yaml", folder.path().string());
  const auto app = required(app_stream(recording, options, {}));
  Digest digest;
  const Clock seconds{recording.messages.front().message.header().t_ns};
  for (const PolledPose& x : app->poses.polls)
    add_pose(digest, x.pose, seconds), digest.add("smooth.p_n", x.smooth.p_n, 3);
  const auto anchors = required(anchor_walk(recording, options, {}));
  for (double px : anchors->px) digest.add("anchor.px", px);
  for (double px : anchors->smooth_px) digest.add("anchor.smooth_px", px);
  digest.add("anchor.start_off_m", anchors->start_off_m);
  digest.add("anchor.by_newest_m", anchors->by_newest_m);
  digest.add("anchor.view_sigma_m", anchors->view_sigma_m);
  compare_kept("walk_app", digest.text(), kRendered);
}

TEST_SUITE_BEGIN("kept_results_data");

TEST_CASE("a phone through a house, a drone in a hall and a hand-held camera in a room give the kept results") {
  if (!kept_for_this_machine()) return;
  const auto house = data_or_skip("phone_house"), hall = data_or_skip("euroc_mh05"),
             tsukuba = data_or_skip("tsukuba_90");
  if (house.empty() || hall.empty() || tsukuba.empty()) return;
  check("walk", "phone_house", house);
  check("inertial_odograph", "euroc_mh05", hall);
  check("monocular_odograph", "tsukuba_90", tsukuba);
}

TEST_CASE("a phone through a shopping mall gives the kept results") {
  if (!kept_for_this_machine()) return;
  const auto walks = data_or_skip("phone_walks");
  if (walks.empty()) return;
  check("phone_walk_magyq", "mall", walks / "site2_F3_5dd398c544333f00067aa431.txt");
}
