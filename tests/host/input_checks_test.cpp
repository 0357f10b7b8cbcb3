// SPDX-License-Identifier: Apache-2.0
//
// Mistakes of an app in the live API: each is named within seconds of a motion that shows it, and no pose is "tracking"
// while it lasts. Right input of the same motions is not called wrong.
#include "sdk/host/checks/picture_check.hpp"
#include "tests/host/mistakes.hpp"

using namespace odograph;

TEST_SUITE_BEGIN("input_checks");

TEST_CASE("each mistake is named with its remedy, and nothing tracks with it") {
  Mistakes table;
  table.units(), table.axes(), table.cameras(), table.pictures(), table.clocks(), table.sampling(), table.others();
  CHECK(table.all.size() >= 50);
  for (const Mistake& mistake : table.all) {
    const std::string name = mistake.name;
    CAPTURE(name);
    const Outcome outcome = run(mistake.input);
    const auto found = outcome.warnings.find(mistake.key);
    std::string others;
    for (const auto& [key, text] : outcome.warnings) others += key + ": " + text + "\n";
    CAPTURE(others);
    CHECK(found != outcome.warnings.end());
    if (found != outcome.warnings.end()) CHECK(contains(found->second, mistake.remedy));
    const bool dropped = std::string(mistake.key).starts_with("wild_") ||
                         std::string(mistake.key).starts_with("dropped_") ||
                         std::string(mistake.key).starts_with("invalid_");
    if (!dropped) CHECK_FALSE(outcome.tracks_at_end);  // what is dropped has no effect
  }
}

TEST_CASE("right input is not called wrong: hands, rest, a bus, a roundabout, cameras of every mount") {
  const Motion motions[] = {{},
                            {0.2, 3, kNoSurge, 0},
                            {0, 0, kNoSurge, 0},
                            {0, 0.02, kNoSurge, 0},
                            {0.05, 0.3, {4, 0, 0}, 0},
                            {0.05, 0.3, {0, 3, 0}, 0.6},
                            {1.2, 5, kNoSurge, 0},
                            {0.6, 0, kNoSurge, 0}};
  for (const Motion& motion : motions)
    for (const bool camera : {false, true}) {
      Input input;
      input.motion = motion, input.camera = camera, input.seconds = 15;
      const Outcome outcome = run(input);
      std::string said;
      for (const auto& [key, text] : outcome.warnings) said += key + ": " + text + "\n";
      CAPTURE(motion.swing_rad);
      CAPTURE(camera);
      CHECK(said == "");
      CHECK(outcome.tracks_at_end);
    }
}

TEST_CASE(
    "a way that bends as the gyroscope turns is not mirrored; one of a phone that is turned in the hand neither") {
  for (const double yaw_radps : {0.2, 0.0, -0.4}) {
    Input input;
    input.seconds = 60, input.motion = {0.1, 2.5, kNoSurge, yaw_radps}, input.further = circle(false, 1);
    CHECK(run(input).warnings.count("gnss_mirrored") == 0);
  }
}

TEST_CASE("a velocity that fits the positions is right; none while these wander, and one that is a quarter off too") {
  for (const double velocity : {1.0, 0.0, 0.75, 1.3}) {
    Input input;
    input.seconds = 60, input.motion = {0.1, 2.5, kNoSurge, 2.0 / 30}, input.further = walk(velocity, false);
    CAPTURE(velocity);
    CHECK(run(input).warnings.count("gnss_velocity") == 0);
  }
}

namespace {

/// Whether pictures 20 times a second are found to repeat: at rest for 3 s, then turning at 0.8 rad/s for 3 s.
bool repeat(const std::function<std::vector<uint8_t>(int i, double turned_rad)>& picture) {
  bool found = false;
  PictureCheck check([&](InputFault fault, bool wrong, double, const SignedAxes&) {
    found = found || (wrong && fault == InputFault::picture_repeated);
  });
  auto c = make_message<odo_calibration>(ODO_TYPE_CALIBRATION, 0);
  c.header.flags = ODO_CALIBRATION_EXTRINSICS;
  c.width = Pictures::kWidth, c.height = Pictures::kHeight, c.fx = c.fy = Pictures::kFocal_px, c.cx = 80, c.cy = 60;
  put_quaternion(rear_camera_mount(), c.q_b_c);
  check.add(c);
  for (int i = 0; i < 1200; ++i) {
    const double t = i / 200.0, rate = t < 3 ? 0 : 0.8;
    check.add(imu_at(static_cast<int64_t>(t * 1e9), Vector3d(0, rate, 0), Vector3d(0, 9.81, 0)));
    if (i % 10 != 0) continue;
    const auto pixels = picture(i / 10, rate * (t - 3));
    auto frame = make_message<odo_frame>(ODO_TYPE_FRAME, static_cast<int64_t>(t * 1e9));
    frame.format = ODO_FORMAT_GREY8, frame.width = Pictures::kWidth, frame.height = Pictures::kHeight;
    frame.planes[0] = {pixels.data(), frame.width, 1, 0};
    check.add(frame);
  }
  return found;
}

}  // namespace

TEST_CASE("pictures repeat at rest and at night; while the camera turns they must not") {
  const Pictures pictures;
  const auto turned = [&](double rad) {
    return pictures.at(Quaterniond(0.5, 0.5, 0.5, 0.5) * Quaterniond(Eigen::AngleAxisd(rad, Vector3d::UnitY())));
  };
  CHECK_FALSE(repeat([&](int, double rad) { return turned(rad); }));
  CHECK(repeat([&](int i, double rad) { return turned(rad - (i % 2) * 0.04 * (rad > 0)); }));
  CHECK_FALSE(repeat([](int, double rad) {  // a lamp in the dark
    std::vector<uint8_t> pixels(size_t(Pictures::kWidth) * Pictures::kHeight, 0);
    const auto at = static_cast<size_t>(20 + 100 * std::fmod(rad, 1.0));
    for (size_t v = 40; v < 46; ++v)
      std::fill_n(pixels.begin() + static_cast<int64_t>(v * Pictures::kWidth + at), 6, 255);
    return pixels;
  }));
}

TEST_CASE("a pause is no batch of samples") {
  Input input;
  input.time = [](int64_t t_ns) {
    const bool later = t_ns > kStart_ns + 6 * kSecond_ns;
    return later ? t_ns + 3600 * kSecond_ns : t_ns;
  };
  CHECK(run(input).warnings.count("imu_batched") == 0);
}

TEST_CASE("a fault that ends is forgotten, and the pose tracks again") {
  Input input;
  input.seconds = 30;
  input.imu = [](odo_imu& m) {
    if (m.header.t_ns < kStart_ns + 10'000'000'000)
      for (double& x : m.accel_b) x /= 9.80665;
  };
  const Outcome outcome = run(input);
  CHECK(outcome.warnings.count("accel_in_g") == 1);
  CHECK(outcome.tracks_at_end);
}

TEST_CASE("an accelerometer that is clipped for a while is named late in a session too, and forgotten") {
  Input input;
  input.seconds = 40;
  input.imu = [](odo_imu& m) {
    const bool clips = m.header.t_ns > kStart_ns + 15 * kSecond_ns && m.header.t_ns < kStart_ns + 25 * kSecond_ns;
    for (double& x : m.accel_b) x = clips ? std::clamp(x, -10.5, 10.5) : x;
  };
  const Outcome outcome = run(input);
  CHECK(outcome.warnings.count("accel_clipped") == 1);
  CHECK(outcome.tracks_at_end);
}

TEST_CASE("samples that no plugin uses are noted once and change nothing") {
  Input input;
  input.camera = true;
  const Outcome outcome = run(input);
  CHECK(outcome.notes.count("unused_frame") == 1);
  CHECK(outcome.tracks_at_end);
}
