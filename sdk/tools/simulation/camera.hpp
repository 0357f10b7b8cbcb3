// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "sdk/tools/simulation/lens.hpp"
#include "sdk/tools/simulation/motion.hpp"
#include "sdk/tools/simulation/tint.hpp"
#include "sdk/tools/simulation/world.hpp"

namespace odograph {

/// A phone's rear camera: lens, rolling shutter, exposure, noise.
class SimCamera {
 public:
  /// `phone`, if given, drives the optical stabiliser and sets the duration of focus changes.
  SimCamera(const Scenario::Camera& camera, double light, uint64_t seed, const Motion* phone = nullptr);

  /// From the camera to the body b: without tilt, the camera's x, y, z are the body's x, -y, -z.
  const Eigen::Quaterniond& in_body() const { return in_body_; }
  Eigen::Isometry3d pose(const Motion& phone, double t_s) const;

  int width() const { return c_.width; }
  int height() const { return c_.height; }
  double cx() const { return 0.5 * (c_.width - 1); }
  double cy() const { return 0.5 * (c_.height - 1); }
  /// Exposure time of row y (its middle), relative to the middle row.
  double row_offset_s(double y) const { return (y - cy()) * c_.row_time_s; }
  /// Unit ray of a pixel's centre, in c, with the lens at rest.
  const Eigen::Vector3f& ray(int x, int y) const {
    return rays_[static_cast<size_t>((y + margin_) * (c_.width + 2 * margin_) + x + margin_)];
  }
  /// The same with a shifted lens.
  Eigen::Vector3f ray(int x, int y, const SimLens::State& lens) const;
  /// Pixel of a point in c, including distortion, with the lens at rest.
  Eigen::Vector2d project(const Eigen::Vector3d& p_c) const;
  const SimLens& lens() const { return lens_; }

  /// Pixel of a point in n in the frame at t, with the camera's pose at the exposure of its row; nothing outside the
  /// picture.
  std::optional<Eigen::Vector2d> project_rolling(const Motion& phone, double t_s, const Eigen::Vector3d& p_n) const;

  /// Converts incident light (grey, 0 to 255 for a well-lit scene) to stored pixels; `open` is the fraction of light
  /// that reaches the lens.
  cv::Mat develop(const cv::Mat& light, size_t frame, double open = 1.0) const;

 private:
  Scenario::Camera c_;
  double light_;
  uint64_t seed_;
  Eigen::Quaterniond in_body_;
  std::vector<Eigen::Vector3f> rays_;
  cv::Mat vignette_;
  SimLens lens_;
  int margin_ = 0;  // extent of the rays beyond the picture's edges, for a moving lens
};

/// A renderer for one thread, with a rolling shutter on the moving phone.
class View {
 public:
  View(const World& world, const SimCamera& camera, const Scenario& scenario);
  ~View();
  View(const View&) = delete;
  View& operator=(const View&) = delete;

  /// 32-bit float grey of the frame whose middle row is exposed at t.
  cv::Mat render(const Motion& phone, double t_s, double exposure_s);
  /// With the scenario's exposure.
  cv::Mat render(const Motion& phone, double t_s) { return render(phone, t_s, c_.camera.exposure_s); }
  /// The tint of each pixel of the last frame, as coloured() takes it; empty without `camera.colour`. Motion blur does
  /// not apply to it.
  const cv::Mat& tint() const { return tint_; }
  /// Mask of the last frame: 255 where the pixel's ray meets nothing.
  cv::Mat sky_mask() const;
  /// Fraction of the last frame's pixels that show moving objects.
  double moving_part() const { return moving_part_; }
  /// Unoccluded fraction of a known object, 0 to 1, in steps of a 25th.
  double visible_part(const KnownObject& object, const Eigen::Vector3d& eye_n, double t_s);

 private:
  void place_movers(double t_s);
  bool same_face(size_t a, size_t b) const;
  void look_along_row();
  void shade_row(float* row, float* depth, uint16_t* instance, Tint* tint);
  void cast_shadows(float* row);
  void cast_reflections(float* row, const float* depth, Tint* tint);
  float sky(const Eigen::Vector3f& ray) const;
  float surface_grey(const RTCRayHit& hit, float distance_before, bool* glass, Eigen::Vector3f* normal) const;
  Tint tint_of(const RTCRayHit& hit, float grey) const;
  cv::Mat blurred(const cv::Mat& grey, const Motion& phone, double t_s, double exposure_s) const;

  const World& world_;
  const SimCamera& camera_;
  const Scenario& c_;
  RTCScene scene_;
  std::vector<RTCGeometry> movers_;
  std::vector<size_t> mesh_of_instance_;
  std::vector<Eigen::Isometry3f> place_of_instance_;
  cv::Mat instance_of_pixel_, tint_, depth_;  // of the current frame
  double moving_part_ = 0;
  // Buffers of the current row: hits, sunlight, shadow rays, and reflected rays.
  std::vector<RTCRayHit> hits_, mirrors_;
  std::vector<float> sunlight_;
  std::vector<RTCRay> shadows_;
  std::vector<size_t> glass_pixels_;
  std::vector<RTCRayHit*> undecided_;
  std::vector<RTCRay*> towards_sun_;
};

}  // namespace odograph
