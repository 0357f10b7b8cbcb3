// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Geometry>
#include <opencv2/features2d.hpp>

#include "plugins/shared/camera/camera_model.hpp"

namespace odograph::gakne2018 {

/// Motion from the picture before to this one. The unit of length is the height, over the camera, of what was matched.
struct Motion {
  Eigen::Quaterniond q_c0_c1 = Eigen::Quaterniond::Identity();
  Eigen::Vector3d p_c0_c1 = Eigen::Vector3d::Zero();
  double rotation_sigma_rad = 0, position_sigma = 0;
  bool valid = false;
  unsigned matches = 0, inliers = 0;
};

/// Visual odometry of a camera that looks up: section 3.1 of Gakne & O'Keefe 2018.
///
/// ORB features are matched between consecutive pictures, rotated to the horizontal and laid onto the plane one unit
/// above the camera; RANSAC and then weighted least squares by singular value decomposition (eq. (1)) find the rigid
/// motion of the plane's points. Its rotation is the vehicle's, its translation the displacement, in units of the
/// roofs' height: as in the paper, points at different heights disagree about the length.
class SkyOdometry {
 public:
  struct Parameters {
    int features = 1000;
    double inlier_rad = 0.006;  ///< of the plane's points: about the tangent of an angle
    unsigned min_inliers = 12;
    // What follows was chosen by hand, and not tuned.
    double lowest = 0.2;                 ///< sine of the least elevation that is used
    int trials = 500;                    ///< of the RANSAC
    double apart = 0.3;                  ///< on the plane, of a pair that says how much the camera turned
    double near = 0.25;                  ///< on the plane: a match farther than this is one of the many windows alike
    float max_distance = 64;             ///< of ORB's 256 bits, of a match
    double huber_part = 0.3;             ///< of inlier_rad, from where on errors count linearly
    double known_rotation_rad = 0;       ///< of the gravity-aligned frame between two pictures: the gyroscope's
    double unknown_rotation_rad = 0.15;  ///< the same without an attitude: what a car turns by
  };

  SkyOdometry(const Parameters& parameters, const CameraModel& camera);
  /// Of the frames to come: focused or shifted.
  void change_lens(const CameraModel& camera) { camera_ = camera; }
  /// `q_l_c`: from c to a gravity-aligned frame l, whose z points down. `max_rotation`: how much l itself may have
  /// turned since the picture before, rad. Walls at both sides of a street shear the plane's points, and eq. (1) takes
  /// that for a rotation.
  Motion process(const cv::Mat& grey, const cv::Mat& mask, const Eigen::Quaterniond& q_l_c, double max_rotation);

 private:
  struct Picture {
    std::vector<cv::KeyPoint> keypoints;
    cv::Mat descriptors;
    std::vector<Eigen::Vector2d> on_plane;  // on the plane; far away where it does not meet it
    Eigen::Quaterniond q_l_c = Eigen::Quaterniond::Identity();
  };

  Parameters p_;
  CameraModel camera_;
  cv::Ptr<cv::ORB> orb_;
  cv::BFMatcher matcher_;
  Picture before_;
};

/// R and T of eq. (1): the least weighted sum of ||R p_i + T - q_i||^2.
struct Rigid2d {
  Eigen::Matrix2d R = Eigen::Matrix2d::Identity();
  Eigen::Vector2d T = Eigen::Vector2d::Zero();
};
Rigid2d rigid_motion(const std::vector<Eigen::Vector2d>& p, const std::vector<Eigen::Vector2d>& q,
                     const std::vector<double>& weights);

}  // namespace odograph::gakne2018
