// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include <Eigen/Core>

namespace odograph::gnss {

/// By how much a walked path is to be turned so that it fits all satellite positions and velocities since its start.
/// The path P is the sum of the steps as the attitude's heading has them. A position is
///
///   z = [P_n -P_e; P_e P_n] (a, b) + c + e + j + noise
///
/// with a = scale cos(turn), b = scale sin(turn), the path's unknown beginning c, the receiver's correlated error e
/// (first-order Gauss-Markov) and a jump j of a reflection. That is linear in all of them, whatever the turn: one
/// Kalman filter fits the whole path. No allocation but the queue of positions that wait for their steps.
class PathHeading {
 public:
  struct Parameters {
    double correlation_s = 20;    ///< of e
    double bias_s = 600;          ///< with which a jump is forgotten; sooner, a reflection that lasts bends the path
    double white_m = 1;           ///< of a position, beside e
    double path_walk = 0.2;       ///< m/sqrt(m): a hand and a compass sway by 0.1 rad, alike for 5 m
    double heading_walk = 0.002;  ///< rad/sqrt(s), of the attitude's heading
    double scale_sigma = 0.1;     ///< of step lengths: walkers differ so
    double gate_sigma = 4;        ///< of a position, beyond which it has jumped
    double velocity_correlation_s = 2;  ///< of a velocity's error
  };
  struct Turn {
    double rad, sigma_rad;  ///< to be added to the attitude's heading
  };
  explicit PathHeading(const Parameters& parameters);

  void add_step(int64_t start_ns, int64_t end_ns, double length_m, double heading_rad);
  /// North and east about any point, the same for all, m; sigma for each. Positions before the newest step count at
  /// once, later ones when the path to them is known, three seconds at most.
  void add_position(int64_t t_ns, const Eigen::Vector2d& position_m, double sigma_m);
  void add_velocity(int64_t t_ns, const Eigen::Vector2d& velocity_mps, double sigma_mps);

  /// Nothing before the path has a direction against the positions.
  std::optional<Turn> turn() const;
  /// What `turn` has learnt since it was last told, as an independent measurement; nothing while that is little.
  std::optional<Turn> news();

 private:
  struct Seen {
    int64_t t_ns;
    Eigen::Vector2d value;
    double sigma;
    bool is_velocity;
  };
  struct Walked {
    int64_t start_ns, end_ns;
    Eigen::Vector2d from, by;
  };
  std::optional<Eigen::Vector2d> path_at(int64_t t_ns) const;
  void work_off();
  void use(const Seen& seen, const Eigen::Vector2d& path, const Eigen::Vector2d& path_velocity);
  void propagate(double dt_s, double walked_m, double sigma_m);

  using Vector8 = Eigen::Matrix<double, 8, 1>;
  using Matrix8 = Eigen::Matrix<double, 8, 8>;
  Parameters p_;
  Vector8 x_;
  Matrix8 P_;
  bool has_position_ = false;
  int64_t t_ns_ = 0, newest_ns_ = INT64_MIN;
  Eigen::Vector2d path_ = Eigen::Vector2d::Zero(), used_path_ = Eigen::Vector2d::Zero();
  std::deque<Walked> steps_;
  std::deque<Seen> waiting_;
  double told_information_ = 0, told_rad_ = 0;
};

}  // namespace odograph::gnss
