// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <unordered_map>
#include <vector>

#include <Eigen/Geometry>

#include "plugins/shared/camera/camera_model.hpp"
#include "plugins/shared/camera/corner_tracker.hpp"
#include "plugins/shared/camera/picture_content.hpp"
#include "plugins/shared/camera/point_tracks.hpp"
#include "plugins/shared/camera/tracking.hpp"
#include "plugins/shared/camera/two_view.hpp"

namespace odograph::five_point {

/// Motion from the previous frame to this one.
struct Motion {
  Eigen::Quaterniond q_c0_c1 = Eigen::Quaterniond::Identity();
  Eigen::Vector3d p_c0_c1 = Eigen::Vector3d::Zero();  ///< up to scale
  bool rotation_valid = false, translation_valid = false;
  double rotation_sigma_rad = 0.0, position_sigma = 0.0;
  Tracking state = Tracking::lost;
  FailureReason failure = FailureReason::initialising;
  unsigned scale_group = 0;
  unsigned tracked = 0, inliers = 0;
};

/// Basic monocular visual odometry: KLT corners; initialisation from the five-point essential matrix as soon as there
/// is parallax; then the pose of each frame by PnP on the triangulated points, and new points triangulated from the
/// poses. The scale is constant while the tracks last (a scale group). There is no joint optimisation.
class VisualOdometry {
 public:
  struct Parameters {
    CornerTracker::Parameters corners;
    double inlier_px = 1.5;              ///< max reprojection error; empirical
    double start_parallax_rad = 0.008;   ///< median, to initialise from two views: half a degree; empirical
    double point_parallax_rad = 0.012;   ///< to triangulate a point: depth to 1 part in 8 at 1.5 px of 1000; empirical
    int min_inliers = 15;                ///< of a pose: three times the five of a sample; empirical
    PictureContent::Parameters content;  ///< with less content nothing is tracked
    size_t sightings = 10;               ///< observations kept per point; empirical
    /// Largest mean difference between a frame's rotation by the map and by the two latest pictures: 1 px of 400;
    /// empirical.
    double contradiction_rad = 0.0025;
    int check_every = 2;             ///< frames
    double max_deviation_rad = 0.5;  ///< largest change of a frame's rotation from the previous one: 860 deg/s at 30 Hz
  };

  VisualOdometry(const Parameters& parameters, const CameraModel& camera)
      : p_(parameters), camera_(camera), tracker_(parameters.corners) {}

  /// Sets the lens of the frames to come (refocused or shifted). The map holds no pixels and stays valid.
  void change_lens(const CameraModel& camera) { camera_ = camera; }
  /// The corners of the latest frame.
  std::vector<TrackedCorner> corners() const;
  /// Their noise: half the largest error of an inlier.
  double corner_sigma_rad() const { return 0.5 * threshold(); }
  /// Processes the next frame, 8-bit grey. The result of the first frame is undefined.
  Motion process(const cv::Mat& grey, const cv::Mat& mask);

 private:
  struct Point {
    std::vector<Sighting> sightings;
    Eigen::Vector3d X_w;
    bool triangulated = false;
    int misses = 0;
  };

  void begin(bool new_group);
  bool try_start(Motion& motion);
  bool estimate_pose(Motion& motion);
  bool plausible(const Eigen::Isometry3d& T_c_w, const Eigen::Isometry3d& T_predicted,
                 const std::vector<cv::Point3d>& inliers, size_t asked) const;
  bool agrees_with_two_views(const Eigen::Isometry3d& T_w_c0);
  void extend_map();
  double threshold() const { return p_.inlier_px / camera_.focal(); }

  Parameters p_;
  CameraModel camera_;
  CornerTracker tracker_;
  std::vector<cv::Point2d> normalized_;
  std::unordered_map<uint64_t, Point> points_;
  std::unordered_map<uint64_t, cv::Point2d> reference_;
  std::unordered_map<uint64_t, cv::Point2d> previous_;
  Eigen::Vector3d contradiction_ = Eigen::Vector3d::Zero();
  int since_start_ = 0;
  Eigen::Isometry3d T_w_c_ = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d last_step_ = Eigen::Isometry3d::Identity();
  bool have_reference_ = false;
  bool started_ = false;
  unsigned group_ = 0;
};

}  // namespace odograph::five_point
