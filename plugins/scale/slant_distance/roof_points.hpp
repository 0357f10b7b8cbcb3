// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "plugins/scale/slant_distance/slant_scale.hpp"

namespace odograph::slant_scale {

/// A landmark of a front-end, up to scale.
struct LandmarkPoint {
  Eigen::Vector3f p_c;   ///< in the camera
  float distance_sigma;  ///< along the ray
};

/// The slant distance as a scale: s = d_slant / ||X - P||. The numerator is eq. (4) of Gakne & O'Keefe 2018 in metres;
/// the denominator is the distance from the camera to the same roof, which the front-end has triangulated.
///
/// Landmarks in the direction of the roof point or below it lie on the wall under its edge: their horizontal distance
/// is the roof point's. A robust mean over them gives the scale of a fix, one over the fixes of the window the scale.
class RoofPoints {
 public:
  /// Empirical, not tuned.
  struct Parameters {
    double beside_rad = 0.2;        ///< max difference of the azimuths of landmark and roof point
    double below_rad = 0.3;         ///< max elevation of the roof point over the landmark's ...
    double above_rad = 0.03;        ///< ... and under it
    double steepest_rad = 1.48;     ///< max elevation: the wall's horizontal distance is undefined at the zenith
    double max_relative_sigma = 1;  ///< of a landmark's distance
    size_t min_points = 3;          ///< of a fix
    double independent = 3;         ///< at most so many count as independent: the rest share their errors
    double model = 0.08;            ///< relative: depth of balconies, cornices and setbacks
    double slant_sigma_m = 1;       ///< of a fix that does not state it
    double history_s = 4;           ///< fixes of a picture come that much later
    double nearest_s = 0.1;         ///< max time between a fix and the landmarks
    double huber = 1.5;             ///< standard deviations beyond which the loss is linear
  };

  /// `scale_drift`: relative change of the odometry's scale within a window.
  RoofPoints(double window_s, double scale_drift) : window_s_(window_s), scale_drift_(scale_drift) {}

  /// The landmarks of a frame, before its motion. A new group drops everything in the old scale.
  void add_points(int64_t t_ns, uint32_t group, std::vector<LandmarkPoint> points);
  /// The camera's orientation at the end of a motion.
  void add_orientation(int64_t t_ns, const Eigen::Quaterniond& q_n_c, uint32_t group);
  struct RoofPoint {
    Eigen::Vector3d from_camera_n;                           ///< from P to X, m
    double slant_sigma_m;                                    ///< of its length; 0: not stated
    std::optional<Eigen::Quaterniond> q_n_c = std::nullopt;  ///< of the fix, if it has one
  };
  void add_fix(int64_t t_ns, const RoofPoint& roof);
  /// The scale at a time; its sigma grows with the age of the fixes.
  std::optional<Scale> scale_at(int64_t t_ns) const;

 private:
  struct Frame {
    int64_t t_ns;
    std::vector<LandmarkPoint> points;
    std::optional<Eigen::Quaterniond> q_n_c;
  };
  /// A measurement of the logarithm of the scale.
  struct LogScale {
    int64_t t_ns;
    double value, variance;
  };
  void begin_group(uint32_t group);
  const Frame* nearest(int64_t t_ns) const;
  static LogScale robust_mean(std::vector<LogScale> values, double huber);

  Parameters p_;
  double window_s_, scale_drift_;
  std::optional<uint32_t> group_;
  std::deque<Frame> frames_;
  std::deque<LogScale> fixes_;
};

}  // namespace odograph::slant_scale
