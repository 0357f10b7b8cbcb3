// SPDX-License-Identifier: Apache-2.0
#include <opencv2/imgcodecs.hpp>

#include "sdk/tools/evaluation/degrade.hpp"
#include "sdk/tools/evaluation/evaluation.hpp"
#include "tests/support/runs.hpp"
#include "tests/support/messages.hpp"

TEST_SUITE_BEGIN("degrade");

namespace {

constexpr int64_t kBegin_ns = 1'000'000'000'000;

/// Ten minutes of IMU at 200 Hz, rotating at 0.1 rad/s about x, and frames at 10 Hz from 1 s on.
Recording recording(bool apart = false) {
  Recording r;
  auto calibration = make_message<odo_calibration>(ODO_TYPE_CALIBRATION, kBegin_ns);
  calibration.model = ODO_CAMERA_PINHOLE, calibration.width = 640, calibration.height = 480,
  calibration.fx = calibration.fy = 500;
  calibration.line_time_ns = 30'000;
  r.add(calibration.header);
  for (int64_t i = 0; i < 120'000; ++i) {
    auto imu = imu_at(kBegin_ns + i * 5'000'000, {0.1, 0, 0}, {0, 0, 9.81});
    if (apart) imu.header.flags = i % 2 ? ODO_IMU_GYRO : ODO_IMU_ACCEL;
    r.add(imu.header);
  }
  for (int64_t i = 10; i < 6000; ++i) {
    auto frame = make_message<odo_frame>(ODO_TYPE_FRAME, kBegin_ns + i * 100'000'000);
    frame.line_time_ns = 30'000;
    r.add(frame.header);
    r.truth.push_back({frame.header.t_ns, Eigen::Quaterniond::Identity(), Eigen::Vector3d::Zero()});
  }
  r.sort();
  return r;
}

std::vector<odo_imu> imu(const Recording& r) { return messages_of<odo_imu>(r, ODO_TYPE_IMU); }
std::vector<odo_frame> frames(const Recording& r) { return messages_of<odo_frame>(r, ODO_TYPE_FRAME); }

template <class Value>
Statistics over(const std::vector<odo_imu>& samples, Value value) {
  std::vector<double> values;
  for (const odo_imu& s : samples) values.push_back(value(s));
  return statistics_of(values);
}

bool in_order(const Recording& r) {
  int64_t last = INT64_MIN;
  for (const RecordedMessage& m : r.messages) {
    if (m.message.header().t_ns < last) return false;
    last = m.message.header().t_ns;
  }
  return true;
}

}  // namespace

TEST_CASE("an empty degradation changes nothing") {
  const Recording before = recording(), after = degraded(before, {}, 1);
  REQUIRE(after.messages.size() == before.messages.size());
  for (size_t i = 0; i < before.messages.size(); ++i)
    REQUIRE(std::ranges::equal(after.messages[i].message.bytes(), before.messages[i].message.bytes()));
}

TEST_CASE("the same seed is bit-identical, and another seed gives other noise") {
  const Recording r = recording();
  const Degradation d{.imu_noise_factor = 5, .stamp_jitter_s = 1e-3, .outliers_per_minute = 1};
  const auto a = imu(degraded(r, d, 1)), b = imu(degraded(r, d, 1)), c = imu(degraded(r, d, 2));
  CHECK(std::memcmp(a.data(), b.data(), a.size() * sizeof(odo_imu)) == 0);
  CHECK(a[100].gyro_b[0] != c[100].gyro_b[0]);
  CHECK(a[100].header.t_ns != c[100].header.t_ns);
}

TEST_CASE("noise of five times a phone's, bias and scale have the requested size") {
  const auto samples = imu(degraded(recording(), {.imu_noise_factor = 5}, 3));
  const double root = std::sqrt(200.0 * 24);
  const auto gyro = over(samples, [](const odo_imu& s) { return s.gyro_b[0]; });
  CHECK(std::abs(gyro.std - root * kPhoneGyroNoise) < 0.02 * root * kPhoneGyroNoise);
  CHECK(std::abs(gyro.mean - 0.1) < 0.0005);
  CHECK(over(samples, [](const odo_imu& s) { return s.accel_b[2]; }).std ==
        doctest::Approx(root * kPhoneAccelNoise).epsilon(0.02));
  const auto biased = imu(degraded(recording(), {.accel_bias_mps2 = 0.3, .imu_scale_error = 0.02}, 3));
  CHECK(biased[7].accel_b[0] == doctest::Approx(0.3));
  CHECK(biased[7].accel_b[2] == doctest::Approx(9.81 * 1.02 + 0.3));
  CHECK(biased[7].gyro_b[0] == doctest::Approx(0.102));
}

TEST_CASE("200 Hz is decimated evenly to 50 Hz, whether the sensors come together or separately") {
  for (const bool apart : {false, true}) {
    const auto samples = imu(degraded(recording(apart), {.imu_rate_hz = 50}, 1));
    std::map<uint32_t, int64_t> last;
    for (const odo_imu& s : samples) {
      const auto before = last.find(s.header.flags);
      if (before != last.end()) REQUIRE(s.header.t_ns - before->second == 20'000'000);
      last[s.header.flags] = s.header.t_ns;
    }
    CHECK(last.size() == (apart ? 2 : 1));
    CHECK(samples.size() == (apart ? 60'000 : 30'000));
  }
}

TEST_CASE("without an accelerometer there is neither its flag nor a sample of it alone") {
  for (const bool apart : {false, true}) {
    const auto samples = imu(degraded(recording(apart), {.accelerometer = false}, 1));
    CHECK(samples.size() == (apart ? 60'000 : 120'000));
    for (const odo_imu& s : samples) {
      REQUIRE(s.header.flags == ODO_IMU_GYRO);
      REQUIRE(s.accel_b[2] == 0);
    }
  }
}

TEST_CASE("a time offset shifts the IMU against the frames, and a line time changes in both of its fields") {
  const Recording before = recording(), after = degraded(before, {.time_offset_s = -0.02, .line_time_factor = 1.2}, 1);
  CHECK(imu(after)[5].header.t_ns == imu(before)[5].header.t_ns - 20'000'000);
  CHECK(frames(after)[5].header.t_ns == frames(before)[5].header.t_ns);
  CHECK(frames(after)[5].line_time_ns == 36'000);
  CHECK(messages_of<odo_calibration>(after, ODO_TYPE_CALIBRATION)[0].line_time_ns == 36'000);
  CHECK(in_order(after));
}

TEST_CASE("a recording ends at the given time, loses a share of its frames, and its light changes") {
  const Recording before = recording();
  const auto cut = frames(degraded(before, {.length_s = 8}, 1));
  REQUIRE_FALSE(cut.empty());
  CHECK(cut.back().header.t_ns == kBegin_ns + 1'000'000'000 + 8'000'000'000);
  const auto whole = frames(before), fewer = frames(degraded(before, {.lost_frames = 0.1}, 1));
  CHECK(static_cast<double>(fewer.size()) / static_cast<double>(whole.size()) == doctest::Approx(0.9).epsilon(0.02));
  double least = 2, most = 0;
  for (const RecordedMessage& m : degraded(before, {.gamma = 2.2, .flicker = 0.5}, 1).messages) {
    if (m.message.header().type != ODO_TYPE_FRAME) continue;
    CHECK(m.picture.gamma_percent == 220);
    least = std::min(least, m.picture.gain_percent / 100.0), most = std::max(most, m.picture.gain_percent / 100.0);
  }
  CHECK(least == doctest::Approx(0.5).epsilon(0.01));
  CHECK(most == doctest::Approx(1.5).epsilon(0.01));
}

TEST_CASE("jittering time stamps keep their order and have the requested deviation") {
  const Recording after = degraded(recording(), {.stamp_jitter_s = 1.4e-3}, 1);
  CHECK(in_order(after));
  const auto samples = imu(after);
  std::vector<double> off;
  for (size_t i = 0; i < samples.size(); ++i) {
    off.push_back(1e-9 * static_cast<double>(samples[i].header.t_ns - kBegin_ns) - 0.005 * static_cast<double>(i));
    if (i > 0) REQUIRE(samples[i].header.t_ns > samples[i - 1].header.t_ns);
  }
  CHECK(std::abs(statistics_of(off).std - 1.4e-3) < 0.05 * 1.4e-3);
}

TEST_CASE("one outlier per minute is at full scale on every axis") {
  size_t wild = 0;
  for (const odo_imu& s : imu(degraded(recording(), {.outliers_per_minute = 1}, 4))) {
    if (s.accel_b[2] == 9.81) continue;
    ++wild;
    for (int k = 0; k < 3; ++k) {
      CHECK(std::abs(s.accel_b[k]) == kOutlierAccel_mps2);
      CHECK(std::abs(s.gyro_b[k]) == kOutlierGyro_radps);
    }
  }
  CHECK(wild == Between{3, 20});  // ten expected
}

TEST_CASE("a cut starts within the recording and keeps the sensors' descriptions") {
  const Recording r = degraded(recording(), {.cut_s = 60}, 1);
  CHECK(frames(r).front().header.t_ns == kBegin_ns + 61'000'000'000);
  CHECK(imu(r).front().header.t_ns == kBegin_ns + 61'000'000'000);
  REQUIRE(messages_of<odo_calibration>(r, ODO_TYPE_CALIBRATION).size() == 1);
  CHECK(r.messages.front().message.header().type == ODO_TYPE_CALIBRATION);
  CHECK(in_order(r));
  CHECK(r.truth.size() == recording().truth.size());
}

TEST_CASE("frames are missing in a gap and black in the dark, counted from the first one after the cut") {
  const Recording r =
      degraded(recording(), {.cut_s = 60, .gap_from_s = 10, .gap_for_s = 2, .dark_from_s = 20, .dark_for_s = 3}, 1);
  const int64_t first = frames(r).front().header.t_ns;
  size_t missing = 20, black = 0;
  for (const RecordedMessage& m : r.messages) {
    if (m.message.header().type != ODO_TYPE_FRAME) continue;
    const double s = static_cast<double>(m.message.header().t_ns - first) * 1e-9;
    missing -= s >= 10 && s < 12;
    CHECK((m.picture.gain_percent == 0) == (s >= 20 && s < 23));
    black += m.picture.gain_percent == 0;
  }
  CHECK(missing == 20);
  CHECK(black == 30);
  CHECK(imu(r).size() == imu(degraded(recording(), {.cut_s = 60}, 1)).size());
}

TEST_CASE("a black picture has the size of the original") {
  const TemporaryFolder folder;
  const auto file = folder / "bright.png";
  REQUIRE(cv::imwrite(file.string(), cv::Mat(6, 8, CV_8UC1, cv::Scalar(200))));
  RecordedMessage m;
  m.message.assign(make_message<odo_frame>(ODO_TYPE_FRAME, 0).header);
  m.picture = {.file = std::make_shared<const std::filesystem::path>(file)};
  for (const bool black : {false, true}) {
    m.picture.gain_percent = black ? 0 : 100;
    const auto frame = required(load_frame(m));
    CHECK(frame->width == 8);
    CHECK(frame->height == 6);
    CHECK(frame->planes[0].data[13] == (black ? 0 : 200));
    frame->loan.release(frame->loan.owner);
  }
}

TEST_CASE("the table of sensors has each fault once, starting with none") {
  const auto all = sensor_qualities();
  CHECK(all.size() == 15);
  CHECK(all.front().name == "as recorded");
  std::map<std::string, int> names;
  for (const Degradation& d : all) ++names[d.name];
  CHECK(names.size() == all.size());
}
