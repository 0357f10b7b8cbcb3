// SPDX-License-Identifier: Apache-2.0
//
// What a run writes is what came out: every column of every file, from events whose numbers all differ.
#include <cmath>
#include <iterator>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "sdk/host/messages/messages.hpp"
#include "sdk/tools/replay/runner.hpp"
#include "tests/support.hpp"

using namespace odograph;

TEST_SUITE_BEGIN("run_files");

namespace {

/// The cells of a file's second line by the names of its first.
std::map<std::string, std::string> cells_of(const std::filesystem::path& file) {
  std::istringstream lines(read_text(file));
  std::string head, row;
  std::getline(lines, head), std::getline(lines, row);
  std::istringstream names(head), values(row);
  std::map<std::string, std::string> cells;
  for (std::string name, value; std::getline(names, name, ',') && std::getline(values, value, ',');)
    cells[name] = value;
  return cells;
}

/// Numbers that all differ, from `first` on.
void count_up(double* values, size_t count, double first) {
  for (size_t i = 0; i < count; ++i) values[i] = first + static_cast<double>(i);
}

void check(const std::map<std::string, std::string>& cells, const std::map<std::string, double>& expected) {
  for (const auto& [name, value] : expected) {
    CAPTURE(name);
    REQUIRE(cells.count(name) == 1);
    CHECK(std::abs(std::stod(cells.at(name)) - value) < 1e-7 * std::abs(value));
  }
}

RunResult distinct_events() {
  RunResult result;
  auto motion = make_message<odo_vo_motion>(ODO_TYPE_VO_MOTION, 2'000'000'001);
  motion.t_from_ns = 1'900'000'003;
  motion.state = 11, motion.reason = 12, motion.scale_group = 13, motion.tracked = 14, motion.inliers = 15;
  count_up(motion.q_c0_c1, 4, 21), count_up(motion.p_c0_c1, 3, 31), count_up(motion.covariance, 36, 100);
  result.motions.push_back(motion);
  auto step = make_message<odo_step>(ODO_TYPE_STEP, 3'000'000'000);
  step.t_start_ns = 2'100'000'007, step.t_end_ns = 2'600'000'009;
  step.length_m = 0.71, step.sigma_m = 0.05, step.frequency_hz = 1.9, step.heading_rad = -2.5;
  step.mode = ODO_MODE_WALKING_SWINGING;
  result.steps.push_back(step);
  auto scale = make_message<odo_scale>(ODO_TYPE_SCALE, 4'000'000'011);
  scale.header.source = 5, scale.header.flags = ODO_SCALE_ACCEPTED, scale.scale = 1.7, scale.sigma = 0.3;
  result.scales.push_back(scale);
  auto fix = make_message<odo_fix>(ODO_TYPE_FIX, 5'000'000'013);
  fix.header.source = 6;
  count_up(fix.p_n, 3, 41), count_up(fix.covariance_n, 9, 51);
  fix.yaw_rad = 0.6;
  result.fixes.push_back({fix, true});
  result.track.push_back({1'234'567'891, Eigen::Quaterniond(0.1, 0.2, 0.3, 0.4), {7.5, 8.5, 9.5}});
  return result;
}

}  // namespace

TEST_CASE("every column of every file has the event's own number") {
  const TemporaryFolder folder;
  const RunResult result = distinct_events();
  REQUIRE(write_run(folder.path(), {}, result, {}));
  const auto vo = cells_of(folder / "vo.csv");
  check(vo, {{"t_from_ns", 1'900'000'003},
             {"t_ns", 2'000'000'001},
             {"state", 11},
             {"reason", 12},
             {"scale_group", 13},
             {"tracked", 14},
             {"inliers", 15},
             {"qw", 21},
             {"qx", 22},
             {"qy", 23},
             {"qz", 24},
             {"x", 31},
             {"y", 32},
             {"z", 33},
             {"sigma_rotation_rad", std::sqrt((100 + 107 + 114) / 3.0)},
             {"sigma_position", std::sqrt((121 + 128 + 135) / 3.0)}});
  const auto step = cells_of(folder / "steps.csv");
  check(step, {{"t_start_ns", 2'100'000'007},
               {"t_end_ns", 2'600'000'009},
               {"length_m", 0.71},
               {"sigma_m", 0.05},
               {"frequency_hz", 1.9},
               {"heading_rad", -2.5}});
  CHECK(step.at("mode") == "walking_swinging");
  check(cells_of(folder / "scale.csv"),
        {{"t_ns", 4'000'000'011}, {"source", 5}, {"scale_m", 1.7}, {"sigma_m", 0.3}, {"used", 1}});
  const auto fix = cells_of(folder / "fixes.csv");
  check(fix, {{"t_ns", 5'000'000'013},
              {"source", 6},
              {"x_m", 41},
              {"y_m", 42},
              {"z_m", 43},
              {"sigma_x_m", std::sqrt(51)},
              {"sigma_y_m", std::sqrt(55)},
              {"sigma_z_m", std::sqrt(59)},
              {"yaw_rad", 0.6},
              {"accepted", 1}});
  CHECK(fix.at("kind") == "position");
  std::istringstream track(read_text(folder / "trajectory.tum"));
  std::string line;
  while (std::getline(track, line) && line.starts_with('#')) {
  }
  std::istringstream words(line);
  std::vector<std::string> pose{std::istream_iterator<std::string>(words), {}};
  REQUIRE(pose.size() == 8);
  CHECK(pose[0] == "1.234567891");
  const double expected[] = {7.5, 8.5, 9.5, 0.2, 0.3, 0.4, 0.1};  // position, then x, y, z, w
  for (size_t i = 0; i < 7; ++i) CHECK(std::stod(pose[i + 1]) == expected[i]);
}

TEST_CASE("what was refused and what kind a fix is can be read") {
  const TemporaryFolder folder;
  RunResult result = distinct_events();
  result.fixes[0].accepted = false, result.fixes[0].fix.header.flags = ODO_FIX_YAW;
  result.scales[0].header.flags = 0;
  REQUIRE(write_run(folder.path(), {}, result, {}));
  CHECK(cells_of(folder / "fixes.csv").at("kind") == "yaw");
  CHECK(cells_of(folder / "fixes.csv").at("accepted") == "0");
  CHECK(cells_of(folder / "scale.csv").at("used") == "0");
  result.fixes[0].fix.header.flags = ODO_FIX_YAW | ODO_FIX_ORIENTATION;
  REQUIRE(write_run(folder.path(), {}, result, {}));
  CHECK(cells_of(folder / "fixes.csv").at("kind") == "pose");
}

TEST_CASE("the summary has every counter under its own name") {
  const TemporaryFolder folder;
  RunResult result = distinct_events();
  odo_statistics& s = result.statistics;
  s.distance_m = 61, s.steps = 62, s.frames = 63, s.tracking_s = 64, s.degraded_s = 65, s.lost_s = 66;
  s.fixes_accepted = 67, s.fixes_rejected = 68, s.late = 69, s.duplicate = 70, s.invalid = 71, s.overflow = 72;
  s.wild = 73, s.events_dropped = 74, s.gaps = 75, s.plugin_faults = 76;
  s.scale_sigma = 0.01, s.scale_by_inertia = 0.9, s.scale_by_steps = 0.1;
  result.frame_ms = {5, 1, 2, 3, 4}, result.imu_us = {10, 30, 20};
  result.heading_offset_rad = 0.25, result.final_state = ODO_DEGRADED;
  result.reports = {"a warning"};
  result.notices["fix/gnss waits"] = {3, "for a position"};
  RunOptions options;
  options.seed = 77;
  REQUIRE(write_run(folder.path(), {}, result, options));
  const auto json = nlohmann::json::parse(read_text(folder / "summary.json"));
  const std::map<std::string, double> expected = {{"/distance_m", 61},
                                                  {"/steps", 62},
                                                  {"/frames", 63},
                                                  {"/poses", 1},
                                                  {"/states_s/tracking", 64},
                                                  {"/states_s/degraded", 65},
                                                  {"/states_s/lost", 66},
                                                  {"/fixes/accepted", 67},
                                                  {"/fixes/rejected", 68},
                                                  {"/faults/late", 69},
                                                  {"/faults/duplicate", 70},
                                                  {"/faults/invalid", 71},
                                                  {"/faults/overflow", 72},
                                                  {"/faults/wild", 73},
                                                  {"/faults/events_dropped", 74},
                                                  {"/faults/gaps", 75},
                                                  {"/faults/plugin", 76},
                                                  {"/scale/sigma_percent", 1},
                                                  {"/scale/by_inertia_percent", 90},
                                                  {"/scale/by_steps_percent", 10},
                                                  {"/timing_ms/frame/median", 3},
                                                  {"/timing_us/imu/median", 20},
                                                  {"/heading_offset_rad", 0.25},
                                                  {"/seed", 77},
                                                  {"/notices/fix~1gnss waits/count", 3}};
  for (const auto& [path, value] : expected) {
    CAPTURE(path);
    CHECK(std::abs(json.at(nlohmann::json::json_pointer(path)).get<double>() - value) < 1e-9);
  }
  CHECK(json["final_state"] == "degraded");
  CHECK(json["reports"][0] == "a warning");
}

TEST_SUITE_END();
