// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <optional>

#include "plugins/vo/odograph/inertial/filter.hpp"

namespace odograph::vio {

/// A frame before the metric scale is known: its corners, and the visual odometry's pose, up to scale.
struct StartFrame {
  FrameCorners corners;
  Eigen::Isometry3d T_w_c = Eigen::Isometry3d::Identity();
  bool posed = false;  ///< the pose belongs to the present map
  unsigned group = 0;  ///< poses of one group share their scale
};

/// "Empirical": chosen on simulated walks (`odograph bench walk700`, phone scenarios) and euroc_mh05; no parameter
/// sweep is recorded.
struct StartParameters {
  // Start from standing.
  /// Time at rest before the filter starts. A swinging phone is at rest for half a second at its turning points, but
  /// never for a second (tests); a drive loses its fixes while waiting for a second, hence 0.6.
  double still_s = 0.6;
  int still_looks = 4;                    ///< pictures within that time that a pure rotation must explain; empirical
  double still_tilt_rad = 0.1;            ///< before gravity is measured
  double still_rate_radps = 0.05;         ///< rms below which the mean rate is the gyro bias; empirical
  double still_bias_sigma_radps = 0.005;  ///< sigma of that bias; empirical
  double still_arm_mps = 0.15;            ///< max speed of a phone carried around by a rotating person; empirical
  double still_px = 1.5;                  ///< max residual flow of the picture after a rotation; empirical
  double still_gravity_sigmas = 3;        ///< of the accelerometer bias: max deviation of the force from gravity
  int still_samples = 10;                 ///< min IMU samples
  // Start in motion: alignment of the visual odometry's poses with the IMU.
  double min_flow_px = 1;            ///< min residual flow after a rotation: a standing hand has 0.2 to 0.7
  double min_s = 0.8, max_s = 3;     ///< length of the motion used; empirical
  size_t min_frames = 6;             ///< 18 equations for 12 unknowns
  int alignment_iterations = 4;      ///< updates of the noise and of the direction of gravity, the linearisation point
  double min_visual_sigma = 2e-3;    ///< of a visual position, in the map's scale (median depth one): 1 px; empirical
  double alignment_sigma = 0.35;     ///< max relative sigma of the scale by the alignment; empirical
  double max_rms_m = 0.1;            ///< max rms difference of visual and inertial poses; good starts have 0.01
  double scale_sigma = 0.15;         ///< max relative sigma of the scale after the filter passes; empirical
  double max_bias_sigmas = 5;        ///< max accelerometer bias, in sigmas of its prior
  double min_fit = 0.5;              ///< min share of the tracks that the filter accepts over these frames; empirical
  double max_calibration_chi2 = 25;  ///< Filter::calibration_chi2 after the lens was doubted; 5 degrees of freedom
  // Starts in motion are hypotheses, each solved from all frames up to then. The newest is accepted once those before
  // it agree.
  double min_path_m = 0.03;  ///< min path, in both, to compare two starts; empirical
  double max_spread = 0.15;  ///< of the logarithm of the scale: those within agree; empirical
  int confirmations = 1;     ///< starts that must agree, and one more for each contradiction within max_s
  double max_gate_px = 1.5;  ///< corner noise estimated by the filter above which the start is rejected
  /// Sigma of the change of velocity over the last history_s, of which a start in motion sees the end only: starting to
  /// walk changes it by 1.4 m/s, to run by 3.
  double velocity_change_mps = 1.5, history_s = 3;
  int passes = 3;                    ///< filter passes over these frames, each linearised about the previous one
  double velocity_sigma_mps = 0.15;  ///< of the starting filter, besides the scale's alignment_sigma; empirical
};

/// Inertial alignment of a segment of visual odometry: p_visual = a + b t + c t^2 / 2 + d (inertial displacement), |c|
/// = d g. Over two seconds the inertial side is almost noise-free and the visual side is not. The visual poses are
/// therefore regressed on the inertial ones; the inverse regression would underestimate the scale (errors in
/// variables).
struct Alignment {
  Navigation nav;             ///< at the first frame, in a w with z along gravity
  double scale = 0;           ///< of the visual odometry
  double relative_sigma = 0;  ///< of the scale
  double tilt_rad = 0;        ///< standard deviation of gravity's direction
  double rms_m = 0;           ///< of the residuals
};
std::optional<Alignment> align_with_imu(const std::deque<StartFrame>& frames, size_t from, const ImuBuffer& imu,
                                        const Camera& camera, const Eigen::Vector3d& gyro_bias,
                                        const FilterParameters& p, const StartParameters& s);

/// Tries to start a filter from the latest frames, standing or moving. Nothing while the metric scale is unobservable.
std::optional<Filter> start_still(const std::deque<StartFrame>& frames, const ImuBuffer& imu, const Camera& camera,
                                  const FilterParameters& p, const StartParameters& s);
std::optional<Filter> start_moving(const std::deque<StartFrame>& frames, const ImuBuffer& imu, const Camera& camera,
                                   const Eigen::Vector3d& gyro_bias, const FilterParameters& p,
                                   const StartParameters& s);

/// Evidence for a start in motion from the ones before it.
class StartEvidence {
 public:
  /// The newest start's scale over that of the one before it; nothing if there is none, or they are not comparable.
  /// Returns true if it is to be accepted.
  bool add(std::optional<double> ratio, int64_t t_ns, const StartParameters& s);
  /// Range of the logarithm of the scale among those that agree.
  double spread() const { return highest_ - lowest_; }

 private:
  int agreeing_ = 0;
  double sum_ = 0, lowest_ = 0, highest_ = 0;  // logarithm of the scale over that of the first that agrees
  std::deque<int64_t> contradicted_ns_;
};

/// Ratio of the second filter's scale to the first's: of the paths through the frames of which both have a clone.
/// Nothing if one of them is shorter than `min_path_m`.
std::optional<double> scale_between(const State& first, const State& second, double min_path_m);

}  // namespace odograph::vio
