// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <numbers>
#include <optional>
#include <vector>

#include "plugins/fix/known_object/sighting_validator.hpp"
#include "sdk/math/rotation.hpp"

namespace odograph::known_object {

/// A pose of the pipeline, as far as a fix needs it.
struct PipelinePose {
  int64_t t_ns = 0;
  Eigen::Quaterniond q_n = Eigen::Quaterniond::Identity();
  Eigen::Vector3d p_n = Eigen::Vector3d::Zero();
  bool is_of_camera = false;                  ///< of the camera; otherwise of the body
  bool is_metric_position = false;            ///< `p_n` is in metres
  std::optional<Eigen::Vector3d> velocity_n;  ///< m/s
  double tilt_sigma_rad = 0, yaw_sigma_rad = 0, horizontal_sigma_m = 0, vertical_sigma_m = 0;
  double path_m = 0;  ///< length of the path so far
};

/// Fixes by known objects (Antigny et al. 2019, section 3.5): finds objects in frames, retains each sighting until a
/// pose at its time arrives, and aligns n with the map of objects that have no known origin. Not thread-safe.
class ObjectFixer {
 public:
  /// Empirical, not tuned, if not stated otherwise.
  struct Parameters {
    bool always_placed = false;  ///< the pose is in the objects' frame from the start; set by the config
    /// n's origin: latitude and longitude in rad, ellipsoidal height in m; set by the config.
    std::optional<std::array<double, 3>> origin;
    double range_m = 30;                  ///< max distance of an object that is searched for; set by the config
    double drift = 0.05;                  ///< of the path since the last fix: error beyond the pose's sigma; config
    int64_t keep_ns = 2'000'000'000;      ///< ns of stored poses
    int64_t patience_ns = 1'000'000'000;  ///< ns that a sighting waits for its pose
    int64_t near_ns = 120'000'000;        ///< ns: max age of a pose for a frame, if none is nearer ...
    size_t waiting = 3;                   ///< ... and more sightings than these are waiting
    size_t max_waiting = 16;              ///< sightings; further ones are dropped
    double max_between_ns = 5e8;          ///< max interval of poses for interpolation, ns
    double min_motion_s = 1e-3;           ///< min interval of two poses for the camera's motion, s
    double max_motion_s = 0.3;            ///< max interval, s
    double gnss_m = 15;                   ///< error of GNSS positions, m, in addition to ...
    double gnss_sigmas = 4;               ///< ... this many of the receiver's own sigmas
    double gnss_sigma_m = 10;             ///< of a receiver that reports none, m
    int64_t fresh_ns = 10'000'000'000;    ///< max age of a GNSS position, ns
    double max_tilt_sigma_rad = 5 * std::numbers::pi / 180;  ///< upper bound, rad: gravity observes the inclination
    double off_m = 3;                                        ///< error of the prior, m, in addition to ...
    double off_sigmas = 4;  ///< ... this many of its own sigmas and the drift since the last fix
  };

  /// Throws std::runtime_error if some objects have geodetic positions and others positions in an n of unknown origin.
  ObjectFixer(const Parameters& parameters, const Finder::Parameters& finder,
              const SightingValidator::Parameters& validator, std::vector<PlaneObject> objects);

  void reset();
  /// Orientation and position of the camera in the body frame, m. The search is limited to objects in range from then
  /// on.
  void set_mount(const Eigen::Quaterniond& q_b_c, const Eigen::Vector3d& p_b_c);
  /// rad; `sigma_m` is the larger horizontal one, m, if the receiver states it.
  void add_gnss(int64_t t_ns, double latitude_rad, double longitude_rad, std::optional<double> sigma_m);
  /// A pose of an earlier time than the last one replaces those after it.
  std::vector<Estimate> add_pose(const PipelinePose& pose);
  /// `grey` 8-bit of the lens's size; `mask` may be empty. The camera's motion in `lens` is set here.
  std::vector<Estimate> add_frame(int64_t t_ns, const cv::Mat& grey, const cv::Mat& mask, RollingLens lens);

  const PlaneObject& object(size_t number) const { return finder_.objects()[number]; }

 private:
  struct Waiting {
    Sighting sighting;
    RollingLens lens;
  };
  struct GnssPosition {
    int64_t t_ns;
    Eigen::Vector3d p_map;
    double accuracy_m;
  };
  std::vector<PlaneObject> on_map(std::vector<PlaneObject> objects);
  Eigen::Vector3d on_map(double latitude_rad, double longitude_rad, double height_m) const;
  void align_map(const PipelinePose& pose);
  void set_motion(RollingLens& lens) const;
  Eigen::Quaterniond camera(const PipelinePose& pose) const;
  Prior prior_of(const PipelinePose& pose) const;
  std::optional<Prior> prior_at(int64_t t_ns) const;
  std::vector<char> possible() const;
  std::vector<Estimate> decide();

  Parameters p_;
  std::array<double, 3> datum_ = {0, 0, 0};  // latitude and longitude in rad, height in m, of the map's origin
  bool any_geodetic_ = false;
  Finder finder_;
  SightingValidator validator_;
  bool has_mount_ = false, is_map_aligned_ = false, placed_ = false;
  Eigen::Quaterniond q_b_c_ = rear_camera_mount();
  Eigen::Vector3d p_b_c_ = Eigen::Vector3d::Zero(), n_from_map_ = Eigen::Vector3d::Zero();
  std::deque<PipelinePose> poses_;
  std::deque<Waiting> waiting_;
  std::optional<Eigen::Vector3d> fix_on_map_;  // the last fix, until the pose that follows it
  std::optional<GnssPosition> gnss_;
};

}  // namespace odograph::known_object
