// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/simulation/walker.hpp"

#include <algorithm>
#include <cmath>

#include <odograph/types.h>

#include "sdk/math/scalar.hpp"
#include "sdk/tools/simulation/carrying.hpp"
#include "sdk/tools/simulation/gait_plan.hpp"
#include "sdk/tools/simulation/signal.hpp"

namespace odograph {
namespace {

using Eigen::Vector3d;

constexpr double kRate_hz = 400.0;  // of the control points: heel shocks ring at 15 to 25 Hz
constexpr double kKerb_m = 0.12;

/// Motion components of body and hand, sampled at kRate_hz.
class Body {
 public:
  Body(const Scenario& c, const Route& route, const Individual& walker, const GaitPlan& plan, uint64_t seed)
      : c_(c),
        route_(route),
        walker_(walker),
        plan_(plan),
        seed_(seed),
        n_(static_cast<size_t>(std::ceil(plan.duration_s * kRate_hz)) + 1) {}

  Journey walk() {
    feet();
    trunk();
    hand();
    Journey walk;
    walk.phone = Motion(kRate_hz, std::move(p_), std::move(q_));
    for (const auto& s : plan_.steps) walk.steps.push_back({s.t0, s.t1, s.length_m, s.mode});
    walk.modes = modes();
    for (size_t k = 0; k < plan_.carry_changes.size(); ++k)
      if (is_covered(plan_.carry_changes[k].second))
        walk.covers.push_back({plan_.carry_changes[k].first, k + 1 < plan_.carry_changes.size()
                                                                 ? plan_.carry_changes[k + 1].first
                                                                 : plan_.duration_s + 1});
    for (const auto& [from, to] : plan_.darknesses) walk.covers.push_back({from, to});
    for (const auto& [t, s] : plan_.marks) {
      const auto place = route_.at(s);
      walk.waypoints.push_back({t, {place.north_east.x(), place.north_east.y(), -place.up}});
    }
    return walk;
  }

 private:
  double time(size_t i) const { return static_cast<double>(i) / kRate_hz; }
  size_t sample(double t) const {
    return std::min(n_ - 1, static_cast<size_t>(std::max(0.0, std::round(t * kRate_hz))));
  }

  /// Distance along the route, phase (integers at foot contacts) and strength of the gait.
  void feet() {
    distance_ = Signal(n_), phase_ = Signal(n_), bounce_ = Signal(n_), vigour_ = Signal(n_);
    double s = 0, phase = 0;
    size_t done = 0;
    double limp = walker_.limp;
    const auto fill = [&](double to) {
      for (; done < n_ && time(done) < to; ++done) distance_[done] = s, phase_[done] = phase;
    };
    for (const auto& step : plan_.steps) {
      fill(step.t0);
      for (; done < n_ && time(done) < step.t1; ++done) {
        const double x = (time(done) - step.t0) / (step.t1 - step.t0);
        distance_[done] = step.s0 + x * (step.s1 - step.s0);
        phase_[done] = phase + x;
        const double leg = 0.53 * walker_.height_m, half = std::min(0.5 * step.length_m, 0.6 * leg);
        const double pendulum = walker_.bounce * (leg - std::sqrt(leg * leg - half * half));
        bounce_[done] =
            (1 + limp) * step.rise * (step.mode == ODO_MODE_RUNNING ? 0.05 : std::max(walker_.min_rise_m, pendulum));
        vigour_[done] = step.length_m / 0.7;
      }
      s = step.s1;
      limp = -limp;
      phase += 1;
    }
    fill(plan_.duration_s + 1);
    smooth(distance_, 0.13, kRate_hz), smooth(phase_, 0.025, kRate_hz);
    for (double& b : bounce_) b *= c_.walker.bounce;
    smooth(bounce_, 0.16, kRate_hz), smooth(vigour_, 0.16, kRate_hz);
  }

  /// Position of the trunk (at the phone's height above the ground) and heading of the body.
  void trunk() {
    heading_ = Signal(n_), lateral_ = Signal(n_);
    Signal north(n_), east(n_), up(n_);
    for (size_t i = 0; i < n_; ++i) {
      const auto place = route_.at(distance_[i]);
      north[i] = place.north_east.x(), east[i] = place.north_east.y(), up[i] = place.up, heading_[i] = place.heading;
    }
    for (const auto& [from, to] : plan_.roads)
      for (size_t i = sample(from); i < sample(to); ++i) up[i] -= kKerb_m;
    ride(up);
    smooth(north, 0.25, kRate_hz), smooth(east, 0.25, kRate_hz), smooth(up, 0.12, kRate_hz);
    smooth(heading_, 0.30, kRate_hz);
    add_gauss_markov(lateral_, Random(seed_, 21), 8.0, 0.18, kRate_hz);
    for (size_t i = 0; i < n_; ++i) lateral_[i] *= c_.walker.weave * std::min(1.0, distance_[i] / 4.0);
    Random side(seed_, 22);
    for (const auto& [middle, duration] : plan_.evasions) {
      const double reach = (side.uniform() < 0.5 ? -1 : 1) * side.uniform(0.5, 0.9);
      for (size_t i = sample(middle - duration); i < sample(middle + duration); ++i)
        lateral_[i] += reach * std::exp(-0.5 * std::pow((time(i) - middle) / (0.22 * duration), 2));
    }
    smooth(lateral_, 0.4, kRate_hz);
    looks();
    Signal aside(n_), sway_noise(n_), nod(n_);
    add_gauss_markov(sway_noise, Random(seed_, 23), 1.2, 0.004, kRate_hz);
    add_gauss_markov(nod, Random(seed_, 24), 1.2, 0.004, kRate_hz);
    smooth(sway_noise, 0.12, kRate_hz),
        smooth(nod, 0.12, kRate_hz);  // a Gauss-Markov process alone has no finite acceleration
    base_.resize(n_);
    for (size_t i = 0; i < n_; ++i) {
      const double h = heading_[i], ph = phase_[i], sway = c_.walker.sway;
      const double forward = sway * walker_.surge_m * vigour_[i] * std::sin(2 * kPi * ph + 0.8) + nod[i];
      const double right =
          lateral_[i] + sway_noise[i] + sway * walker_.sway_m * std::min(vigour_[i], 1.2) * std::sin(kPi * ph);
      const double rise =
          -0.5 * bounce_[i] * (std::cos(2 * kPi * ph) + 0.18 * std::cos(4 * kPi * ph + walker_.phases[0]));
      base_[i] = {north[i] + forward * std::cos(h) - right * std::sin(h),
                  east[i] + forward * std::sin(h) + right * std::cos(h), -(up[i] + rise)};
    }
  }

  /// Lifts: up to 1.6 m/s, reached within 2 s, doors for 2 s before and after; every other ride goes down.
  void ride(Signal& up) const {
    constexpr double kDoors_s = 2, kFastest_mps = 1.6, kPull_mps2 = 0.8;
    double floor_m = 0, direction = 1;
    size_t done = 0;
    const auto fill = [&](size_t to) {
      for (; done < to; ++done) up[done] += floor_m;
    };
    for (const auto& stand : plan_.stands) {
      if (stand.what != "lift") continue;
      const double from = stand.t0 + kDoors_s, to = stand.t1 - kDoors_s;
      fill(sample(from));
      for (; done < sample(to); ++done) {
        const double speed = std::min({kFastest_mps, kPull_mps2 * (time(done) - from), kPull_mps2 * (to - time(done))});
        floor_m += direction * std::max(0.0, speed) / kRate_hz;
        up[done] += floor_m;
      }
      direction = -direction;
    }
    fill(n_);
  }

  /// Heel strikes: a damped oscillation, up and backwards.
  void shocks() {
    Random random(seed_, 25);
    for (const auto& step : plan_.steps) {
      const double f = random.uniform(14, 22), w = 2 * kPi * f, decay = 0.035;
      const double strength = (step.mode == ODO_MODE_RUNNING ? 3.0 : 1.0) * walker_.shock * random.uniform(0.7, 1.3) *
                              step.length_m / std::max(0.2, step.t1 - step.t0) / 1.35;
      const Vector3d direction(-0.35 * std::cos(heading_[sample(step.t0)]), -0.35 * std::sin(heading_[sample(step.t0)]),
                               -1.0);
      for (size_t i = sample(step.t0); i < sample(step.t0 + 8 * decay); ++i) {
        const double age = time(i) - step.t0, rise = 1 - std::exp(-std::pow(age / 0.008, 2));
        base_[i] += strength / (w * w) * rise * std::exp(-age / decay) * std::sin(w * age) * direction;
      }
    }
  }

  /// Standing, looking around, turning in place: body heading relative to the route.
  void looks() {
    Random random(seed_, 26);
    look_yaw_ = Signal(n_), look_pitch_ = Signal(n_), gesture_ = Signal(n_);
    for (const auto& stand : plan_.stands) {
      const size_t from = sample(stand.t0 + 0.5), to = sample(stand.t1 - 0.5);
      if (stand.what == "look_around") {
        for (double t = stand.t0 + 0.5; t < stand.t1 - 1.0;) {
          const double next = std::min(t + random.uniform(1.2, 3.0), stand.t1 - 0.7);
          const double yaw = random.uniform(-1.1, 1.1), pitch = random.uniform(-0.25, 0.35);
          for (size_t i = sample(t); i < sample(next); ++i) look_yaw_[i] = yaw, look_pitch_[i] = pitch;
          t = next + 1e-3;
        }
      } else if (stand.what == "turn") {
        const double whole = random.uniform() < 0.5 ? -2 * kPi : 2 * kPi;
        for (size_t i = from; i < n_; ++i)
          look_yaw_[i] += whole * std::min(1.0, (static_cast<double>(i) - static_cast<double>(from)) /
                                                    std::max(1.0, static_cast<double>(to) - static_cast<double>(from)));
      } else if (stand.what == "handle") {
        for (size_t i = from; i < to; ++i) gesture_[i] = 1;
      }
    }
    for (const auto& f : plan_.facings)
      for (size_t i = sample(f.t0); i < sample(f.t1); ++i) look_yaw_[i] += f.yaw_rad;
    if (walker_.scans) scan();
    smooth(look_yaw_, 0.35, kRate_hz), smooth(look_pitch_, 0.35, kRate_hz), smooth(gesture_, 0.3, kRate_hz);
  }

  /// A viewer pans the phone from one object to the next while walking.
  void scan() {
    Random random(seed_, 28);
    for (double t = 0; t < plan_.duration_s;) {
      const double next = t + random.uniform(1.5, 5.0);
      const double yaw = random.uniform() < 0.4 ? 0.0 : random.uniform(-0.7, 0.7), pitch = random.uniform(-0.2, 0.2);
      for (size_t i = sample(t); i < sample(next); ++i) look_yaw_[i] += yaw, look_pitch_[i] += pitch;
      t = next;
    }
  }

  /// Pose of the phone relative to the trunk, and hand motion.
  void hand() {
    Signal swing(n_), pocket(n_), leg(n_), bag(n_);
    for (size_t k = 0; k < plan_.carry_changes.size(); ++k) {
      const size_t to = k + 1 < plan_.carry_changes.size() ? sample(plan_.carry_changes[k + 1].first) : n_;
      for (size_t i = sample(plan_.carry_changes[k].first); i < to; ++i) {
        swing[i] = plan_.carry_changes[k].second == "swinging";
        pocket[i] = plan_.carry_changes[k].second == "pocket";
        leg[i] = plan_.carry_changes[k].second == "leg", bag[i] = plan_.carry_changes[k].second == "bag";
      }
    }
    for (Signal* part : {&swing, &pocket, &leg, &bag}) smooth(*part, 0.4, kRate_hz);
    Signal drift[6], shake[6], wave[6];
    for (size_t k = 0; k < 6; ++k) {
      drift[k] = Signal(n_), shake[k] = Signal(n_), wave[k] = Signal(n_);
      add_gauss_markov(drift[k], Random(seed_, 30 + k), 2.5, k < 3 ? 0.006 : 0.016, kRate_hz);
      add_narrow_band(shake[k], Random(seed_, 40 + k), 8.5, 0.25, walker_.tremor * (k < 3 ? 6e-5 : 9e-4), kRate_hz);
      add_narrow_band(wave[k], Random(seed_, 50 + k), 1.3, 0.5, k < 3 ? 0.02 : 0.09, kRate_hz);
      smooth(drift[k], 0.15, kRate_hz), smooth(wave[k], 0.06, kRate_hz), smooth(shake[k], 0.012, kRate_hz);
    }
    hang();
    shocks();
    Eigen::Matrix3d axes;  // columns: the body's x, y, z in the forward-right-down frame of an upright phone
    axes << 0, 0, -1, 1, 0, 0, 0, -1, 0;
    const Eigen::Quaterniond upright(axes);
    Random strap(seed_, 29);
    const double strap_m = strap.uniform(0.35, 0.55), damping = strap.uniform(0.08, 0.2);
    const Bag swaying(base_, heading_, strap_m, damping, kRate_hz);
    p_.resize(n_), q_.resize(n_);
    for (size_t i = 0; i < n_; ++i) {
      const double v = std::min(vigour_[i], 1.3), ph = phase_[i], rocking = c_.walker.rocking * walker_.rocking * v;
      const auto other = [&](size_t k) { return drift[k][i] + shake[k][i] + gesture_[i] * wave[k][i]; };
      const double arm = 0.38 * walker_.height_m, angle = 0.35 * v * std::sin(kPi * ph + 0.3) - 0.05;
      const Vector3d text(walker_.hold_forward_m, 0, -walker_.hold_height_m);
      const Vector3d swung(arm * std::sin(angle), 0.22, -0.80 * walker_.height_m + arm * std::cos(angle));
      const Vector3d pocketed(0.10 + 0.06 * v * std::sin(kPi * ph), 0.18, -0.48 * walker_.height_m);
      const double s = swing[i], k = pocket[i], held = std::max(0.0, 1 - s - k - leg[i] - bag[i]);
      const CarriedPose thigh = on_leg(ph, v, walker_.height_m), bagged = swaying.at(i, walker_.height_m);
      const double facing = heading_[i] + look_yaw_[i] + c_.camera.facing_rad;
      Vector3d offset = held * text + s * swung + k * pocketed + leg[i] * thigh.offset + bag[i] * bagged.offset;
      offset += Vector3d(other(0), other(1), other(2));
      p_[i] = base_[i] + Eigen::AngleAxisd(facing, Vector3d::UnitZ()) * offset;
      const double yaw = facing + walker_.yaw_rad * rocking * std::sin(kPi * ph + walker_.phases[1]) + other(3);
      const double pitch = held * (c_.camera.pitch_rad + look_pitch_[i]) + s * (-1.1 + angle) +
                           k * (0.1 + 0.35 * v * std::sin(kPi * ph)) +  // the thigh
                           leg[i] * thigh.pitch_rad + bag[i] * bagged.pitch_rad +
                           walker_.pitch_rad * rocking * std::sin(2 * kPi * ph + walker_.phases[2]) + other(4);
      const double roll = s * 0.4 + k * 2.8 +  // top down in the pocket
                          leg[i] * thigh.roll_rad + bag[i] * bagged.roll_rad +
                          walker_.roll_rad * rocking * std::sin(kPi * ph + walker_.phases[3]) + other(5);
      q_[i] = Eigen::AngleAxisd(yaw, Vector3d::UnitZ()) * Eigen::AngleAxisd(pitch, Vector3d::UnitY()) *
              Eigen::AngleAxisd(roll, Vector3d::UnitX()) * upright;
      if (i > 0 && q_[i].dot(q_[i - 1]) < 0) q_[i].coeffs() *= -1;
    }
  }

  /// The arm as a damped spring between trunk and phone: it follows the trunk's motion with a delay and some overshoot.
  void hang() {
    Random random(seed_, 27);
    const double frequency_hz = random.uniform(3.2, 5.0);
    follow_by_spring(base_, frequency_hz, random.uniform(0.45, 0.75), kRate_hz);
  }

  std::vector<Journey::Mode> modes() const {
    std::vector<Journey::Mode> modes;
    const auto add = [&](double t, uint32_t mode) {
      if (modes.empty() || modes.back().mode != mode) modes.push_back({t, mode});
    };
    size_t stand = 0;
    for (size_t k = 0; k <= plan_.steps.size(); ++k) {
      const double until = k < plan_.steps.size() ? plan_.steps[k].t0 : plan_.duration_s;
      for (; stand < plan_.stands.size() && plan_.stands[stand].t0 <= until + 1e-9; ++stand)
        add(plan_.stands[stand].t0, plan_.stands[stand].what == "stand" || plan_.stands[stand].what == "lift"
                                        ? ODO_MODE_STATIC
                                        : ODO_MODE_HANDLING);
      if (k < plan_.steps.size()) add(plan_.steps[k].t0, plan_.steps[k].mode);
    }
    return modes;
  }

  const Scenario& c_;
  const Route& route_;
  const Individual& walker_;
  const GaitPlan& plan_;
  const uint64_t seed_;
  const size_t n_;
  Signal distance_, phase_, bounce_, vigour_, heading_, lateral_, look_yaw_, look_pitch_, gesture_;
  std::vector<Vector3d> base_, p_;
  std::vector<Eigen::Quaterniond> q_;
};

}  // namespace

Journey make_walk(const Scenario& scenario, uint64_t seed) {
  return make_walk(scenario, Route(scenario.route, scenario.corner_m), seed);
}

Journey make_walk(const Scenario& scenario, const Route& route, uint64_t seed) {
  const Individual walker(scenario, seed);
  const GaitPlan plan = plan_gait(scenario, route, walker, seed);
  return Body(scenario, route, walker, plan, seed).walk();
}

}  // namespace odograph
