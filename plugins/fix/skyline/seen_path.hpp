// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Geometry>

#include "plugins/fix/skyline/horizon.hpp"
#include "plugins/fix/skyline/seen_skyline.hpp"

namespace odograph::skyline {

/// An earlier picture of the path: its sky edge, and the camera's pose by the odometry.
struct View {
  std::vector<SkyEdge> edges;
  Eigen::Vector3d p_n;
  Eigen::Quaterniond q_n_c;
};

/// The observed skyline of one picture or of several along a path, for comparison with a city's. The path moves rigidly
/// and rotates about its newest place: the odometry's error along it is small against the prior's.
class SeenPath {
 public:
  /// Chosen empirically, not tuned.
  struct Parameters {
    double moved_m = 0.1;      ///< places nearer than this have the same skyline
    double correlated = 2;     ///< pictures of a path with common errors, counted as one: as PlaceFinder's
    double beside_rad = 0.17;  ///< margin around the headings in reach, for inclination and steps of the refinement
  };

  struct Seen {
    SeenSkyline skyline;
    Eigen::Vector3d offset_n;    ///< from the newest place
    Sector sector;               ///< that contains its directions for all headings in reach
    Horizon horizon;             ///< of the city, at computed_n
    Eigen::Vector3d computed_n;  ///< the place of the latest evaluation

    Eigen::Vector3d place(const Eigen::Vector3d& newest_n, double yaw_rad) const;
  };

  /// The newest picture, taken at p_n, and older ones; headings are known to yaw_reach_rad.
  void set(const std::vector<SkyEdge>& edges, const Eigen::Vector3d& p_n, const Eigen::Quaterniond& q_n_c,
           const std::vector<View>& older, double yaw_reach_rad);

  /// The newest first.
  std::vector<Seen>& seen() { return seen_; }
  const std::vector<Seen>& seen() const { return seen_; }
  Seen& newest() { return seen_.front(); }
  bool is_path() const { return seen_.size() > 1; }
  size_t directions() const;
  double lowest_rad() const;
  /// Sum of the directions' weights.
  double total_weight() const;
  /// The factor by which that overstates the information: pictures of a path show the same houses and have common
  /// errors.
  double correlated() const;
  /// The middle of the path relative to its newest place, and the max distance of its places from there.
  Eigen::Vector3d middle_n() const;
  double half_length_m() const;

  /// Computes the city's skyline at all places of the path; unless `recompute_all`, only at those that the heading has
  /// moved.
  void look(const City& city, const Eigen::Vector3d& newest_n, double yaw_rad, bool recompute_all);
  uint64_t work_to_recompute(const City& city, const Eigen::Vector3d& newest_n, double yaw_rad,
                             bool recompute_all) const;
  /// Mean loss of a direction, rad, against the computed skylines.
  double loss(const Guess& guess, double max_rad) const;
  /// Fraction of the directions in which picture and model agree, against the computed skylines.
  double agreement(const Guess& guess, double bound_rad) const;

 private:
  bool must_recompute(const Seen& seen, const Eigen::Vector3d& newest_n, double yaw_rad) const;

  Parameters p_;
  std::vector<Seen> seen_;
};

}  // namespace odograph::skyline
