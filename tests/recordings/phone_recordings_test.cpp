// SPDX-License-Identifier: Apache-2.0
//
// A simulated walk in the format of each app, read back: messages and poses equal those of the direct run. Broken or
// missing items are reported.
#include <functional>
#include <tuple>

#include <opencv2/imgcodecs.hpp>

#include "sdk/host/base/nearest.hpp"
#include "sdk/math/scalar.hpp"
#include "sdk/tools/recording/frame_clock.hpp"
#include "sdk/tools/recording/phone_format.hpp"
#include "sdk/tools/recording/archive.hpp"
#include "sdk/tools/replay/guessed_camera.hpp"
#include "sdk/tools/replay/picture_source.hpp"
#include "tests/recordings/phone/app_files.hpp"
#include "tests/recordings/phone/video_file.hpp"
#include "tests/support/runs.hpp"

TEST_SUITE_BEGIN("phone_recordings");

namespace {

const PhoneWalk& walk(bool upright) { return street_walk(upright); }

Recording read(const fs::path& path) {
  auto recording = required(read_recording(path));
  return std::move(*recording);
}

bool warns(const Recording& recording, const std::string& text) {
  for (const auto& warning : recording.warnings)
    if (contains(warning, text)) return true;
  return false;
}

RunResult run(const Recording& recording) {
  const auto result = required(replay(recording, {.config = source("samples/configs/walk.yaml").string()}));
  return *result;
}

/// Reference run of the walk with only the content of the app's recording: sensors, and the camera's mount.
const StampedPoses& direct_track(bool upright, const Recording& like) {
  static std::map<std::tuple<bool, bool, bool, bool>, StampedPoses> tracks;
  const bool field = like.has(ODO_TYPE_MAGNETOMETER), pressure = like.has(ODO_TYPE_BAROMETER);
  bool lever = false;
  for (const auto& m : like.messages)
    if (m.message.header().type == ODO_TYPE_CALIBRATION)
      lever = Eigen::Vector3d(as<odo_calibration>(m.message.header()).p_b_c).norm() > 0;
  auto& track = tracks[{upright, field, pressure, lever}];
  if (!track.empty()) return track;
  PhoneWalk reduced = walk(upright);
  auto& messages = reduced.recording.messages;
  std::erase_if(messages, [&](const RecordedMessage& m) {
    const uint32_t type = m.message.header().type;
    return (type == ODO_TYPE_MAGNETOMETER && !field) || (type == ODO_TYPE_BAROMETER && !pressure);
  });
  for (auto& m : messages)
    if (m.message.header().type == ODO_TYPE_CALIBRATION && !lever)
      std::fill_n(reinterpret_cast<odo_calibration&>(m.message.header()).p_b_c, 3, 0.0);
  const TemporaryFolder folder;
  write_direct(reduced, folder / "direct.odo");
  return track = run(read(folder / "direct.odo")).track;
}

/// Largest distance of two tracks (m), each from its own first time on; 1e9 if their lengths differ.
double apart(const StampedPoses& a, const StampedPoses& b) {
  if (a.size() != b.size() || a.empty()) return 1e9;
  double farthest = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    if (std::abs((a[i].t_ns - a[0].t_ns) - (b[i].t_ns - b[0].t_ns)) > 1) return 1e9;
    farthest = std::max(farthest, (a[i].p - b[i].p).norm());
  }
  return farthest;
}

/// Whether vectors are equal up to rounding of units or floats.
bool same(const double* a, const double* b, double relative) {
  const Eigen::Vector3d x(a[0], a[1], a[2]), y(b[0], b[1], b[2]);
  return (x - y).norm() <= relative * (y.norm() + 1e-3);
}

/// Times on the recording's clock, aligned at the first sample.
std::vector<int64_t> shifted(std::vector<int64_t> times_ns, const Recording& recording) {
  const int64_t begin_ns = walk(false).recording.messages.front().message.header().t_ns;
  for (int64_t& t : times_ns) t += recording.messages.front().message.header().t_ns - begin_ns;
  return times_ns;
}

/// All samples of the walk in order, without items that an app's format cannot hold.
void check_samples(const Recording& found, const PhoneWalk& given, double relative) {
  const auto a = messages_of<odo_imu>(found, ODO_TYPE_IMU), b = messages_of<odo_imu>(given.recording, ODO_TYPE_IMU);
  REQUIRE(a.size() == b.size());
  size_t wrong = 0;
  for (size_t i = 0; i < a.size(); ++i)
    wrong += std::abs((a[i].header.t_ns - a[0].header.t_ns) - (b[i].header.t_ns - b[0].header.t_ns)) > 1 ||
             !same(a[i].gyro_b, b[i].gyro_b, relative) || !same(a[i].accel_b, b[i].accel_b, relative);
  CHECK(wrong == 0);
  if (const auto fields = messages_of<odo_magnetometer>(found, ODO_TYPE_MAGNETOMETER); !fields.empty()) {
    const auto expected = messages_of<odo_magnetometer>(given.recording, ODO_TYPE_MAGNETOMETER);
    REQUIRE(fields.size() == expected.size());
    CHECK(same(fields[3].field_b, expected[3].field_b, 1e-9));
  }
  if (const auto p = messages_of<odo_barometer>(found, ODO_TYPE_BAROMETER); !p.empty())
    CHECK(p[2].pressure_pa ==
          doctest::Approx(messages_of<odo_barometer>(given.recording, ODO_TYPE_BAROMETER)[2].pressure_pa));
  if (const auto places = messages_of<odo_gnss>(found, ODO_TYPE_GNSS); !places.empty()) {
    const auto expected = messages_of<odo_gnss>(given.recording, ODO_TYPE_GNSS);
    REQUIRE(places.size() == expected.size());
    CHECK(std::abs(places[1].latitude_rad - expected[1].latitude_rad) < 1e-14);
    CHECK(std::abs(places[1].longitude_rad - expected[1].longitude_rad) < 1e-14);
    CHECK(places[1].height_m == doctest::Approx(expected[1].height_m));
    CHECK(places[1].covariance_n[0] == doctest::Approx(expected[1].covariance_n[0]));
    CHECK(places[1].covariance_n[8] == doctest::Approx(expected[1].covariance_n[8]));
  }
}

/// Whether the IMU's samples are exact.
bool exact(const Recording& found, const PhoneWalk& given) {
  const auto a = messages_of<odo_imu>(found, ODO_TYPE_IMU), b = messages_of<odo_imu>(given.recording, ODO_TYPE_IMU);
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const odo_imu& x, const odo_imu& y) {
    return std::equal(x.gyro_b, x.gyro_b + 3, y.gyro_b) && std::equal(x.accel_b, x.accel_b + 3, y.accel_b);
  });
}

}  // namespace

TEST_CASE("a walk written by each app, upright or wide, gives the samples and the poses of the direct run") {
  for (size_t i = 0; i < apps().size(); ++i)
    for (const bool upright : {false, true}) {
      const App& app = apps()[i];
      if (upright && (i == 5 || i == 9)) continue;  // its files have the lens in sensor orientation
      CAPTURE(app.name);
      CAPTURE(i);
      CAPTURE(upright);
      const TemporaryFolder folder;
      app.write(walk(upright), folder / "out");
      if (!app.has_lens) write_lens(walk(upright), folder / "out");
      write_zip(folder / "out", folder / "export.zip", i % 2 ? "2026-11-25_Walk/" : "");
      const Recording recording = read(folder / "export.zip");
      CHECK(recording.format == app.name);
      const bool floats = app.name == "VideoIMUCapture";
      check_samples(recording, walk(upright), floats ? 1e-6 : 1e-12);
      if (app.name == "GnssLogger") {
        CHECK_FALSE(recording.has(ODO_TYPE_FRAME));
        continue;
      }
      CHECK(frame_times_ns(recording) == shifted(walk(upright).times_ns, recording));
      if (upright && i != 0 && i != 11) continue;  // the same samples and times give the same poses
      const double off_m = apart(run(recording).track, direct_track(upright, recording));
      MESSAGE(app.name, std::string(upright ? " (upright)" : ""), ": ", 1e3 * off_m, " mm from the direct run");
      // The last digit of a sample may accept or reject a corner: single precision changes 12 m by 7 to 13 mm, and so
      // does the rounding of a sum with gravity.
      CHECK(off_m < (exact(recording, walk(upright)) ? 1e-6 : 30e-3));
    }
}

TEST_CASE("a folder is read like its zip, and lossy video gives a similar track") {
  const TemporaryFolder folder;
  apps()[0].write(walk(false), folder / "out");
  write_lens(walk(false), folder / "out");
  const Recording recording = read(folder / "out");
  CHECK(recording.format == "Sensor Logger (Android)");
  CHECK(apart(run(recording).track, direct_track(false, recording)) < 1e-4);
  const fs::path video = folder / "out/Camera/1781801310305.mp4";
  REQUIRE(write_video(video, walk(false).pictures, walk(false).times_ns, 23));
  std::vector<std::pair<int64_t, int64_t>> samples;
  for (const int64_t t : walk(false).times_ns) samples.emplace_back(t - walk(false).times_ns[0], t);
  add_metadata_track(video, samples);
  const double off_m = apart(run(read(folder / "out")).track, direct_track(false, recording));
  MESSAGE("H.264 at CRF 23: ", 1e3 * off_m, " mm from the direct run");
  CHECK(off_m < 0.4);  // 3 % of the 12 m
}

TEST_CASE("the pictures of a video for a calibration are as stored, three a second") {
  const TemporaryFolder folder;
  REQUIRE(write_video(folder / "film.mp4", walk(false).pictures, walk(false).times_ns));
  const auto sources = pictures_of((folder / "film.mp4").string());
  REQUIRE(sources.ok());
  const double span_s = 1e-9 * static_cast<double>(walk(false).times_ns.back() - walk(false).times_ns.front());
  CHECK(static_cast<double>(sources->size()) == doctest::Approx(3 * span_s).epsilon(0.15));
  CHECK(cv::norm(sources->front().grey(), walk(false).pictures.front(), cv::NORM_INF) == 0);
}

TEST_CASE("guesses are reported: the lens by the phone, the mount by the picture's shape, times by the file name") {
  const TemporaryFolder folder;
  apps()[2].write(walk(false), folder / "out");
  const Recording recording = read(folder / "out");
  CHECK(warns(recording, "guessed a focal length of 265.6 px"));
  CHECK(warns(recording, "iPhone14,5"));
  CHECK(warns(recording, "mount of the camera guessed"));
  const auto c = messages_of<odo_calibration>(recording, ODO_TYPE_CALIBRATION).front();
  CHECK(c.fx == doctest::Approx(0.83 * 320));
  CHECK(c.cx == doctest::Approx(159.5));
  REQUIRE(write_video(folder / "out/Camera/1781801310305.mp4", walk(false).pictures, walk(false).times_ns));
  const Recording without = read(folder / "out");
  CHECK(warns(without, "0.1 to 0.7 s early"));
  CHECK(frame_times_ns(without).front() == 1'781'801'310'305'000'000);
}

TEST_CASE("lens, mount and the time of a video without times are refined against the gyroscope") {
  const TemporaryFolder folder;
  apps()[3].write(walk(false), folder / "out");
  REQUIRE(write_video(folder / "out/Camera/1781801310305.mp4", walk(false).pictures, walk(false).times_ns));
  Recording recording = read(folder / "out");
  refine_guessed_camera(recording);
  for (const auto& warning : recording.warnings) MESSAGE(warning);
  const auto c = messages_of<odo_calibration>(recording, ODO_TYPE_CALIBRATION).front();
  const double late_s = 1e-9 * static_cast<double>(walk(false).times_ns.front() - 1'781'801'310'305'000'000);
  CHECK(std::abs(1e-9 * static_cast<double>(c.time_offset_ns) - late_s) < 5e-3);
  const Eigen::Quaterniond q(c.q_b_c[0], c.q_b_c[1], c.q_b_c[2], c.q_b_c[3]);
  const auto& t = walk(false).lens.q_b_c;
  CHECK(q.angularDistance(Eigen::Quaterniond(t[0], t[1], t[2], t[3])) < 0.03);
}

TEST_CASE("a magnetometer, a barometer and fixes may be missing, and cached fixes are skipped") {
  const TemporaryFolder folder;
  apps()[0].write(walk(false), folder / "out");
  for (const char* name : {"Magnetometer.csv", "Barometer.csv"}) fs::remove(folder / "out" / name);
  const std::string places = read_text(folder / "out/Location.csv");
  const size_t head = places.find('\n') + 1;
  write_text(folder / "out/Location.csv", places.substr(0, head) +
                                              "1781801200000000000,-111,-1,-1,5,20,0,0,30,2.35,48.85\n" +
                                              "1781801312000000000,1,-1,-1,-1,-1,0,0,0,0,0\n" + places.substr(head));
  const Recording recording = read(folder / "out");
  CHECK(warns(recording, "not recorded: magnetometer, barometer"));
  CHECK(warns(recording, "1 fixes are older than the recording"));
  CHECK(warns(recording, "1 fixes are marked as invalid"));
  CHECK(messages_of<odo_gnss>(recording, ODO_TYPE_GNSS).size() ==
        messages_of<odo_gnss>(walk(false).recording, ODO_TYPE_GNSS).size());
}

TEST_CASE("what an app leaves out of a fix is unknown, not zero or the previous one's") {
  const TemporaryFolder folder;
  const auto last_fix = [&](size_t app, const char* file, const std::function<void(std::string&)>& shorten) {
    const fs::path out = folder / std::to_string(app);
    apps()[app].write(walk(false), out);
    std::string text = read_text(out / file);
    shorten(text);
    write_text(out / file, text);
    return messages_of<odo_gnss>(read(out), ODO_TYPE_GNSS).back();
  };
  const auto of_table = last_fix(0, "Location.csv", [](std::string& text) {
    const size_t row = text.rfind('\n', text.size() - 2) + 1;
    text.replace(text.find(",-1,-1,", row), std::string::npos, ",-1,-1,,,1.2,90,,2.35,48.85\n");
  });
  const auto of_lines = last_fix(5, "data.jsonl", [](std::string& text) {
    const size_t fix = text.rfind("{\"gps\":{");
    text.replace(fix, text.find('}', fix) - fix, "{\"gps\":{\"latitude\":48.85,\"longitude\":2.35");
  });
  for (const odo_gnss& fix : {of_table, of_lines}) {
    CHECK(fix.latitude_rad == doctest::Approx(48.85 / kDeg_per_rad));
    CHECK(fix.header.flags == ODO_GNSS_POSITION);  // no height, no covariance
  }
}

TEST_CASE("GnssLogger's older columns are read, with Unix time alone where the sensors have it too") {
  const TemporaryFolder folder;
  apps()[10].write(walk(false), folder / "out");
  const fs::path file = fs::directory_iterator(folder / "out")->path();
  const auto fixes = [&] { return messages_of<odo_gnss>(read(file), ODO_TYPE_GNSS); };
  const auto now = fixes();
  std::string text = read_text(file), old;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("# Fix,")) line = "# Fix,Provider,Latitude,Longitude,Altitude,Speed,Accuracy,(UTC)TimeInMs";
    if (line.starts_with("Fix,")) {
      const auto fields = split(line, ',');
      line = "Fix,gps," + fields[2] + "," + fields[3] + "," + fields[4] + "," + fields[5] + "," + fields[6] + "," +
             fields[8];
    }
    old += line + "\n";
  }
  write_text(file, old);
  const auto older = fixes();
  REQUIRE(older.size() == now.size());
  for (size_t i = 0; i < now.size(); ++i) {
    CHECK(older[i].latitude_rad == now[i].latitude_rad);
    CHECK(std::abs(older[i].header.t_ns - now[i].header.t_ns) <= 1'000'000);
  }
  for (size_t at; (at = old.find("utcTimeMillis")) != std::string::npos;) old.replace(at, 13, "other");
  write_text(file, old);
  CHECK(fixes().empty());
  CHECK(warns(read(file), "GNSS (in Unix time, which the other sensors lack)"));
}

TEST_CASE("the platform's own poses are the reference, converted to our axes") {
  const TemporaryFolder folder;
  apps()[9].write(walk(false), folder / "out");
  const Recording recording = read(folder / "out");
  const StampedPoses& expected = walk(false).recording.truth;
  REQUIRE(recording.truth.size() == expected.size());
  CHECK((recording.truth[7].p - expected[7].p).norm() < 1e-9);
  CHECK(recording.truth[7].q.angularDistance(expected[7].q) < 1e-7);
  CHECK(warns(recording, "drifts too"));
}

TEST_CASE("table rows are matched to frames if some are missing at the start, but not in between") {
  std::vector<int64_t> video, rows;
  for (int64_t i = 0; i < 50; ++i) video.push_back(i * 33'000'000 + (i % 7) * 1'500'000);
  for (const int64_t t : video) rows.push_back(t + 77);
  const std::vector<int64_t> fewer(rows.begin() + 3, rows.end());
  const auto matched = required(phone::match_rows(video, fewer));
  CHECK((*matched)[2] == SIZE_MAX);
  CHECK((*matched)[3] == 0);
  std::vector<int64_t> other = rows;
  for (size_t i = 0; i < other.size(); ++i) other[i] += static_cast<int64_t>(i) * 20'000'000;
  CHECK_FALSE(phone::match_rows(video, other).ok());
}

TEST_CASE("a picture is read in sensor orientation, whatever its EXIF orientation") {
  const TemporaryFolder folder;
  std::vector<unsigned char> jpeg;
  REQUIRE(cv::imencode(".jpg", cv::Mat(16, 32, CV_8U, cv::Scalar(90)), jpeg));
  for (const char orientation : {1, 3, 6, 8}) {
    const std::string exif(
        "\xFF\xE1\0\x22"
        "Exif\0\0"
        "MM\0*\0\0\0\10"
        "\0\1"
        "\1\x12\0\3\0\0\0\1\0",
        29);
    std::string bytes(jpeg.begin(), jpeg.begin() + 2);
    bytes += exif + orientation + std::string(6, '\0');
    bytes.append(jpeg.begin() + 2, jpeg.end());
    write_text(folder / "a.jpg", bytes);
    RecordedMessage message;
    message.message.assign(make_message<odo_frame>(ODO_TYPE_FRAME, 1).header);
    message.picture.file = std::make_shared<const fs::path>(folder / "a.jpg");
    const auto frame = required(load_frame(message));
    CHECK(frame->width == 32);
    CHECK(frame->height == 16);
    frame->loan.release(frame->loan.owner);
    CHECK(cv::imread((folder / "a.jpg").string()).cols == (orientation < 5 ? 32 : 16));  // OpenCV reads the tag
  }
}

TEST_CASE("phyphox' exports are read with any separator and decimal mark, in a folder or one level down") {
  struct Form {
    const char *separator, *folder;
    char mark;
  };
  for (const Form& form :
       {Form{",", "", '.'}, {";", "", '.'}, {"\t", "", '.'}, {";", "walk/", ','}, {"\t", "walk/", ','}}) {
    const TemporaryFolder folder;
    std::filesystem::create_directories(folder.path() / form.folder);
    const auto table = [&](const char* name, const char* unit, double level) {
      std::string text = "\"Time (s)\"";
      for (const char* axis : {"X", "Y", "Z"}) text += std::string(form.separator) + "\"" + axis + " (" + unit + ")\"";
      text += "\n";
      for (int i = 0; i < 100; ++i) {
        char row[128];
        std::snprintf(row, sizeof row, "%.6E%s%.6E%s%.6E%s%.6E\n", 0.02 * i, form.separator, 0.01 * i, form.separator,
                      -0.5, form.separator, level);
        std::string numbers = row;
        std::replace(numbers.begin(), numbers.end(), '.', form.mark);
        text += numbers;
      }
      write_text(folder.path() / form.folder / name, text);
    };
    table("Accelerometer.csv", "m/s^2", 9.8), table("Gyroscope.csv", "rad/s", 0.25);
    CAPTURE(std::string(form.separator));
    const auto recording = required(read_recording(folder.path()));
    CHECK(recording->format == "phyphox");
    int gyro = 0, accel = 0;
    for (const RecordedMessage& each : recording->messages) {
      if (each.message.header().type != ODO_TYPE_IMU) continue;
      const auto& imu = as<odo_imu>(each.message.header());
      if (imu.header.flags & ODO_IMU_GYRO) {
        ++gyro;
        CHECK(imu.gyro_b[2] == doctest::Approx(0.25));
      }
      if (imu.header.flags & ODO_IMU_ACCEL) {
        ++accel;
        CHECK(imu.accel_b[1] == doctest::Approx(-0.5));
      }
    }
    CHECK(gyro == 100);
    CHECK(accel == 100);
  }
}

TEST_CASE("names match patterns") {
  CHECK(phone::matches("Camera/*.mp4|*.mov", "Camera/12.mp4"));
  CHECK(phone::matches("Camera/*.mp4|*.mov", "a.mov"));
  CHECK_FALSE(phone::matches("*.mp4", "Camera/12.mp4"));
  CHECK_FALSE(phone::matches("a*b", "abc"));
}
