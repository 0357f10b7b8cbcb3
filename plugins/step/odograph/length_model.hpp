// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "plugins/step/odograph/step_finder.hpp"

namespace odograph::steps {

/// Carrying mode.
enum class CarryMode : uint32_t { texting, swinging, pocket, running };

/// Length of a step by the model, for a walker of factor one.
struct ModelLength {
  double m;
  double pace;          ///< logarithm of the cadence relative to that below which a pace is slow
  double own_sigma;     ///< relative standard deviation, independent of the next step's
  double common_sigma;  ///< relative standard deviation that all steps of such a walk share, without the walker's
  bool gentle = false;
};

/// Step length: a product of powers of what grows with a walker's speed, so that it follows the pace within a person,
///
///     L = usual min(f / slow, 1)^0.9 (h / 0.03 m)^0.22 exp(-0.8 r - 0.3 s)
///
/// * f, cadence. A person lengthens his steps with the cadence (Grieve & Gear, Ergonomics 9, 1966: L ~ f^0.72), but
///   among people at their own pace it does not count: tall people walk slowly. A cadence below `slow` is a slow pace;
///   above it the rise counts alone, until the walker is known (Walker).
/// * h, rise of the trunk: an inverted pendulum has h ~ L^2 (Zijlstra & Hof, Gait & Posture 6, 1997), of which arm,
///   strap and cloth leave an unknown part.
/// * r, rate at which the path bends: turning and evading shorten the steps (Courtine & Schieppati, Eur J Neurosci 18,
///   2003).
/// * s, second harmonic of the vertical acceleration, in phase with the first: the push of a short step is one sharp
///   peak, that of a long one has two humps, as the force on the ground has. It is not used where the hand's motion
///   dominates, in gentle steps and where little of the power is vertical, nor at slow paces, where it is always
///   strong.
///
/// The README has the sources of the numbers.
class LengthModel {
 public:
  struct Parameters {
    double usual_m = 0.727;          ///< at the usual rise, straight on
    double by_cadence = 0.9;         ///< exponent of the cadence below slow_hz
    double slow_hz = 1.72;           ///< cadence below which a pace is slow
    double by_rise = 0.22;           ///< exponent of the rise
    double usual_rise_m = 0.03;      ///< origin of the rise
    double per_turning_s = 0.8;      ///< s/rad, relative shortening on a bending path
    double per_harmonic = 0.3;       ///< relative shortening by the second harmonic
    double min_vertical_part = 0.4;  ///< of the power, below which the harmonic is the arm's
    double min_harmonic_hz = 1.45;   ///< cadence below which it is as strong as the first, also in long steps
    double leg_factor = 0.89;        ///< on a leg, which rises more than the trunk
    /// Lower limit of the cadence: the ratio of length and cadence of still slower walkers grows (Murakami & Otaka, J
    /// Phys Ther Sci 29, 2017).
    double min_cadence_hz = 1.15;
    double min_rise_m = 0.015, max_rise_m = 0.12;        ///< limits of the fitted rises
    double max_turning_radps = 0.3, max_harmonic = 0.4;  ///< limits of the fitted values
    /// The first step after standing is half as long; the deficit decays with the further steps: RIDI's walkers.
    double first_part = 0.5, initiation_steps = 1.3, initiation_sigma = 0.5;  ///< the sigma is relative to the deficit
    double shortest_m = 0.15, longest_m = 1.6;                                ///< limits of a step length; empirical
    double step_sigma = 0.03, per_irregularity = 0.08;  ///< of a single step, and more by 1 - repetition
    /// Uncertainty of the law itself, the same for all steps of a walk: the exponent of the rise among people, of the
    /// cadence beyond the fitted paces, and of steps on a leg or gentle ones.
    double by_rise_sigma = 0.10, fast_hz = 2.2, by_fast_sigma = 0.8, leg_sigma = 0.05, gentle_sigma = 0.10;
  };
  LengthModel() : LengthModel(Parameters{}) {}
  explicit LengthModel(const Parameters& parameters) : p_(parameters) {}

  double length_m(const FoundStep& step) const;
  ModelLength estimate(const FoundStep& step) const;

 private:
  double initiation_part(const FoundStep& step) const;
  double relative_rise(const FoundStep& step) const;
  double pace(const FoundStep& step) const;
  double own_sigma(const FoundStep& step) const;
  double common_sigma(const FoundStep& step) const;

  Parameters p_;
};

/// Estimated parameters of a walker: a factor on the model's lengths, an exponent of the cadence in addition to the
/// model's (slope), and the rotation from the steps' heading to the fixes' frame. A Kalman filter uses the displacement
/// vector between fixes, so that a fix off the path is detected. Paths that contradict the estimate are rejected; the
/// next consistent fix closes the path.
class Walker {
 public:
  struct Parameters {
    double factor_sigma = 0.08;                 ///< standard deviation among walkers
    double slope_sigma = 0.55;                  ///< the same of the exponent of the cadence (README)
    double by_own_cadence = 0.8;                ///< exponent of a known walker's cadence above his usual one (README)
    double rotation_drift_rad = 0.0005;         ///< of the headings, rad per sqrt(m)
    double gentle_hand_rad = 0.2;               ///< direction of a phone looked through, against the walk; empirical
    double gentle_hand_m = 5;                   ///< its correlation length; empirical
    double min_path_m = 4.0;                    ///< min path between two fixes used
    double fix_sigmas = 3;                      ///< min path in sigmas of the fixes; empirical
    double gate = 9.0;                          ///< chi-square with two components: rejects 1 % of good paths
    int max_rejected = 3;                       ///< consecutive rejected paths after which the anchor is dropped
    double min_factor = 0.6, max_factor = 1.6;  ///< limits of the walker's factor; empirical
    double max_slope = 1.0;                     ///< limit of its size; empirical
    /// Lower bounds of the standard deviations, since a walker varies during a day; empirical.
    double min_factor_sigma = 0.008, min_slope_sigma = 0.1, min_rotation_sigma_rad = 1e-3;
    /// Lower bounds after loading: another day, other shoes, another pace; empirical.
    double loaded_factor_variance = 4e-4, loaded_slope_variance = 0.01;
  };
  explicit Walker(const Parameters& parameters) : p_(parameters) {
    P_.diagonal() << p_.factor_sigma * p_.factor_sigma, p_.slope_sigma * p_.slope_sigma, 0;
  }

  /// Factor on the model's length of a step of that pace (ModelLength).
  double factor(double pace) const { return factor_ * relative(pace); }
  void set_factor(double factor) { factor_ = factor; }
  /// Relative standard deviation of that factor.
  double factor_sigma(double pace) const;

  void on_step(const ModelLength& length, double heading_rad);
  /// A position in a horizontal frame, with the standard deviation of each component.
  void on_fix(const Eigen::Vector2d& p_n, double sigma_m);

  std::vector<uint8_t> save() const;
  bool load(const uint8_t* data, size_t size);

 private:
  double relative(double pace) const;

  Parameters p_;
  double factor_ = 1.0, slope_ = 0.0, rotation_rad_ = 0;
  double usual_quickness_ = 0;                   ///< mean of the pace above zero, where the factor was estimated
  Eigen::Matrix3d P_ = Eigen::Matrix3d::Zero();  ///< of factor, slope and rotation
  bool has_rotation_ = false;
  // Displacement by the model and the slope since the anchor (the last accepted fix), and its derivative by the slope.
  bool has_anchor_ = false;
  Eigen::Vector2d anchor_ = Eigen::Vector2d::Zero(), path_ = Eigen::Vector2d::Zero(), by_slope_ = path_;
  double anchor_sigma_m_ = 0, walked_m_ = 0, gentle_m_ = 0, own_variance_m2_ = 0, common_sigma_m_ = 0, quickness_m_ = 0;
  int rejected_ = 0;
};

}  // namespace odograph::steps
