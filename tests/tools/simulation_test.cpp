// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validator.hpp>

#include "sdk/host/config/manifest.hpp"
#include "sdk/tools/simulation/drive.hpp"
#include "sdk/tools/simulation/sensors.hpp"
#include "sdk/tools/simulation/walker.hpp"
#include "tests/support/runs.hpp"

TEST_SUITE_BEGIN("simulation");

namespace {

Scenario small() {
  Scenario s;
  s.camera.width = 320, s.camera.height = 240, s.camera.focal_px = 250;
  s.route = {{0, 0, 0}, {10, 0, 0}, {14, 8, 0}};
  s.walker.stand_s = 1.5;
  return s;
}

Scenario tiny() {
  Scenario s = small();
  s.camera.width = 96, s.camera.height = 64, s.camera.focal_px = 80;
  s.route = {{0, 0, 0}, {4, 0, 0}};
  return s;
}

}  // namespace

TEST_CASE("the same seed gives the same bytes for any number of threads, and another seed different ones") {
  const TemporaryFolder folder;
  REQUIRE(simulate(tiny(), 5, folder / "a.odo", {.threads = 1}).ok());
  REQUIRE(simulate(tiny(), 5, folder / "b.odo", {.threads = 3}).ok());
  REQUIRE(simulate(tiny(), 6, folder / "c.odo", {.threads = 1}).ok());
  const std::string a = read_text(folder / "a.odo");
  CHECK(a == read_text(folder / "b.odo"));
  CHECK(a != read_text(folder / "c.odo"));
}

TEST_CASE("the motion's derivatives match its poses") {
  const Journey walk = make_walk(small(), 3);
  const double h = 2e-5;
  double worst_speed = 0, worst_acceleration = 0, worst_rotation = 0, speed = 0, acceleration = 0, rotation = 0;
  for (double t = 0.3; t < walk.phone.duration_s() - 0.3; t += 0.00713) {
    const auto s = walk.phone.at(t);
    const auto at = [&](int k) { return walk.phone.pose(t + k * h); };
    const auto p = [&](int k) -> Eigen::Vector3d { return at(k).translation(); };
    const Eigen::Vector3d v = (8 * (p(1) - p(-1)) - (p(2) - p(-2))) / (12 * h);
    const auto velocity = [&](int k) { return walk.phone.at(t + k * h).velocity_n; };
    const Eigen::Vector3d a = (8 * (velocity(1) - velocity(-1)) - (velocity(2) - velocity(-2))) / (12 * h);
    const Eigen::AngleAxisd near(at(-1).linear().transpose() * at(1).linear());
    const Eigen::AngleAxisd far(at(-2).linear().transpose() * at(2).linear());
    const Eigen::Vector3d w = (8 * near.angle() * near.axis() - far.angle() * far.axis()) / (12 * h);
    worst_speed = std::max(worst_speed, (v - s.velocity_n).norm()), speed = std::max(speed, v.norm());
    worst_acceleration = std::max(worst_acceleration, (a - s.acceleration_n).norm());
    acceleration = std::max(acceleration, a.norm());
    worst_rotation = std::max(worst_rotation, (w - s.angular_velocity_b).norm()),
    rotation = std::max(rotation, w.norm());
  }
  CHECK(worst_speed < 1e-6 * speed);
  CHECK(worst_acceleration < 1e-6 * acceleration);
  CHECK(worst_rotation < 1e-6 * rotation);
}

TEST_CASE("an even motion has no acceleration at its ends") {
  std::vector<Eigen::Vector3d> p;
  std::vector<Eigen::Quaterniond> q;
  for (int i = 0; i < 10; ++i) {
    p.emplace_back(0.1 * i, 0, 0);
    q.emplace_back(Eigen::AngleAxisd(0.02 * i, Eigen::Vector3d::UnitZ()));
  }
  const Motion motion(10, p, q);
  CHECK(motion.duration_s() == doctest::Approx(0.9));
  for (const double t : {0.0, 0.05, 0.5, 0.9}) {
    const auto state = motion.at(t);
    CHECK(state.acceleration_n.norm() < 1e-9);
    CHECK((state.velocity_n - Eigen::Vector3d(1, 0, 0)).norm() < 1e-9);
    CHECK((state.angular_velocity_b - Eigen::Vector3d(0, 0, 0.2)).norm() < 1e-9);
    CHECK(state.T_n_b.translation().x() == doctest::Approx(t));
  }
}

TEST_CASE("the ideal IMU integrates to the true motion") {
  const Journey walk = make_walk(small(), 3);
  const Motion& phone = walk.phone;
  const double dt = 5e-4;
  Eigen::Isometry3d T = phone.pose(0.5);
  Eigen::Vector3d velocity = phone.at(0.5).velocity_n;
  for (double t = 0.5; t < 6.5 - dt / 2; t += dt) {
    const auto k = phone.at(t + dt / 2);
    const Eigen::Vector3d w = k.angular_velocity_b * dt;
    const Eigen::Matrix3d half = Eigen::AngleAxisd(w.norm() / 2, w.normalized()).toRotationMatrix();
    const Eigen::Vector3d a = T.linear() * half * k.specific_force_b() + Eigen::Vector3d(0, 0, 9.80665);
    T.translation() += velocity * dt + 0.5 * a * dt * dt;
    velocity += a * dt;
    T.linear() = (T.linear() * half * half).eval();
  }
  const Eigen::Isometry3d truth = phone.pose(6.5);
  CHECK((T.translation() - truth.translation()).norm() < 2e-3);
  CHECK(Eigen::AngleAxisd(T.linear().transpose() * truth.linear()).angle() < 1e-4);
}

TEST_CASE("the true steps cover the walk and end at the stops") {
  Scenario s = small();
  s.events = {{6.0, "stand", 3.0, 0, true}, {12.0, "turn", 4.0, 0, false}};
  const Journey walk = make_walk(s, 3);
  double sum = 0, longest_break = 0;
  for (size_t i = 0; i < walk.steps.size(); ++i) {
    const auto& step = walk.steps[i];
    CHECK(step.t_end_s > step.t_start_s);
    CHECK(step.length_m == Between{0.1, 1.0});
    if (i > 0) longest_break = std::max(longest_break, step.t_start_s - walk.steps[i - 1].t_end_s);
    sum += step.length_m;
  }
  CHECK(sum == doctest::Approx(10 + std::hypot(4, 8)).epsilon(0.06));  // the corner is rounded
  CHECK(longest_break == doctest::Approx(4.0));
  REQUIRE(walk.waypoints.size() == 1);
  const Eigen::Vector3d phone = walk.phone.pose(walk.waypoints[0].t_s).translation();
  CHECK((phone - walk.waypoints[0].p_n).head<2>().norm() < 0.8);  // the phone is held in front of the walker
  CHECK(walk.modes.front().mode == ODO_MODE_STATIC);
  // The phone moves with the feet.
  const double gone =
      (walk.phone.pose(walk.phone.duration_s()).translation() - walk.phone.pose(0).translation()).norm();
  CHECK(gone == doctest::Approx(std::hypot(14, 8)).epsilon(0.06));
}

TEST_CASE("the paper's pipeline tracks a simulated walk") {
  const TemporaryFolder folder;
  Scenario s = small();
  s.camera = Scenario().camera;  // the resolution that the configs are made for
  const Recording recording = recorded(s, 11, folder / "walk.odo");
  const RunOptions options = options_of(source("samples/configs/antigny2019_paper.yaml"));
  const RunResult result = run_of(recording, options);
  CHECK(result.track.size() == recording.truth.size());  // one pose a frame
  CHECK(std::abs(static_cast<double>(result.steps.size()) - static_cast<double>(recording.true_steps.size())) <= 3);
  const Pairs pairs = associate(recording.truth, result.track, 0.001);
  const auto errors = absolute_errors(pairs.reference, align(pairs, Alignment::yaw, nullptr)).translation_m;
  CHECK(statistics_of(errors).rmse < 0.06 * path_length(recording.truth));
  CHECK(result.statistics.lost_s < 1.0);
  CHECK(write_run(folder / "out", recording, result, options).ok());
  for (const char* name : {"trajectory.tum", "steps.csv", "scale.csv", "fixes.csv", "summary.json"})
    CHECK(std::filesystem::file_size(folder / (std::string("out/") + name)) > 30);
  const auto schema_json = nlohmann::json::parse(read_text(source("schemas/summary.schema.json")));
  const auto summary = nlohmann::json::parse(read_text(folder / "out/summary.json"));
  valijson::Schema schema;
  valijson::SchemaParser().populateSchema(valijson::adapters::NlohmannJsonAdapter(schema_json), schema);
  valijson::Validator validator;
  CHECK(validator.validate(schema, valijson::adapters::NlohmannJsonAdapter(summary), nullptr));
}

TEST_CASE("all boxes of Antigny et al.'s Figure 1 work together") {
  const TemporaryFolder folder;
  Scenario s = small();
  s.camera = Scenario().camera;
  s.walker.height_m = 1.7;
  s.route = {{0, 0, 0}, {14, 0, 0}};
  s.objects = {{.at_m = 13, .right_m = -1.5, .up_m = 1.6, .side_m = 0.8}};
  s.events = {{8, "stand", 5}};
  const Recording recording = recorded(s, 11, folder / "walk.odo");
  REQUIRE(write_known_objects(s, 11, folder.path()).ok());
  RunOptions options = options_of(source("samples/configs/antigny2019.yaml"));
  options.asset_path = folder.path().string();
  const RunResult result = run_of(recording, options);
  size_t of_gnss = 0, of_terrain = 0, of_object = 0;
  int64_t first_object_ns = 0;
  for (const odo_fix& fix : result.accepted()) {
    of_gnss += (fix.header.flags & (ODO_FIX_NORTH | ODO_FIX_ORIENTATION)) == ODO_FIX_NORTH;
    of_terrain += (fix.header.flags & (ODO_FIX_NORTH | ODO_FIX_DOWN)) == ODO_FIX_DOWN;
    if ((fix.header.flags & ODO_FIX_ORIENTATION) && of_object++ == 0) first_object_ns = fix.header.t_ns;
  }
  CHECK(of_gnss == 1);
  CHECK(of_terrain > 50);
  REQUIRE(of_object > 0);
  uint32_t before = 0, after = 0;
  for (const odo_vo_motion& m : result.motions) (m.header.t_ns <= first_object_ns ? before : after) = m.scale_group;
  CHECK(after > before);  // the object has restarted the visual odometry
  for (size_t k = result.first_metric + 2; k < result.track.size() && result.track[k].t_ns < first_object_ns; ++k)
    CHECK(result.track[k].p.z() == doctest::Approx(-1.53).epsilon(0.03));  // 0.9 * 1.70 m above the ground
}

TEST_CASE("an exported EuRoC folder is read back and gives the identical run") {
  const TemporaryFolder folder;
  Scenario scenario = small();
  scenario.camera.distortion = {-0.1, 0.02, 0.0005, -0.001};
  scenario.route = {{0, 0, 0}, {5, 0, 0}};
  const Recording original = recorded(scenario, 9, folder / "walk.odo");
  REQUIRE(write_euroc(original, folder / "asl", nullptr).ok());
  const auto copy = required(read_recording(folder / "asl"));
  CHECK(copy->format == "EuRoC/ASL");
  for (const char* config : {"monocular_inertia", "phone_walk_camera"}) {  // the second models the rolling shutter
    const auto file = source("samples/configs/" + std::string(config) + ".yaml");
    const StampedPoses a = run_of(original, file).track, b = run_of(*copy, file).track;
    REQUIRE(a.size() == b.size());
    CHECK(a.size() > 40);
    bool same = true;
    for (size_t i = 0; i < a.size(); ++i)
      same = same && a[i].t_ns == b[i].t_ns && a[i].p == b[i].p && a[i].q.coeffs() == b[i].q.coeffs();
    CHECK_MESSAGE(same, config);
  }
  REQUIRE(copy->truth.size() == original.true_states.size());
  CHECK(std::filesystem::exists(folder / "asl/camchain-imucam.yaml"));
  // The layout of the data set's own files.
  const auto first_line = [&](const char* file) {
    const std::string text = read_text(folder / (std::string("asl/mav0/") + file));
    return text.substr(0, text.find_first_of("\r\n"));
  };
  CHECK(first_line("cam0/data.csv") == "#timestamp [ns],filename");
  CHECK(first_line("imu0/data.csv") ==
        "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],a_RS_S_x [m s^-2],"
        "a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]");
  CHECK(first_line("state_groundtruth_estimate0/data.csv")
            .starts_with("#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], "
                         "q_RS_z [], v_RS_R_x [m s^-1]"));
  const std::string camera = read_text(folder / "asl/mav0/cam0/sensor.yaml");
  for (const char* key : {"sensor_type: camera", "T_BS:", "cols: 4", "rows: 4", "data: [",
                          "rate_hz:", "resolution:", "camera_model: pinhole",
                          "intrinsics:", "distortion_model: radial-tangential", "distortion_coefficients:"})
    CHECK_MESSAGE(contains(camera, key), key);
}

TEST_CASE("every scenario of the SDK is valid and walks its route") {
  size_t found = 0;
  for (const auto& entry : std::filesystem::directory_iterator(source("samples/scenarios"))) {
    CAPTURE(entry.path().string());
    const auto scenario = required(read_scenario(entry.path().string()));
    const Route route(scenario->route, scenario->corner_m);
    const Journey walk = scenario->drives() ? make_drive(*scenario, route, 2) : make_walk(*scenario, route, 2);
    CHECK(walk.phone.duration_s() > 5);
    double fastest = 0, hardest = 0;
    for (double t = 0; t < walk.phone.duration_s(); t += 0.01) {
      const auto state = walk.phone.at(t);
      fastest = std::max(fastest, state.velocity_n.head<2>().norm());
      hardest = std::max(hardest, state.specific_force_b().norm());
    }
    CHECK(fastest < (scenario->drives() ? 15 : 7));
    CHECK(hardest < 80);
    ++found;
  }
  CHECK(found >= 16);
}

namespace {

std::vector<double> resting(const SimTriad::Errors& errors, double hz, double duration_s) {
  SimTriad triad(Random(4, 2), errors, hz);
  std::vector<double> x;
  for (int i = 0; i < static_cast<int>(duration_s * hz); ++i) x.push_back(triad.measure(Eigen::Vector3d::Zero()).x());
  return x;
}

/// Overlapping Allan deviation of a rate signal over `tau_s` (IEEE Std 952-1997).
double allan_deviation(const std::vector<double>& rate, double hz, double tau_s) {
  const auto m = static_cast<size_t>(std::lround(tau_s * hz));
  std::vector<double> angle(rate.size() + 1, 0.0);
  for (size_t i = 0; i < rate.size(); ++i) angle[i + 1] = angle[i] + rate[i] / hz;
  double sum = 0;
  size_t n = 0;
  for (size_t i = 0; i + 2 * m < angle.size(); ++i, ++n) {
    const double d = angle[i + 2 * m] - 2 * angle[i + m] + angle[i];
    sum += d * d;
  }
  return std::sqrt(sum / (2 * tau_s * tau_s * static_cast<double>(n)));
}

}  // namespace

TEST_CASE("the IMU's Allan deviation is as requested") {
  const double hz = 100, noise = 2e-3, walk = 1e-4;
  const auto white = resting({0.1, 0, noise, 0, 0, 1e3, 0}, hz, 20000);
  for (const double tau : {0.1, 1.0, 10.0})
    CHECK(std::abs(allan_deviation(white, hz, tau) - noise / std::sqrt(tau)) < 0.05 * std::abs(noise / std::sqrt(tau)));
  const auto wandering = resting({0.1, walk, 0, 0, 0, 1e3, 0}, hz, 20000);
  for (const double tau : {1.0, 10.0, 100.0})
    CHECK(std::abs(allan_deviation(wandering, hz, tau) - walk * std::sqrt(tau / 3)) <
          0.15 * std::abs(walk * std::sqrt(tau / 3)));
  const auto both = resting({0.1, walk, noise, 0, 0, 1e3, 0}, hz, 20000);
  const double asked_for = std::sqrt(noise * noise / 10 + walk * walk * 10 / 3);
  CHECK(std::abs(allan_deviation(both, hz, 10) - asked_for) < 0.08 * asked_for);
}

TEST_CASE("GNSS fixes bound the error of a geodetic walk") {
  const TemporaryFolder folder;
  Scenario s = small();
  s.camera.width = 96, s.camera.height = 64, s.camera.focal_px = 80, s.camera.rate_hz = 1;
  s.route = {{0, 0, 0}, {25, 0, 0}, {25, 25, 0}};
  s.gnss = {1.0, 1.0, 20.0, 1.0};
  s.magnetometer.hard_iron = s.magnetometer.disturbance = 0;
  const Recording recording = recorded(s, 4, folder / "walk.odo");
  const auto config =
      write_text(folder / "c.yaml",
                 "odograph: 1\nattitude:\n  plugin: attitude/vqf\n  parameters:\n    magnetometer: true\n"
                 "step_estimator:\n  plugin: step/renaudin2012\nabsolute_fixers:\n  - plugin: fix/gnss\n");
  const RunResult result = run_of(recording, config);
  CHECK(result.statistics.fixes_accepted > 30);
  // The source of the fixes can be looked up.
  REQUIRE(result.plugins.size() == 3);
  REQUIRE_FALSE(result.fixes.empty());
  for (const auto& fix : result.fixes) {
    const auto& plugin = result.plugins.at(fix.fix.header.source - 1);
    CHECK(plugin.number == fix.fix.header.source);
    CHECK((plugin.id == "fix/gnss" && plugin.kind == "absolute_fixer"));
    CHECK(plugin.sha256 == *sha256_of(plugin_folder() / "fix_gnss.so"));
  }
  // n's origin is the first fix, the walk starts at the true origin: the offset is that fix's error.
  CHECK((result.track.back().p - recording.truth.back().p).head<2>().norm() < 6.0);
}
