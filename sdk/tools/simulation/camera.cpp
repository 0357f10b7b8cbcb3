// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/simulation/camera.hpp"

#include <cmath>

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "sdk/math/rotation.hpp"
#include "sdk/tools/simulation/random.hpp"

namespace odograph {
namespace {

/// Fast normal random numbers: random lookup in a table of exact quantiles.
const std::vector<float>& normal_table() {
  static const std::vector<float> table = [] {
    std::vector<float> t(65536);
    Random random(1, 1);
    for (float& x : t) x = static_cast<float>(random.normal());
    return t;
  }();
  return table;
}

cv::Matx33d intrinsics(const Scenario::Camera& c) {
  return {c.focal_px, 0, 0.5 * (c.width - 1), 0, c.focal_px, 0.5 * (c.height - 1), 0, 0, 1};
}

}  // namespace

Eigen::Isometry3d SimCamera::pose(const Motion& phone, double t_s) const {
  Eigen::Isometry3d T = phone.pose(t_s);
  T.linear() = (T.linear() * in_body_.toRotationMatrix()).eval();
  return T;
}

SimCamera::SimCamera(const Scenario::Camera& camera, double light, uint64_t seed, const Motion* phone)
    : c_(camera),
      light_(light),
      seed_(seed),
      in_body_(rear_camera_mount() * Eigen::AngleAxisd(camera.tilt_rad, Eigen::Vector3d::UnitX())),
      vignette_(camera.height, camera.width, CV_32F) {
  if (phone) lens_ = SimLens(camera, in_body_, *phone, seed);
  if (lens_.moves()) margin_ = static_cast<int>(std::ceil(lens_.reach_px())) + 2;
  std::vector<cv::Point2d> pixels, rays;
  for (int y = -margin_; y < c_.height + margin_; ++y)
    for (int x = -margin_; x < c_.width + margin_; ++x) pixels.emplace_back(x, y);
  const cv::TermCriteria exact(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 100, 1e-12);
  if (c_.model == "kannala_brandt")
    cv::fisheye::undistortPoints(pixels, rays, intrinsics(c_), cv::Mat(c_.distortion, true));
  else
    cv::undistortPoints(pixels, rays, intrinsics(c_), c_.distortion, cv::noArray(), cv::noArray(), exact);
  rays_.reserve(rays.size());
  const double corner = std::hypot(cx(), cy());
  for (size_t i = 0; i < rays.size(); ++i) {
    rays_.push_back(Eigen::Vector3d(rays[i].x, rays[i].y, 1).normalized().cast<float>());
    if (!cv::Rect2d(0, 0, c_.width, c_.height).contains(pixels[i])) continue;
    const double r = std::hypot(pixels[i].x - cx(), pixels[i].y - cy()) / corner;
    vignette_.at<float>(static_cast<int>(pixels[i].y), static_cast<int>(pixels[i].x)) =
        static_cast<float>(1 - c_.vignetting * r * r);
  }
}

Eigen::Vector2d SimCamera::project(const Eigen::Vector3d& p) const {
  std::vector<cv::Point2d> out;
  const cv::Vec3d zero(0, 0, 0);
  if (c_.model == "kannala_brandt")
    cv::fisheye::projectPoints(std::vector<cv::Point3d>{{p.x(), p.y(), p.z()}}, out, zero, zero, intrinsics(c_),
                               cv::Mat(c_.distortion, true));
  else
    cv::projectPoints(std::vector<cv::Point3d>{{p.x(), p.y(), p.z()}}, zero, zero, intrinsics(c_), c_.distortion, out);
  return {out[0].x, out[0].y};
}

Eigen::Vector3f SimCamera::ray(int x, int y, const SimLens::State& lens) const {
  const double u = cx() + (x - lens.shift_px.x() - cx()) / lens.focal, left = std::floor(u);
  const double v = cy() + (y - lens.shift_px.y() - cy()) / lens.focal, top = std::floor(v);
  const auto a = static_cast<float>(u - left), b = static_cast<float>(v - top);
  const int i = static_cast<int>(left), k = static_cast<int>(top);
  return (1 - b) * ((1 - a) * ray(i, k) + a * ray(i + 1, k)) + b * ((1 - a) * ray(i, k + 1) + a * ray(i + 1, k + 1));
}

std::optional<Eigen::Vector2d> SimCamera::project_rolling(const Motion& phone, double t_s,
                                                          const Eigen::Vector3d& p_n) const {
  Eigen::Vector2d pixel(cx(), cy());
  for (int i = 0; i < 6; ++i) {
    const Eigen::Vector3d p_c = pose(phone, t_s + row_offset_s(pixel.y())).inverse() * p_n;
    if (p_c.z() < 0.05 || p_c.head<2>().norm() > 4 * p_c.z()) return {};
    const SimLens::State lens = lens_.at(t_s + row_offset_s(pixel.y()));
    pixel = project(p_c);
    if (lens_.moves()) {
      const Eigen::Vector2d middle(cx(), cy());
      pixel = middle + lens.focal * (pixel - middle) + lens.shift_px;
    }
    if (!(std::abs(pixel.x() - cx()) < c_.width && std::abs(pixel.y() - cy()) < c_.height)) return {};
  }
  const bool inside = pixel.x() >= 0 && pixel.y() >= 0 && pixel.x() <= c_.width - 1 && pixel.y() <= c_.height - 1;
  return inside ? std::optional(pixel) : std::nullopt;
}

cv::Mat SimCamera::develop(const cv::Mat& light, size_t frame, double open) const {
  // The exposure follows the light in steps up to its limit; gain makes up the rest, and adds noise.
  Random random(seed_, 1000 + frame);
  const double step = std::exp(c_.exposure_steps * Random(seed_, 70 + frame / 7).normal());
  const auto gain = static_cast<float>(std::min(12.0, 1 / (light_ * std::max(open, 1e-3))));
  const auto brightness = static_cast<float>(light_ * open * gain * step);
  const auto shot = static_cast<float>(c_.shot_noise * c_.shot_noise) * gain;
  const auto read = static_cast<float>(c_.read_noise * c_.read_noise) * gain * gain;
  const auto& normal = normal_table();
  cv::Mat picture(light.size(), CV_8U);
  for (int y = 0; y < light.rows; ++y) {
    const auto *in = light.ptr<float>(y), *fall = vignette_.ptr<float>(y);
    auto* out = picture.ptr<uint8_t>(y);
    for (int x = 0; x < light.cols; x += 4) {
      uint64_t bits = random.next();
      for (int k = x; k < std::min(x + 4, light.cols); ++k, bits >>= 16) {
        const float grey = in[k] * fall[k] * brightness;
        out[k] = cv::saturate_cast<uint8_t>(grey + std::sqrt(shot * grey + read) * normal[bits & 0xffff]);
      }
    }
  }
  return picture;
}

}  // namespace odograph
