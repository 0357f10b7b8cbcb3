// SPDX-License-Identifier: Apache-2.0
//
// Inputs of benchmarks: simulated sensors and boards, degraded receivers, options, and frame times of a
// recording.
#include "sdk/tools/city/city_scenario.hpp"
#include "sdk/tools/evaluation/degrade.hpp"
#include "sdk/tools/evaluation/evaluation.hpp"
#include "sdk/tools/recording/recording.hpp"
#include "sdk/tools/simulation/board_pictures.hpp"
#include "sdk/tools/simulation/simulate.hpp"
#include "tests/support/support.hpp"

using Eigen::Vector3d;

TEST_SUITE_BEGIN("simulated_inputs");

namespace {

constexpr int64_t kSecond = 1'000'000'000;
constexpr double kDegree = EIGEN_PI / 180;

TrueState state_at(int64_t t_ns, const Vector3d& p = Vector3d::Zero()) {
  TrueState s;
  s.t_ns = t_ns, s.p = p, s.v = s.gyro_bias = s.accel_bias = Vector3d::Zero();
  return s;
}

}  // namespace

TEST_CASE("frame times are converted to the IMU's clock") {
  Recording r;
  for (const int i : {1, 2}) r.add(make_message<odo_frame>(ODO_TYPE_FRAME, i * kSecond).header);
  CHECK(frame_times_ns(r) == std::vector<int64_t>{kSecond, 2 * kSecond});
  auto calibration = make_message<odo_calibration>(ODO_TYPE_CALIBRATION, 0);
  calibration.model = ODO_CAMERA_PINHOLE, calibration.width = 640, calibration.height = 480,
  calibration.fx = calibration.fy = 500;
  calibration.time_offset_ns = 5'000'000;
  r.add(calibration.header);
  CHECK(frame_times_ns(r)[0] == kSecond);  // flagged unknown
  calibration.header.flags = ODO_CALIBRATION_TIME_OFFSET;
  r.add(calibration.header);
  CHECK(frame_times_ns(r)[0] == kSecond + 5'000'000);
}

TEST_CASE("a simulated board is found in its pictures, which are stored if a folder is named") {
  const TemporaryFolder folder;
  const odo_calibration lens = random_lens(false, 3);
  const auto views = required(simulated_views({}, lens, 3, 3, folder / "kept", {}));
  CHECK(views->size() >= 2);
  CHECK(std::distance(std::filesystem::directory_iterator(folder / "kept"), {}) == 3);
  write_text(folder / "file", "");
  CHECK(simulated_views({}, lens, 3, 1, folder / "file", {}).failure().status == ODO_E_IO);
}

TEST_CASE("GNSS positions are shifted east for a time, and added velocities are the walker's") {
  Recording r;
  for (int i = 0; i <= 200 * 20; ++i) {
    r.true_states.push_back(state_at(i * kSecond / 200, Vector3d(0, i / 200.0, 0)));
  }
  for (int i = 1; i < 20; ++i) {
    auto gnss = make_message<odo_gnss>(ODO_TYPE_GNSS, i * kSecond);
    gnss.latitude_rad = 60 * kDegree;
    r.add(gnss.header);
  }
  shift_gnss(r, 5, 10, 40);
  add_gnss_velocities(r, 0, 1);
  const auto at = [&](size_t second) { return as<odo_gnss>(r.messages[second - 1].message.header()); };
  CHECK(at(4).longitude_rad == 0);
  CHECK(at(7).longitude_rad * 6378137 * std::cos(60 * kDegree) == doctest::Approx(40));
  CHECK(at(11).longitude_rad == 0);
  CHECK((at(7).header.flags & ODO_GNSS_VELOCITY) != 0);
  CHECK(at(7).velocity_n[1] == doctest::Approx(1));
}

TEST_CASE("a scenario is simulated without a camera, identically for the same seed") {
  Scenario s;
  s.walk_m = 10;
  const auto one = required(simulated(s, 3)), again = simulated(s, 3);
  CHECK(one->has(ODO_TYPE_IMU));
  CHECK_FALSE(one->has(ODO_TYPE_FRAME));
  CHECK(one->true_states.back().p == again->true_states.back().p);
  CHECK(one->true_states.back().p != simulated(s, 4)->true_states.back().p);
}

TEST_CASE("a model replaces that of the skyline fixer with its origin, and so does a named database") {
  const auto plain = skyline_overrides("folder/lyon.city.json", {1, 2.5, -3}, "");
  REQUIRE(plain.size() == 2);
  CHECK(plain[0].path == "absolute_fixers.fix/skyline.parameters.model");
  CHECK(plain[0].value == "lyon.city.json");
  CHECK(plain[1].value == "[1.0000 m, 2.5000 m, -3.0000 m]");
  CHECK(skyline_overrides("a.json", {0, 0, 0}, "/b.skylines").at(2).value == "/b.skylines");
}

TEST_CASE("an interval is two numbers of seconds, the second above zero") {
  double from_s = -1, for_s = -1;
  CHECK(parse_interval("", "--gap", from_s, for_s));
  CHECK(from_s == -1);
  CHECK(parse_interval("10:2.5", "--gap", from_s, for_s));
  CHECK(from_s == 10);
  CHECK(for_s == 2.5);
  for (const char* wrong : {"10", "10:", "10:2s", "-1:2", "10:0"})
    CHECK(contains(parse_interval(wrong, "--gap", from_s, for_s).failure().text, "expected FROM:FOR"));
}
