// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include <Eigen/Core>

namespace odograph::gnss {

/// By how much a walked path is to be turned so that it fits all satellite positions and velocities since its start.
/// With d a piece of the path as the attitude's heading has it, the walker's place c and a position z are
///
///   c <- c + [d_n -d_e; d_e d_n] (a, b)     (a, b) <- (a, b) + (a', b') dt     z = c + e + j + noise
///
/// with a = scale cos(yaw), b = scale sin(yaw), which drift as the attitude does (its gyroscope's bias, its compass),
/// the receiver's correlated error e (first-order Gauss-Markov) and a jump j of a reflection. That is linear in all of
/// them, whatever the yaw offset: one Kalman filter fits the whole path. No allocation but the queue of positions that
/// wait for their steps.
class PathHeading {
 public:
  struct Parameters {
    double correlation_s = 20;    ///< of e
    double bias_s = 600;          ///< with which a jump is forgotten; sooner, a reflection that lasts bends the path
    double white_m = 1;           ///< of a position, beside e
    double path_walk = 0.2;       ///< m/sqrt(m): a hand and a compass sway by 0.1 rad, alike for 5 m
    double heading_walk = 0.002;  ///< rad/sqrt(s), of the path's heading, a gyroscope's
    double heading_rate = 0.005;  ///< rad/s, of its bias, as an attitude source starts with
    double heading_rate_s = 120;  ///< for how long it is alike; the filter is linear for about so long
    double scale_sigma = 0.1;     ///< of step lengths: walkers differ so
    double gate_sigma = 4;        ///< of a position, beyond which it has jumped
    double velocity_correlation_s = 2;  ///< of a velocity's error
    double velocity_trust = 10;         ///< velocities for which the sigma told counts
    double min_velocity_mps = 0.1;      ///< no receiver's velocity is better between houses
    // What follows was chosen by hand, and not tuned.
    double any = 3;                       ///< of (a, b) at the start: any yaw, any scale
    double any_m = 1e5;                   ///< of the path's beginning
    double jump_m = 50;                   ///< of a reflection
    int64_t patience_ns = 3'000'000'000;  ///< for which a position waits for its steps: they are told so late at most
    int64_t velocity_ns = 1'000'000'000;  ///< of the path, that a velocity is compared with: two steps
    double tellable_rad = 0.35;           ///< a yaw offset is told once it is as well known
    double news = 0.1;                    ///< and again when it has gained so much of its information
    double steps_mps = 0.2;               ///< of a second of the path
    double min_scale = 0.3;               ///< of (a, b): below it has no direction yet
    double telling_mps = 0.5;  ///< of the path's own velocity: surer, and it tells how good the receiver's is
  };
  struct Yaw {
    double rad, sigma_rad;  ///< to be added to the attitude's heading
  };
  explicit PathHeading(const Parameters& parameters);

  void add_step(int64_t start_ns, int64_t end_ns, double length_m, double heading_rad);
  /// North and east about any point, the same for all, m; sigma for each. Positions before the newest step count at
  /// once, later ones when the path to them is known, three seconds at most.
  void add_position(int64_t t_ns, const Eigen::Vector2d& position_m, double sigma_m);
  void add_velocity(int64_t t_ns, const Eigen::Vector2d& velocity_mps, double sigma_mps);

  /// Of a velocity's component, m/s: what was told, until the velocities show what they are against the path.
  double velocity_sigma(double told_mps) const;

  /// Nothing before the path has a direction against the positions.
  std::optional<Yaw> yaw() const;
  /// What `yaw` has learnt since it was last told, as an independent measurement; nothing while that is little.
  std::optional<Yaw> news();

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

  static constexpr int kStates = 10, kYaw = 0, kPlace = 2, kError = 4, kJump = 6, kRate = 8;
  using Vector = Eigen::Matrix<double, kStates, 1>;
  using Matrix = Eigen::Matrix<double, kStates, kStates>;
  std::optional<Yaw> yaw_of(const Vector& x, const Matrix& P) const;
  void propagate(double dt_s, const Eigen::Vector2d& moved, double sigma_m);
  void learn_velocity(double squared_mps2, double by_path_mps2);
  Parameters p_;
  Vector x_;
  Matrix P_;
  double velocities_ = 0, velocity_squares_ = 0;  // that have shown their error, and its squares
  bool has_position_ = false;
  int64_t t_ns_ = 0, newest_ns_ = INT64_MIN;
  Eigen::Vector2d path_ = Eigen::Vector2d::Zero(), used_path_ = Eigen::Vector2d::Zero();
  std::deque<Walked> steps_;
  std::deque<Seen> waiting_;
  bool told_ = false;
  Vector told_x_;  // what was told, as it has aged since
  Matrix told_P_;
};

}  // namespace odograph::gnss
