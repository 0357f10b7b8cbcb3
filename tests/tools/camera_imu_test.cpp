// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/config/camera_yaml.hpp"
#include "sdk/tools/replay/camera_imu_source.hpp"
#include "tests/tools/camera_imu_motion.hpp"
#include "tests/support/support.hpp"

namespace {

constexpr double kDegree = 0.017453292519943295;

/// A different phone for each seed: any mount, offsets up to 150 ms, readouts of 5 to 25 ms.
HandHeld phone(uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> even(-1, 1);
  HandHeld phone;
  // The camera looks forward; the body's axes are arbitrary.
  const Eigen::Quaterniond mount =
      Eigen::Quaterniond{even(random), even(random), even(random), even(random)}.normalized();
  phone.q_b_c = Eigen::Quaterniond(0, 1, 0, 0);
  phone.mount = mount;
  phone.time_offset_s = 0.15 * even(random);
  phone.row_time_s = 30e-6 + 20e-6 * even(random);
  return phone;
}

/// Initial values of a calibration: no mount and times, a focal length 3 % off.
CameraImuData unknown(const HandHeld& phone, uint64_t seed) {
  CameraImuData data = phone.data(seed);
  data.given.header.flags = 0;
  data.given_row_time_s = 0;
  data.given.fx *= 1.03, data.given.fy *= 1.03;
  return data;
}

}  // namespace

TEST_SUITE_BEGIN("camera_imu");

TEST_CASE("without initial values: mount within 0.2 degrees, offset within 0.5 ms, row time within 5 % while walking") {
  for (uint64_t seed = 1; seed <= 6; ++seed) {
    CAPTURE(seed);
    HandHeld held = phone(seed);
    if (seed % 2 == 0) held.walk_mps = 0.15;
    const auto found = required(calibrate_camera_imu(unknown(held, seed), {}));
    CHECK(found->rotation_observable);
    const bool walks = seed % 2;
    // On the spot the corners and a small path share the effect of the row time: of 12 phones the worst are 0.48
    // degrees, 1.5 ms and 3.9 us off.
    CHECK(found->q_b_c.angularDistance(held.q_b_c_true()) < (walks ? 0.2 : 0.6) * kDegree);
    CHECK(std::abs(found->time_offset_s.value - held.time_offset_s) < (walks ? 5e-4 : 2e-3));
    CHECK(std::abs(found->row_time_s.value - held.row_time_s) < (walks ? 0.05 * held.row_time_s : 5e-6));
    CHECK(std::abs(found->focal_px.value / held.focal_px - 1) < (walks ? 0.01 : 0.03));
    CHECK(shutter_of(*found) == Shutter::rolling);
    CHECK(found->time_offset_s.sigma < 5e-4);
    CHECK((found->gyro_bias_b - held.mount * held.gyro_bias).norm() < 5e-3);
  }
}

TEST_CASE("noise-free tracks give the exact mount and times") {
  HandHeld held = phone(9);
  held.noise_px = 0, held.gyro_noise_rps = 0, held.imu_hz = 400;
  const auto found = required(calibrate_camera_imu(unknown(held, 9), {}));
  CHECK(found->q_b_c.angularDistance(held.q_b_c_true()) < 0.03 * kDegree);
  CHECK(std::abs(found->time_offset_s.value - held.time_offset_s) < 1e-4);
  CHECK(std::abs(found->row_time_s.value / held.row_time_s - 1) < 0.02);
}

TEST_CASE("a global shutter is detected") {
  HandHeld held = phone(3);
  held.row_time_s = 0;
  const auto found = required(calibrate_camera_imu(unknown(held, 3), {}));
  CHECK(std::abs(found->row_time_s.value) < 1e-6);
  CHECK(shutter_of(*found) != Shutter::rolling_up);
}

TEST_CASE("the same recording gives bit-identical figures") {
  const CameraImuData data = unknown(phone(2), 2);
  const auto one = calibrate_camera_imu(data, {}), other = calibrate_camera_imu(data, {});
  REQUIRE(one);
  REQUIRE(other);
  CHECK(one->time_offset_s.value == other->time_offset_s.value);
  CHECK(one->q_b_c.coeffs() == other->q_b_c.coeffs());
  CHECK(one->row_time_s.sigma == other->row_time_s.sigma);
}

TEST_CASE("an unobservable parameter keeps its given value and is reported") {
  // Slow rotation with coarse corners: a row time is unobservable to 0.1 ms per picture, and so is the lens.
  HandHeld held = phone(5);
  held.rotation_rad *= 0.25, held.noise_px = 2, held.seconds = 12;
  CameraImuData data = held.data(5);
  data.given_row_time_s = 12e-6;
  const auto found = required(calibrate_camera_imu(data, {.max_readout_sigma_s = 1e-4}));
  CHECK_FALSE(found->row_time_s.observable);
  CHECK(found->row_time_s.value == 12e-6);
  CHECK_FALSE(found->focal_px.observable);
  CHECK(found->focal_px.value == held.focal_px);
  bool said = false;
  for (const auto& warning : warnings_about(*found))
    said = said || warning.find("row time is not observable") != warning.npos;
  CHECK(said);
}

TEST_CASE("insufficient data gives an error text") {
  const auto words = [](const CameraImuData& data) { return calibrate_camera_imu(data, {}).failure().text; };
  const CameraImuData good = unknown(phone(1), 1);
  CameraImuData data = good;
  data.frames.clear();
  CHECK(contains(words(data), "no frames"));
  data = good, data.gyro.clear();
  CHECK(contains(words(data), "no IMU"));
  data = good;
  for (auto& sample : data.gyro) sample.rate_b *= 0.01;
  CHECK(contains(words(data), "too little rotation"));
  data = good;
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal(0, 0.5);
  for (auto& sample : data.gyro) sample.rate_b = {normal(random), normal(random), normal(random)};
  CHECK(contains(words(data), "does not match the gyroscope"));
  data = good;
  for (auto& frame : data.frames) frame.ids.resize(8), frame.pixels.resize(8);
  CHECK(contains(words(data), "enough corners"));
}

TEST_CASE("the written camera.yaml is read back with mount and times") {
  const HandHeld held = phone(4);
  const auto found = required(calibrate_camera_imu(unknown(held, 4), {}));
  const TemporaryFolder folder;
  const auto read = read_camera_yaml(write_text(folder / "camera.yaml", camera_yaml(*found)), nullptr);
  REQUIRE_MESSAGE(read, (read ? "" : read.failure().text));
  CHECK((read->header.flags & (ODO_CALIBRATION_EXTRINSICS | ODO_CALIBRATION_TIME_OFFSET | ODO_CALIBRATION_LINE_TIME)) ==
        7);
  CHECK(std::abs(read->time_offset_ns - found->time_offset_s.value * 1e9) < 1000);
  CHECK(std::abs(read->line_time_ns - found->row_time_s.value * 1e9) < 10);
  CHECK(read->fx == doctest::Approx(found->focal_px.value).epsilon(1e-8));
  CHECK(std::abs(read->q_b_c[1] - found->q_b_c.x()) < 1e-8);
}

TEST_CASE("real recordings match a drone's published calibration and another calibrator's for a phone" *
          doctest::test_suite("camera_imu_data")) {
  if (const auto folder = data_or_skip("euroc_mh05"); !folder.empty()) {
    const auto recording = required(read_recording(folder));
    auto data = required(camera_imu_data(*recording));
    const odo_calibration published = data->given;
    data->given.header.flags = 0;
    const auto found = required(calibrate_camera_imu(*data, {}));
    const double* q = published.q_b_c;
    CHECK(found->q_b_c.angularDistance(Eigen::Quaterniond(q[0], q[1], q[2], q[3])) < 0.5 * kDegree);
    CHECK(std::abs(found->time_offset_s.value) < 1e-3);
    CHECK(shutter_of(*found) != Shutter::rolling);
  }
  if (const auto folder = data_or_skip("phone_house"); !folder.empty()) {
    const auto recording = required(read_recording(folder));
    auto data = required(camera_imu_data(*recording));
    const auto found = required(calibrate_camera_imu(*data, {}));
    CHECK(found->q_b_c.angularDistance(found->given_q_b_c) < 2 * kDegree);
    CHECK(std::abs(found->time_offset_s.value + 0.002) < 1.5e-3);  // OpenVINS: -2 ms
    CHECK(std::abs(found->focal_px.value / 502 - 1) < 0.03);       // OpenVINS: 502 px
  }
}
