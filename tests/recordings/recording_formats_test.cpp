// SPDX-License-Identifier: Apache-2.0
//
// Every number of every format: written and read again, or read from a synthetic file with distinct numbers.
#include <opencv2/imgcodecs.hpp>

#include "sdk/math/rotation.hpp"
#include "sdk/tools/recording/distortion.hpp"
#include "sdk/tools/recording/kalibr.hpp"
#include "sdk/tools/recording/mcap_writer.hpp"
#include "sdk/tools/recording/odo_file.hpp"
#include "tests/support/messages.hpp"
#include "tests/support/support.hpp"

using Eigen::Quaterniond;
using Eigen::Vector3d;

TEST_SUITE_BEGIN("recording");

namespace {

const Quaterniond kQ = Quaterniond(0.4, 0.5, -0.6, 0.7).normalized();

template <class Message>
Message first(const Recording& r, uint32_t type, uint32_t flags = 0) {
  for (const auto& m : r.messages)
    if (m.message.header().type == type && (m.message.header().flags & flags) == flags)
      return as<Message>(m.message.header());
  FAIL("no such message");
  return {};
}

void check_list(const double* found, std::initializer_list<double> expected) {
  for (const double x : expected) {
    CHECK(std::abs(*found - x) < 1e-9 * std::abs(x) + 1e-15);
    ++found;
  }
}

Recording read(const fs::path& path) {
  auto recording = required(read_recording(path));
  return std::move(*recording);
}

void picture(const fs::path& path) { cv::imwrite(path.string(), cv::Mat(48, 64, CV_8U, cv::Scalar(77))); }

TrueState a_state() {
  TrueState s{.t_ns = 71};
  s.q = kQ, s.p = {1, 2, 3}, s.v = {4, 5, 6}, s.gyro_bias = {7, 8, 9}, s.accel_bias = {10, 11, 12}, s.mode = 4;
  return s;
}

}  // namespace

TEST_CASE("all ground truth of a simulator is read back from an Odograph recording number by number") {
  const TemporaryFolder folder;
  const auto path = folder / "a.odo";
  auto writer = required(OdoWriter::create(path, 0));
  REQUIRE((*writer)->write(make_message<odo_imu>(ODO_TYPE_IMU, 1).header).ok());
  auto step = make_message<odo_step>(ODO_TYPE_STEP, 55);
  step.t_start_ns = 33, step.length_m = 0.7;
  REQUIRE((*writer)->write_true_step(step).ok());
  REQUIRE((*writer)->write_truth({61, kQ, {13, 14, 15}}).ok());
  REQUIRE((*writer)->write_true_state(a_state()).ok());
  REQUIRE((*writer)->write_true_skyline({81, {0.1F, 0.2F, 0.3F}, {10, 20, 30}}).ok());
  TrueSighting sighting{.t_ns = 91, .tag = 5, .visible = 0.75F};
  for (int i = 0; i < 8; ++i) sighting.corners_px[i] = 100 + i;
  REQUIRE((*writer)->write_true_sighting(sighting).ok());
  REQUIRE((*writer)->finish().ok());
  const Recording r = read(path);
  REQUIRE(r.truth.size() == 1);
  CHECK((r.truth[0].t_ns == 61 && r.truth[0].q.coeffs() == kQ.coeffs() && r.truth[0].p == Vector3d(13, 14, 15)));
  REQUIRE(r.true_states.size() == 1);
  const TrueState &s = r.true_states[0], t = a_state();
  CHECK((s.t_ns == 71 && s.mode == 4 && s.q.coeffs() == kQ.coeffs()));
  CHECK((s.p == t.p && s.v == t.v && s.gyro_bias == t.gyro_bias && s.accel_bias == t.accel_bias));
  REQUIRE(r.true_skylines.size() == 1);
  CHECK(r.true_skylines[0].t_ns == 81);
  CHECK(r.true_skylines[0].elevation_rad == std::vector<float>{0.1F, 0.2F, 0.3F});
  CHECK(r.true_skylines[0].distance_m == std::vector<float>{10, 20, 30});
  REQUIRE(r.true_sightings.size() == 1);
  CHECK((r.true_sightings[0].t_ns == 91 && r.true_sightings[0].tag == 5 && r.true_sightings[0].visible == 0.75F));
  check_list(r.true_sightings[0].corners_px, {100, 101, 102, 103, 104, 105, 106, 107});
  REQUIRE(r.true_steps.size() == 1);
  CHECK((r.true_steps[0].t_start_ns == 33 && r.true_steps[0].length_m == 0.7));
}

TEST_CASE("colours are read in their order, and a grey picture row by row") {
  const TemporaryFolder folder;
  auto writer = required(OdoWriter::create(folder / "a.odo", 0));
  std::vector<uint8_t> pixels(2 * 16);
  for (size_t i = 0; i < pixels.size(); ++i) pixels[i] = static_cast<uint8_t>(3 * i + 1);
  const std::pair<uint32_t, uint32_t> formats[] = {
      {ODO_FORMAT_GREY8, 1}, {ODO_FORMAT_RGB8, 3}, {ODO_FORMAT_RGBA8, 4}, {ODO_FORMAT_BGRA8, 4}};
  for (const auto& [format, channels] : formats) {
    auto frame = make_message<odo_frame>(ODO_TYPE_FRAME, format + 1);
    frame.format = format, frame.width = 3, frame.height = 2, frame.planes[0] = {pixels.data(), 16, channels, 0};
    REQUIRE((*writer)->write(frame.header).ok());
  }
  REQUIRE((*writer)->finish().ok());
  const Recording r = read(folder / "a.odo");
  REQUIRE(r.messages.size() == 4);
  for (const auto& m : r.messages) {
    const auto frame = required(load_frame(m));
    CHECK((frame->width == 3 && frame->height == 2));
    const uint32_t given = m.message.header().t_ns == ODO_FORMAT_GREY8 + 1  ? 1
                           : m.message.header().t_ns == ODO_FORMAT_RGB8 + 1 ? 3
                                                                            : 4;
    const uint32_t kept = std::min(given, 3U);
    const bool blue_first = m.message.header().t_ns == ODO_FORMAT_BGRA8 + 1;
    CHECK(frame->planes[0].pixel_stride == kept);
    for (uint32_t y = 0; y < 2; ++y)
      for (uint32_t x = 0; x < 3; ++x)
        for (uint32_t c = 0; c < kept; ++c)
          CHECK(frame->planes[0].data[y * frame->planes[0].row_stride + x * kept + c] ==
                pixels[16 * y + given * x + (blue_first ? 2 - c : c)]);
    frame->loan.release(frame->loan.owner);
  }
}

TEST_CASE("trajectory files have each number in its column, geodetic ones longitude first except in GPX") {
  const TemporaryFolder folder;
  const StampedPoses track = {{1'000'000'007, kQ, {1.5, -2.25, 3.125}},
                              {2'000'000'000, Quaterniond::Identity(), {4, 5, 6}}};
  const ToGeodetic earth = [](const Vector3d& p) {
    return std::array<double, 3>{0.8 + 1e-3 * p.x(), -0.1 + 1e-3 * p.y(), 200 - p.z()};
  };
  const double lat = 0.8015 * 180 / EIGEN_PI, lon = -0.10225 * 180 / EIGEN_PI, height = 196.875;
  const auto numbers = [&](const char* name, const char* from, size_t count) {
    REQUIRE(write_trajectory(folder / name, track, earth).ok());
    const std::string text = read_text(folder / name);
    std::string rest = text.substr(text.find(from) + std::string(from).size());
    for (char& c : rest)
      if (!contains("0123456789.-", {&c, 1})) c = ' ';
    std::istringstream in(rest);
    std::vector<double> found(count);
    for (double& x : found) in >> x;
    CHECK(in);
    return found;
  };
  check_list(numbers("a.gpx", "<trkseg>", 3).data(), {lat, lon, height});
  check_list(numbers("a.kml", "<coordinates>", 3).data(), {lon, lat, height});
  check_list(numbers("a.geojson", "\"coordinates\":[", 3).data(), {lon, lat, height});
  check_list(numbers("a.csv", "qz\n", 8).data(), {1'000'000'007, 1.5, -2.25, 3.125, kQ.w(), kQ.x(), kQ.y(), kQ.z()});
  REQUIRE(write_trajectory(folder / "a.txt", track, nullptr).ok());
  CHECK((*read_tum(folder / "a.txt"))[0].q.angularDistance(kQ) < 1e-9);
  CHECK(path_length(track) == doctest::Approx(std::hypot(2.5, 7.25, 2.875)));
}

TEST_CASE("tracks on a map have times if the clock is Unix time, otherwise none") {
  const TemporaryFolder folder;
  const ToGeodetic earth = [](const Vector3d&) { return std::array<double, 3>{0.8, -0.1, 20}; };
  const StampedPoses unix_times = {{1'781'801'311'043'000'000, kQ, {}}, {1'781'801'312'043'000'000, kQ, {1, 0, 0}}};
  const StampedPoses boot_times = {{77'043'000'000, kQ, {}}, {78'043'000'000, kQ, {1, 0, 0}}};
  const auto has = [&](const char* name, const StampedPoses& track, const char* text) {
    REQUIRE(write_trajectory(folder / name, track, earth).ok());
    return contains(read_text(folder / name), text);
  };
  CHECK(has("a.gpx", unix_times, "<time>2026-06-18T16:48:31.043Z</time>"));
  CHECK(has("a.kml", unix_times, "<when>2026-06-18T16:48:32.043Z</when>"));
  CHECK(has("a.geojson", unix_times, "\"coordTimes\":[\n\"2026-06-18T16:48:31.043Z\","));
  CHECK_FALSE(has("b.gpx", boot_times, "<time>"));
  CHECK_FALSE(has("b.kml", boot_times, "<when>"));
  CHECK_FALSE(has("b.geojson", boot_times, "coordTimes"));
}

TEST_CASE("image folders take their times from a table, and report its absence") {
  const TemporaryFolder folder;
  write_text(folder / "camera.yaml", "width: 64\nheight: 48\nfx: 50\nfy: 50\ncx: 32\ncy: 24\n");
  for (const char* name : {"1.png", "2.png", "3.png"}) picture(folder / name);
  const Recording assumed = read(folder.path());
  CHECK(contains(assumed.warnings.at(0), "taken to be at 30 Hz"));
  CHECK(contains(assumed.warnings.at(1), "no imu.csv"));
  write_text(folder / "timestamps.csv", "timestamp\n0.5\n0.75\n1.5\n");
  const Recording timed = read(folder.path());
  CHECK(timed.warnings.size() == 1);
  CHECK(timed.messages.at(2).message.header().t_ns == 750'000'000);
  write_text(folder / "timestamps.csv", "timestamp\n500000000\n750000000\n");
  CHECK(contains(read_recording(folder.path()).failure().text, "3 pictures, 2 times"));
}

TEST_CASE("EuRoC without its camera's sensor.yaml is read, and asks for a lens") {
  const TemporaryFolder folder;
  fs::create_directories(folder / "mav0/cam0/data"), fs::create_directories(folder / "mav0/imu0");
  picture(folder / "mav0/cam0/data/5.png");
  write_text(folder / "mav0/cam0/data.csv", "#t,name\n5,5.png\n");
  write_text(folder / "mav0/imu0/data.csv", "4,0,0,0,0,0,9.8\n6,0,0,0,0,0,9.8\n");
  const Recording recording = read(folder.path());
  CHECK(recording.has(ODO_TYPE_FRAME));
  CHECK_FALSE(recording.has(ODO_TYPE_CALIBRATION));
  CHECK(contains(recording.warnings.at(0), "no sensor.yaml"));
}

TEST_CASE("the camera's numbers, times and poses of KITTI and TUM RGB-D are read") {
  const TemporaryFolder folder;
  const auto kitti = folder / "kitti";
  fs::create_directories(kitti / "image_0");
  picture(kitti / "image_0/000000.png"), picture(kitti / "image_0/000001.png");
  write_text(kitti / "calib.txt", "P0: 11 12 13 14 15 16 17 18 19 20 21 22\nP1: 1 1 1 1 1 1 1 1 1 1 1 1\n");
  write_text(kitti / "times.txt", "0.5\n0.75\n");
  write_text(kitti / "poses.txt", "0 -1 0 4 1 0 0 5 0 0 1 6\n1 0 0 7 0 1 0 8 0 0 1 9\n");
  const Recording k = read(kitti);
  const auto c = first<odo_calibration>(k, ODO_TYPE_CALIBRATION);
  CHECK((c.fx == 11 && c.cx == 13 && c.fy == 16 && c.cy == 17 && c.width == 64 && c.height == 48));
  CHECK(k.messages.back().message.header().t_ns == 750'000'000);
  REQUIRE(k.truth.size() == 2);
  CHECK((k.truth[0].t_ns == 500'000'000 && k.truth[0].p == Vector3d(4, 5, 6)));
  CHECK((k.truth[0].q * Vector3d(1, 0, 0) - Vector3d(0, 1, 0)).norm() < 1e-9);
  CHECK((*read_kitti_poses(kitti / "poses.txt", {}))[1].t_ns == 100'000'000);  // 10 Hz

  const auto tum = folder / "tum";
  fs::create_directories(tum / "rgb");
  picture(tum / "rgb/1.png");
  write_text(tum / "rgb.txt", "1.5 rgb/1.png\n");
  write_text(tum / "groundtruth.txt", "1.25 1 2 3 0.5 0.1 -0.5 0.7\n");
  write_text(tum / "accelerometer.txt", "1.4 0.1 0.2 9.8\n");
  const Recording t = read(tum);
  CHECK((k.format == "KITTI odometry" && t.format == "TUM RGB-D"));
  CHECK(t.truth.at(0).t_ns == 1'250'000'000);
  CHECK(t.truth[0].p == Vector3d(1, 2, 3));
  CHECK(t.truth[0].q.angularDistance(Quaterniond(0.7, 0.5, 0.1, -0.5).normalized()) < 1e-9);
  check_list(first<odo_imu>(t, ODO_TYPE_IMU).accel_b, {0.1, 0.2, 9.8});
  CHECK(first<odo_imu>(t, ODO_TYPE_IMU).header.flags == ODO_IMU_ACCEL);
  const auto lens = first<odo_calibration>(t, ODO_TYPE_CALIBRATION);
  CHECK((lens.fx == 525 && lens.fy == 525 && lens.cx == 319.5 && lens.cy == 239.5 && lens.width == 640));
}

TEST_CASE("each sensor's axes, signs and units of ADVIO and the Indoor Location Competition are converted") {
  const TemporaryFolder folder;
  const auto advio = folder / "advio";
  fs::create_directories(advio / "iphone"), fs::create_directories(advio / "ground-truth");
  write_text(advio / "iphone/accelerometer.csv", "0.01,0.1,-0.9,0.2\n");
  write_text(advio / "iphone/gyro.csv", "0.015,0.1,0.2,0.3\n");
  write_text(advio / "iphone/magnetometer.csv", "0.02,21,-32,43\n");
  write_text(advio / "iphone/barometer.csv", "0.03,101.3,-5\n");
  write_text(advio / "iphone/platform-location.csv", "0.5,60,-30,5,20,3,1\n");
  write_text(advio / "ground-truth/pose.csv", "0.25,1,2,3,0.7,0.5,0.1,-0.5\n");
  const Recording a = read(advio);
  CHECK(a.format == "ADVIO");
  check_list(first<odo_imu>(a, ODO_TYPE_IMU, ODO_IMU_ACCEL).accel_b, {-0.980665, 8.825985, -1.96133});
  check_list(first<odo_imu>(a, ODO_TYPE_IMU, ODO_IMU_GYRO).gyro_b, {0.1, 0.2, 0.3});
  check_list(first<odo_magnetometer>(a, ODO_TYPE_MAGNETOMETER).field_b, {21e-6, -32e-6, 43e-6});
  CHECK(first<odo_barometer>(a, ODO_TYPE_BAROMETER).pressure_pa == doctest::Approx(101300));
  const auto gnss = first<odo_gnss>(a, ODO_TYPE_GNSS);
  check_list(&gnss.latitude_rad, {EIGEN_PI / 3, -EIGEN_PI / 6, 20});
  check_list(gnss.covariance_n, {12.5, 0, 0, 0, 12.5, 0, 0, 0, 9});
  CHECK(gnss.header.t_ns == 500'000'000);
  REQUIRE(a.truth.size() == 1);
  CHECK((a.truth[0].t_ns == 250'000'000 && a.truth[0].p == Vector3d(1, 2, 3)));
  CHECK(a.truth[0].q.angularDistance(Quaterniond(0.7, 0.5, 0.1, -0.5).normalized()) < 1e-9);

  const Recording w = read(write_text(folder / "walk.txt",
                                      "# head\n1500\tTYPE_ACCELEROMETER\t1\t2\t3\t3\n1501\tTYPE_GYROSCOPE\t4\t5\t6\t3\n"
                                      "1502\tTYPE_MAGNETIC_FIELD\t7\t8\t9\t3\n1503\tTYPE_WAYPOINT\t10\t11\n"
                                      "1504\tTYPE_ROTATION_VECTOR\t0\t0\t0\t3\n1505\tTYPE_WIFI\ta\tb\tc\n"));
  check_list(first<odo_imu>(w, ODO_TYPE_IMU, ODO_IMU_ACCEL).accel_b, {1, 2, 3});
  check_list(first<odo_imu>(w, ODO_TYPE_IMU, ODO_IMU_GYRO).gyro_b, {4, 5, 6});
  check_list(first<odo_magnetometer>(w, ODO_TYPE_MAGNETOMETER).field_b, {7e-6, 8e-6, 9e-6});
  const auto mark = first<odo_waypoint>(w, ODO_TYPE_WAYPOINT);
  check_list(mark.p_n, {11, 10, 0});  // north before east
  CHECK((mark.header.t_ns == 1'503'000'000 && mark.sigma_m == 0.5));
  REQUIRE(w.phone_attitudes.size() == 1);  // flat and facing north: y north, x east, z up
  CHECK((w.phone_attitudes[0].q * Vector3d(1, 2, 3) - Vector3d(2, 1, -3)).norm() < 1e-9);
  CHECK(w.phone_attitudes[0].t_ns == 1'504'000'000);
}

TEST_CASE("an EuRoC folder's truth has the states' numbers, is converted to the camera, and reports skipped rows") {
  const TemporaryFolder folder;
  Recording r{.format = "test", .path = "x"};
  for (int64_t i = 0; i < 5; ++i) {
    auto imu = imu_at(1'000'000'000 + i * 4'000'000, {0, 0, 0}, {0, 0, 0});
    r.add(imu.header);
  }
  for (int64_t i = 0; i < 3; ++i) r.add(make_message<odo_gnss>(ODO_TYPE_GNSS, 1'000'000'000 + i).header);
  r.sort();
  r.true_states = {a_state()};
  const auto written = required(write_euroc(r, folder / "a", nullptr));
  CHECK(written->messages == 5);
  CHECK(written->true_states == 1);
  CHECK(written->left_out == "3 gnss");
  const std::string csv = read_text(folder / "a/mav0/state_groundtruth_estimate0/data.csv");
  std::istringstream fields(csv.substr(csv.find('\n') + 1));
  std::vector<double> values;
  for (std::string field; std::getline(fields, field, ',');) values.push_back(std::stod(field));
  REQUIRE(values.size() == 17);
  check_list(values.data(), {71, 1, 2, 3, kQ.w(), kQ.x(), kQ.y(), kQ.z(), 4, 5, 6, 7, 8, 9, 10, 11, 12});
  CHECK(contains(read_text(folder / "a/imu.yaml"), "update_rate: 250\n"));
  CHECK(contains(read_text(folder / "a/mav0/imu0/sensor.yaml"), "rate_hz: 250\n"));
  const Recording copy = read(folder / "a");
  REQUIRE(copy.truth.size() == 1);
  CHECK(copy.truth[0].p == Vector3d(1, 2, 3));
  CHECK(copy.truth[0].q.angularDistance(kQ) < 1e-12);
  CHECK_FALSE(write_euroc(r, folder / "a", nullptr).ok());
}

TEST_CASE("a log's transforms are the camera's mount; a frame without a name is not the parent of another one") {
  struct Row {
    std::string camera, imu, parent, child;
    bool given;
  };
  for (const Row& row : {Row{"c", "i", "i", "c", true}, {"", "i", "", "i", false}, {"c", "", "", "c", false}}) {
    CAPTURE(row.child);
    CAPTURE(row.camera);
    const TemporaryFolder folder;
    auto writer = required(McapWriter::create(folder / "log.mcap", ""));
    const auto write = [&](const std::string& topic, const std::string& type, const std::string& json) {
      (*writer)->write((*writer)->add({topic, "json", type, "jsonschema", "{}"}), 100'000'000'000, json);
    };
    const std::string now = R"("timestamp":{"sec":100,"nsec":0},)";
    write("/imu", "sensor_msgs/msg/Imu",
          R"({"header":{"stamp":{"sec":100,"nanosec":0},"frame_id":")" + row.imu +
              R"("},"angular_velocity":{"x":0.1,"y":0,"z":0},"linear_acceleration":{"x":0,"y":0,"z":9.8}})");
    write("/tf", "foxglove.FrameTransform",
          "{" + now + R"("parent_frame_id":")" + row.parent + R"(","child_frame_id":")" + row.child +
              R"(","translation":{"x":1,"y":2,"z":3},"rotation":{"x":1,"y":0,"z":0,"w":0}})");
    write("/camera", "foxglove.RawImage",
          "{" + now + R"("frame_id":")" + row.camera +
              R"(","width":2,"height":1,"encoding":"mono8","step":2,"data":"AAA="})");
    REQUIRE((*writer)->finish().ok());
    const Recording recording = read(folder / "log.mcap");
    CHECK(recording.guessed.mount != row.given);
    if (row.given) check_list(first<odo_calibration>(recording, ODO_TYPE_CALIBRATION).p_b_c, {1, 2, 3});
  }
}

TEST_CASE("a distortion is used whole or refused, never read as none") {
  struct Row {
    std::string model;
    std::vector<double> k;
    uint32_t used;  // coefficients; 9: refused
  };
  const Row rows[] = {
      {"", {}, 0},
      {"radtan", {-0.3}, 4},
      {"plumb_bob", {-0.3, 0.1, 0, 0, 0.2}, 5},
      {"rational_polynomial", {-0.3, 0.1, 0, 0, 0.2, 1}, 8},
      {"rational_polynomial", {-0.3, 0.1, 0, 0, 0.2, 1, 2, 3, 0, 0, 0, 0, 0, 0}, 8},
      {"rational_polynomial", {-0.3, 0.1, 0, 0, 0.2, 1, 2, 3, 0, 0, 1e-3, 0}, 9},
      {"equidistant", {0.1, 0.2, 0.3, 0.4}, 4},
      {"equidistant", {0.1, 0.2}, 4},
      {"equidistant", {0.1, 0.2, 0.3, 0.4, 0.5}, 9},
      {"fov", {0.93}, 9},
      {"thin_prism_fisheye", {0.1}, 9},
  };
  for (const Row& row : rows) {
    CAPTURE(row.model);
    odo_calibration c{};
    const std::string fault = take_distortion(c, row.model, row.k);
    CHECK(fault.empty() == (row.used < 9));
    if (!fault.empty()) continue;
    CHECK(c.distortion_count == row.used);
    CHECK(c.model == (row.model == "equidistant" ? ODO_CAMERA_KANNALA_BRANDT : ODO_CAMERA_PINHOLE));
    check_list(c.distortion, {row.k.empty() ? 0 : row.k[0], row.k.size() > 1 ? row.k[1] : 0});
  }
}

TEST_CASE("a log whose CameraInfo has another distortion model asks for a camera.yaml") {
  const TemporaryFolder folder;
  auto writer = required(McapWriter::create(folder / "log.mcap", ""));
  const auto write = [&](const std::string& topic, const std::string& type, const std::string& json) {
    (*writer)->write((*writer)->add({topic, "json", type, "jsonschema", "{}"}), 100'000'000'000, json);
  };
  const std::string head = R"({"header":{"stamp":{"sec":100,"nanosec":0},"frame_id":"c"},)";
  write("/camera_info", "sensor_msgs/msg/CameraInfo",
        head + R"("height":1,"width":2,"distortion_model":"fov","d":[0.9],"k":[2,0,1,0,2,0.5,0,0,1]})");
  write("/camera", "sensor_msgs/msg/Image",
        head + R"("height":1,"width":2,"encoding":"mono8","is_bigendian":0,"step":2,"data":"AAA="})");
  REQUIRE((*writer)->finish().ok());
  const auto refused = read_recording(folder / "log.mcap");
  REQUIRE_FALSE(refused.ok());
  CHECK(contains(refused.failure().text, "/camera_info: distortion model 'fov'"));
  write_text(folder / "camera.yaml", "model: pinhole\nwidth: 2\nheight: 1\nfx: 2\nfy: 2\ncx: 1\ncy: 0.5\n");
  CHECK(read_recording(folder / "log.mcap").ok());
}

TEST_CASE("Kalibr's mount is read in either direction, and no time shift is dropped") {
  const TemporaryFolder folder;
  const auto chain = [&](const std::string& mount, const std::string& more) {
    const auto path = folder.path() / "camchain.yaml";
    write_text(path, "cam0:\n  " + mount +
                         ":\n  - [0, 1, 0, 0.5]\n  - [-1, 0, 0, -0.25]\n  - [0, 0, 1, 0.125]\n  - [0, 0, 0, 1]\n"
                         "  camera_model: pinhole\n  distortion_coeffs: [0, 0, 0, 0]\n  distortion_model: radtan\n"
                         "  intrinsics: [450, 450, 360, 240]\n  resolution: [720, 480]\n" +
                         more);
    return read_camchain(path);
  };
  const auto as_it_stands = required(chain("T_imu_cam", "")), inverse = required(chain("T_cam_imu", ""));
  CHECK((Eigen::Vector3d(as_it_stands->p_b_c) - Eigen::Vector3d(0.5, -0.25, 0.125)).norm() < 1e-12);
  CHECK((quaternion(as_it_stands->q_b_c) * Eigen::Vector3d::UnitX() - Eigen::Vector3d(0, -1, 0)).norm() < 1e-12);
  CHECK((quaternion(inverse->q_b_c) * quaternion(as_it_stands->q_b_c)).vec().norm() < 1e-12);
  const auto late = required(chain("T_cam_imu", "  timeshift_cam_imu: -6.02\n"));
  CHECK(late->time_offset_ns == -6'020'000'000);
  CHECK_FALSE(chain("T_cam_imu", "  timeshift_cam_imu: 1e6\n").ok());
  CHECK_FALSE(chain("T_cam_imu", "  line_delay: 0.5\n").ok());
}
