// SPDX-License-Identifier: Apache-2.0
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "sdk/math/scalar.hpp"
#include "sdk/tools/simulation/codec.hpp"
#include "sdk/tools/simulation/random.hpp"
#include "sdk/tools/simulation/walker.hpp"
#include "tests/tools/tags.hpp"

using Eigen::Vector2d;
using Eigen::Vector3d;

TEST_SUITE_BEGIN("phone_camera");

namespace {

constexpr double kDeg = kPi / 180;

Scenario tiny(const std::string& profile) {
  Scenario s;
  s.camera.width = 96, s.camera.height = 64;
  take_camera_of(profile, s.camera), take_imu_of(profile, s.imu);
  s.camera.focal_px = 80;
  s.route = {{0, 0, 0}, {4, 0, 0}};
  return s;
}

/// The phone at rest at the origin, rotating about its y axis by that angle of time.
template <class Angle>
Motion rotating(double duration_s, const Angle& angle) {
  std::vector<Vector3d> p;
  std::vector<Eigen::Quaterniond> q;
  for (double t = 0; t <= duration_s; t += 0.0025) {
    p.emplace_back(0, 0, 0);
    q.emplace_back(Eigen::AngleAxisd(angle(t), Vector3d::UnitY()));
  }
  return {400, std::move(p), std::move(q)};
}

Scenario::Camera stabilised() {
  Scenario::Camera c;
  c.stabiliser.travel_rad = 0.9 * kDeg, c.stabiliser.residual_px = 0;
  c.row_time_s = 0;
  return c;
}

/// Standard deviation of the pixel of a distant point ahead, px.
double wobble_px(const Scenario::Camera& c, const Motion& phone, double from_s) {
  const SimCamera camera(c, 1, 1, &phone);
  const Vector3d ahead = camera.pose(phone, 0) * Vector3d(0, 0, 1000);
  double sum = 0, squares = 0, n = 0;
  for (double t = from_s; t < phone.duration_s() - 0.1; t += 0.004) {
    const auto pixel = required(camera.project_rolling(phone, t, ahead));
    sum += pixel->x(), squares += pixel->x() * pixel->x(), n += 1;
  }
  return std::sqrt(std::max(0.0, squares / n - sum / n * (sum / n)));
}

/// A textured picture that drifts by half a pixel per frame.
cv::Mat textured(int frame) {
  cv::Mat noise(160, 240, CV_8U), picture;
  Random random(3, 3);
  for (int y = 0; y < noise.rows; ++y)
    for (int x = 0; x < noise.cols; ++x) noise.at<uint8_t>(y, x) = static_cast<uint8_t>(random.uniform(0, 255));
  cv::GaussianBlur(noise, noise, {}, 1.2);
  const cv::Mat shift = (cv::Mat_<double>(2, 3) << 1, 0, 0.5 * frame, 0, 1, 0.25 * frame);
  cv::warpAffine(noise, picture, shift, noise.size(), cv::INTER_LINEAR, cv::BORDER_REFLECT);
  return picture;
}

double rms_after(double bit_rate, int frames) {
  VideoCodec codec({.bit_rate = bit_rate});
  double last = 0;
  for (int k = 0; k < frames; ++k) {
    const cv::Mat picture = textured(k), shown = codec.pass(picture);
    REQUIRE(shown.size() == picture.size());
    last = cv::norm(shown, picture, cv::NORM_L2) / std::sqrt(static_cast<double>(picture.total()));
    CHECK(codec.bits() <= (k == 0 ? 4.001 : 1.001) * bit_rate / 30);
  }
  return last;
}

}  // namespace

TEST_CASE("the clean profile has none of a phone's errors, and a static lens changes no pixel") {
  const Scenario clean = tiny("clean"), plain = [] {
    Scenario s;
    s.camera.width = 96, s.camera.height = 64, s.camera.focal_px = 80;
    s.route = {{0, 0, 0}, {4, 0, 0}};
    return s;
  }();
  const TemporaryFolder folder;
  REQUIRE(simulate(clean, 5, folder / "a.odo", {.threads = 1}).ok());
  REQUIRE(simulate(plain, 5, folder / "b.odo", {.threads = 1}).ok());
  CHECK(read_text(folder / "a.odo") == read_text(folder / "b.odo"));
  const auto recording = read_recording(folder / "a.odo");
  const auto frames = messages_of<odo_frame>(*recording, ODO_TYPE_FRAME);
  REQUIRE(frames.size() == recording->truth.size());
  for (size_t i = 0; i < frames.size(); ++i) CHECK(frames[i].header.t_ns == recording->truth[i].t_ns);
  // Values of the simulator before phone profiles: a change of its random numbers or its light shows here.
  const auto imu = messages_of<odo_imu>(*recording, ODO_TYPE_IMU);
  REQUIRE(imu.size() > 500);
  CHECK(imu[500].gyro_b[0] == doctest::Approx(0.28462).epsilon(1e-6));
  CHECK(imu[500].accel_b[1] == doctest::Approx(7.7088).epsilon(1e-6));
  std::vector<double> greys;
  for_each_picture(*recording, [&](const odo_frame& frame) { greys.push_back(mean_grey(frame)); });
  CHECK(greys[0] == doctest::Approx(116.251).epsilon(1e-4));
}

TEST_CASE("the stabiliser compensates a fast shake within its travel and lets slow rotation through") {
  const auto shake = rotating(4, [](double t) { return 0.2 * kDeg * std::sin(2 * kPi * 6 * t); });
  const Scenario::Camera with = stabilised(), without = [] {
    Scenario::Camera c = stabilised();
    c.stabiliser.travel_rad = 0;
    return c;
  }();
  const double free_px = wobble_px(without, shake, 1), held_px = wobble_px(with, shake, 1);
  CHECK(std::abs(free_px - 500 * 0.2 * kDeg / std::sqrt(2.0)) < 0.02 * std::abs(500 * 0.2 * kDeg / std::sqrt(2.0)));
  CHECK(held_px < 0.35 * free_px);
  const auto slow = rotating(40, [](double t) { return 1.5 * kDeg * std::sin(2 * kPi * 0.05 * t); });
  CHECK(wobble_px(with, slow, 5) > 0.9 * wobble_px(without, slow, 5));
  // A rotation far beyond the travel moves the lens to its end and no farther.
  const auto wide = rotating(6, [](double t) { return 8 * kDeg * std::sin(2 * kPi * 1.9 * t); });
  const SimCamera camera(with, 1, 1, &wide);
  double most = 0;
  for (double t = 1; t < 5; t += 0.01) most = std::max(most, camera.lens().at(t).shift_px.norm());
  CHECK(most > 0.6 * 500 * 0.9 * kDeg);
  CHECK(most <= 500 * 0.9 * kDeg);
}

TEST_CASE("pixels rendered through a moving lens match the truth") {
  const TemporaryFolder folder;
  Scenario s = past_a_tag();
  take_camera_of("phone", s.camera);
  s.camera.rate_hz = 4;
  s.camera.focus.breathing = 0.03;
  const Recording recording = recorded(s, 2, folder / "tag.odo");
  const Journey walk = make_walk(s, 2);
  const SimCamera still(s.camera, 1, 2);
  double furthest = 0;  // error with a static lens
  const Vector3d corner = World(s, 2).known_objects()[0].corners[0];
  check_tags(recording, 0.7, [&](int64_t t_ns, const Vector2d& found) {
    const auto plain = still.project_rolling(walk.phone, static_cast<double>(t_ns) * 1e-9 - 1000, corner);
    if (plain) furthest = std::max(furthest, (*plain - found).norm());
  });
  CHECK(furthest > 2);
}

TEST_CASE("autofocus moves the focal length within its breathing, in moves of the given length") {
  Scenario::Camera c;
  c.focus = {0.012, 1.5, 0.3};
  const auto still = rotating(120, [](double) { return 0.0; });
  const SimCamera camera(c, 1, 7, &still);
  double low = 2, high = 0, fastest = 0, moving = 0, n = 0;
  for (double t = 0; t < 119; t += 0.01, n += 1) {
    const double f = camera.lens().at(t).focal, rate = std::abs(camera.lens().at(t + 0.01).focal - f) / 0.01;
    low = std::min(low, f), high = std::max(high, f), fastest = std::max(fastest, rate);
    moving += rate > 1e-6;
  }
  CHECK(low >= 1 - 0.012);
  CHECK(high <= 1 + 0.012);
  CHECK(high - low > 0.015);
  CHECK(fastest < 2 * 0.012 * 1.5 / 0.3 * 1.01);
  CHECK(std::abs(moving / n - 0.3 / 1.8) < 0.3 * 0.3 / 1.8);
  // A corner of the picture moves along its radius, the middle does not.
  const Vector3d p(3, 2, 10);
  const Eigen::Isometry3d T = camera.pose(still, 0);
  const auto a = camera.project_rolling(still, 5, T * p), b = camera.project_rolling(still, 60, T * p);
  REQUIRE(a);
  REQUIRE(b);
  const Vector2d middle(camera.cx(), camera.cy());
  CHECK((*a - middle).norm() / (*b - middle).norm() ==
        doctest::Approx(camera.lens().at(5).focal / camera.lens().at(60).focal).epsilon(1e-6));
}

TEST_CASE("the recording keeps the nominal lens, row time and clock, the truth the true ones") {
  Scenario s = tiny("phone_old");
  s.camera.row_time_error = 0.2, s.camera.focal_error = 0.02, s.camera.bit_rate = 0;
  s.route = {{0, 0, 0}, {30, 0, 0}};
  const Recording recording = recorded(s, 3, true);
  const auto frames = messages_of<odo_frame>(recording, ODO_TYPE_FRAME);
  REQUIRE(frames.size() > 100);
  REQUIRE(frames.size() == recording.truth.size());
  CHECK(static_cast<double>(frames[0].line_time_ns) == doctest::Approx(1.2 * 31e6 / 64).epsilon(1e-5));
  double mean = 0, squares = 0;
  std::vector<int64_t> exposures;
  for (size_t i = 0; i < frames.size(); ++i) {
    const double off = 1e-9 * static_cast<double>(frames[i].header.t_ns - recording.truth[i].t_ns);
    mean += off, squares += off * off;
    exposures.push_back(frames[i].exposure_ns);
  }
  mean /= static_cast<double>(frames.size());
  const double sigma = std::sqrt(squares / static_cast<double>(frames.size()) - mean * mean);
  // The first row's start is computed from the middle with a row time that is 20 % too long.
  CHECK(std::abs(mean - (-30e-3 + 0.5 * 63 * 0.2 * 31e-3 / 64)) <
        0.03 * std::abs(-30e-3 + 0.5 * 63 * 0.2 * 31e-3 / 64));
  CHECK(std::abs(sigma - 3e-3) < 0.25 * 3e-3);
  CHECK(*std::min_element(exposures.begin(), exposures.end()) == 20'000'000);
  CHECK(*std::max_element(exposures.begin(), exposures.end()) == 33'000'000);
  for (const auto& m : recording.messages)
    if (m.message.header().type == ODO_TYPE_CALIBRATION) {
      const auto& c = as<odo_calibration>(m.message.header());
      CHECK(c.fx == doctest::Approx(1.02 * 80));
      CHECK(c.time_offset_ns == 0);
    }
}

TEST_CASE("a lens that reports itself has a calibration for each frame, correct up to its error") {
  Scenario s = tiny("phone_reported");
  s.camera.focal_px = 500;  // shifts in pixels
  const Recording recording = recorded(s, 3, true);
  const Journey walk = make_walk(s, 3);
  const SimCamera camera(s.camera, 1, 3, &walk.phone);
  size_t reports = 0, frame = 0;
  double squares = 0, moved = 0;
  odo_calibration last{};
  for (const auto& m : recording.messages) {
    if (m.message.header().type == ODO_TYPE_CALIBRATION) last = as<odo_calibration>(m.message.header()), ++reports;
    if (m.message.header().type != ODO_TYPE_FRAME) continue;
    const auto lens = camera.lens().at(1e-9 * static_cast<double>(recording.truth[frame++].t_ns) - 1000);
    const Vector2d reported(last.cx - camera.cx(), last.cy - camera.cy());
    squares += (reported - lens.shift_px).squaredNorm(), moved = std::max(moved, lens.shift_px.norm());
    CHECK(last.fx == doctest::Approx(500 * lens.focal));
  }
  CHECK(reports == frame + 1);
  CHECK(moved > 2);
  CHECK(std::abs(std::sqrt(squares / (2 * static_cast<double>(frame))) - 0.4) < 0.12);
}

TEST_CASE("the video's error decreases with the bit rate, almost to zero") {
  const double fine = rms_after(2e7, 6), middle = rms_after(1e6, 6), coarse = rms_after(2e5, 6);
  CHECK(fine < 1.2);
  CHECK(middle > 1.3 * fine);
  CHECK(coarse == Between{1.3 * middle, 40});
}

TEST_CASE("a compressed recording is the same for any number of threads") {
  const TemporaryFolder folder;
  Scenario s = tiny("phone_indoors");
  s.route = {{0, 0, 0}, {3, 0, 0}};
  REQUIRE(simulate(s, 5, folder / "a.odo", {.threads = 1}).ok());
  REQUIRE(simulate(s, 5, folder / "b.odo", {.threads = 3}).ok());
  CHECK(read_text(folder / "a.odo") == read_text(folder / "b.odo"));
}
