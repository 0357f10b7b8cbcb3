// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Geometry>

#include "plugins/fix/skyline/horizon.hpp"
#include "plugins/fix/skyline/seen_skyline.hpp"

namespace odograph::skyline {

/// A picture that was taken earlier on the path: its sky's edge, and where the odometry has its camera.
struct View {
  std::vector<SkyEdge> edges;
  Eigen::Vector3d p_n;
  Eigen::Quaterniond q_n_c;
};

/// What one picture, or several along a path, show of the skyline, to be laid over a city's. The path moves as one and
/// turns as one about its newest place: what the odometry errs by along it is small against what is looked for.
class SeenPath {
 public:
  /// Chosen by hand, and not tuned.
  struct Parameters {
    double moved_m = 0.1;      ///< nearer to each other than this two places have the same skyline
    double correlated = 2;     ///< pictures of a path that count as one: as PlaceFinder's
    double beside_rad = 0.17;  ///< beyond the headings in reach, for inclination and steps of the refinement
  };

  struct Seen {
    SeenSkyline skyline;
    Eigen::Vector3d offset_n;  ///< from the newest place
    Sector sector;             ///< in which its directions lie whatever the heading in reach
    Horizon horizon;           ///< of the city, where it was looked at last
    Eigen::Vector3d looked_n;  ///< the place of that

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
  /// As many directions as count.
  double total_weight() const;
  /// How many times that is too many: pictures of a path show the same houses, and err with them.
  double correlated() const;
  /// The middle of the path against its newest place, and how far from there its places lie.
  Eigen::Vector3d middle_n() const;
  double half_length_m() const;

  /// Looks at the city from all places of the path. Unless `anew`, from those alone that the heading has moved.
  void look(const City& city, const Eigen::Vector3d& newest_n, double yaw_rad, bool anew);
  uint64_t work_to_look(const City& city, const Eigen::Vector3d& newest_n, double yaw_rad, bool anew) const;
  /// Mean loss of a direction, rad, against what was looked at.
  double loss(const Guess& guess, double max_rad) const;
  /// Part of the directions in which picture and model agree, against what was looked at.
  double agreement(const Guess& guess, double bound_rad) const;

 private:
  bool must_look(const Seen& seen, const Eigen::Vector3d& newest_n, double yaw_rad) const;

  Parameters p_;
  std::vector<Seen> seen_;
};

}  // namespace odograph::skyline
