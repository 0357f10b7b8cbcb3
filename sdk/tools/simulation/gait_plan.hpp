// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sdk/tools/simulation/random.hpp"
#include "sdk/tools/simulation/route.hpp"
#include "sdk/tools/simulation/scenario.hpp"

namespace odograph {

/// Individual gait parameters, drawn from the seed.
struct Individual {
  Individual(const Scenario& scenario, uint64_t seed);
  double height_m;
  double length_factor;                 ///< individual factor on the step length law for the height
  double asymmetry;                     ///< half the relative difference of left and right steps
  double fatigue_per_km;                ///< relative shortening of steps
  double bounce;                        ///< trunk's rise relative to an inverted pendulum's
  double sway_m, surge_m;               ///< amplitudes
  double limp;                          ///< relative excess of the trunk's rise over one foot
  double shock;                         ///< heel strike at the hand, m/s^2 at 1.35 m/s
  double pitch_rad, yaw_rad, roll_rad;  ///< amplitudes of the phone's rotation with the gait
  double phases[6];
  double tremor;  ///< of the hand, factor
  double hold_height_m, hold_forward_m;
  double step_time_sigma = 0.015, step_length_sigma = 0.02;  ///< step-to-step standard deviation, relative
  double min_rise_m = 0;                                     ///< rise of the trunk for a step of zero length
  double rise_sigma = 0;                                     ///< step-to-step, of the trunk's rise, relative
  double speed_kick = 0.01;                                  ///< step-to-step variation of the speed, relative
  double rocking = 1;  ///< of the phone with the gait, relative to a surveyor's hand
  bool scans = false;  ///< pans the phone while walking

  /// Step length at a speed on horizontal ground, without variation.
  double step_length(double speed_mps) const;

 private:
  void view(uint64_t seed);
};

/// Foot contacts of a walk over time and along the route, and actions while standing.
struct GaitPlan {
  struct Step {
    double t0, t1;  ///< s
    double s0, s1;  ///< along the route, m
    double length_m;
    uint32_t mode;
    double rise = 1;  ///< of the trunk, relative to the usual rise of such a step
  };
  struct Stand {
    double t0, t1;
    std::string what;
  };
  std::vector<Step> steps;
  std::vector<Stand> stands;
  std::vector<std::pair<double, std::string>> carry_changes;  ///< valid from this time on
  std::vector<std::pair<double, double>> roads;               ///< crossed from kerb to kerb: from, to
  std::vector<std::pair<double, double>> darknesses;          ///< from, to
  std::vector<std::pair<double, double>> evasions;            ///< middle, duration
  std::vector<std::pair<double, double>> marks;               ///< time, distance along the route
  struct Facing {
    double t0, t1, yaw_rad;
  };
  std::vector<Facing> facings;  ///< heading of the body relative to the route while walking
  double duration_s = 0;
};

GaitPlan plan_gait(const Scenario& scenario, const Route& route, const Individual& walker, uint64_t seed);

}  // namespace odograph
