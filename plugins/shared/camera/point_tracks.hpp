// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include <Eigen/Geometry>

namespace odograph {

/// A corner of the newest frame.
struct TrackedCorner {
  uint64_t id = 0;                                     ///< of its track
  Eigen::Vector3d ray_c = Eigen::Vector3d::UnitZ();    ///< in the camera at the frame's time, z = 1
  Eigen::Vector3d origin_c = Eigen::Vector3d::Zero();  ///< of the ray: not zero where rows have poses of their own
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  bool used = true;  ///< took part in the motion
};

/// A landmark in the camera of the newest frame.
struct TrackedPoint {
  uint64_t id = 0;
  Eigen::Vector3d p_c = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  ///< not set if lost
  unsigned age = 0;                                 ///< frames
  bool used = false, lost = false, uncertain = false;
};

/// Points triangulated from the corners of any front-end and the motions that it reports, therefore in the unit of its
/// scale group: for each track the point nearest to all its rays, by least squares with the noise of a corner at the
/// point's distance. The covariance is that of the corners given the motions, whose errors it does not contain.
class PointTracks {
 public:
  struct Parameters {
    size_t rays = 12;                ///< kept of each track, the first and the newest; as the window of vo/odograph
    double min_angle_rad = 0.002;    ///< between two rays of a track: a nearer one replaces the newest; 1.4 px of 700
    double min_parallax_rad = 0.01;  ///< largest angle between two rays, below which there is no point; as vo/odograph
    double uncertain =
        0.25;             ///< relative sigma of the distance above which it is not known: a twofold range at 2.7 sigma
    double max_chi2 = 4;  ///< per degree of freedom; above it the track moves or slides; judgement
    int iterations = 3;   ///< of the weights by distance
  };

  PointTracks() = default;
  explicit PointTracks(const Parameters& parameters) : p_(parameters) {}

  /// Forgets all tracks: a new scale group, or a motion that is not known.
  void clear() { tracks_.clear(), points_.clear(), T_w_c_.setIdentity(); }
  /// The motion from the previous frame.
  void move(const Eigen::Quaterniond& q_c0_c1, const Eigen::Vector3d& p_c0_c1);
  /// The corners of the frame that was moved to, with their noise. Returns its points, the lost ones last; valid until
  /// the next call.
  const std::vector<TrackedPoint>& see(const std::vector<TrackedCorner>& corners, double sigma_rad);

 private:
  struct Ray {
    Eigen::Vector3d origin_w, direction_w;
  };
  struct Track {
    std::vector<Ray> rays;
    Eigen::Vector3d X_w = Eigen::Vector3d::Zero();
    Eigen::Matrix3d covariance_w = Eigen::Matrix3d::Zero();
    unsigned age = 0;
    uint64_t seen_in = 0;  ///< number of the frame
    bool located = false, uncertain = false;
  };

  void add(Track& track, const Ray& ray) const;
  void locate(Track& track, double sigma_rad) const;
  TrackedPoint in_camera(uint64_t id, const Track& track) const;

  Parameters p_;
  Eigen::Isometry3d T_w_c_ = Eigen::Isometry3d::Identity();
  std::map<uint64_t, Track> tracks_;  // ordered: the same points in the same order each time
  std::vector<TrackedPoint> points_;
  uint64_t frame_ = 0;
};

}  // namespace odograph
