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
  /// Logarithms of a step's length relative to a usual one, by its rise, the path's bend, the second harmonic, the leg,
  /// and a quick cadence.
  using Terms = Eigen::Matrix<double, 5, 1>;
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
    double on_leg = -0.12;           ///< logarithm; a leg rises more than the trunk
    double by_own_cadence = 0.8;     ///< exponent of the cadence above slow_hz within a person (Walker)
    /// Lower limit of the cadence: the ratio of length and cadence of still slower walkers grows (Murakami & Otaka, J
    /// Phys Ther Sci 29, 2017).
    double min_cadence_hz = 1.15;
    /// Limits of the terms: rises of 15 to 120 mm, 0.3 rad/s, a harmonic of 0.4; a stranger's quick cadence does not
    /// count.
    Terms least{-0.1525, -0.24, -0.12, -0.12, 0}, most{0.305, 0, 0, 0, 0};
    /// Mean terms of the walkers of the fit, each person once, and the uncertainty of a term relative to its distance
    /// from there: a length is less certain, the less its step resembles those fitted.
    Terms fitted{0.08, -0.08, -0.05, -0.01, 0.08};
    double terms_sigma = 0.4;
    /// The first step after standing is half as long; the deficit decays with the further steps: RIDI's walkers.
    double first_part = 0.5, initiation_steps = 1.3, initiation_sigma = 0.5;  ///< the sigma is relative to the deficit
    double shortest_m = 0.15, longest_m = 1.6;                                ///< limits of a step length; empirical
    double step_sigma = 0.03, per_irregularity = 0.08;  ///< of a single step, and more by 1 - repetition
  };
  LengthModel() : LengthModel(Parameters{}) {}
  explicit LengthModel(const Parameters& parameters) : p_(parameters) {}

  double length_m(const FoundStep& step) const;
  ModelLength estimate(const FoundStep& step) const;

 private:
  double initiation_part(const FoundStep& step) const;
  Terms terms(const FoundStep& step) const;
  double pace(const FoundStep& step) const;
  double own_sigma(const FoundStep& step) const;
  double common_sigma(const FoundStep& step) const;

  Parameters p_;
};

/// Estimated parameters of a walker: a factor on the model's lengths and an exponent of the cadence in addition to the
/// model's (slope). A Kalman filter tracks the walker's position by the steps and by every fix; its other states are
/// the factor and the rotation from the steps' heading to the fixes' frame, as factor times cosine and sine, in which a
/// path is linear, and the slope. Fixes that contradict it are rejected.
class Walker {
 public:
  struct Parameters {
    double factor_sigma = 0.08;  ///< standard deviation among walkers
    double slope_sigma = 0.55;   ///< the same of the exponent of the cadence (README)
    double by_own_cadence = LengthModel::Parameters().by_own_cadence;
    double rotation_drift_rad = 0.0005;  ///< of the headings, rad per sqrt(m)
    double any_rotation = 10;            ///< variance of factor times cosine and sine if the rotation is unknown
    double known_rotation_rad = 0.4;     ///< its standard deviation s, below which the factor counts, which it
                                         ///< makes too large by s^2 / 2: by `factor_sigma`
    double common_m = 30;          ///< distance over which the law's error remains the same; judgement. A camera's few
                                   ///< displacements learn it with the factor: they serve the walk that they come from
    double gentle_hand_rad = 0.2;  ///< direction of a phone looked through, against the walk; empirical
    double gentle_hand_m = 5;      ///< its correlation length; empirical
    double min_path_m = 4.0;       ///< min path between two accumulating fixes
    double min_walked_m = 1;       ///< the same of others: while he stands, a receiver's errors drift
    double fix_sigmas = 3;         ///< the same in sigmas of both; empirical
    double gate = 9.0;             ///< chi-square with two components: rejects 1 % of good fixes
    int max_rejected = 3;          ///< consecutive rejected fixes after which the position is dropped
    double min_factor = 0.6, max_factor = 1.6;  ///< limits of the walker's factor; empirical
    double max_slope = 1.0;                     ///< limit of its size; empirical
    /// Lower bounds of the standard deviations, since a walker varies during a day; empirical.
    double min_factor_sigma = 0.008, min_slope_sigma = 0.1;
    /// Lower bounds after loading: another day, other shoes, another pace; empirical.
    double loaded_factor_variance = 4e-4, loaded_slope_variance = 0.01;
  };
  explicit Walker(const Parameters& parameters) : p_(parameters) {
    walker_.diagonal() << p_.factor_sigma * p_.factor_sigma, p_.slope_sigma * p_.slope_sigma;
  }

  /// Factor on the model's length of a step of that pace (ModelLength).
  double factor(double pace) const { return factor_ * relative(pace); }
  void set_factor(double factor) { factor_ = factor; }
  /// Relative standard deviation of that factor.
  double factor_sigma(double pace) const;

  void on_step(const ModelLength& length, double heading_rad);
  /// A position in a horizontal frame, with the standard deviation of each component. `accumulates`: the error is that
  /// of the previous fix plus an independent one, as of an odometry, so that only displacements count.
  void on_fix(const Eigen::Vector2d& p_n, double sigma_m, bool accumulates = false);

  std::vector<uint8_t> save() const;
  bool load(const uint8_t* data, size_t size);

 private:
  using State = Eigen::Matrix<double, 5, 1>;  ///< factor times cosine and sine of the rotation, slope, position
  using Covariance = Eigen::Matrix<double, 5, 5>;
  double relative(double pace) const;
  void start_at(const Eigen::Vector2d& p_n, double sigma_m);
  void start_path();
  void predict(State& x, Covariance& P, const Eigen::Vector2d& seen_m, double common_m) const;
  void learn();

  Parameters p_;
  double factor_ = 1.0, slope_ = 0.0;
  Eigen::Matrix2d walker_ = Eigen::Matrix2d::Zero();  ///< covariance of factor and slope
  double usual_quickness_ = 0;                        ///< mean of the pace above zero, where the factor was estimated
  double quickness_m_ = 0, quick_walked_m_ = 0;       ///< sum of that pace by distance, since the factor changed
  State x_ = State::Zero();                           ///< at the last fix used
  Covariance P_ = Covariance::Zero();
  bool is_placed_ = false, is_rotated_ = false;  ///< position and rotation are known
  // By the model and the slope since that fix, without the factor: displacement and its derivative by the slope.
  Eigen::Vector2d path_ = Eigen::Vector2d::Zero(), by_slope_ = path_;
  double walked_m_ = 0, gentle_m_ = 0, own_variance_m2_ = 0, common_sigma_m_ = 0;
  int rejected_ = 0;
};

}  // namespace odograph::steps
