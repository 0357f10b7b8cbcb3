// SPDX-License-Identifier: Apache-2.0
//
// Effect of damage: only the damaged records are lost, and every loss is reported.
#include <chrono>

#include <sys/stat.h>

#include <opencv2/imgcodecs.hpp>

#include "sdk/host/base/printable.hpp"
#include "sdk/tools/recording/odo_file.hpp"
#include "sdk/tools/simulation/random.hpp"
#include "tests/support/messages.hpp"
#include "tests/support/support.hpp"

TEST_SUITE_BEGIN("recording_loss");

namespace {

/// Inertial samples, frames and true poses, 161 messages in total.
fs::path recording_of(const TemporaryFolder& folder, int frames = 40) {
  const auto path = folder / "whole.odo";
  auto created = OdoWriter::create(path, 0);
  OdoWriter* writer = created->get();
  auto calibration = make_message<odo_calibration>(ODO_TYPE_CALIBRATION, 0);
  calibration.model = ODO_CAMERA_PINHOLE;
  calibration.width = 32, calibration.height = 24, calibration.fx = calibration.fy = 30;
  REQUIRE(writer->write(calibration.header).ok());
  std::vector<uint8_t> pixels(32 * 24);
  for (int i = 0; i < frames; ++i) {
    for (int k = 0; k < 3; ++k) {
      auto imu = make_message<odo_imu>(ODO_TYPE_IMU, i * 1000 + k);
      imu.accel_b[2] = 9.81 + i;
      REQUIRE(writer->write(imu.header).ok());
    }
    auto frame = make_message<odo_frame>(ODO_TYPE_FRAME, i * 1000 + 5);
    frame.format = ODO_FORMAT_GREY8;
    frame.width = 32, frame.height = 24;
    for (auto& pixel : pixels) pixel = static_cast<uint8_t>(pixel * 5 + i + 1);
    frame.planes[0] = {pixels.data(), 32, 1, 0};
    REQUIRE(writer->write(frame.header).ok());
    REQUIRE(writer->write_truth({i * 1000 + 5, Eigen::Quaterniond::Identity(), {1.0 * i, 2, 3}}).ok());
  }
  REQUIRE(writer->finish().ok());
  return path;
}

/// Every message as a string of bytes, a frame with its picture.
std::multiset<std::string> contents(const Recording& recording) {
  std::multiset<std::string> all;
  for (const auto& m : recording.messages) {
    const auto bytes = m.message.bytes();
    std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (m.picture.size > 0) {
      std::ifstream file(*m.picture.file, std::ios::binary);
      std::string picture(m.picture.size, '\0');
      file.seekg(static_cast<std::streamoff>(m.picture.offset));
      file.read(picture.data(), static_cast<std::streamsize>(picture.size()));
      text += picture;
    }
    all.insert(text);
  }
  return all;
}

size_t in_both(const std::multiset<std::string>& a, const std::multiset<std::string>& b) {
  return static_cast<size_t>(
      std::count_if(a.begin(), a.end(), [&](const std::string& message) { return b.count(message) > 0; }));
}

}  // namespace

TEST_CASE("each of 500 flipped bits costs at most its own record, and is reported") {
  const TemporaryFolder folder;
  const auto path = recording_of(folder);
  const std::string bytes = read_text(path);
  const auto whole = contents(*read_odo(path));
  Random random(7, 1);
  size_t refused = 0;
  for (int i = 0; i < 500; ++i) {
    const size_t at = i < 40 ? static_cast<size_t>(i) : random.next() % bytes.size();  // including the head's bytes
    const int bit = static_cast<int>(random.next() % 8);
    std::string damaged = bytes;
    damaged[at] = static_cast<char>(damaged[at] ^ (1 << bit));
    CAPTURE(at);
    CAPTURE(bit);
    const auto recording = read_recording(write_text(folder / "flip.odo", damaged));
    if (!recording) {  // an unknown version
      CHECK(at >= 8);
      CHECK(at < 12);
      CHECK(contains(recording.failure().text, "version"));
      ++refused;
      continue;
    }
    const auto found = contents(*recording);
    CHECK(in_both(found, whole) == found.size());
    const size_t lost = whole.size() - found.size();
    const size_t poses_lost = 40 - recording->truth.size();
    CHECK(lost + poses_lost <= 1);
    if (at >= 12 && at < 16) continue;  // the minor version: nothing is lost
    CHECK(recording->loss.any());
    REQUIRE(recording->warnings.size() == 1);
    if (recording->loss.file.records_lost) CHECK(*recording->loss.file.records_lost == lost + poses_lost);
  }
  CHECK(refused <= 4);
}

TEST_CASE("each of 300 truncations keeps everything before it and is reported, also between two records") {
  const TemporaryFolder folder;
  const auto path = recording_of(folder);
  const std::string bytes = read_text(path);
  const auto whole = contents(*read_odo(path));
  std::vector<size_t> borders;
  for (size_t at = bytes.find("ODOR", 16); at != std::string::npos; at = bytes.find("ODOR", at + 1))
    borders.push_back(at);
  Random random(8, 1);
  size_t said = 0;
  for (int i = 0; i < 300; ++i) {
    const size_t at = i < 100 ? borders[random.next() % borders.size()] : random.next() % bytes.size();
    CAPTURE(at);
    const auto recording = read_recording(write_text(folder / "cut.odo", bytes.substr(0, at)));
    if (!recording) {
      CHECK(at < 400);  // before the first message
      CHECK_FALSE(recording.failure().text.empty());
      ++said;
      continue;
    }
    CHECK(in_both(contents(*recording), whole) == recording->messages.size());
    CHECK(recording->loss.file.cut);
    CHECK(contains(recording->warnings.at(0), "end mark is missing"));
    ++said;
  }
  CHECK(said == 300);
}

TEST_CASE("a recording within a damaged record's payload is not read as one") {
  const TemporaryFolder folder;
  const std::string inner = read_text(recording_of(folder, 2));
  auto created = RecordWriter::create(folder / "outer.odo");
  RecordWriter& writer = *created;
  const auto payload = std::span(reinterpret_cast<const unsigned char*>(inner.data()), inner.size());
  const auto imu = make_message<odo_imu>(ODO_TYPE_IMU, 77);
  REQUIRE(writer.write(imu.header, {}));
  REQUIRE(writer.write(0x80000000u, payload));
  REQUIRE(writer.write(imu.header, {}));
  REQUIRE(writer.finish().ok());
  std::string bytes = read_text(folder / "outer.odo");
  bytes[16 + 16 + sizeof(odo_imu) + 12] = static_cast<char>(bytes[16 + 16 + sizeof(odo_imu) + 12] ^ 1);  // its checksum
  const auto recording = required(read_odo(write_text(folder / "outer.odo", bytes)));
  CHECK(recording->messages.size() == 2);
  CHECK(recording->loss.file.records_lost == 1);
}

TEST_CASE("a file of nothing but starts of records is not read in quadratic time") {
  const TemporaryFolder folder;
  const uint32_t head[4] = {0x524F444F, 1, 30u << 20, 0};
  std::string bytes = read_text(recording_of(folder, 1));
  while (bytes.size() < (40u << 20)) bytes.append(reinterpret_cast<const char*>(head), sizeof head);
  const auto started = std::chrono::steady_clock::now();
  const auto recording = read_odo(write_text(folder / "heads.odo", bytes));
  CHECK(std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count() < 20);
  REQUIRE(recording.ok());
  CHECK(recording->messages.size() == 5);
  CHECK(recording->loss.any());
}

namespace {

struct Euroc {
  TemporaryFolder folder;
  std::string sensor =
      "sensor_type: camera\nT_BS:\n  cols: 4\n  rows: 4\n  data: [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]\n"
      "resolution: [64, 48]\nintrinsics: [50, 51, 32, 24]\ndistortion_model: radial-tangential\n"
      "distortion_coefficients: [-0.28, 0.07, 1e-4, 1e-5]\n";
  std::string frames = "#t,file\n150,150.png\n";

  Result<Recording> read(const ReadOptions& options = {}) {
    fs::create_directories(folder / "mav0/cam0/data");
    write_text(folder / "mav0/cam0/sensor.yaml", sensor);
    write_text(folder / "mav0/cam0/data.csv", frames);
    return read_recording(folder.path(), options);
  }
  void replace(const std::string& what, const std::string& by) { sensor.replace(sensor.find(what), what.size(), by); }
};

}  // namespace

TEST_CASE("impossible calibrations are errors with their location") {
  REQUIRE(Euroc().read().ok());
  struct Case {
    const char *what, *by, *said;
  };
  const Case cases[] = {
      {"51, 32", "-51, 32", "sensor.yaml:7:13: fy = -51; expected above 0"},
      {"[64, 48]", "[-64, 48]", "sensor.yaml:6:13: resolution: -64; expected whole pixels"},
      {"[64, 48]", "[64.5, 48]", "sensor.yaml:6:13: resolution: 64.5; expected whole pixels"},
      {"[64, 48]", "[1e9, 48]", "sensor.yaml:6:14: resolution: '1e9'; expected a number within"},
      {"[64, 48]", "[.nan, 48]", "resolution: '.nan'; expected a number"},
      {"[1,0,0,0,", "[.nan,0,0,0,", "sensor.yaml:5:10: data: '.nan'; expected a number"},
      {"[1,0,0,0,", "[2,0,0,0,", "sensor.yaml:5:9: T_BS: its 3 x 3 part is no rotation"},
      {"[1,0,0,0,", "[1,0,0,", "data: expected a list of 16 numbers"},
      {"0.07", "many", "distortion_coefficients: 'many'; expected a number"},
      {"radial-tangential", "fov", "distortion model 'fov'; expected radial-tangential or equidistant"},
      {"0.07", "0.07, 1, 2, 3, 4, 5, 6", "with 10 coefficients; expected at most 8"},
      {"sensor_type: camera", "camera_model: omni", "camera_model 'omni'; expected pinhole"},
  };
  for (const Case& c : cases) {
    Euroc euroc;
    euroc.replace(c.what, c.by);
    const auto recording = euroc.read();
    CAPTURE(c.by);
    REQUIRE_FALSE(recording.ok());
    CHECK_MESSAGE(contains(recording.failure().text, c.said), recording.failure().text);
    CHECK(recording.failure().status == ODO_E_DATA);
  }
}

TEST_CASE("a picture's name that leads out of the recording is rejected unless allowed") {
  for (const char* name : {"../../../../secret.png", "/etc/secret.png", "a/../../b.png"}) {
    Euroc euroc;
    euroc.frames = std::string("#t,file\n150,") + name + "\n";
    const auto recording = euroc.read();
    REQUIRE_FALSE(recording.ok());
    CHECK(contains(recording.failure().text, "data.csv:2: "));
    CHECK(contains(recording.failure().text, "leads out of"));
    CHECK(euroc.read({.pictures_outside = true}).ok());
  }
  Euroc euroc;
  euroc.frames = "#t,file\n150,left/../150.png\n";
  CHECK(euroc.read().ok());
}

TEST_CASE("times near the ends of int64 are skipped and counted") {
  Euroc euroc;
  euroc.frames = "#t,file\n150,a.png\n9223372036854775807,b.png\n-9223372036854775808,c.png\n";
  const auto recording = required(euroc.read());
  CHECK(recording->messages.size() == 2);
  CHECK(recording->loss.times_out_of_range == 2);
  CHECK(recording->loss.any());
  CHECK(contains(recording->warnings.at(0), "2 messages have times beyond"));
  for (const char* text : {"--99999999999", "9300000000", "-9300000000", "9.3e9"})
    CHECK_FALSE(parse_seconds(text).ok());
}

TEST_CASE("messages with impossible numbers are skipped, counted and the first one reported") {
  Recording recording;
  auto imu = imu_at(7, {0, 0, 0}, {0, 0, 0}, ODO_IMU_GYRO);
  for (const double rate : {0.1, std::nan(""), HUGE_VAL}) {
    imu.gyro_b[1] = rate;
    recording.add(imu.header);
  }
  CHECK(recording.messages.size() == 1);
  CHECK(recording.loss.impossible == 2);
  CHECK(recording.loss.any());
  CHECK(recording.loss.first_impossible == "imu at 7 ns: gyro_b[1] = nan; expected a finite number");
}

TEST_CASE("a pipe is rejected with a reason, without waiting") {
  const TemporaryFolder folder;
  const auto pipe = folder / "pipe.odo";
  REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
  CHECK(contains(read_recording(pipe).failure().text, "a pipe or a device"));
  CHECK(contains(read_odo(pipe).failure().text, "a pipe or a device"));
  CHECK(contains(read_tum(pipe).failure().text, "a pipe or a device"));
  Euroc euroc;
  fs::create_directories(euroc.folder / "mav0/cam0/data");
  REQUIRE(mkfifo((euroc.folder / "mav0/cam0/data/150.png").c_str(), 0600) == 0);
  const auto recording = required(euroc.read());
  CHECK_FALSE(load_frame(recording->messages.back()).ok());
}

TEST_CASE("control characters are escaped") {
  CHECK(printable("a\x1b[31mb\r\n\x7f") == "a\\x1B[31mb\\x0D\n\\x7F");
  CHECK(printable("L\xc3\xa4nge \xc2\x9b") == "L\xc3\xa4nge \\x9B");
  CHECK(printable(std::string("\0", 1)) == "\\x00");
}

TEST_CASE("the next record is found behind damage of any length, also if its mark spans two reads") {
  const TemporaryFolder folder;
  constexpr size_t kHeader = 16, kSlack = 24;
  const std::string bytes = read_text(recording_of(folder, 1));
  const auto damaged = [&](size_t length) {
    CAPTURE(length);
    std::string garbage(length, 'x');
    for (size_t i = 0; i + 4 < length; i += 97) garbage.replace(i, 4, "ODOD");  // half a mark
    const auto path = write_text(folder / "damaged.odo", bytes.substr(0, kHeader) + garbage + bytes.substr(kHeader));
    auto reader = required(RecordReader::open(path));
    size_t records = 0;
    while (reader->next()) ++records;
    const RecordLoss& loss = reader->loss();
    CHECK(records == 6);
    CHECK(loss.records_lost == 0);
    CHECK(loss.bytes == length);
    CHECK(loss.places == 1);
    CHECK(loss.first_at == kHeader);
  };
  for (size_t length = 1; length < 64; ++length) damaged(length);
  for (size_t look = 4096, end = 0; look < (1 << 17); look *= 2) {  // reads overlap by some bytes
    end += look;
    for (size_t length = end - kSlack; length < end + 8; ++length) damaged(length);
  }
}

TEST_CASE("a file that another program still writes is read as it was when it was opened") {
  const TemporaryFolder folder;
  const std::string bytes = read_text(recording_of(folder, 20));
  for (const size_t at : {bytes.size() / 2, bytes.size() - 28}) {  // within a record; before the end mark
    const auto path = write_text(folder / "growing.odo", bytes.substr(0, at));
    auto reader = required(RecordReader::open(path));
    write_text(path, bytes);
    size_t records = 0;
    while (reader->next() && records < 1000) ++records;
    CHECK(records == Between{30, 101});  // of 101
    CHECK(reader->loss().cut);
  }
}
