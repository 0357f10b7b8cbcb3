// SPDX-License-Identifier: Apache-2.0
//
// Files from others: tables with shifted columns, links out of a recording, pictures too large to decode.
#include <doctest/doctest.h>

#include <cmath>

#include <opencv2/imgcodecs.hpp>

#include "sdk/tools/recording/picture_header.hpp"
#include "sdk/tools/recording/recording.hpp"
#include "sdk/tools/recording/text_rows.hpp"
#include "tests/support/support.hpp"

using namespace odograph;
namespace fs = std::filesystem;

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
  CHECK(recording.failure().text.find("a.png: a link leads out of the recording's folder") != std::string::npos);
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
      const auto size = picture_size(file);
      REQUIRE_MESSAGE(size.ok(), (size.ok() ? "" : size.failure().text));
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
    CHECK_MESSAGE(frame.failure().text.find("a picture of 32000 x 32000 pixels; expected at most 64 million") !=
                      std::string::npos,
                  frame.failure().text);
  }
  CHECK(picture_size(write_text(folder / "64.pgm", "P5 8000 8000 255\n")).ok());
  CHECK_FALSE(picture_size(write_text(folder / "more.pgm", "P5 8000 8001 255\n")).ok());  // no side too long
  CHECK_FALSE(picture_size(write_text(folder / "text.png", "no picture")).ok());
  CHECK_FALSE(picture_size(write_text(folder / "cut.jpg", jpeg.substr(0, 12))).ok());
  CHECK_FALSE(picture_size(folder / "missing.png").ok());
}

TEST_SUITE_END();
