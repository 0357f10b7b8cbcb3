// SPDX-License-Identifier: Apache-2.0
#include <rapidcheck.h>

#include <opencv2/imgcodecs.hpp>

#include "sdk/host/config/overrides.hpp"
#include "sdk/math/rotation.hpp"
#include "sdk/tools/recording/odo_file.hpp"
#include "sdk/tools/recording/text_rows.hpp"
#include "tests/support/messages.hpp"
#include "tests/support/runs.hpp"

TEST_SUITE_BEGIN("recording");

namespace {

/// A small recording with every type of content.
fs::path small_recording(const TemporaryFolder& folder, int frames) {
  const auto path = folder / "small.odo";
  auto created = OdoWriter::create(path, 0);
  OdoWriter* writer = created->get();
  auto calibration = make_message<odo_calibration>(ODO_TYPE_CALIBRATION, 0);
  calibration.model = ODO_CAMERA_PINHOLE;
  calibration.width = 8, calibration.height = 6, calibration.fx = calibration.fy = 5;
  REQUIRE(writer->write(calibration.header).ok());
  std::vector<uint8_t> pixels(8 * 6);
  for (int i = 0; i < frames; ++i) {
    auto imu = make_message<odo_imu>(ODO_TYPE_IMU, i * 1000 + 1);
    imu.accel_b[2] = 9.81 + i;
    REQUIRE(writer->write(imu.header).ok());
    auto frame = make_message<odo_frame>(ODO_TYPE_FRAME, i * 1000 + 2);
    frame.format = ODO_FORMAT_GREY8;
    frame.width = 8, frame.height = 6;
    pixels[7] = static_cast<uint8_t>(i);
    frame.planes[0] = {pixels.data(), 8, 1, 0};
    REQUIRE(writer->write(frame.header).ok());
    REQUIRE(writer->write_truth({i * 1000 + 2, Eigen::Quaterniond::Identity(), {1.0 * i, 2, 3}}).ok());
  }
  REQUIRE(writer->finish().ok());
  return path;
}

void small_picture(const fs::path& path) { cv::imwrite(path.string(), cv::Mat(48, 64, CV_8U, cv::Scalar(77))); }

}  // namespace

TEST_CASE("an Odograph recording is read back bit for bit") {
  const TemporaryFolder folder;
  const auto recording = required(read_recording(small_recording(folder, 5)));
  CHECK(recording->messages.size() == 11);
  CHECK(recording->truth.size() == 5);
  CHECK(recording->warnings.empty());
  int frames = 0;
  for_each_picture(*recording, [&](const odo_frame& frame) { CHECK(frame.planes[0].data[7] == frames++); });
  CHECK(frames == 5);
}

TEST_CASE("random bytes behind a valid head never crash the reader") {
  const TemporaryFolder folder;
  const std::string whole = read_text(small_recording(folder, 2));
  rc::check("random damage", [&] {
    std::string bytes = whole;
    for (int i = 0; i < 8; ++i) bytes[*rc::gen::inRange<size_t>(16, bytes.size())] = *rc::gen::arbitrary<char>();
    write_text(folder / "random.odo", bytes);
    const auto recording = read_odo(folder / "random.odo");
    if (recording)
      for (const auto& m : recording->messages)
        if (m.message.header().type == ODO_TYPE_FRAME)
          if (const auto frame = load_frame(m)) frame->loan.release(frame->loan.owner);
  });
}

TEST_CASE("times are written to text and read back exactly") {
  rc::check("nanoseconds", [](int64_t t) {
    const int64_t t_ns = t % 4'600'000'000'000'000'000;
    RC_ASSERT(*parse_seconds(format_seconds(t_ns)) == t_ns);
  });
  CHECK(*parse_seconds("1305031098.6659") == 1305031098665900000);
  CHECK(*parse_seconds("1.000000e-01") == 100000000);
  CHECK_FALSE(parse_seconds("1.2.3").ok());
}

TEST_CASE("trajectories are written to TUM and KITTI files and read back") {
  const TemporaryFolder folder;
  StampedPoses track;
  for (int i = 0; i < 20; ++i)
    track.push_back({1574129954212000000 + i * 100'000'000LL,
                     Eigen::Quaterniond(Eigen::AngleAxisd(0.2 * i, Eigen::Vector3d(1, 2, 3).normalized())),
                     {0.1 * i, -3.0, 1e-3 * i}});
  const auto same = [&](const StampedPoses& other, bool times) {
    REQUIRE(other.size() == track.size());
    for (size_t i = 0; i < track.size(); ++i) {
      if (times) CHECK(other[i].t_ns == track[i].t_ns);
      CHECK((other[i].p - track[i].p).norm() < 1e-9);
      CHECK(other[i].q.angularDistance(track[i].q) < 1e-9);
    }
  };
  REQUIRE(write_trajectory(folder / "a.tum", track, nullptr).ok());
  same(*read_tum(folder / "a.tum"), true);
  REQUIRE(write_trajectory(folder / "a.kitti", track, nullptr).ok());
  same(*read_kitti_poses(folder / "a.kitti", {}), false);
  CHECK_FALSE(write_trajectory(folder / "a.gpx", track, nullptr).ok());
  CHECK_FALSE(write_trajectory(folder / "a.xyz", track, nullptr).ok());
}

TEST_CASE("errors in tables are reported with file and line") {
  const TemporaryFolder folder;
  CHECK(read_tum(write_text(folder / "a.tum", "# head\n1 2 3 4 0 0 0 1\n2 2 3 x 0 0 0 1\n"))
            .failure()
            .text.find("a.tum:3: field 4 'x'") != std::string::npos);
  CHECK(contains(read_tum(write_text(folder / "b.tum", "1 2 3\n")).failure().text, "b.tum:1: expected at least 8"));
  CHECK(contains(read_tum(write_text(folder / "c.tum", "1 2 3 4 0 0 0 0\n")).failure().text, "norm"));
  CHECK(contains(read_tum(write_text(folder / "d.tum", "")).failure().text, "no poses"));
  CHECK(read_recording(folder / "nothing").failure().status == ODO_E_NOT_FOUND);
  CHECK(contains(read_recording(folder.path()).failure().text, "looked for"));
}

TEST_CASE("pictures of a folder are in the order of their numbers, and an error in camera.yaml has its line") {
  const TemporaryFolder folder;
  const auto images = folder / "images";
  fs::create_directories(images);
  for (const char* name : {"2.png", "10.png", "1.png"}) small_picture(images / name);
  write_text(images / "camera.yaml", "width: 64\nheight: 48\nfx: 50 px\nfy: 50\ncx: 32\ncy: 24\nfps: 10 Hz\n");
  const auto i = required(read_recording(images));
  REQUIRE(i->messages.size() == 4);
  CHECK(i->messages[3].picture.file->filename() == "10.png");  // by number, not alphabetically
  CHECK(i->messages[3].message.header().t_ns == 200'000'000);
  write_text(images / "camera.yaml", "width: 64\nheight: 48\nfx: 50\nfz: 50\ncx: 32\ncy: 24\n");
  CHECK(contains(read_recording(images).failure().text, "camera.yaml:4:1: unknown key 'fz'"));
}

TEST_CASE("the real recordings are read" * doctest::test_suite("recording_data")) {
  const auto folder = data_or_skip("");
  if (folder.empty()) return;
  const auto kitti = required(read_recording(folder / "kitti_clip_b"));
  CHECK(kitti->format == "KITTI odometry");
  CHECK(kitti->truth.size() == 51);
  CHECK(path_length(kitti->truth) == doctest::Approx(51.8).epsilon(0.01));
  const auto tsukuba = required(read_recording(folder / "tsukuba_90"));
  CHECK(tsukuba->truth.size() == 90);
  int walks = 0;
  for (const auto& entry : fs::directory_iterator(folder / "phone_walks")) {
    if (entry.path().extension() != ".txt") continue;
    const auto walk = required(read_recording(entry.path()));
    CHECK(walk->has(ODO_TYPE_WAYPOINT));
    ++walks;
  }
  CHECK(walks == 80);
}

TEST_CASE("a recording in memory has the size of its messages, and ground truth is read on request") {
  const TemporaryFolder folder;
  Recording recording;
  recording.add(make_message<odo_imu>(ODO_TYPE_IMU, 1).header);
  CHECK(sizeof(RecordedMessage) <= 64);  // besides sizeof(odo_imu), at 200 per second
  StoredMessage copy = recording.messages[0].message;
  auto& imu = reinterpret_cast<odo_imu&>(copy.header());
  imu.accel_b[2] = 9.81;
  CHECK(as<odo_imu>(recording.messages[0].message.header()).accel_b[2] == 0);
  recording.messages[0].message = copy;
  CHECK(as<odo_imu>(recording.messages[0].message.header()).accel_b[2] == 9.81);

  const auto path = folder / "states.odo";
  auto created = required(OdoWriter::create(path, 0));
  REQUIRE((*created)->write(imu.header).ok());
  TrueState state{.t_ns = 1};
  state.p = state.v = state.gyro_bias = state.accel_bias = Eigen::Vector3d::Zero();
  REQUIRE((*created)->write_true_state(state).ok());
  REQUIRE((*created)->finish().ok());
  CHECK(read_recording(path)->true_states.size() == 1);
  CHECK(read_recording(path, {.true_states = false})->true_states.empty());
}

namespace {

odo_calibration a_lens(uint32_t model, uint32_t coefficients) {
  auto c = make_message<odo_calibration>(ODO_TYPE_CALIBRATION, 0);
  c.header.flags = ODO_CALIBRATION_EXTRINSICS | ODO_CALIBRATION_TIME_OFFSET;
  c.model = model, c.width = 64, c.height = 48;
  c.fx = 61.5, c.fy = 62.25, c.cx = 31.125, c.cy = 24.75;
  c.distortion_count = coefficients;
  for (uint32_t i = 0; i < coefficients; ++i) c.distortion[i] = 0.01 * (i + 1) * (i % 2 ? -1 : 1);
  put_quaternion(Eigen::Quaterniond(0.5, 0.7, -0.3, 0.4).normalized(), c.q_b_c);
  Eigen::Vector3d::Map(c.p_b_c) = Eigen::Vector3d(0.03, -0.07, 0.01);
  c.time_offset_ns = 12'500'000;
  return c;
}

/// The numbers of a list in Kalibr's file; lists of lists are concatenated.
std::vector<double> numbers_at(const YamlNode& root, const std::string& path) {
  std::vector<double> numbers;
  const std::function<void(const YamlNode&)> collect = [&](const YamlNode& node) {
    if (node.items.empty()) numbers.push_back(std::stod(node.text));
    for (const YamlNode& item : node.items) collect(item);
  };
  if (const YamlNode* node = node_at(root, path)) collect(*node);
  return numbers;
}

Recording one_frame(const odo_calibration& lens, const fs::path& png) {
  Recording r{.format = "test", .path = png};
  r.add(lens.header);
  auto noise = make_message<odo_imu_noise>(ODO_TYPE_IMU_NOISE, 0);
  noise.gyro_noise = 1e-3, noise.gyro_walk = 2e-5, noise.accel_noise = 3e-3, noise.accel_walk = 4e-4;
  r.add(noise.header);
  auto imu = imu_at(1'000'000'001, {0, 0, 0}, {0, 0, 0});
  for (int i = 0; i < 3; ++i) imu.gyro_b[i] = 0.1 * (i + 1), imu.accel_b[i] = 9 - i;
  r.add(imu.header);
  auto frame = make_message<odo_frame>(ODO_TYPE_FRAME, 1'000'000'002);
  frame.header.flags = ODO_FRAME_LINE_TIME, frame.line_time_ns = 31'000;
  r.add(frame.header, {std::make_shared<const fs::path>(png)});
  return r;
}

}  // namespace

TEST_CASE("the camera of a written EuRoC folder is read back, and Kalibr's file has the same in Kalibr's conventions") {
  for (const uint32_t model : {ODO_CAMERA_PINHOLE, ODO_CAMERA_KANNALA_BRANDT}) {
    CAPTURE(model);
    const TemporaryFolder folder;
    small_picture(folder / "a.png");
    const odo_calibration lens = a_lens(model, model == ODO_CAMERA_PINHOLE ? 5 : 4);
    const Recording original = one_frame(lens, folder / "a.png");
    REQUIRE(write_euroc(original, folder / "asl", nullptr).ok());
    const auto copy = required(read_recording(folder / "asl"));
    REQUIRE(copy->messages.size() == original.messages.size());
    auto expected = lens;  // the ASL layout has no time offset
    expected.header.flags = ODO_CALIBRATION_EXTRINSICS, expected.time_offset_ns = 0;
    for (const auto& m : copy->messages) {
      const odo_header& header = m.message.header();
      if (header.type != ODO_TYPE_CALIBRATION) continue;
      auto read = as<odo_calibration>(header);
      CHECK((Eigen::Vector4d::Map(read.q_b_c) - Eigen::Vector4d::Map(lens.q_b_c)).norm() < 1e-12);
      std::copy(lens.q_b_c, lens.q_b_c + 4, read.q_b_c);
      CHECK(std::memcmp(&read, &expected, sizeof read) == 0);  // NOLINT(bugprone-suspicious-memory-comparison): no NaN
    }
    for (const auto& m : original.messages) {
      const auto same = [&](const RecordedMessage& other) {
        return other.message.header().type == m.message.header().type;
      };
      const auto found = std::find_if(copy->messages.begin(), copy->messages.end(), same);
      REQUIRE(found != copy->messages.end());
      const auto *a = &m.message.header(), *b = &found->message.header();
      CHECK(a->t_ns == b->t_ns);
      if (a->type == ODO_TYPE_IMU || a->type == ODO_TYPE_IMU_NOISE)
        CHECK(std::ranges::equal(m.message.bytes(), found->message.bytes()));
      if (a->type == ODO_TYPE_FRAME) CHECK(as<odo_frame>(*b).line_time_ns == 31'000);
    }
    const auto kalibr = required(read_yaml((folder / "asl/camchain-imucam.yaml").string()));
    // T_cam_imu maps points of the IMU to the camera; t_imu = t_cam + timeshift_cam_imu.
    const auto rows = numbers_at(*kalibr, "cam0.T_cam_imu");
    REQUIRE(rows.size() == 16);
    const Eigen::Matrix4d T_c_b = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>::Map(rows.data());
    const Eigen::Vector3d p_c(1, -2, 3), p_b = raw_quaternion(lens.q_b_c) * p_c + Eigen::Vector3d(lens.p_b_c);
    CHECK((T_c_b * p_b.homogeneous() - p_c.homogeneous()).norm() < 1e-12);
    CHECK(numbers_at(*kalibr, "cam0.timeshift_cam_imu") == std::vector<double>{0.0125});
    CHECK(numbers_at(*kalibr, "cam0.intrinsics") == std::vector<double>{61.5, 62.25, 31.125, 24.75});
    CHECK(numbers_at(*kalibr, "cam0.resolution") == std::vector<double>{64, 48});
    CHECK(numbers_at(*kalibr, "cam0.line_delay")[0] * 1e6 == doctest::Approx(31));
    CHECK(numbers_at(*kalibr, "cam0.distortion_coeffs") == std::vector<double>(lens.distortion, lens.distortion + 4));
    CHECK(node_at(*kalibr, "cam0.distortion_model")->text == (model == ODO_CAMERA_PINHOLE ? "radtan" : "equidistant"));
  }
}
