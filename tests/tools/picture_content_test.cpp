// SPDX-License-Identifier: Apache-2.0
//
// A picture in a pocket is noise, which is not tracked.
#include <opencv2/imgproc.hpp>

#include "plugins/shared/camera/picture_content.hpp"
#include "plugins/vo/five_point/visual_odometry.hpp"
#include "plugins/vo/odograph/visual/odometry.hpp"
#include "tests/support/support.hpp"

TEST_SUITE_BEGIN("vo_odograph");

namespace {

constexpr int kWide = 640, kHigh = 480;

cv::Mat noise_picture(double mean, double sigma, uint64_t seed) {
  cv::Mat picture(kHigh, kWide, CV_16S);
  cv::RNG rng(seed);
  rng.fill(picture, cv::RNG::NORMAL, mean, sigma);
  picture.convertTo(picture, CV_8U);
  return picture;
}

/// A street at night: blocks of other greys under noise of the same size.
cv::Mat night_picture(uint64_t seed) {
  cv::Mat blocks(kHigh / 40, kWide / 40, CV_8U), picture;
  cv::RNG(5).fill(blocks, cv::RNG::UNIFORM, 15, 60);
  cv::resize(blocks, picture, {kWide, kHigh}, 0, 0, cv::INTER_NEAREST);
  cv::add(picture, noise_picture(30, 16, seed), picture);
  cv::subtract(picture, 30, picture);
  return picture;
}

}  // namespace

TEST_CASE("noise is distinguished from content, whatever its mean") {
  const PictureContent::Parameters p;
  for (const auto& noise : {std::array{7.0, 9.0}, {25.0, 20.0}, {120.0, 30.0}}) {
    CAPTURE(noise[0]);
    CHECK_FALSE(content_of(noise_picture(noise[0], noise[1], 1)).has_content(p));
  }
  CHECK_FALSE(content_of(cv::Mat(kHigh, kWide, CV_8U, cv::Scalar(128))).has_content(p));
  CHECK_FALSE(content_of(cv::Mat(3, 2, CV_8U, cv::Scalar(128))).has_content(p));
  CHECK(content_of(night_picture(2)).has_content(p));
  cv::Mat wall(kHigh, kWide, CV_8U, cv::Scalar(180));
  cv::rectangle(wall, {200, 100, 60, 120}, 150, cv::FILLED);  // a plain wall with one frame on it
  CHECK(content_of(wall).has_content(p));
}

TEST_CASE("no odometry finds a motion in a pocket") {
  const CameraModel lens = [] {
    CameraModel model;
    model.fx = model.fy = 500, model.cx = 0.5 * kWide, model.cy = 0.5 * kHigh;
    return model;
  }();
  vo::Odometry ours({}, lens);
  five_point::VisualOdometry plain({}, lens);
  for (uint64_t k = 0; k < 60; ++k) {
    const cv::Mat picture = noise_picture(14, 12, k % 4);  // a cycle of four pictures: each corner is found again
    vo::Frame frame;
    frame.t_ns = int64_t(k) * 100'000'000, frame.grey = picture;
    const auto check = [&](const auto& motion) {
      CHECK(motion.state != Tracking::tracking);
      CHECK_FALSE(motion.translation_valid);
      if (k > 0) CHECK(motion.failure == FailureReason::too_dark);
    };
    check(ours.process(frame)), check(plain.process(picture, {}));
  }
}
