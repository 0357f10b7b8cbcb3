// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sdk/tools/simulation/random.hpp"
#include "sdk/tools/simulation/route.hpp"
#include "sdk/tools/simulation/scenario.hpp"

namespace odograph {

/// What the seed draws of a person.
struct Individual {
  Individual(const Scenario& scenario, uint64_t seed);
  double height_m;
  double length_factor;                 ///< own deviation from the law of his height
  double asymmetry;                     ///< a left step is longer than a right one by twice this fraction
  double fatigue_per_km;                ///< fraction by which steps shorten
  double bounce;                        ///< trunk's rise as a fraction of an inverted pendulum's
  double sway_m, surge_m;               ///< amplitudes
  double limp;                          ///< the trunk's rise is higher by this fraction over one foot than the mean
  double shock;                         ///< heel strike at the hand, m/s^2 at 1.35 m/s
  double pitch_rad, yaw_rad, roll_rad;  ///< amplitudes of the phone's turning with the gait
  double phases[6];
  double tremor;  ///< of the hand, factor
  double hold_height_m, hold_forward_m;
  double step_time_sigma = 0.015, step_length_sigma = 0.02;  ///< from step to step, as a part of it
  double min_rise_m = 0;                                     ///< a step of no length lifts the trunk by that much
  double rise_sigma = 0;                                     ///< of the trunk's rise, the same
  double speed_kick = 0.01;                                  ///< the speed's wander from step to step, as a part of it
  double rocking = 1;  ///< of the phone with the gait, over that of a surveyor's hand
  bool scans = false;  ///< turns the phone to and fro while walking

  /// Step length at a speed, on level ground, without variation.
  double step_length(double speed_mps) const;

 private:
  void view(uint64_t seed);
};

/// The feet's part of a walk: steps in time and along the route, and what is done while standing.
struct GaitPlan {
  struct Step {
    double t0, t1;  ///< s
    double s0, s1;  ///< along the route, m
    double length_m;
    uint32_t mode;
    double rise = 1;  ///< of the trunk, over the usual of such a step
  };
  struct Stand {
    double t0, t1;
    std::string what;
  };
  std::vector<Step> steps;
  std::vector<Stand> stands;
  std::vector<std::pair<double, std::string>> carries;  ///< from this time on
  std::vector<std::pair<double, double>> roads;         ///< crossed from kerb to kerb: from, to
  std::vector<std::pair<double, double>> darknesses;    ///< from, to
  std::vector<std::pair<double, double>> evasions;      ///< middle, duration
  std::vector<std::pair<double, double>> marks;         ///< time, distance along the route
  struct Facing {
    double t0, t1, yaw_rad;
  };
  std::vector<Facing> facings;  ///< while walking, the body faces that far off the route's direction
  double duration_s = 0;
};

GaitPlan plan_gait(const Scenario& scenario, const Route& route, const Individual& who, uint64_t seed);

}  // namespace odograph
