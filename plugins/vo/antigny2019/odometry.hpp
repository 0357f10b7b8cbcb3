// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "plugins/shared/camera/camera_model.hpp"
#include "plugins/shared/camera/point_tracks.hpp"
#include "plugins/vo/antigny2019/features.hpp"

namespace odograph::antigny2019 {

enum class Outcome { tracking, no_parallax, lost };

/// Motion from the previous picture to this one.
struct Motion {
  Eigen::Isometry3d T_c0_c1 = Eigen::Isometry3d::Identity();
  double rotation_sigma_rad = 0, position_sigma = 0;
  Outcome outcome = Outcome::lost;
  bool rotation_valid = false, translation_valid = false;
  unsigned scale_group = 0, matches = 0, inliers = 0;
};

/// The visual odometry of Antigny et al. 2019, section 3.2 and Figure 3: features, sparse selection, SSD matching with
/// unique correspondences, epipolar outlier rejection by MSAC, triangulation of the inliers of t-2 and t-1 that are
/// matched again in t, the pose at t by PnP (eq. (2), (3)). There is no map: each triple of pictures passes the scale
/// on to the next.
///
/// The paper leaves two things open. Here the odometry starts with the essential matrix of the first two pictures that
/// have parallax; their distance is the unit of length. A picture with too little parallax does not become t-1.
class Odometry {
 public:
  struct Parameters {
    std::string features = "surf";  ///< as the paper, section 3.2
    int most = 1500;                ///< max features per picture; empirical
    int cell_px = 32,
        in_a_cell = 6;   ///< strongest features kept per cell; the paper has a sparse selection but gives no numbers
    double ratio = 0.6;  ///< of the squared differences; Lowe 2004 has 0.8 of the differences, 0.64 of these
    double inlier_px = 1.5;     ///< distance to the epipolar line; twice that for PnP; as vo/five_point
    double parallax_px = 4.0;   ///< min median parallax of two pictures to triangulate from; empirical
    double max_drift = 1e4;     ///< of the scale within a group, in either direction; then another group begins
    unsigned min_inliers = 12;  ///< of a pose; empirical
    double dark_grey = 8;       ///< mean grey level below which a picture is too dark; as the other front-ends
  };

  Odometry(const Parameters& parameters, const CameraModel& camera, cv::Size size);
  /// Sets the lens of the frames to come (refocused or shifted). Stored pixels are those of an ideal camera.
  void change_lens(const CameraModel& camera) { camera_ = camera; }
  Motion process(const cv::Mat& grey, const cv::Mat& mask);
  /// The features of the latest picture; those that agree with t-1 keep the track's number.
  const std::vector<TrackedCorner>& corners() const { return corners_; }
  /// Their noise: half the largest error of an inlier.
  double corner_sigma_rad() const { return 0.5 * p_.inlier_px / f_; }
  /// Starts again from the last picture: those before it are forgotten, and the next motion has a new scale group.
  void restart();

 private:
  struct Picture {
    Features features;
    std::vector<cv::Point2d> ideal;  // pixels of an ideal camera with the focal length f_
    std::vector<uint64_t> tracks;    // numbers, one for each feature
  };
  struct EpipolarPair {
    Eigen::Isometry3d T_0_1;  // pose of the second camera in the first, unit distance
    std::vector<std::pair<int, int>> inliers;
    double parallax_px;  // median, rotation compensated
  };

  void follow(const std::vector<std::pair<int, int>>& inliers, Picture& now);
  Picture look(const cv::Mat& grey, const cv::Mat& mask);
  std::optional<EpipolarPair> epipolar(const Picture& a, const Picture& b,
                                       const std::vector<std::pair<int, int>>& pairs) const;
  bool estimate_pose(const Picture& now, const std::vector<std::pair<int, int>>& pairs, Eigen::Isometry3d& T_b_c,
                     Motion& motion) const;

  Parameters p_;
  CameraModel camera_;
  cv::Size size_;
  double f_;
  std::unique_ptr<FeatureFinder> finder_;
  std::optional<Picture> a_, b_, last_;  // t-2, t-1, and the last one where it has not become t-1
  std::vector<std::pair<int, int>> ab_;  // inliers of both
  Eigen::Isometry3d T_a_b_ = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d T_b_before_ = Eigen::Isometry3d::Identity();  // pose of the previous picture in b
  double scale_ = 1.0;
  unsigned group_ = 0;
  uint64_t next_track_ = 0;
  std::vector<TrackedCorner> corners_;
};

}  // namespace odograph::antigny2019
