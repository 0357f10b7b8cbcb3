// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "plugins/step/odograph/step_finder.hpp"

namespace odograph::steps {

/// How the phone is carried.
enum class Carry : uint32_t { texting, swinging, pocket, running };

/// Step length: of a vivid walk a linear law of how much the phone rises and falls with the step, of the cadence and of
/// how well the walk repeats itself from stride to stride. Whoever walks straight on at his own pace repeats himself
/// and takes long steps; who sets out, turns, evades or strolls does not (regularity grows with speed: Moe-Nilssen &
/// Helbostad, J Biomechanics 37, 2004). A hand, a strap or cloth softens the bounce by an amount that nobody knows, so
/// the rise counts for little where it is small, and the less the quicker the steps are; and a hand that rocks adds a
/// rise of its own, which a leg that rotates as much does not: there little of the power is vertical.
/// Of gentle steps the rise tells less, because knees and arms soften it, and the cadence more: L = a v^0.42 with
/// v = L f (Grieve & Gear, Ergonomics 1966; down to 0.1 m/s by Wu et al., Scientific Reports 2019) is
/// L = (a f^0.42)^(1 / 0.58). Where the numbers come from is said in the README.
struct LengthModel {
  double usual_m = 0.638;  ///< with the usual rise, cadence and repetition
  double per_rise = 4.37, per_cadence_and_rise = -3.9, per_repetition = 0.20;  ///< m/m, 1/Hz, m
  double per_rocking_and_rise = -1.75;                                         ///< s
  double usual_rise_m = 0.03, usual_cadence_hz = 1.8, usual_repetition = 0.85, usual_radps = 0.5, usual_part = 0.6;
  /// Beyond, cadence, rise and rotation are those of nobody fitted.
  double slowest_hz = 1.4, quickest_hz = 2.3, highest_m = 0.06, calmest_radps = 0.2, wildest_radps = 1.4;
  /// Whoever sets out takes half a step first; the rest is made up for with each further one: RIDI's walkers (README).
  double first_part = 0.5, setting_out_steps = 1.3, setting_out_sigma = 0.5;  ///< the last of what is missing
  double at_one_mps_m = 0.632, by_speed = 0.42;  ///< a, for a height of 1.70 m, and its exponent
  double per_root_gentle_rise = 4.0;             ///< m for a root of a metre: l = 0.90 m, knees and arms take 55 %
  double part_of_rise = 0.45;                    ///< of the gentle step's logarithm
  double gentle_factor = 0.965;                  ///< gentle walkers take small steps among the others
  double shortest_m = 0.15, longest_m = 1.6;     ///< of a step, whatever the model says; judgement
  double min_rise_m = 0.001;                     ///< of a gentle step: less is the sensor's noise
  /// Standard deviation of one step, as a part of it: of people who were left out of the fit, by the repetition.
  double regular_sigma = 0.03, per_irregularity = 0.20, gentle_sigma = 0.30;

  double length_m(const FoundStep& step) const;
  double own_sigma(const FoundStep& step) const;

 private:
  double setting_out_part(const FoundStep& step) const;
};

/// What is learnt of a walker: one factor on the model's lengths, another one on gentle steps beside it, and the
/// rotation between the steps' headings and the fixes' frame, by a Kalman filter on the path from fix to fix as a
/// vector, so that a fix that lies beside the path betrays itself. Paths that contradict what is known are not
/// believed; a path is closed by the next fix that fits.
class Walker {
 public:
  struct Parameters {
    double factor_sigma = 0.08;          ///< how much walkers differ
    double gentle_ratio_sigma = 0.20;    ///< how much one's gentle steps differ from that: the walk ratio L / f of slow
                                         ///< walkers scatters so (Murakami & Otaka 2017)
    double rotation_drift_rad = 0.0005;  ///< of the headings, for the root of a metre
    double gentle_hand_rad = 0.2;        ///< of who looks through the phone, against where he goes; judgement
    double gentle_hand_m = 5;            ///< for so long that is the same; judgement
    double min_path_m = 4.0;             ///< between two fixes that teach something
    double fix_sigmas = 3;  ///< of the fixes' own errors, that the path must be longer than as well; judgement
    double gate = 9.0;      ///< of an innovation squared, two components: 1 % of good paths
    int believe_after = 3;  ///< paths in a row that contradict what is known, but not each other's anchor
    double min_factor = 0.6, max_factor = 1.6;              ///< of the walker; judgement
    double min_gentle_ratio = 0.5, max_gentle_ratio = 1.6;  ///< judgement
    /// Standard deviations that no fix makes smaller: a walker is not the same all day; judgement.
    double min_factor_sigma = 0.008, min_gentle_sigma = 0.05, min_rotation_sigma_rad = 1e-3;
    /// At least, of what was saved: another day, other shoes, another hurry; judgement.
    double loaded_factor_variance = 4e-4, loaded_gentle_variance = 0.01;
  };
  explicit Walker(const Parameters& parameters) : p_(parameters) {
    P_.diagonal() << p_.factor_sigma * p_.factor_sigma, p_.gentle_ratio_sigma * p_.gentle_ratio_sigma, 0;
  }

  double factor() const { return factor_; }
  void set_factor(double factor) { factor_ = factor; }
  /// Of gentle steps, beside `factor`.
  double gentle_ratio() const { return gentle_ratio_; }
  /// Of a step of that length: the walker's part, common to all steps, and the step's own, a part of its length. m
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
  // Since the anchor, the last fix that was believed: what the model makes of the steps, gentle ones by themselves.
  bool has_anchor_ = false;
  Eigen::Vector2d anchor_ = Eigen::Vector2d::Zero(), path_ = Eigen::Vector2d::Zero(),
                  gentle_path_ = Eigen::Vector2d::Zero();
  double anchor_sigma_m_ = 0, walked_m_ = 0, gentle_m_ = 0, own_variance_m2_ = 0;
  int doubted_ = 0;
};

}  // namespace odograph::steps
