// SPDX-License-Identifier: Apache-2.0
//
// Every number of every file that a run writes, against its event.
#include <nlohmann/json.hpp>

#include "sdk/tools/page/run_page.hpp"
#include "tests/support/support.hpp"

TEST_SUITE_BEGIN("recording");

namespace {

using Row = std::vector<std::string>;

/// The second line of a table with a head, by column name.
std::map<std::string, std::string> first_row(const std::filesystem::path& file) {
  std::istringstream lines(read_text(file));
  std::string line, field;
  Row rows[2];
  for (Row& row : rows) {
    REQUIRE(std::getline(lines, line));
    for (std::istringstream fields(line); std::getline(fields, field, ',');) row.push_back(field);
  }
  REQUIRE(rows[0].size() == rows[1].size());
  std::map<std::string, std::string> out;
  for (size_t i = 0; i < rows[0].size(); ++i) out[rows[0][i]] = rows[1][i];
  CHECK(out.size() == rows[0].size());
  return out;
}

void check_row(const std::filesystem::path& file, const std::vector<std::pair<const char*, double>>& expected,
               const std::vector<std::pair<const char*, std::string>>& words = {}) {
  auto row = first_row(file);
  CHECK(row.size() == expected.size() + words.size());
  for (const auto& column : expected) {
    CAPTURE(column.first);
    REQUIRE(row.contains(column.first));
    CHECK(std::abs(std::stod(row[column.first]) - column.second) <= 1e-8 * std::abs(column.second));
  }
  for (const auto& column : words) CHECK_MESSAGE(row[column.first] == column.second, column.first);
}

template <class Message>
Message message(uint32_t type, int64_t t_ns) {
  return make_message<Message>(type, t_ns);
}

odo_vo_motion a_motion() {
  auto m = message<odo_vo_motion>(ODO_TYPE_VO_MOTION, 2'000'000'017);
  m.t_from_ns = 1'900'000'003, m.state = ODO_DEGRADED, m.reason = ODO_REASON_TOO_FAST, m.scale_group = 5;
  m.tracked = 81, m.inliers = 67;
  for (int i = 0; i < 4; ++i) m.q_c0_c1[i] = 0.11 + 0.2 * i;
  for (int i = 0; i < 3; ++i) m.p_c0_c1[i] = -0.3 + 0.7 * i;
  for (int i = 0; i < 36; ++i) m.covariance[i] = 0.01 * (i + 1) * (i + 1);
  return m;
}

odo_fix a_fix(uint32_t flags) {
  auto f = message<odo_fix>(ODO_TYPE_FIX, 3'000'000'019);
  f.header.source = 7, f.header.flags = flags, f.yaw_rad = -1.25;
  for (int i = 0; i < 3; ++i) f.p_n[i] = 10.5 - 7.25 * i;
  for (int i = 0; i < 9; ++i) f.covariance_n[i] = 0.1 * (i + 1) * (i + 2);
  return f;
}

Recording nothing_of(const std::string& name) {
  Recording r{.format = "made up", .path = name};
  r.add(make_message<odo_imu>(ODO_TYPE_IMU, 1).header);
  return r;
}

}  // namespace

TEST_CASE("the tables of a run have each event's own numbers under each name") {
  const TemporaryFolder folder;
  RunResult run;
  run.motions = {a_motion()};
  auto step = message<odo_step>(ODO_TYPE_STEP, 5);
  step.t_start_ns = 11, step.t_end_ns = 23, step.length_m = 0.71, step.sigma_m = 0.06, step.frequency_hz = 1.9;
  step.heading_rad = -2.3, step.mode = ODO_MODE_WALKING_SWINGING;
  run.steps = {step};
  auto scale = message<odo_scale>(ODO_TYPE_SCALE, 29);
  scale.header.source = 3, scale.scale = 1.7, scale.sigma = 0.2, scale.displacement_m = 9;
  scale.header.flags = ODO_FLAG_ACCEPTED | ODO_SCALE_STEADY;
  run.scales = {scale};
  run.fixes = {{a_fix(ODO_FIX_NORTH | ODO_FIX_EAST), true}};
  run.track = {{1'000'000'007, Eigen::Quaterniond(0.5, 0.1, -0.7, 0.5), {1.25, -2.5, 3.75}}};
  odo_map_point point{};
  point.p_n[0] = 1.5, point.p_n[1] = -2.25, point.p_n[2] = 0.125, point.sigma_m = 0.0625;
  run.points = {point};
  REQUIRE(write_run(folder / "a", nothing_of("x"), run, {}).ok());
  CHECK(read_text(folder / "a/points.ply").ends_with("property float sigma\nend_header\n1.5 -2.25 0.125 0.0625\n"));
  const double* c = run.motions[0].covariance;
  const odo_vo_motion& m = run.motions[0];
  check_row(folder / "a/vo.csv", {{"t_from_ns", 1'900'000'003},
                                  {"t_ns", 2'000'000'017},
                                  {"state", ODO_DEGRADED},
                                  {"reason", ODO_REASON_TOO_FAST},
                                  {"scale_group", 5},
                                  {"tracked", 81},
                                  {"inliers", 67},
                                  {"qw", m.q_c0_c1[0]},
                                  {"qx", m.q_c0_c1[1]},
                                  {"qy", m.q_c0_c1[2]},
                                  {"qz", m.q_c0_c1[3]},
                                  {"x", m.p_c0_c1[0]},
                                  {"y", m.p_c0_c1[1]},
                                  {"z", m.p_c0_c1[2]},
                                  {"sigma_rotation_rad", std::sqrt((c[0] + c[7] + c[14]) / 3)},
                                  {"sigma_position", std::sqrt((c[21] + c[28] + c[35]) / 3)}});
  check_row(folder / "a/steps.csv",
            {{"t_start_ns", 11},
             {"t_end_ns", 23},
             {"length_m", 0.71},
             {"sigma_m", 0.06},
             {"frequency_hz", 1.9},
             {"heading_rad", -2.3}},
            {{"mode", odo_mode_text(ODO_MODE_WALKING_SWINGING)}});
  check_row(folder / "a/scale.csv", {{"t_ns", 29}, {"source", 3}, {"scale_m", 1.7}, {"sigma_m", 0.2}, {"used", 1}});
  const odo_fix f = run.fixes[0].fix;
  check_row(folder / "a/fixes.csv",
            {{"t_ns", 3'000'000'019},
             {"source", 7},
             {"x_m", f.p_n[0]},
             {"y_m", f.p_n[1]},
             {"z_m", f.p_n[2]},
             {"sigma_x_m", std::sqrt(f.covariance_n[0])},
             {"sigma_y_m", std::sqrt(f.covariance_n[4])},
             {"sigma_z_m", std::sqrt(f.covariance_n[8])},
             {"yaw_rad", -1.25},
             {"accepted", 1}},
            {{"kind", "position"}});
  CHECK(read_text(folder / "a/trajectory.tum") == "1.000000007 1.25 -2.5 3.75 0.1 -0.7 0.5 0.5\n");

  run.scales[0].header.flags = ODO_SCALE_STEADY;
  run.fixes = {{a_fix(ODO_FIX_YAW), false}};
  run.motions.clear();
  REQUIRE(write_run(folder / "a", nothing_of("x"), run, {}).ok());
  CHECK(first_row(folder / "a/scale.csv")["used"] == "0");
  CHECK(first_row(folder / "a/fixes.csv")["kind"] == "yaw");
  CHECK(first_row(folder / "a/fixes.csv")["accepted"] == "0");
  CHECK_FALSE(std::filesystem::exists(folder / "a/vo.csv"));  // from an older run
  run.fixes = {{a_fix(ODO_FIX_YAW | ODO_FIX_ORIENTATION), false}};
  REQUIRE(write_run(folder / "a", nothing_of("x"), run, {}).ok());
  CHECK(first_row(folder / "a/fixes.csv")["kind"] == "pose");
}

TEST_CASE("a run's summary has each statistic under its own name") {
  const TemporaryFolder folder;
  RunResult run;
  odo_statistics& s = run.statistics;
  s.frames = 101, s.steps = 102, s.fixes_accepted = 103, s.fixes_rejected = 104, s.late = 105, s.duplicate = 106;
  s.invalid = 107, s.overflow = 108, s.gaps = 109, s.plugin_faults = 110, s.wild = 111, s.events_dropped = 112;
  s.tracking_s = 1.5, s.degraded_s = 2.5, s.lost_s = 3.5, s.distance_m = 4.5;
  s.scale_sigma = 0.03, s.scale_by_inertia = 0.4, s.scale_by_steps = 0.6;
  run.final_state = ODO_LOST, run.final_reason = ODO_REASON_TOO_DARK, run.heading_offset_rad = 0.75;
  run.frame_ms = {1, 2, 3, 4, 105}, run.imu_us = {10, 20, 30, 40, 1050};
  run.loss.file = {.records_lost = 21, .bytes = 22, .places = 23, .cut = true};
  run.loss.pictures = 24, run.loss.times_out_of_range = 25, run.loss.impossible = 26;
  run.notices["p: k"] = {.count = 31, .text = "said"};
  run.plugins = {{1, "attitude", "a/b", "1.2.3", "12ab"}};
  run.reports = {"a report"}, run.config_text = "a: config\n";
  run.track.resize(3);
  Recording recording = nothing_of("walk.odo");
  recording.warnings = {"a warning"};
  REQUIRE(write_run(folder / "a", recording, run, {.seed = 77}).ok());
  const auto j = nlohmann::json::parse(read_text(folder / "a/summary.json"));
  const std::vector<std::pair<const char*, double>> expected = {{"/distance_m", 4.5},
                                                                {"/steps", 102},
                                                                {"/frames", 101},
                                                                {"/poses", 3},
                                                                {"/states_s/tracking", 1.5},
                                                                {"/states_s/degraded", 2.5},
                                                                {"/states_s/lost", 3.5},
                                                                {"/fixes/accepted", 103},
                                                                {"/fixes/rejected", 104},
                                                                {"/scale/sigma_percent", 3},
                                                                {"/scale/by_inertia_percent", 40},
                                                                {"/scale/by_steps_percent", 60},
                                                                {"/timing_ms/frame/median", 3},
                                                                {"/timing_ms/frame/p99", 4 + 0.96 * 101},
                                                                {"/timing_us/imu/median", 30},
                                                                {"/timing_us/imu/p99", 40 + 0.96 * 1010},
                                                                {"/faults/late", 105},
                                                                {"/faults/duplicate", 106},
                                                                {"/faults/invalid", 107},
                                                                {"/faults/overflow", 108},
                                                                {"/faults/wild", 111},
                                                                {"/faults/events_dropped", 112},
                                                                {"/faults/gaps", 109},
                                                                {"/faults/plugin", 110},
                                                                {"/lost/records", 21},
                                                                {"/lost/bytes", 22},
                                                                {"/lost/places", 23},
                                                                {"/lost/pictures", 24},
                                                                {"/lost/wild_times", 25},
                                                                {"/lost/impossible", 26},
                                                                {"/heading_offset_rad", 0.75},
                                                                {"/notices/p: k/count", 31},
                                                                {"/seed", 77}};
  for (const auto& value : expected) {
    CAPTURE(value.first);
    const nlohmann::json::json_pointer at(value.first);
    REQUIRE(j.contains(at));
    CHECK(std::abs(j.at(at).get<double>() - value.second) < 1e-9 * value.second);
  }
  CHECK(j["lost"]["cut_off"] == true);
  CHECK(j["final_state"] == odo_state_text(ODO_LOST));
  CHECK(j["final_reason"] == odo_reason_text(ODO_REASON_TOO_DARK));
  CHECK(j["recording"] == "walk.odo");
  CHECK(j["format"] == "made up");
  CHECK(j["warnings"][0] == "a warning");
  CHECK(j["reports"][0] == "a report");
  CHECK(j["notices"]["p: k"]["text"] == "said");
  CHECK(j["config"] == "a: config\n");
  CHECK(j["plugins"].dump() == R"([{"id":"a/b","kind":"attitude","number":1,"sha256":"12ab","version":"1.2.3"}])");
  CHECK(j["peak_rss_mb"].get<double>() == Between{1, 10'000});
  s.scale_sigma = 0, run.loss = {};
  REQUIRE(write_run(folder / "a", recording, run, {}).ok());
  const auto bare = nlohmann::json::parse(read_text(folder / "a/summary.json"));
  CHECK(bare["scale"].is_null());
  CHECK(bare["lost"]["records"] == 0);
}

TEST_CASE("the page of a run shows its own numbers, and each run aligned with the truth separately") {
  RunResult run;
  constexpr int64_t kSecond = 1'000'000'000;
  for (int i = 0; i <= 4; ++i)
    run.track.push_back({(10 + i) * kSecond, Eigen::Quaterniond::Identity(), {1.0 * i, 20.0 + 2 * i, -3.0 * i}});
  run.states = {1, 1, 2, 3, 3};
  auto step = message<odo_step>(ODO_TYPE_STEP, 14 * kSecond);
  step.t_start_ns = 11 * kSecond, step.t_end_ns = 12 * kSecond, step.length_m = 0.7, step.sigma_m = 0.05;
  run.steps = {step};
  auto scale = message<odo_scale>(ODO_TYPE_SCALE, 13 * kSecond);
  scale.header.source = 2, scale.scale = 2, scale.sigma = 0.25;
  run.scales = {scale};
  run.plugins = {{2, "scale_source", "scale/x", "1.0", ""}};
  run.config_text = "</script><b>";
  auto fix = a_fix(ODO_FIX_NORTH | ODO_FIX_EAST | ODO_FIX_DOWN);
  fix.header.t_ns = 12 * kSecond + kSecond / 2;
  run.fixes = {{fix, true}};
  const Recording recording = nothing_of("x");
  using Json = nlohmann::json;
  const Json all = Json::parse(run_page_data(recording, {{"run", &run}}, {}));
  const Json& shown = all["runs"][0];
  CHECK(shown["t"] == Json({0.0, 1.0, 2.0, 3.0, 4.0}));
  CHECK(shown["p"][9] == 3.0);
  CHECK(shown["p"][10] == 26.0);
  CHECK(shown["steps"] == Json({{"t", {2.0}}, {"y", {0.7}}, {"sigma", {0.05}}}));
  CHECK(shown["scales"][0] == Json({{"t", {3.0}}, {"y", {2.0}}, {"sigma", {0.25}}, {"source", "scale/x"}}));
  CHECK(shown["fixes"]["t"] == Json({2.5}));
  CHECK(std::abs(shown["fixes"]["residual"][0][0].get<double>() - (fix.p_n[0] - 2.5)) < 1e-4);
  CHECK(std::abs(shown["fixes"]["residual"][1][0].get<double>() - (fix.p_n[1] - 25)) < 1e-4);
  CHECK(std::abs(shown["fixes"]["residual"][2][0].get<double>() - (fix.p_n[2] + 7.5)) < 1e-4);
  REQUIRE(shown["states"].size() == 3);
  CHECK(shown["states"][1] == Json({{"t", 2.0}, {"state", 2}, {"text", odo_state_text(ODO_DEGRADED)}}));
  CHECK(shown["states"][2]["t"] == 3.0);
  // No content of a config can end the page's data.
  const std::string page = run_page(recording, {{"run", &run}}, {});
  CHECK_FALSE(contains(page, "</script><b>"));

  Recording known = recording;  // rotated, shifted, and one pose 2 m off
  for (const StampedPose& x : run.track) known.truth.push_back({x.t_ns, x.q, {-x.p.y() + 5, x.p.x() + 1, x.p.z() + 4}});
  for (const auto& [t, error] : align_to_truth(known, run).error_m) CHECK(error < 1e-9);
  run.track[2].p.z() += 2;
  const auto errors = align_to_truth(known, run).error_m;
  REQUIRE(errors.size() == 5);
  CHECK(errors[2].first == 2);
  CHECK(std::abs(errors[2].second - 1.6) < 1e-9);
  CHECK(std::abs(errors[0].second - 0.4) < 1e-9);

  run.track[2].p.z() -= 2;
  RunResult moved = run;  // the same track in another frame: an equally good run
  for (StampedPose& x : moved.track) x.p = {x.p.y() + 100, -x.p.x(), x.p.z()};
  const AlignedRun aligned = align_to_truth(known, moved);
  CHECK(aligned.rms_m() < 1e-9);
  for (size_t k = 0; k < known.truth.size(); ++k)
    CHECK((aligned.to_truth.q * moved.track[k].p * aligned.scale + aligned.to_truth.p - known.truth[k].p).norm() <
          1e-6);
}
