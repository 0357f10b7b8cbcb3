// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "plugins/step/odograph/step_finder.hpp"

namespace odograph::steps {

/// Carrying mode.
enum class CarryMode : uint32_t { texting, swinging, pocket, running };

/// Step length. For a vivid walk it is linear in the rise of the phone within the step, the cadence and the regularity,
/// that is, the repetition of the walk from stride to stride. A walker who goes straight at his own pace is regular and
/// takes long steps; starting, turning, evading and strolling are irregular (regularity grows with speed: Moe-Nilssen &
/// Helbostad, J Biomechanics 37, 2004). Hand, strap or cloth dampen the bounce by an unknown amount, so a small rise
/// counts little, and the less the higher the cadence. A rocking hand adds a rise of its own, with little vertical
/// power; a leg that rotates as much does not. For gentle steps knees and arms dampen the rise, so that the cadence
/// counts more: L = a v^0.42 with v = L f (Grieve & Gear, Ergonomics 1966; down to 0.1 m/s by Wu et al., Scientific
/// Reports 2019) gives L = (a f^0.42)^(1 / 0.58). The README has the sources of the numbers.
struct LengthModel {
  double usual_m = 0.638;  ///< at the mean rise, cadence and repetition
  double per_rise = 4.37, per_cadence_and_rise = -3.9, per_repetition = 0.20;  ///< m/m, 1/Hz, m
  double per_rocking_and_rise = -1.75;                                         ///< s
  double usual_rise_m = 0.03, usual_cadence_hz = 1.8, usual_repetition = 0.85, usual_radps = 0.5, usual_part = 0.6;
  /// Limits of the fitted range of cadence, rise and angular rate.
  double min_cadence_hz = 1.4, max_cadence_hz = 2.3, max_rise_m = 0.06, min_rate_radps = 0.2, max_rate_radps = 1.4;
  /// The first step after standing is half as long; the deficit decays with the further steps: RIDI's walkers (README).
  double first_part = 0.5, initiation_steps = 1.3, initiation_sigma = 0.5;  ///< the sigma is relative to the deficit
  double at_one_mps_m = 0.632, by_speed = 0.42;  ///< a, for a body height of 1.70 m, and its exponent
  double per_root_gentle_rise = 4.0;             ///< m per sqrt(m): leg length 0.90 m; knees and arms take 55 %
  double part_of_rise = 0.45;                    ///< weight of the rise in the log of a gentle step
  double gentle_factor = 0.965;                  ///< gentle walkers mix in smaller steps
  double shortest_m = 0.15, longest_m = 1.6;     ///< limits of a step length; empirical
  double min_rise_m = 0.001;                     ///< of a gentle step: smaller is sensor noise
  /// Relative standard deviation of one step, by the repetition: from people left out of the fit.
  double regular_sigma = 0.03, per_irregularity = 0.20, gentle_sigma = 0.30;

  double length_m(const FoundStep& step) const;
  double own_sigma(const FoundStep& step) const;

 private:
  double initiation_part(const FoundStep& step) const;
};

/// Estimated parameters of a walker: a factor on the model's lengths, a further one on gentle steps, and the rotation
/// from the steps' heading to the fixes' frame. A Kalman filter uses the displacement vector between fixes, so that a
/// fix off the path is detected. Paths that contradict the estimate are rejected; the next consistent fix closes the
/// path.
class Walker {
 public:
  struct Parameters {
    double factor_sigma = 0.08;          ///< standard deviation among walkers
    double gentle_ratio_sigma = 0.20;    ///< of the gentle steps of one walker: scatter of the walk ratio L / f of slow
                                         ///< walkers (Murakami & Otaka 2017)
    double rotation_drift_rad = 0.0005;  ///< of the headings, rad per sqrt(m)
    double gentle_hand_rad = 0.2;        ///< direction of a phone looked through, against the walk; empirical
    double gentle_hand_m = 5;            ///< its correlation length; empirical
    double min_path_m = 4.0;             ///< min path between two fixes used
    double fix_sigmas = 3;               ///< min path in sigmas of the fixes; empirical
    double gate = 9.0;                   ///< chi-square with two components: rejects 1 % of good paths
    int max_rejected = 3;                ///< consecutive rejected paths after which the anchor is dropped
    double min_factor = 0.6, max_factor = 1.6;              ///< limits of the walker's factor; empirical
    double min_gentle_ratio = 0.5, max_gentle_ratio = 1.6;  ///< empirical
    /// Lower bounds of the standard deviations, since a walker varies during a day; empirical.
    double min_factor_sigma = 0.008, min_gentle_sigma = 0.05, min_rotation_sigma_rad = 1e-3;
    /// Lower bounds after loading: another day, other shoes, another pace; empirical.
    double loaded_factor_variance = 4e-4, loaded_gentle_variance = 0.01;
  };
  explicit Walker(const Parameters& parameters) : p_(parameters) {
    P_.diagonal() << p_.factor_sigma * p_.factor_sigma, p_.gentle_ratio_sigma * p_.gentle_ratio_sigma, 0;
  }

  double factor() const { return factor_; }
  void set_factor(double factor) { factor_ = factor; }
  /// Ratio of gentle steps, in addition to `factor`.
  double gentle_ratio() const { return gentle_ratio_; }
  /// Sigma of a step of that length, m: the walker's error, common to all steps, and the step's own, relative to its
  /// length.
  double sigma_m(double length_m, double own_sigma, bool gentle = false) const;
  double factor_sigma() const;

  void on_step(double model_length_m, double heading_rad, double own_sigma, bool gentle = false);
  /// A position in a horizontal frame, with the standard deviation of each component.
  void on_fix(const Eigen::Vector2d& p_n, double sigma_m);

  std::vector<uint8_t> save() const;
  bool load(const uint8_t* data, size_t size);

 private:
  Parameters p_;
  double factor_ = 1.0, gentle_ratio_ = 1.0, rotation_rad_ = 0;
  Eigen::Matrix3d P_ = Eigen::Matrix3d::Zero();  ///< of factor, gentle ratio and rotation
  bool has_rotation_ = false;
  // Displacement by the model since the anchor (the last accepted fix); gentle steps separately.
  bool has_anchor_ = false;
  Eigen::Vector2d anchor_ = Eigen::Vector2d::Zero(), path_ = Eigen::Vector2d::Zero(),
                  gentle_path_ = Eigen::Vector2d::Zero();
  double anchor_sigma_m_ = 0, walked_m_ = 0, gentle_m_ = 0, own_variance_m2_ = 0;
  int rejected_ = 0;
};

}  // namespace odograph::steps
