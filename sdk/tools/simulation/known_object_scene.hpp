// SPDX-License-Identifier: Apache-2.0
//
// Scenes of `odograph bench known-object`: pictures on a wall, original and look-alike, and a camera.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <odograph/types.h>
#include <opencv2/core.hpp>

#include "sdk/math/scalar.hpp"
#include "sdk/tools/simulation/random.hpp"

namespace odograph::known_object_scene {

using Eigen::Matrix3d;
using Eigen::Vector3d;

struct Target {
  std::string id;
  double width_m, height_m;
  int tag;
};
inline const Target kTargets[] = {{"board", 3.2, 2.4, -1}, {"poster", 1.2, 1.8, -1}, {"tag", 0.8, 0.8, 7}};

/// Centre of every target: the same point of a wall that faces south.
inline const Vector3d kMiddle(0, 0, -1.7);
inline Matrix3d wall_axes() {
  Matrix3d R_n_o;
  R_n_o << 0, 0, 1, 1, 0, 0, 0, 1, 0;  // right is east, down is down, into the wall is north
  return R_n_o;
}

/// One of three lenses, by scene number.
odo_calibration lens_of(uint64_t number);

/// The picture of a target; for a tag, including its black border.
cv::Mat picture_of(const Target& target, uint64_t layout, uint64_t content);

/// Background texture of a wall.
cv::Mat wall_picture(uint64_t seed);

/// Pose and motion of the camera.
struct Viewpoint {
  Vector3d p_n, velocity_n = Vector3d::Zero(), rate_c = Vector3d::Zero();
  Matrix3d R_n_c;
  Viewpoint after(double s) const {
    Viewpoint v = *this;
    v.p_n += s * velocity_n;
    const double angle = s * rate_c.norm();
    if (angle > 1e-12) v.R_n_c = R_n_c * Eigen::AngleAxisd(angle, rate_c.normalized()).toRotationMatrix();
    return v;
  }
  Eigen::Isometry3d to(const Vector3d& o_n) const {
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.linear() = R_n_c.transpose() * wall_axes();
    T.translation() = R_n_c.transpose() * (o_n - p_n);
    return T;
  }
};

Viewpoint viewpoint(Random& random, double distance_m, double oblique_rad, bool walking);

/// A picture in a scene, in n, facing south.
struct WallPicture {
  cv::Mat grey;
  double width_m, height_m;
  Vector3d at_n;
};

/// Kinds of look-alikes. The first three and other boards are not the known object at all.
constexpr const char* kLookAlikes[] = {"the same layout, another content",
                                       "a half of it exchanged",
                                       "mirrored, upside down",
                                       "the same, 12 to 150 m away",
                                       "a smaller print, 7 to 12 m aside",
                                       "two side by side",
                                       "other boards",
                                       "two, the right one out of view"};
constexpr size_t kOtherBoards = 6, kRightOneOutOfView = 7;

/// The pictures shown instead of a target; may move the viewpoint.
std::vector<WallPicture> make_look_alike(size_t kind, const Target& target, const cv::Mat& original, uint64_t seed,
                                         Random& random, Viewpoint& v, uint64_t scene);

}  // namespace odograph::known_object_scene
