// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "plugins/scale/inertial/window.hpp"
#include "sdk/math/ring.hpp"

namespace odograph::inertial_scale {

/// "Judgement": chosen, found to be insensitive; "empirical": never varied.
struct Parameters {
  double window_s = 4.0;        ///< s of motion per regression; 6 s increases the error by a quarter on simulated gait
  double start_sigma = 0.15;    ///< relative sigma of the scale below which it is reported
  double scale_walk = 0.03;     ///< 1/sqrt(m), random walk of the odometry's log-scale: vo/five_point at corners,
                                ///< simulated streets (docs/accuracy/pose.md); half of the time a third of it
  double standing_walk = 0.01;  ///< 1/sqrt(s), the same while the camera hardly moves: 3 % over a stop is typical
  double standing_mps = 0.1;    ///< m/s, speed below which the camera hardly moves; empirical
  double common_sigma = 0.03;   ///< relative error of the scale common to all windows: rolling-shutter remainder in the
                                ///< gait's motion (simulated streets, as above); the accelerometer's own scale error
                                ///< is 0.01 at most (data sheets of BMI270 and ICM-20602)
  double frame_spacing_s = 0.08;  ///< s, min spacing of a window's frames: closer ones have the same error; judgement
  double anchor_s = 2.0;          ///< s, time constant of the alignment with the host's orientation; judgement, 1 to 3
  double jump_rad = 0.1;  ///< rad, difference above which the host has corrected its orientation in one step. A bias of
                          ///< 17 mrad/s, the worst of four phones, gives 0.034; judgement
  double longest_gap_s = 0.05;  ///< s, max interval of IMU samples: two or three at 50 Hz
  double gravity_mps2 = 9.81;   ///< m/s^2, 9.78 to 9.83 on Earth; c2 absorbs the difference
  double gate = 10.83;   ///< chi-square bound of the normalised innovation squared that 99.9 % of good windows pass
  int max_rejected = 3;  ///< consecutive windows, after which the scale itself is wrong
  Window::Parameters window;
};

/// Mount of the camera: by default a phone's rear camera.
struct Mount {
  Eigen::Quaterniond q_b_c{0, 1, 0, 0};
  Eigen::Vector3d p_b_c = Eigen::Vector3d::Zero();  ///< m
};

struct Scale {
  double scale, relative_sigma;
};

/// Scale of an odometry's displacements from inertia. A Kalman filter with one state, r = 1/scale: each window (Window)
/// measures it directly; a new scale group restarts it. Windows share no frame and thus have independent errors; their
/// common error (common_sigma) is added to the reported sigma and never averaged out. A motion is used when the next
/// one arrives, when the IMU samples around its later frame are available. Does not allocate.
class InertialScale {
 public:
  struct Motion {
    int64_t from_ns, t_ns;
    Eigen::Quaterniond q_n_c0;
    Eigen::Quaterniond q_c0_c1;  ///< rotation by the camera, not the gyroscope
    Eigen::Vector3d p_c0_c1;     ///< up to scale
    uint32_t group;
    bool translates;  ///< q_c0_c1 and p_c0_c1 are valid
  };

  explicit InertialScale(const Parameters& parameters = {}) : p_(parameters), window_(parameters.window) {}

  /// Ends the window if the mount differs from the previous one.
  void set_camera(const Mount& mount);
  /// rad/s and m/s^2. Samples that are not newer than the last one are ignored.
  void add_imu(int64_t t_ns, const Eigen::Vector3d& gyro_b, const Eigen::Vector3d& accel_b);
  void add_motion(const Motion& motion);
  /// Nothing until it is known.
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
  int64_t last_ns_ = INT64_MIN;  // frame up to which the motions are consecutive
  Eigen::Quaterniond q_n_b_ = Eigen::Quaterniond::Identity();
  Eigen::Vector3d alpha_n_ = Eigen::Vector3d::Zero(), rate_n_ = Eigen::Vector3d::Zero(), y_n_ = Eigen::Vector3d::Zero(),
                  beta_n_ = Eigen::Vector3d::Zero();  // as in Window
  double inverse_scale_ = 0, variance_ = -1;          // negative: no window yet
  bool known_ = false;
  int rejected_ = 0;
};

}  // namespace odograph::inertial_scale
