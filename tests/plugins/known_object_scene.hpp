// SPDX-License-Identifier: Apache-2.0
//
// A poster, lenses and a camera in front of it, for the tests of fix/known_object.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "plugins/fix/known_object/sighting_validator.hpp"
#include "sdk/host/messages/messages.hpp"
#include "sdk/tools/simulation/poster.hpp"
#include "sdk/tools/simulation/random.hpp"

namespace odograph::known_object_tests {

using namespace known_object;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kDegree = EIGEN_PI / 180;

/// For a reader looking north: right is east, down is down, into the wall is north.
inline Matrix3d wall_axes() {
  Matrix3d R;
  R << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  return R;
}

inline PlaneObject poster(uint64_t content = 1) {
  PlaneObject o;
  o.id = "poster";
  o.width_m = 1.2, o.height_m = 1.8;
  o.picture = poster_picture(1, content, {600, 900});
  o.place.R_n_o = wall_axes();
  o.place.p_n = {0, 0, -1.7};
  return o;
}

inline odo_calibration calibration(int kind) {
  auto c = make_message<odo_calibration>(ODO_TYPE_CALIBRATION, 0);
  c.width = 640, c.height = 480, c.fx = c.fy = 500, c.cx = 319.5, c.cy = 239.5;
  c.model = ODO_CAMERA_PINHOLE;
  const double radtan[] = {-0.15, 0.05, 4e-4, -3e-4}, fisheye[] = {-0.02, 0.008, -0.003, 0};
  if (kind > 0) c.distortion_count = 4;
  if (kind == 1) std::copy(radtan, radtan + 4, c.distortion);
  if (kind == 2) c.model = ODO_CAMERA_KANNALA_BRANDT, c.fx = c.fy = 430, std::copy(fisheye, fisheye + 4, c.distortion);
  return c;
}

inline RollingLens lens_of(const odo_calibration& c) {
  RollingLens lens;
  lens.camera.distortion = c.model == ODO_CAMERA_KANNALA_BRANDT ? CameraModel::Distortion::kannala_brandt
                                                                : CameraModel::Distortion::radial_tangential;
  lens.camera.fx = c.fx, lens.camera.fy = c.fy, lens.camera.cx = c.cx, lens.camera.cy = c.cy;
  lens.camera.coefficients.assign(c.distortion, c.distortion + c.distortion_count);
  lens.width = 640, lens.height = 480;
  return lens;
}

/// The camera `distance` away and `oblique` to the right of the normal, looking at the object.
struct Scene {
  Vector3d p_n;
  Matrix3d R_n_c;
  Scene(const PlaneObject& o, double distance_m, double oblique_rad, double aside_m = 0.1) {
    p_n = o.place.p_n + distance_m * Vector3d(-std::cos(oblique_rad), std::sin(oblique_rad), 0) + Vector3d(0, 0, 0.2);
    const Vector3d forward = (o.place.p_n + Vector3d(0, aside_m, 0.1) - p_n).normalized();
    const Vector3d right = Vector3d::UnitZ().cross(forward).normalized();
    R_n_c << right, forward.cross(right), forward;
  }
  Pose pose(const PlaneObject& o) const {
    return {R_n_c.transpose() * o.place.R_n_o, R_n_c.transpose() * (o.place.p_n - p_n)};
  }
  Vector3d place_by(const Pose& pose, const PlaneObject& o) const {
    return o.place.p_n - o.place.R_n_o * pose.R_c_o.transpose() * pose.t_c_o;
  }
  Prior prior() const {
    Prior p;
    p.q_n_c = Eigen::Quaterniond(R_n_c), p.p_n = p_n, p.placed = true;
    p.tilt_sigma_rad = kDegree, p.yaw_sigma_rad = 3 * kDegree, p.horizontal_sigma_m = 1, p.vertical_sigma_m = 0.3;
    return p;
  }
};

inline FlatPicture flat(const PlaneObject& o, const cv::Mat& grey, const Pose& pose) {
  FlatPicture f{grey, o.width_m, o.height_m, Eigen::Isometry3d::Identity()};
  f.T_c_o.linear() = pose.R_c_o, f.T_c_o.translation() = pose.t_c_o;
  return f;
}

inline cv::Mat wall() {
  Random random(3, 1);
  cv::Mat grey(512, 512, CV_8U);
  for (uint8_t& p : cv::Mat_<uint8_t>(grey)) p = static_cast<uint8_t>(random.uniform(60, 180));
  cv::GaussianBlur(grey, grey, {0, 0}, 3);
  return grey;
}

inline cv::Mat frame_of(const std::vector<FlatPicture>& pictures, const odo_calibration& c,
                        PosterCamera::Shot shot = {}) {
  std::vector<FlatPicture> all = pictures;
  FlatPicture back = pictures.front();
  back.grey = wall(), back.width_m = 40, back.height_m = 40;
  back.T_c_o.translation() += 0.05 * back.T_c_o.linear().col(2);
  all.insert(all.begin(), back);
  return PosterCamera(c).take(all, shot);
}

/// An ideal sighting of the poster, with the plane's second pose.
inline Sighting sighting_of(const Scene& scene, const PlaneObject& o, int64_t t_ns, double cost_of_other) {
  Sighting s;
  s.t_ns = t_ns;
  s.clear.fill(true);
  Alignment a;
  a.pose = scene.pose(o);
  a.information.setIdentity();
  a.information *= 1e5;
  a.correlation = 0.95, a.agreeing_part = 1;
  s.poses.push_back(a);
  if (cost_of_other >= 0) {  // mirrored about the line of sight
    const Vector3d sight = a.pose.t_c_o.normalized();
    const double rotation =
        2 * std::atan2(a.pose.R_c_o.col(2).cross(sight).dot(a.pose.R_c_o.col(1)), a.pose.R_c_o.col(2).dot(sight));
    a.pose.R_c_o = Eigen::AngleAxisd(rotation, a.pose.R_c_o.col(1)) * a.pose.R_c_o;
    a.cost = cost_of_other;
    s.poses.push_back(a);
  }
  return s;
}

inline std::optional<Estimate> after_frames(SightingValidator& validator, const Scene& scene, const PlaneObject& o,
                                            const Prior& prior, int frames, double cost_of_other = -1, int first = 0) {
  std::optional<Estimate> last;
  for (int k = first; k < first + frames; ++k)
    if (auto e = validator.validate(sighting_of(scene, o, k * 100'000'000LL, cost_of_other), o, lens_of(calibration(0)),
                                    prior))
      last = e;
  return last;
}

}  // namespace odograph::known_object_tests
