// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "plugins/scale/inertial/window.hpp"
#include "sdk/math/ring.hpp"

namespace odograph::inertial_scale {

/// Units and sources; "judgement" is a choice that was seen not to matter much, "by hand" one that was never varied.
struct Parameters {
  double window_s = 4.0;      ///< s of motion in a regression; with 6 s the error grows by a quarter on simulated gait
  double start_sigma = 0.15;  ///< of the scale, relative, at which it counts as known
  double scale_walk = 0.03;   ///< 1/sqrt(m) of the odometry's log-scale: vo/five_point at corners, simulated streets
                              ///< (docs/accuracy/pose.md); half of the time a third of it
  double standing_walk = 0.01;  ///< 1/sqrt(s) of it where the camera hardly moves: 3 % over a stop is usual
  double standing_mps = 0.1;    ///< m/s: slower, the camera hardly moves; by hand
  double common_sigma = 0.03;   ///< of the scale, relative, the same in all windows: what a rolling shutter leaves in
                               ///< the gait's motion (simulated streets, as above); the accelerometer's own scale error
                               ///< is 0.01 at most (data sheets of BMI270 and ICM-20602)
  double frame_spacing_s = 0.08;  ///< s between a window's frames: nearer ones have the same error; judgement
  double anchor_s = 2.0;          ///< s in which the gyroscope's orientation follows the host's; judgement, 1 to 3
  double jump_rad = 0.1;          ///< rad between the two: beyond, the host has corrected its own at once. A bias of
                                  ///< 17 mrad/s, the worst of four phones, makes 0.034; judgement
  double longest_gap_s = 0.05;    ///< s between IMU samples that is no gap: two or three at 50 Hz
  double gravity_mps2 = 9.81;     ///< m/s^2, 9.78 to 9.83 on Earth; the difference is in c2
  double gate = 10.83;            ///< squared normalised innovation that 99.9 % of good windows pass (chi-square)
  int max_rejected = 3;           ///< windows in a row: then it is the scale that is wrong
  Window::Parameters window;
};

/// The camera in the body: a phone's rear camera where nothing else is given.
struct Mount {
  Eigen::Quaterniond q_b_c{0, 1, 0, 0};
  Eigen::Vector3d p_b_c = Eigen::Vector3d::Zero();  ///< m
};

struct Scale {
  double scale, relative_sigma;
};

/// The scale of an odometry's displacements from inertia. A Kalman filter of one state, r = 1/scale: each window
/// (Window) measures it directly, a new scale group starts it anew. Windows share no frame, so their errors are
/// independent; what is common to all of them (common_sigma) is added to the stated sigma and never averaged away. A
/// motion is used when the next one comes, since the IMU samples around its later frame are there by then. No
/// allocation.
class InertialScale {
 public:
  struct Motion {
    int64_t from_ns, t_ns;
    Eigen::Quaterniond q_n_c0;
    Eigen::Quaterniond q_c0_c1;  ///< of a camera's rotation, not the gyroscope's
    Eigen::Vector3d p_c0_c1;     ///< up to scale
    uint32_t group;
    bool translates;  ///< q_c0_c1 and p_c0_c1 are valid
  };

  explicit InertialScale(const Parameters& parameters = {}) : p_(parameters), window_(parameters.window) {}

  /// A mount that differs from the one before ends the window.
  void set_camera(const Mount& mount);
  /// rad/s and m/s^2. Times increase; what does not is passed over.
  void add_imu(int64_t t_ns, const Eigen::Vector3d& gyro_b, const Eigen::Vector3d& accel_b);
  void add_motion(const Motion& motion);
  /// Nothing before it is known.
  std::optional<Scale> scale() const { return known_ ? estimate() : std::nullopt; }

 private:
  struct Sample {
    int64_t t_ns;
    Eigen::Vector3d gyro_b, accel_b;
  };

  void use(const Motion& motion);
  bool integrate(int64_t from_ns, int64_t to_ns);
  bool orient(const Motion& motion);
  void predict(const Motion& motion, double dt_s);
  void update(const WindowScale& window);
  void add_frame(int64_t t_ns);
  std::optional<Scale> estimate() const;

  Parameters p_;
  Mount mount_;
  Ring<Sample, 1024> samples_;
  std::optional<Motion> pending_;
  Window window_;
  int64_t window_ns_ = 0;        // of its first frame
  int64_t last_ns_ = INT64_MIN;  // the frame up to which the motions chain without a break
  Eigen::Quaterniond q_n_b_ = Eigen::Quaterniond::Identity();
  Eigen::Vector3d alpha_n_ = Eigen::Vector3d::Zero(), rate_n_ = Eigen::Vector3d::Zero(), y_n_ = Eigen::Vector3d::Zero(),
                  beta_n_ = Eigen::Vector3d::Zero();  // as in Window
  double inverse_scale_ = 0, variance_ = -1;          // below 0: no window yet
  bool known_ = false;
  int rejected_ = 0;
};

}  // namespace odograph::inertial_scale
