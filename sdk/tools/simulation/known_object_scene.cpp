// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/simulation/known_object_scene.hpp"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "sdk/host/messages/messages.hpp"
#include "sdk/tools/simulation/poster.hpp"

namespace odograph::known_object_scene {
namespace {

/// Viewpoint in front of the copy, facing and moving away from the original, so that at least half of the original is
/// out of the picture.
Viewpoint before_copy(Viewpoint v, const Vector3d& aside, const PosterCamera& camera) {
  constexpr double kRotation_rad = 0.02, kFirst_s = -0.25;
  constexpr int kYaws = 60;
  const double side = aside.y() > 0 ? 1 : -1;
  v.p_n += aside;
  v.velocity_n.y() = side * std::abs(v.velocity_n.y());
  v.rate_c.setZero();
  for (int k = 0; k < kYaws; ++k) {
    const Eigen::Vector3d p_c = v.after(kFirst_s).to(kMiddle).translation();
    if (p_c.z() <= 0) break;
    const double x = camera.project(p_c).x();
    if (x < 0 || x > 639) break;
    v.R_n_c = Eigen::AngleAxisd(side * kRotation_rad, Vector3d::UnitZ()).toRotationMatrix() * v.R_n_c;
  }
  return v;
}

}  // namespace

cv::Mat wall_picture(uint64_t seed) {
  Random random(seed, 21);
  cv::Mat wall(1024, 2048, CV_8U, cv::Scalar(random.uniform(90, 170)));
  for (int k = 0; k < 500; ++k) {
    const auto point = [&](double x0, double x1, double y0, double y1) {
      const double y = random.uniform(y0, y1), x = random.uniform(x0, x1);
      return cv::Point(static_cast<int>(x), static_cast<int>(y));
    };
    const cv::Point a = point(0, 2048, 0, 1024), b = a + point(4, 70, 4, 90);
    const int thickness = random.uniform() < 0.5 ? cv::FILLED : 2;
    cv::rectangle(wall, a, b, random.uniform(40, 230), thickness);
  }
  for (uint8_t& p : cv::Mat_<uint8_t>(wall)) p = cv::saturate_cast<uint8_t>(p + 10 * random.normal());
  return wall;
}

odo_calibration lens_of(uint64_t number) {
  auto c = make_message<odo_calibration>(ODO_TYPE_CALIBRATION, 0);
  c.header.flags = ODO_CALIBRATION_EXTRINSICS;
  c.width = 640, c.height = 480;
  c.fx = c.fy = 500, c.cx = 319.5, c.cy = 239.5;
  c.q_b_c[1] = 1;  // the body's x, -y, -z
  c.model = ODO_CAMERA_PINHOLE;
  const auto put = [&](std::initializer_list<double> k) {
    c.distortion_count = static_cast<uint32_t>(k.size());
    std::copy(k.begin(), k.end(), c.distortion);
  };
  if (number % 3 == 1) put({-0.15, 0.05, 4e-4, -3e-4});
  if (number % 3 == 2) c.model = ODO_CAMERA_KANNALA_BRANDT, c.fx = c.fy = 430, put({-0.02, 0.008, -0.003, 0});
  return c;
}

cv::Mat picture_of(const Target& t, uint64_t layout, uint64_t content) {
  if (t.tag >= 0) return tag_board_picture(static_cast<uint32_t>(t.tag), 512);
  const int height = 900;
  return poster_picture(layout, content, {static_cast<int>(std::lround(height * t.width_m / t.height_m)), height});
}

Viewpoint viewpoint(Random& random, double distance_m, double oblique_rad, bool walking) {
  Viewpoint v;
  const double side = random.uniform() < 0.5 ? -1 : 1;
  v.p_n = kMiddle + distance_m * Vector3d(-std::cos(oblique_rad), side * std::sin(oblique_rad), 0);
  v.p_n.z() = -random.uniform(1.2, 1.7);
  const double spread = 0.12 * distance_m;
  const double z = random.uniform(-spread, spread), y = random.uniform(-spread, spread);
  const Vector3d target = kMiddle + Vector3d(0, y, z);
  const Vector3d forward = (target - v.p_n).normalized();
  const Vector3d right = Vector3d::UnitZ().cross(forward).normalized();
  v.R_n_c << right, forward.cross(right), forward;
  v.R_n_c = v.R_n_c * Eigen::AngleAxisd(0.08 * random.normal(), Vector3d::UnitZ()).toRotationMatrix();
  if (walking) {
    const double heading = random.uniform(-kPi, kPi);
    v.velocity_n = random.uniform(0.5, 1.3) * Vector3d(std::cos(heading), std::sin(heading), 0);
    for (double& w : v.rate_c) w = 0.2 * random.normal();
  } else {
    for (double& w : v.rate_c) w = 0.005 * random.normal();
  }
  return v;
}

std::vector<WallPicture> make_look_alike(size_t kind, const Target& target, const cv::Mat& original, uint64_t seed,
                                         Random& random, Viewpoint& v, uint64_t scene) {
  const auto as_target = [&](cv::Mat grey) {
    return WallPicture{std::move(grey), target.width_m, target.height_m, kMiddle};
  };
  switch (kind) {
    case 0: {  // another board of the same layout, or another tag
      Target other = target;
      if (target.tag >= 0) other.tag = 8 + static_cast<int>(random.next() % 400);
      return {as_target(picture_of(other, seed, 1000 + random.next() % 1000000))};
    }
    case 1: {  // a part of it replaced
      WallPicture h = as_target(original.clone());
      const cv::Mat other = poster_picture(seed, 1000 + random.next() % 1000000, original.size());
      const int cut = static_cast<int>(original.rows * random.uniform(0.4, 0.6));
      const cv::Range rows = random.uniform() < 0.5 ? cv::Range(0, cut) : cv::Range(original.rows - cut, original.rows);
      other.rowRange(rows).copyTo(h.grey.rowRange(rows));
      return {h};
    }
    case 2: {  // mirrored or upside down
      WallPicture h = as_target(cv::Mat());
      cv::flip(original, h.grey, random.uniform() < 0.5 ? 1 : -1);
      return {h};
    }
    case 3: {  // the original elsewhere, with the scene otherwise unchanged
      const double direction = random.uniform(0, 2 * kPi), far_m = random.uniform(12, 150);
      const Vector3d away = far_m * Vector3d(std::cos(direction), std::sin(direction), 0);
      v.p_n += away;
      WallPicture h = as_target(original);
      h.at_n += away;
      return {h};
    }
    case 4: {  // a smaller print of it beside its true position
      const double part = random.uniform(0.3, 0.6), aside = (random.uniform() < 0.5 ? -1 : 1) * random.uniform(7, 12);
      v.p_n += Vector3d(0, aside, 0);
      WallPicture h{original, part * target.width_m, part * target.height_m, kMiddle + Vector3d(0, aside, 0)};
      return {h};
    }
    case 5: {  // two copies side by side, one of them in the true position
      WallPicture h = as_target(original), second = h;
      second.at_n.y() += (random.uniform() < 0.5 ? -1 : 1) * 1.15 * target.width_m;
      return {h, second};
    }
    case kRightOneOutOfView: {  // two copies: the camera sees the displaced one, past the true one
      WallPicture h = as_target(original), second = h;
      const double side = random.uniform() < 0.5 ? -1 : 1;
      const Vector3d aside = side * random.uniform(1.05, 1.25) * target.width_m * Vector3d::UnitY();
      second.at_n += aside;
      v = before_copy(v, aside, PosterCamera(lens_of(scene)));
      return {h, second};
    }
    default: {  // other boards
      const uint64_t layout = 101 + random.next() % 8;
      return {as_target(poster_picture(layout, 1000 + random.next() % 1000000, {600, 900}))};
    }
  }
}

}  // namespace odograph::known_object_scene
