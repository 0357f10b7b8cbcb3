// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include <Eigen/Core>

namespace odograph::slant_scale {

/// Eq. (4) to (6) and Algorithm 1 of Gakne & O'Keefe 2018 as printed: s_g = d_slant / ||P_3DBM - P_VO||, with P_VO the
/// previous position by the odometry alone, up to scale, from the same start as P_3DBM. For its value, and for what
/// eq. (6) leaves open, see docs/slant_distance.md.
class LiteralScale {
 public:
  /// The position in n at which the path starts; until it is known, n's origin.
  void start_at(const Eigen::Vector3d& p_n);
  /// A motion's displacement in n, up to scale: the positions of eq. (6). A new group starts at the last position by
  /// the city model.
  void add_motion(int64_t from_ns, int64_t t_ns, const Eigen::Vector3d& d_n, uint32_t group);
  /// The position by the city model at the time of a frame, and the slant distance from there, m.
  void add_position(int64_t t_ns, const Eigen::Vector3d& p_n, double slant_distance_m);
  /// s: 1 before the first position, then the latest s_g.
  double scale() const { return scale_; }
  /// s_r of the newest frame, eq. (6): the length of its displacement, up to scale.
  double frame_displacement() const { return frame_displacement_; }
  /// Whether s comes from a position.
  bool corrected() const { return corrected_; }

 private:
  struct Point {
    int64_t t_ns;
    Eigen::Vector3d p;  // up to scale
  };
  std::optional<Eigen::Vector3d> previous_position(int64_t t_ns) const;

  static constexpr double kHistory_s = 10;  // a fix of a picture comes seconds later
  Eigen::Vector3d start_n_ = Eigen::Vector3d::Zero(), last_position_ = Eigen::Vector3d::Zero();
  std::deque<Point> path_;
  std::optional<uint32_t> group_;
  double scale_ = 1, frame_displacement_ = 1;
  bool corrected_ = false, began_at_start_ = true;
};

}  // namespace odograph::slant_scale
