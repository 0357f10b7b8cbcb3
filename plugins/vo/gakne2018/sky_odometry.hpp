// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Geometry>
#include <opencv2/features2d.hpp>

#include "plugins/shared/camera/camera_model.hpp"

namespace odograph::gakne2018 {

/// Motion from the previous picture to this one. The unit of length is the height of the matched points over the
/// camera.
struct Motion {
  Eigen::Quaterniond q_c0_c1 = Eigen::Quaterniond::Identity();
  Eigen::Vector3d p_c0_c1 = Eigen::Vector3d::Zero();
  double rotation_sigma_rad = 0, position_sigma = 0;
  bool valid = false;
  unsigned matches = 0, inliers = 0;
};

/// R and T that minimise the weighted sum of ||R p_i + T - q_i||^2, eq. (1).
struct Rigid2d {
  Eigen::Matrix2d R = Eigen::Matrix2d::Identity();
  Eigen::Vector2d T = Eigen::Vector2d::Zero();
};
Rigid2d rigid_motion(const std::vector<Eigen::Vector2d>& p, const std::vector<Eigen::Vector2d>& q,
                     const std::vector<double>& weights);

/// A matched point of the latest picture. Its unit of length is the motion's.
struct SkyPoint {
  uint64_t id;   ///< the same as long as it is matched from picture to picture
  uint32_t age;  ///< pictures in which it was seen
  cv::Point2f pixel;
  Eigen::Vector3d p_c;
  double relative_sigma, ray_sigma_rad;  ///< of its distance; across its ray
};

/// Visual odometry of a camera that looks up (Gakne & O'Keefe 2018, section 3.1).
///
/// ORB features are matched between consecutive pictures, rotated to the horizontal and projected onto the plane one
/// unit above the camera. RANSAC, then weighted least squares by singular value decomposition (eq. (1)), give the rigid
/// motion of the points in the plane: the rotation of the vehicle, and its displacement in units of the height of the
/// roofs. As in the paper, points at different heights imply different lengths.
class SkyOdometry {
 public:
  struct Parameters {
    int features = 1000;
    double inlier_rad = 0.006;  ///< max error of an inlier on the plane: about the tangent of an angle
    unsigned min_inliers = 12;
    // Empirical, not tuned:
    double lowest = 0.2;      ///< sine of the smallest elevation used
    int trials = 500;         ///< of RANSAC
    double apart = 0.3;       ///< on the plane: min distance of the two points of a pair that gives the rotation
    double near = 0.25;       ///< on the plane: a match farther away is taken for another, similar window
    float max_distance = 64;  ///< max Hamming distance of a match, of ORB's 256 bits
    double huber_part = 0.3;  ///< part of inlier_rad beyond which the loss is linear
    /// Max rotation of the gravity-aligned frame between two pictures, by the gyroscope.
    double known_rotation_rad = 0;
    double unknown_rotation_rad = 0.15;  ///< the same by eq. (1) alone: a turning car
    // Heights of the inliers, in units of the motion:
    double height_sigma = 0.3;   ///< prior of the inverse height, whose mean is 1 by the definition of the unit
    double match_sigma = 0.002;  ///< of a match on the plane near the zenith: a pixel
  };

  SkyOdometry(const Parameters& parameters, const CameraModel& camera);
  /// Sets the lens of the frames to come (refocused or shifted).
  void change_lens(const CameraModel& camera) { camera_ = camera; }
  /// `q_l_c`: from c to a gravity-aligned frame l, whose z points down. `max_rotation`: largest rotation of l since the
  /// previous picture, rad; the walls on both sides of a street shear the points in the plane, which eq. (1) would
  /// otherwise treat as a rotation.
  Motion process(const cv::Mat& grey, const cv::Mat& mask, const Eigen::Quaterniond& q_l_c, double max_rotation);
  /// Inliers of the latest motion, the most certain first. In the plane a point at the height h, in units, moves by
  /// T / h where eq. (1) gives T: its displacement along T is a measurement of 1 / h. Where the motion is small
  /// against the errors of the matches the height stays near its prior, one unit.
  const std::vector<SkyPoint>& points() const { return points_; }

 private:
  struct Picture {
    std::vector<cv::KeyPoint> keypoints;
    cv::Mat descriptors;
    std::vector<Eigen::Vector2d> on_plane;  // projected; far away if the ray does not meet the plane
    Eigen::Quaterniond q_l_c = Eigen::Quaterniond::Identity();
    struct Track {
      uint64_t id;
      uint32_t age;
    };
    std::vector<Track> tracks;  // of the keypoints
  };
  struct Pair {
    size_t before, now;  // keypoints
  };
  Picture detect(const cv::Mat& grey, const cv::Mat& mask, const Eigen::Quaterniond& q_l_c);
  std::vector<Pair> matches(const Picture& now);
  void locate(const std::vector<Pair>& pairs, const std::vector<double>& inlier, const Rigid2d& rigid, Picture& now);

  Parameters p_;
  CameraModel camera_;
  cv::Ptr<cv::ORB> orb_;
  cv::BFMatcher matcher_;
  Picture before_;
  std::vector<SkyPoint> points_;
  uint64_t next_id_ = 0;
};

/// From c to a gravity-aligned frame l without the attitude's heading: `up_c` becomes l's -z, by the shortest rotation
/// of a camera that looks straight up.
Eigen::Quaterniond levelled(const Eigen::Vector3d& up_c);

/// Height over the camera and its sigma, in units of a motion, of a point that moved in the plane by `flow` = q - R p
/// where eq. (1) gives T. Prior: the inverse height is 1 with `height_sigma`.
struct Height {
  double value, relative_sigma;
};
Height height_of(const Eigen::Vector2d& flow, const Eigen::Vector2d& T, double flow_sigma, double height_sigma);

}  // namespace odograph::gakne2018
