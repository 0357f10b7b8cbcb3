// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/simulation/gait_plan.hpp"

#include <algorithm>
#include <cmath>

#include <odograph/types.h>

#include "sdk/math/scalar.hpp"
#include "sdk/tools/simulation/carrying.hpp"

namespace odograph {
namespace {

constexpr double kRunning_mps = 2.2;

double limited(Random& random, double sigma, double most) { return std::clamp(sigma * random.normal(), -most, most); }

bool is_stop(const std::string& what) {
  return what == "stand" || what == "look_around" || what == "handle" || what == "turn" || what == "lift";
}

uint32_t carry_mode(const std::string& carry) {
  if (carry == "swinging") return ODO_MODE_WALKING_SWINGING;
  if (is_covered(carry)) return ODO_MODE_WALKING_POCKET;
  return ODO_MODE_WALKING_TEXTING;
}

/// Generates step after step.
class Feet {
 public:
  Feet(const Scenario& c, const Route& route, const Individual& walker, uint64_t seed)
      : route_(route), walker_(walker), random_(seed, 12), speed_(c.walker.speed_mps), carry_(c.walker.carry) {
    plan.carry_changes.push_back({0.0, carry_});
    stand(c.walker.stand_s, "stand");
  }

  GaitPlan plan;

  void stand(double duration, const std::string& what) {
    plan.stands.push_back({t_, t_ + duration, what});
    t_ += duration;
  }
  void carry(const std::string& how) { plan.carry_changes.push_back({t_, carry_ = how}); }
  void mark(double ago) { plan.marks.push_back({t_ - ago, s_}); }
  void evade(double duration) { plan.evasions.push_back({t_ + 0.5 * duration, duration}); }
  void darken(double duration) { plan.darknesses.push_back({t_, t_ + duration}); }
  void cross(double duration) { plan.roads.push_back({t_, t_ + duration}); }
  void set_speed(double speed) { speed_ = speed; }
  void shuffle(double duration) { shuffle_until_ = t_ + duration; }
  void sidestep(double duration) {
    side_until_ = t_ + duration;
    plan.facings.push_back({t_, t_ + duration, random_.uniform() < 0.5 ? -kPi / 2 : kPi / 2});
  }
  void backwards(double duration) {
    backwards_until_ = t_ + duration;
    plan.facings.push_back({t_, t_ + duration, kPi});
  }

  /// Walks to a distance along the route; stops there, or passes.
  void walk_to(double s_end, bool stops) {
    int since_start = rests_ ? 0 : 2;
    while (s_ < s_end - 1e-6) {
      const bool shuffles = t_ < shuffle_until_;
      speed_variation_ += -0.05 * speed_variation_ + walker_.speed_kick * random_.normal();
      double speed = speed_ * (1 + speed_variation_);
      if (since_start == 0) speed *= 0.6;
      if (since_start == 1) speed *= 0.85;
      const double slope = route_.at(s_).slope;
      const bool stairs = std::abs(slope) > 0.2;
      const bool back = t_ < backwards_until_, aside = t_ < side_until_;
      if (back) speed *= 0.6;
      double nominal = (back ? 0.8 : 1.0) * walker_.step_length(speed);
      if (stairs) nominal = 0.29, speed = std::min(speed, 0.5);  // one step per tread
      if (shuffles) nominal = random_.uniform(0.12, 0.28), speed = nominal * random_.uniform(1.1, 1.8);
      if (aside) nominal = random_.uniform(0.18, 0.32), speed = nominal * random_.uniform(1.0, 1.5);
      const double period =
          nominal / speed * (1 + limited(random_, walker_.step_time_sigma, 3 * walker_.step_time_sigma));
      double length = nominal * (1 + limited(random_, walker_.step_length_sigma, 3 * walker_.step_length_sigma)) *
                      (left_ ? 1 + walker_.asymmetry : 1 - walker_.asymmetry);
      if (!stairs) length *= walker_.length_factor * (1 - walker_.fatigue_per_km * s_ * 1e-3);
      const double left = s_end - s_;
      double time = period;
      if (stops && left < 2.6 * length) {  // the last steps fit the remaining distance
        const double n = left < 1.15 * length ? 1 : left < 2.1 * length ? 2 : 3;
        time *= left / n < 0.75 * length ? 1.12 : 1.0;
        length = left / n;
      }
      const uint32_t mode = stairs ? ODO_MODE_STAIRS : speed > kRunning_mps ? ODO_MODE_RUNNING : carry_mode(carry_);
      const double rise =
          walker_.rise_sigma > 0 ? 1 + limited(random_, walker_.rise_sigma, 3 * walker_.rise_sigma) : 1.0;
      plan.steps.push_back({t_, t_ + time, s_, s_ + length, length, mode, rise});
      t_ += time;
      s_ += length;
      left_ = !left_;
      ++since_start;
    }
    rests_ = stops;
  }

  void finish(double duration) {
    stand(duration, "stand");
    plan.duration_s = t_;
  }
  double s() const { return s_; }

 private:
  const Route& route_;
  const Individual& walker_;
  Random random_;
  double speed_, speed_variation_ = 0, t_ = 0, s_ = 0, shuffle_until_ = -1, side_until_ = -1, backwards_until_ = -1;
  std::string carry_;
  bool left_ = true, rests_ = true;
};

}  // namespace

Individual::Individual(const Scenario& c, uint64_t seed) : height_m(c.walker.height_m) {
  Random random(seed, 11);
  length_factor = 1 + limited(random, 0.04, 0.10);
  asymmetry = limited(random, 0.012, 0.03);
  fatigue_per_km = random.uniform(0.0, 0.03);
  bounce = random.uniform(0.55, 0.95);
  sway_m = random.uniform(0.012, 0.026);
  surge_m = random.uniform(0.006, 0.013);
  shock = random.uniform(1.8, 4.4);
  pitch_rad = random.uniform(0.045, 0.09), yaw_rad = random.uniform(0.055, 0.12),
  roll_rad = random.uniform(0.015, 0.04);
  for (double& phase : phases) phase = random.uniform(0, 2 * kPi);
  tremor = random.uniform(0.6, 1.6);
  hold_height_m = height_m * random.uniform(0.68, 0.82);
  hold_forward_m = random.uniform(0.25, 0.40);
  limp = random.uniform(0.15, 0.27);
  if (c.walker.gait == "viewing") view(seed);
}

/// Slow walkers: the trunk rises by 2.7 cm (sd 0.5) at 0.7 m/s, two thirds of an inverted pendulum's rise, and sways
/// laterally by 7.0 cm (1.3) (Orendurff et al., J Rehabil Res Dev 41, 2004); knees and arms that steady the picture
/// leave half of the rise; step time varies about twice as much as for brisk walkers (Beauchet et al., J Neuroeng
/// Rehabil 6, 2009).
void Individual::view(uint64_t seed) {
  Random random(seed, 13);
  bounce = random.uniform(0.25, 0.65);
  sway_m = random.uniform(0.025, 0.045);
  shock *= random.uniform(0.2, 0.5);
  rocking = random.uniform(0.25, 0.6);
  hold_height_m = height_m * random.uniform(0.80, 0.90);
  hold_forward_m = random.uniform(0.30, 0.50);
  step_time_sigma = 0.03, step_length_sigma = 0.04, rise_sigma = 0.15;
  speed_kick = 0.03;
  min_rise_m = 0.010;
  scans = true;
}

double Individual::step_length(double speed_mps) const {
  return 0.75 * (height_m / 1.75) * std::pow(speed_mps / 1.4, 0.42);
}

GaitPlan plan_gait(const Scenario& c, const Route& route, const Individual& walker, uint64_t seed) {
  Feet feet(c, route, walker, seed);
  auto events = c.events;
  std::stable_sort(events.begin(), events.end(), [](const auto& a, const auto& b) { return a.at_m < b.at_m; });
  const double finish = std::min(route.length(), c.walk_m);
  for (const auto& e : events) {
    if (e.at_m > finish) break;
    feet.walk_to(e.at_m, is_stop(e.what));
    if (e.waypoint && !is_stop(e.what)) feet.mark(0);
    if (is_stop(e.what)) {
      feet.stand(e.for_s, e.what);
      if (e.waypoint) feet.mark(0.5 * e.for_s);
    } else if (is_carry(e.what)) {
      feet.carry(e.what);
    } else if (e.what == "evade") {
      feet.evade(e.for_s);
    } else if (e.what == "cross") {
      feet.cross(e.for_s);
    } else if (e.what == "dark") {
      feet.darken(e.for_s);
    } else if (e.what == "shuffle") {
      feet.shuffle(e.for_s);
    } else if (e.what == "sidestep") {
      feet.sidestep(e.for_s);
    } else if (e.what == "backwards") {
      feet.backwards(e.for_s);
    } else if (e.what == "speed") {
      feet.set_speed(e.speed_mps);
    }
  }
  feet.walk_to(finish, true);
  feet.finish(c.walker.stand_s);
  return std::move(feet.plan);
}

}  // namespace odograph
