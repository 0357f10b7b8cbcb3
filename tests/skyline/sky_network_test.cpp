// SPDX-License-Identifier: Apache-2.0
//
// The sky network: its convolutions against plain sums, and cameras of every attitude.
#include <random>

#include <Eigen/Geometry>
#include <opencv2/imgproc.hpp>

#include "plugins/fix/skyline/robust_sky.hpp"
#include "plugins/fix/skyline/sky_rays.hpp"
#include "tests/support/support.hpp"

using namespace odograph::skyline;
using Eigen::Vector3d;

TEST_SUITE_BEGIN("sky_network");

namespace {

constexpr double kDegree = std::numbers::pi / 180;

Volume random_volume(int channels, int height, int width, std::mt19937& random) {
  Volume v;
  v.create(channels, height, width);
  std::normal_distribution<float> normal;
  for (int c = 0; c < channels; ++c)
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) v.row(c, y)[x] = normal(random);
  return v;
}

Convolution random_layer(int inputs, int outputs, int side, int stride, std::mt19937& random) {
  Convolution layer{inputs, outputs, side, stride, {}, {}};
  std::normal_distribution<float> normal;
  for (int k = 0; k < inputs * outputs * side * side; ++k) layer.weights.push_back(normal(random));
  for (int k = 0; k < outputs; ++k) layer.biases.push_back(normal(random));
  return layer;
}

/// One result by definition; `own`: depthwise, from the output's own plane only.
double plain(const Convolution& c, const Volume& in, int o, int y, int x, bool own) {
  double sum = static_cast<double>(c.biases[static_cast<size_t>(o)]);
  size_t k = static_cast<size_t>(o * c.inputs * c.side * c.side);
  const int reach = c.side / 2;
  for (int i = 0; i < c.inputs; ++i)
    for (int dy = -reach; dy <= reach; ++dy)
      for (int dx = -reach; dx <= reach; ++dx, ++k) {
        const int v = c.stride * y + dy, u = c.stride * x + dx;
        if (v < 0 || u < 0 || v >= in.height() || u >= in.width()) continue;
        sum += static_cast<double>(c.weights[k] * in.row(own ? o : i, v)[u]);
      }
  return sum;
}

/// A street seen by a pinhole or a fisheye: clouds over a ring of houses with roofs at `elevation(azimuth)`, walls with
/// windows, a floor.
template <class Elevation>
cv::Mat street(const CameraModel& camera, cv::Size size, const Eigen::Matrix3d& R_n_c, Elevation&& elevation) {
  cv::Mat picture(size, CV_8UC1), noise(size, CV_32F);
  cv::RNG random(11);
  random.fill(noise, cv::RNG::NORMAL, 0, 3);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      Vector3d ray;
      double grey = 40;
      if (ray_of(camera, {double(x), double(y)}, 1.56, ray)) {
        const Vector3d d = R_n_c * ray;  // z is up
        const double azimuth = std::atan2(d.y(), d.x()), up = std::asin(std::clamp(d.z(), -1.0, 1.0));
        if (up > elevation(azimuth))
          grey = 205 + 25 * std::sin(4 * d.x() + 2) * std::cos(5 * d.y());
        else if (up < -0.06)
          grey = 85 + 10 * std::sin(40 * d.x() / d.z());
        else
          grey = std::fmod(azimuth * 20 + 100, 2) < 1 && std::fmod(up * 20 + 100, 2) < 1 ? 45 : azimuth > 0 ? 150 : 100;
      }
      picture.at<uint8_t>(y, x) = cv::saturate_cast<uint8_t>(grey + double(noise.at<float>(y, x)));
    }
  cv::GaussianBlur(picture, picture, {3, 3}, 0.6);
  return picture;
}

}  // namespace

TEST_CASE("a layer's results are the plain sums") {
  std::mt19937 random(3);
  Volume split, out;
  for (const int side : {1, 3})
    for (const int stride : {1, 2}) {
      const Volume in = random_volume(5, 12, 19, random);
      const Convolution layer = random_layer(5, 7, side, stride, random);
      convolve(layer, in, false, split, out);
      REQUIRE(out.height() == (12 + stride - 1) / stride);
      for (int o = 0; o < 7; ++o)
        for (int y = 0; y < out.height(); ++y)
          for (int x = 0; x < out.width(); ++x)
            REQUIRE(double(out.row(o, y)[x]) == doctest::Approx(plain(layer, in, o, y, x, false)).epsilon(1e-4));
    }
  for (const int stride : {1, 2}) {
    const Volume in = random_volume(6, 12, 18, random);
    const Convolution layer = random_layer(1, 6, 3, stride, random);
    convolve_each(layer, in, out);
    for (int o = 0; o < 6; ++o)
      for (int y = 0; y < out.height(); ++y)
        for (int x = 0; x < out.width(); ++x)
          REQUIRE(double(out.row(o, y)[x]) ==
                  doctest::Approx(std::max(0.0, plain(layer, in, o, y, x, true))).epsilon(1e-4));
  }
  const Volume coarse = random_volume(2, 4, 5, random);
  Volume fine = random_volume(2, 8, 10, random);
  const Volume before = fine;
  add_doubled(coarse, fine);
  for (int c = 0; c < 2; ++c)
    for (int y = 0; y < 8; ++y)
      for (int x = 0; x < 10; ++x)
        REQUIRE(fine.row(c, y)[x] == std::max(0.0f, before.row(c, y)[x] + coarse.row(c, y / 2)[x / 2]));
}

TEST_CASE("roofs are found by cameras that look ahead, level and tilted, and straight up") {
  const CameraModel ahead{.fx = 460, .fy = 460, .cx = 319.5, .cy = 239.5};
  const CameraModel wide{
      .distortion = CameraModel::Distortion::kannala_brandt, .fx = 200, .fy = 200, .cx = 319.5, .cy = 239.5};
  const auto roofs = [](double azimuth) { return (std::sin(6 * azimuth) > 0 ? 17 : 11) * kDegree; };
  for (const double pitch : {0.0, 0.35, 1.5707}) {
    const CameraModel& camera = pitch > 1 ? wide : ahead;
    Eigen::Matrix3d R_n_c;  // x ahead, z up; the camera's x right, y down, z ahead
    R_n_c.col(0) = -Vector3d::UnitY();
    R_n_c.col(2) = Vector3d(std::cos(pitch), 0, std::sin(pitch));
    R_n_c.col(1) = R_n_c.col(2).cross(R_n_c.col(0));
    const cv::Mat picture = street(camera, {640, 480}, R_n_c, roofs);
    RobustSkyFinder finder({}, camera, picture.size());
    const Vector3d up_c = R_n_c.transpose() * Vector3d::UnitZ(), north_c = R_n_c.transpose() * Vector3d::UnitX();
    int told = 0, right = 0;
    for (const SkyEdge& e : finder.find(picture, {}, up_c, north_c)) {
      if (e.open || e.above) continue;
      ++told;
      const Vector3d d = R_n_c * e.ray_c;
      right += std::abs(std::asin(d.z()) - roofs(std::atan2(d.y(), d.x()))) < kDegree;
    }
    CAPTURE(pitch);
    CHECK(told > (pitch > 1 ? 400 : 80));  // the wide lens's upper and lower border cut the roofs off
    CHECK(right > 0.7 * told);
  }
}

TEST_CASE("a picture without sky has no skyline, and no picture gives a number that is none") {
  const CameraModel camera{.fx = 460, .fy = 460, .cx = 319.5, .cy = 239.5};
  RobustSkyFinder finder({}, camera, {640, 480});
  for (const int grey : {0, 255}) {
    finder.find(cv::Mat(480, 640, CV_8U, cv::Scalar(grey)), {}, -Vector3d::UnitY(), Vector3d::UnitZ());
    CHECK(cv::checkRange(finder.log_odds()));
  }
  // The street of the previous case, facing down: there is no sky below the horizon.
  Eigen::Matrix3d R_n_c;
  R_n_c.col(0) = -Vector3d::UnitY(), R_n_c.col(2) = Vector3d(0.6, 0, -0.8);
  R_n_c.col(1) = R_n_c.col(2).cross(R_n_c.col(0));
  const cv::Mat down = street(camera, {640, 480}, R_n_c, [](double) { return 0.2; });
  CHECK(finder.find(down, {}, R_n_c.transpose() * Vector3d::UnitZ(), R_n_c.transpose() * Vector3d::UnitX()).empty());
  // The mask excludes the whole picture.
  CHECK(finder.find(down, cv::Mat(480, 640, CV_8U, cv::Scalar(0)), Vector3d::UnitZ(), Vector3d::UnitX()).empty());
}
