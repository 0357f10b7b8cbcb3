// SPDX-License-Identifier: Apache-2.0
//
// Sky in real photographs with masks made by hand: how many pixels each of the finders has right.
#include <doctest/doctest.h>

#include <algorithm>
#include <ctime>
#include <numbers>
#include <string>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "plugins/fix/skyline/frame_chroma.hpp"
#include "plugins/fix/skyline/robust_sky.hpp"
#include "tests/support.hpp"

using namespace odograph;
using namespace odograph::skyline;
using Eigen::Vector3d;

TEST_SUITE_BEGIN("sky_photographs");

namespace {

CameraModel fisheye(double radius_px, cv::Size size) {
  // The circle is a hemisphere; the lens's own calibration is not known.
  const double f = radius_px / (0.5 * std::numbers::pi);
  return {.distortion = CameraModel::Distortion::kannala_brandt,
          .fx = f,
          .fy = f,
          .cx = 0.5 * (size.width - 1),
          .cy = 0.5 * (size.height - 1)};
}

struct Planes {
  cv::Mat grey;
  Chroma chroma;
};

/// As a phone's camera gives them: colour at half the resolution.
Planes planes_of(const cv::Mat& bgr) {
  cv::Mat both, planes[3];
  cv::cvtColor(bgr, both, cv::COLOR_BGR2YCrCb);
  cv::split(both, planes);
  Planes p{planes[0], {}};
  cv::resize(planes[2], p.chroma.cb, bgr.size() / 2, 0, 0, cv::INTER_AREA);
  cv::resize(planes[1], p.chroma.cr, bgr.size() / 2, 0, 0, cv::INTER_AREA);
  return p;
}

}  // namespace

TEST_CASE("photographs that no network was taught on: flood fill, robust in grey, robust in colour" *
          doctest::test_suite("sky_photographs_data")) {
  namespace fs = std::filesystem;
  const fs::path folder = data_or_skip("sky_fisheye");
  if (folder.empty()) return;
  std::vector<fs::path> pictures;
  for (const auto& entry : fs::directory_iterator(folder / "images")) pictures.push_back(entry.path());
  std::sort(pictures.begin(), pictures.end());
  double right[3] = {}, all = 0;
  for (size_t i = 0; i < pictures.size(); ++i) {
    if (i / 10 % 2 == 0) continue;  // every other ten were taught
    const cv::Mat bgr = cv::imread(pictures[i].string());
    const cv::Mat truth = cv::imread((folder / "masks" / pictures[i].stem()).string() + ".png", cv::IMREAD_GRAYSCALE);
    REQUIRE(bgr.size() == truth.size());
    const CameraModel camera = fisheye(460, bgr.size());
    const Planes planes = planes_of(bgr);
    SkyFinder plain(camera, bgr.size());
    RobustSkyFinder grey({}, camera, bgr.size()), colour({}, camera, bgr.size());
    cv::Mat masks[3] = {cv::Mat(bgr.size(), CV_8U, cv::Scalar(0))}, odds;
    plain.find(planes.grey, Vector3d::UnitZ(), Vector3d::UnitX());
    if (!plain.mask().empty()) cv::resize(plain.mask(), masks[0], bgr.size(), 0, 0, cv::INTER_NEAREST);
    grey.find(planes.grey, {}, Vector3d::UnitZ(), Vector3d::UnitX());
    cv::resize(grey.log_odds(), odds, bgr.size(), 0, 0, cv::INTER_LINEAR);
    masks[1] = odds > 0;
    colour.find(planes.grey, {}, Vector3d::UnitZ(), Vector3d::UnitX(), planes.chroma);
    colour.full_log_odds(planes.grey, planes.chroma, odds);
    masks[2] = odds > 0;
    cv::Mat circle(bgr.size(), CV_8U, cv::Scalar(0));
    cv::circle(circle, {463, 463}, 440, cv::Scalar(255), -1);
    all += cv::countNonZero(circle);
    for (int k = 0; k < 3; ++k) right[k] += cv::countNonZero(((masks[k] > 127) == (truth > 127)) & circle);
  }
  MESSAGE("pixels right: flood fill " << 100 * right[0] / all << " %, robust in grey " << 100 * right[1] / all
                                      << " %, in colour " << 100 * right[2] / all << " %");
  CHECK(right[1] > right[0]);
  CHECK(right[1] > 0.86 * all);
  CHECK(right[2] > 0.94 * all);
}

TEST_CASE("a frame's colour is the same in every format, and a grey one has none") {
  cv::Mat rgb(16, 24, CV_8UC3, cv::Scalar(60, 110, 200)), both, planes[3];
  rgb(cv::Rect(8, 4, 8, 8)) = cv::Scalar(190, 150, 90);
  cv::cvtColor(rgb, both, cv::COLOR_RGB2YCrCb);
  cv::split(both, planes);
  cv::Mat cb, cr, pair, bgra, rgba;
  cv::resize(planes[2], cb, {12, 8}, 0, 0, cv::INTER_AREA), cv::resize(planes[1], cr, {12, 8}, 0, 0, cv::INTER_AREA);
  cv::cvtColor(rgb, bgra, cv::COLOR_RGB2BGRA), cv::cvtColor(rgb, rgba, cv::COLOR_RGB2RGBA);
  const auto frame_of = [](uint32_t format, std::vector<cv::Mat> parts) {
    odo_frame frame{};
    frame.format = format, frame.width = 24, frame.height = 16;
    for (size_t k = 0; k < parts.size(); ++k)
      frame.planes[k] = {parts[k].data, static_cast<int64_t>(parts[k].step), static_cast<uint32_t>(parts[k].elemSize()),
                         0};
    return chroma_of(frame);
  };
  const auto like = [&](const Chroma& c) {
    REQUIRE(c.cb.size() == cb.size());
    CHECK(cv::norm(c.cb, cb, cv::NORM_INF) <= 1);
    CHECK(cv::norm(c.cr, cr, cv::NORM_INF) <= 1);
  };
  like(frame_of(ODO_FORMAT_RGB8, {rgb}));
  like(frame_of(ODO_FORMAT_RGBA8, {rgba}));
  like(frame_of(ODO_FORMAT_BGRA8, {bgra}));
  like(frame_of(ODO_FORMAT_YUV420, {planes[0], cb, cr}));
  cv::merge(std::vector<cv::Mat>{cb, cr}, pair);
  like(frame_of(ODO_FORMAT_NV12, {planes[0], pair}));
  cv::merge(std::vector<cv::Mat>{cr, cb}, pair);
  like(frame_of(ODO_FORMAT_NV21, {planes[0], pair}));
  CHECK(frame_of(ODO_FORMAT_GREY8, {planes[0]}).empty());
  const cv::Mat none(8, 12, CV_8U, cv::Scalar(128));
  CHECK(frame_of(ODO_FORMAT_YUV420, {planes[0], none, none}).empty());
}

TEST_CASE("a colour picture of 640x480: its sky, in so much processor time" *
          doctest::test_suite("sky_photographs_data")) {
  namespace fs = std::filesystem;
  const fs::path folder = data_or_skip("sky_fisheye");
  if (folder.empty()) return;
  const fs::path first = *fs::directory_iterator(folder / "images");
  cv::Mat picture;
  cv::resize(cv::imread(first.string())(cv::Rect(0, 116, 926, 694)), picture, {640, 480}, 0, 0, cv::INTER_AREA);
  const Planes planes = planes_of(picture);
  RobustSkyFinder finder({}, fisheye(460 * 640.0 / 926, picture.size()), picture.size());
  for (const bool in_colour : {false, true}) {
    std::vector<double> ms;
    cv::Mat odds;
    for (int k = 0; k < 21; ++k) {
      timespec from{}, to{};
      clock_gettime(CLOCK_THREAD_CPUTIME_ID, &from);
      finder.find(planes.grey, {}, Vector3d::UnitZ(), Vector3d::UnitX(), in_colour ? planes.chroma : Chroma{});
      if (in_colour) finder.full_log_odds(planes.grey, planes.chroma, odds);
      clock_gettime(CLOCK_THREAD_CPUTIME_ID, &to);
      ms.push_back(1e3 * static_cast<double>(to.tv_sec - from.tv_sec) +
                   1e-6 * static_cast<double>(to.tv_nsec - from.tv_nsec));
    }
    std::sort(ms.begin(), ms.end());
    MESSAGE(std::string(in_colour ? "in colour, with all pixels: " : "in grey: ") << ms[10] << " ms");
    CHECK(ms[0] < 60);  // far above what it takes, for builds without optimisation and busy machines
  }
}

TEST_SUITE_END();
