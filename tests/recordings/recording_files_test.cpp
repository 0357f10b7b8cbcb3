// SPDX-License-Identifier: Apache-2.0
//
// Files from others: tables with shifted columns, links out of a recording, pictures too large to decode.
// Published data sets of walks without a camera, and figures of an estimate against their truth.
#include <opencv2/imgcodecs.hpp>

#include "sdk/tools/evaluation/walk_truth.hpp"
#include "sdk/tools/recording/picture_header.hpp"
#include "sdk/tools/recording/recording.hpp"
#include "sdk/tools/recording/text_rows.hpp"
#include "tests/support/support.hpp"

TEST_SUITE_BEGIN("recording_files");

TEST_CASE("a table's cells keep their columns with decimal commas, empty cells and quotes") {
  const TemporaryFolder folder;
  const auto rows = [&](const std::string& text) -> std::string {
    const auto file = write_text(folder / "t.csv", text);
    std::string all;
    const auto done = read_rows(file, [&](const TextRow& row) -> Result<bool> {
      for (size_t i = 0; i < row.fields.size(); ++i) {
        const auto value = row.number(i);
        if (!value) return value.failure();
        all += std::to_string(static_cast<int>(std::lround(*value * 100))) + " ";
      }
      return true;
    });
    return done ? all : done.failure().text.substr(done.failure().text.find("t.csv"));
  };
  CHECK(rows("t;x\n1;2.5\n3;4.5\n") == "100 250 300 450 ");
  CHECK(rows("1, 2.5 ,3\r\n4,5,6\r\n") == "100 250 300 400 500 600 ");
  CHECK(rows("1 2.5\t3\n4   5 6\n") == "100 250 300 400 500 600 ");
  CHECK(rows("\"1\",\"2.5\"\n") == "100 250 ");
  CHECK(rows("# t [ns],x\n1,2\n") == "100 200 ");
  CHECK(rows("1,2,3,\n4,5,6,\n") == "100 200 300 400 500 600 ");
  CHECK(rows("1;2,5\n") == "t.csv:1: field 2 '2,5' is not a number; expected a decimal point");
  CHECK(rows("1,5 2,5\n") == "t.csv:1: field 2 '5 2' is not a number");
  CHECK(rows("t,x\n1,2,5\n") ==
        "t.csv:2: 3 fields separated by ',', line 1 has 2; expected as many (a decimal comma is to be a point)");
  CHECK(rows("# t [ns],x\n1,2,5\n") == "t.csv:2: 3 fields, the head has 2 (a decimal comma is to be a point)");
  CHECK(rows("1,2,3\n4,5,5,6\n") ==
        "t.csv:2: 4 fields separated by ',', line 1 has 3; expected as many (a decimal comma is to be a point)");
  CHECK(rows("1,2,3\n4,,6\n") == "t.csv:2: field 2 is empty; expected a number");
  CHECK(rows("1,2,3\n,5,6\n") == "t.csv:2: field 1 is empty; expected a number");
  CHECK(rows("1,\"2\n") == "t.csv:1: field 2 begins with a quote that does not end");
}

TEST_CASE("a picture outside the recording, reached through a link, is rejected unless allowed") {
  const TemporaryFolder folder, elsewhere;
  const auto data = folder / "mav0/cam0/data";
  fs::create_directories(data);
  write_text(folder / "mav0/cam0/sensor.yaml",
             "sensor_type: camera\nT_BS:\n  cols: 4\n  rows: 4\n  data: [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]\n"
             "resolution: [64, 48]\nintrinsics: [50, 51, 32, 24]\ndistortion_model: radial-tangential\n"
             "distortion_coefficients: [-0.28, 0.07, 1e-4, 1e-5]\n");
  write_text(folder / "mav0/cam0/data.csv", "#t,file\n150,a.png\n");
  REQUIRE(read_recording(folder.path()).ok());
  write_text(elsewhere / "private.png", "x");
  fs::create_symlink("b.png", data / "a.png");
  write_text(data / "b.png", "x");
  CHECK(read_recording(folder.path()).ok());  // a link within the recording
  fs::remove(data / "a.png");
  fs::create_symlink(elsewhere / "private.png", data / "a.png");
  const auto recording = read_recording(folder.path());
  REQUIRE_FALSE(recording.ok());
  CHECK(contains(recording.failure().text, "a.png: a link leads out of the recording's folder"));
  CHECK(read_recording(folder.path(), {.pictures_outside = true}).ok());
}

TEST_CASE("a picture's header states its size, and a too large one is rejected before decoding") {
  const TemporaryFolder folder;
  for (const char* kind : {".png", ".jpg", ".bmp", ".pgm", ".ppm"})
    for (const auto& [width, height] : {std::pair(1, 1), {7, 300}, {641, 479}, {3000, 2}}) {
      const fs::path file = folder / (std::to_string(width) + kind);
      const bool colour = std::string(kind) == ".ppm" || width == 7;
      if (std::string(kind) == ".pgm" && colour) continue;
      cv::imwrite(file.string(), cv::Mat(height, width, colour ? CV_8UC3 : CV_8U, cv::Scalar::all(9)));
      const auto size = required(picture_size(file));
      CHECK(size->width == static_cast<uint32_t>(width));
      CHECK(size->height == static_cast<uint32_t>(height));
    }
  const auto large = [](uint8_t a, uint8_t b) { return std::string{0, 0, static_cast<char>(a), static_cast<char>(b)}; };
  const std::string png = std::string("\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR", 16) + large(0x7D, 0) + large(0x7D, 0) +
                          std::string("\x08\0\0\0\0xxxx", 9);
  const std::string jpeg = std::string("\xFF\xD8\xFF\xE0\0\x04xx\xFF\xFF\xC0\0\x0b\x08\x7D\0\x7D\0\x01\x11\0", 21);
  const std::string pgm = "P5 # many\n32000 # and more\n32000 255\n";
  for (const auto& file : {std::pair("a.png", png), {"a.jpg", jpeg}, {"a.pgm", pgm}}) {
    CAPTURE(file.first);
    RecordedMessage recorded;
    recorded.message.assign(make_message<odo_frame>(ODO_TYPE_FRAME, 0).header);
    recorded.picture = {std::make_shared<const fs::path>(write_text(folder / file.first, file.second))};
    const auto frame = load_frame(recorded);
    REQUIRE_FALSE(frame.ok());
    CHECK_MESSAGE(contains(frame.failure().text, "a picture of 32000 x 32000 pixels; expected at most 64 million"),
                  frame.failure().text);
  }
  CHECK(picture_size(write_text(folder / "64.pgm", "P5 8000 8000 255\n")).ok());
  CHECK_FALSE(picture_size(write_text(folder / "more.pgm", "P5 8000 8001 255\n")).ok());  // no side too long
  CHECK_FALSE(picture_size(write_text(folder / "text.png", "no picture")).ok());
  CHECK_FALSE(picture_size(write_text(folder / "cut.jpg", jpeg.substr(0, 12))).ok());
  CHECK_FALSE(picture_size(folder / "missing.png").ok());
}

TEST_SUITE_BEGIN("recording");

TEST_CASE("a RIDI walk has the phone's axes and a truth with north, east and down") {
  const TemporaryFolder folder;
  const std::string head =
      "time_s,gyro_x,gyro_y,gyro_z,acce_x,acce_y,acce_z,magnet_x,magnet_y,magnet_z,pos_x,pos_y,pos_z,ori_w,ori_x,ori_y,"
      "ori_z\n";
  const auto file = write_text(folder / "ann_leg1.csv", head + "1.0,.1,.2,.3,0,0,9.8,20,30,40,1,2,3,1,0,0,0\n" +
                                                            "1.5,.1,.2,.3,0,0,9.8,20,30,40,4,2,3,1,0,0,0\n");
  const auto recording = required(read_recording(file));
  CHECK(recording->format == "RIDI");
  REQUIRE(recording->truth.size() == 2);
  CHECK(recording->truth[0].t_ns == 1'000'000'000);
  CHECK((recording->truth[0].p - Eigen::Vector3d(2, 1, -3)).norm() < 1e-12);
  const Eigen::Vector3d up_n = recording->truth[0].q * Eigen::Vector3d::UnitZ();  // the phone is on its back
  CHECK((up_n - Eigen::Vector3d(0, 0, -1)).norm() < 1e-9);
  const WalkerName name = walker_name(*recording);
  CHECK(name.person == "ann");
  CHECK(name.place == "leg");
  const auto broken = read_recording(write_text(folder / "b.csv", head + "x,.1\n"));
  REQUIRE_FALSE(broken.ok());
  CHECK(contains(broken.failure().text, "b.csv:2"));
}

TEST_CASE("an IPIN walk has the sensors' clock, positions in metres, and floors") {
  const TemporaryFolder folder;
  const auto recording = read_recording(write_text(folder / "T01_R02.txt",
                                                   "% head\nACCE;10.02;100.0;0;0;9.8;3\nGYRO;10.03;100.0;0;0;0.1;3\n"
                                                   "ACCE;10.2;100.1;0;0;9.8;3\nPRES;10.05;100.0;990.5;3\n"
                                                   "POSI;11;1;49.0;11.0;0;0\nPOSI;21;2;49.0001;11.0;-1;0\n"));
  REQUIRE_MESSAGE(recording.ok(), (recording.ok() ? "" : recording.failure().text));
  const auto places = recording->waypoints();
  REQUIRE(places.size() == 2);
  CHECK(places[1].p_n.x() == doctest::Approx(11.12).epsilon(0.001));
  REQUIRE(recording->true_floors.size() == 2);
  CHECK(recording->true_floors[1].floor == -1);
  int64_t last_ns = 0;
  for (const RecordedMessage& m : recording->messages)
    if (m.message.header().type == ODO_TYPE_IMU) last_ns = m.message.header().t_ns;
  CHECK(last_ns == 10'120'000'000);  // by the sensor's clock; the app's was late
}

TEST_CASE("in Oxford's step counter each rise of a switch is a step") {
  const TemporaryFolder folder;
  write_text(folder / "P_Ann_Hard_InHand_1_stepcounter.csv", "0,0,1\n90000000,1,1\n180000000,1,0\n270000000,0,1\n");
  const auto recording = required(read_recording(
      write_text(folder / "P_Ann_Hard_InHand_1_accelerometer.csv", "0,3,0,0,9.8\n10000000,3,0,0,9.8\n")));
  CHECK(recording->true_steps.size() == 2);
  CHECK(walker_name(*recording).person == "Ann");
}

TEST_CASE("a trundle wheel's distances and empty fields are read") {
  const TemporaryFolder folder;
  const auto recording = read_recording(
      write_text(folder / "walk.csv",
                 "time;m_accG_x;m_accG_y;m_accG_z;m_rotTate_alpha;m_rotTate_beta;m_rotTate_gamma;steps;distance\n"
                 "100;0;0;9.8;90;0;0;;\n116;0;0;9.8;90;0;0;;\n120;;;;;;;;1\n820;;;;;;;;2\n"));
  REQUIRE_MESSAGE(recording.ok(), (recording.ok() ? "" : recording.failure().text));
  REQUIRE(recording->true_distances.size() == 2);
  CHECK(recording->true_distances[1].walked_m == 2);
  REQUIRE(recording->messages.size() == 2);
  CHECK(as<odo_imu>(recording->messages[0].message.header()).gyro_b[0] == doctest::Approx(1.5708).epsilon(1e-4));
}

TEST_CASE("a trundle wheel's accelerations are brought to gravity, and a fix counts as of the sample before it") {
  const TemporaryFolder folder;
  const auto recording = read_recording(
      write_text(folder / "walk.csv",
                 "time;m_accG_x;m_accG_y;m_accG_z;m_rotTate_alpha;m_rotTate_beta;m_rotTate_gamma;p_lat;p_long;p_alt;"
                 "p_acc;steps;distance\n"
                 "100;0;0;11.3;90;0;0;;;;;;\n1691050804000;;;;;;;55.6;13;;12;;\n116;0;0;11.3;90;0;0;;;;;;\n"));
  REQUIRE_MESSAGE(recording.ok(), (recording.ok() ? "" : recording.failure().text));
  size_t fixes = 0;
  for (const auto& m : recording->messages) {
    if (m.message.header().type == ODO_TYPE_IMU)
      CHECK(as<odo_imu>(m.message.header()).accel_b[2] == doctest::Approx(9.80665));
    if (m.message.header().type != ODO_TYPE_GNSS) continue;
    ++fixes;
    CHECK(m.message.header().t_ns == 100'000'000);
    CHECK(as<odo_gnss>(m.message.header()).covariance_n[0] == doctest::Approx(72));
  }
  CHECK(fixes == 1);
}

TEST_CASE("a walk's figures are distance, position after alignment, direction and consistency") {
  Recording recording;
  recording.format = "RIDI";
  StampedPoses track;
  std::vector<odo_step> steps;
  for (int i = 0; i <= 600; ++i) {  // 1 m/s, a corner after 30 s; the track is rotated, and 10 % too long
    const double s = 0.1 * i, north = std::min(s, 30.0), east = std::max(0.0, s - 30);
    const int64_t t_ns = int64_t{100'000'000} * i;
    recording.truth.push_back({t_ns, Eigen::Quaterniond::Identity(), {north, east, 0}});
    track.push_back({t_ns, Eigen::Quaterniond::Identity(), {-1.1 * east, 1.1 * north, 5}});
    if (i % 5 != 0 || i == 0) continue;
    odo_step step = make_message<odo_step>(ODO_TYPE_STEP, t_ns);
    step.t_start_ns = t_ns - 500'000'000, step.t_end_ns = t_ns, step.length_m = 0.55, step.sigma_m = 0.05;
    steps.push_back(step);
  }
  const WalkTruthFigures f = walk_truth_figures(recording, steps, track);
  CHECK(f.estimated_m / f.true_m == doctest::Approx(1.1).epsilon(0.02));
  CHECK(f.position_m == Between{0.5, 2});  // from the length alone: the rotation is removed
  CHECK(percentile(f.heading_deg, 0.5) < 3);
  CHECK(percentile(f.normalised_error, 0.5) == doctest::Approx(1).epsilon(0.1));
  CHECK(std::isnan(f.count_percent));
}
