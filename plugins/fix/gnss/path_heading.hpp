// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include <Eigen/Core>

namespace odograph::gnss {

/// Yaw that rotates a walked path onto all satellite positions and velocities since its start. With d a segment of the
/// path along the attitude's heading, c the walker's position and z a satellite position:
///
///   c <- c + [d_n -d_e; d_e d_n] (a, b)     (a, b) <- (a, b) + (a', b') dt     z = c + e + j + noise
///
/// with a = scale cos(yaw), b = scale sin(yaw), which drift like the attitude (gyro bias, compass), the receiver's
/// correlated error e (first-order Gauss-Markov) and a jump j by a reflection. The model is linear in all of them for
/// any yaw offset, so that one Kalman filter fits the whole path. Allocates only for the queue of positions that await
/// their steps.
class PathHeading {
 public:
  struct Parameters {
    double correlation_s = 20;          ///< of e
    double bias_s = 600;                ///< decay of a jump; with a shorter one a lasting reflection bends the path
    double white_m = 1;                 ///< of a position, in addition to e
    double path_walk = 0.2;             ///< m/sqrt(m): hand and compass deviate by 0.1 rad, correlated over 5 m
    double heading_walk = 0.002;        ///< rad/sqrt(s), of the path's heading by a gyroscope
    double heading_rate = 0.005;        ///< rad/s, initial gyro bias of an attitude source
    double heading_rate_s = 120;        ///< its correlation time; the filter stays linear for about as long
    double scale_sigma = 0.1;           ///< of step lengths: differences between walkers
    double gate_sigma = 4;              ///< of a position, above which it is a jump
    double velocity_correlation_s = 2;  ///< correlation time of a velocity's error
    double velocity_prior_weight = 10;  ///< weight of the reported sigma, in velocities
    double min_velocity_mps = 0.1;      ///< lower bound of the sigma of a receiver's velocity between buildings
    // Empirical, not tuned:
    double initial_sigma = 3;               ///< initial sigma of (a, b): any yaw, any scale
    double initial_position_sigma_m = 1e5;  ///< initial sigma of the path's start
    double jump_m = 50;                     ///< sigma of a reflection
    /// Max waiting time of a position for its steps, which are reported with a delay.
    int64_t max_wait_ns = 3'000'000'000;
    int64_t velocity_ns = 1'000'000'000;  ///< segment of the path that a velocity is compared with: two steps
    double max_yaw_sigma_rad = 0.35;      ///< max sigma of a yaw offset to be reported
    double min_gain = 0.1;                ///< relative gain of information before it is reported again
    double steps_mps = 0.2;               ///< sigma of the path over one second
    double min_scale = 0.3;               ///< of (a, b): below it the direction is undefined
    double max_path_sigma_mps = 0.5;  ///< sigma of the path's velocity below which it measures the receiver's accuracy
  };
  struct Yaw {
    double rad, sigma_rad;  ///< to be added to the attitude's heading
  };
  explicit PathHeading(const Parameters& parameters);

  void add_step(int64_t start_ns, int64_t end_ns, double length_m, double heading_rad);
  /// North and east about any common point, m; sigma per axis. Positions before the newest step are used at once, later
  /// ones when the path to them is known, after three seconds at most.
  void add_position(int64_t t_ns, const Eigen::Vector2d& position_m, double sigma_m);
  void add_velocity(int64_t t_ns, const Eigen::Vector2d& velocity_mps, double sigma_mps);

  /// Sigma of a velocity component, m/s: as reported, refined by comparison with the path.
  double velocity_sigma(double reported_mps) const;

  /// Nothing until the direction of the path against the positions is determined.
  std::optional<Yaw> yaw() const;
  /// The information gained by `yaw` since the last report, as an independent measurement; nothing while it is small.
  std::optional<Yaw> new_information();

 private:
  struct Seen {
    int64_t t_ns;
    Eigen::Vector2d value;
    double sigma;
    bool is_velocity;
  };
  struct PathSegment {
    int64_t start_ns, end_ns;
    Eigen::Vector2d from, by;
  };
  std::optional<Eigen::Vector2d> path_at(int64_t t_ns) const;
  void process_waiting();
  void use(const Seen& seen, const Eigen::Vector2d& path, const Eigen::Vector2d& path_velocity);

  static constexpr int kStates = 10, kYaw = 0, kPlace = 2, kError = 4, kJump = 6, kRate = 8;
  using Vector = Eigen::Matrix<double, kStates, 1>;
  using Matrix = Eigen::Matrix<double, kStates, kStates>;
  std::optional<Yaw> yaw_of(const Vector& x, const Matrix& P) const;
  void propagate(double dt_s, const Eigen::Vector2d& moved, double sigma_m);
  void update_velocity_sigma(double squared_mps2, double by_path_mps2);
  Parameters p_;
  Vector x_;
  Matrix P_;
  double velocities_ = 0,
         velocity_squares_ = 0;  // velocities compared with the path, and the sum of their squared errors
  bool has_position_ = false;
  int64_t t_ns_ = 0, newest_ns_ = INT64_MIN;
  Eigen::Vector2d path_ = Eigen::Vector2d::Zero(), used_path_ = Eigen::Vector2d::Zero();
  std::deque<PathSegment> steps_;
  std::deque<Seen> waiting_;
  bool has_reported_ = false;
  Vector reported_x_;  // last report, propagated to the present
  Matrix reported_P_;
};

}  // namespace odograph::gnss
