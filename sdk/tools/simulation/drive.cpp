// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/simulation/drive.hpp"

#include <algorithm>
#include <cmath>

#include <odograph/types.h>

#include "sdk/math/scalar.hpp"
#include "sdk/tools/simulation/signal.hpp"

namespace odograph {
namespace {

using Eigen::Vector3d;

constexpr double kDrive_hz = 400.0;
constexpr double kCell_m = 0.25;                              // of the speed profile
constexpr double kBrake = 2.0, kPull = 1.5, kSideways = 2.0;  // m/s^2
constexpr double kBumpSpeed = 4.5, kBumpLength_m = 0.9, kBumpHeight_m = 0.06, kWheelbase_m = 2.7;

struct Stop {
  double at_m, for_s;
  bool waypoint;
};

Signal derivative(const Signal& s) {
  Signal d(s.size(), 0.0);
  for (size_t i = 1; i + 1 < s.size(); ++i) d[i] = 0.5 * kDrive_hz * (s[i + 1] - s[i - 1]);
  return d;
}

class Car {
 public:
  Car(const Scenario& c, const Route& route, uint64_t seed)
      : c_(c), route_(route), seed_(seed), end_m_(std::min(route.length(), c.walk_m)) {
    for (const auto& e : c.events) {
      if (e.at_m >= end_m_) continue;
      if (e.what == "stand") stops_.push_back({e.at_m, e.for_s, e.waypoint});
      if (e.what == "bump") bumps_.push_back(e.at_m);
    }
    std::sort(stops_.begin(), stops_.end(), [](const Stop& a, const Stop& b) { return a.at_m < b.at_m; });
    stops_.push_back({end_m_, c.walker.stand_s, false});
  }

  Journey drive() {
    plan_speed();
    roll();
    Journey journey;
    journey.phone = ride();
    journey.waypoints = marks_;
    journey.modes = {{0.0, ODO_MODE_UNKNOWN}};
    return journey;
  }

 private:
  /// Maximum speed at every cell of the route, from limits, bends, stops and the car's acceleration.
  void plan_speed() {
    const auto cells = static_cast<size_t>(std::ceil(end_m_ / kCell_m)) + 1;
    speed_.assign(cells, 0);
    for (size_t i = 0; i < cells; ++i) {
      const double s = static_cast<double>(i) * kCell_m;
      double limit = c_.vehicle.speed_mps, since = -1;
      for (const auto& e : c_.events)
        if (e.what == "speed" && e.at_m <= s && e.at_m > since) limit = e.speed_mps, since = e.at_m;
      if (const double k = std::abs(route_.curvature_at(s)); k > 1e-6)
        limit = std::min(limit, std::sqrt(kSideways / k));
      for (const double bump : bumps_)
        if (std::abs(s - bump) < 2.5) limit = std::min(limit, kBumpSpeed);
      speed_[i] = limit;
    }
    speed_[0] = 0;
    for (const Stop& stop : stops_) speed_[std::min(cells - 1, cell(stop.at_m))] = 0;
    for (size_t i = 1; i < cells; ++i)
      speed_[i] = std::min(speed_[i], std::sqrt(speed_[i - 1] * speed_[i - 1] + 2 * kPull * kCell_m));
    for (size_t i = cells - 1; i-- > 0;)
      speed_[i] = std::min(speed_[i], std::sqrt(speed_[i + 1] * speed_[i + 1] + 2 * kBrake * kCell_m));
  }
  static size_t cell(double s) { return static_cast<size_t>(std::llround(s / kCell_m)); }

  /// Converts speeds along the route to distance over time.
  void roll() {
    std::vector<std::pair<double, double>> course;  // time, distance
    double t = c_.walker.stand_s;
    course.emplace_back(0.0, 0.0), course.emplace_back(t, 0.0);
    size_t next = 0;
    for (size_t i = 1; i < speed_.size(); ++i) {
      const double mean = 0.5 * (speed_[i - 1] + speed_[i]);
      t += kCell_m / std::max(mean, 0.2);
      course.emplace_back(t, static_cast<double>(i) * kCell_m);
      if (next < stops_.size() && i == std::min(speed_.size() - 1, cell(stops_[next].at_m))) {
        const double stand = std::max(stops_[next].for_s, 1.0);
        if (stops_[next].waypoint) {
          const auto place = route_.at(static_cast<double>(i) * kCell_m);
          marks_.push_back({t + 0.5 * stand, {place.north_east.x(), place.north_east.y(), -place.up}});
        }
        t += stand;
        course.emplace_back(t, static_cast<double>(i) * kCell_m);
        ++next;
      }
    }
    n_ = static_cast<size_t>(std::ceil(t * kDrive_hz)) + 1;
    distance_ = Signal(n_);
    size_t k = 0;
    for (size_t i = 0; i < n_; ++i) {
      const double now = static_cast<double>(i) / kDrive_hz;
      while (k + 2 < course.size() && course[k + 1].first < now) ++k;
      const auto& [t0, s0] = course[k];
      const auto& [t1, s1] = course[k + 1];
      distance_[i] = s0 + (s1 - s0) * std::clamp((now - t0) / std::max(t1 - t0, 1e-9), 0.0, 1.0);
    }
    smooth(distance_, 0.35, kDrive_hz);
  }

  /// Height of the road under a wheel about its mean: white slope as in ISO 8608, plus bumps.
  Signal road() const {
    constexpr double kStep_m = 0.05;
    Random random(seed_, 120);
    const double slope = std::sqrt(random.uniform(0.8e-5, 2.0e-5) / (2 * kStep_m));
    Signal height(static_cast<size_t>((end_m_ + 20) / kStep_m), 0.0);
    double z = 0;
    for (double& h : height) h = z += slope * kStep_m * random.normal();
    Signal hills = height;
    smooth(hills, 8.0, 1 / kStep_m);  // wavelengths above the car's length belong to the route's height
    for (size_t i = 0; i < height.size(); ++i) {
      height[i] -= hills[i];
      const double s = static_cast<double>(i) * kStep_m - 10;
      for (const double bump : bumps_)
        if (const double x = std::abs(s - bump) / (0.5 * kBumpLength_m); x < 1)
          height[i] += 0.5 * kBumpHeight_m * (1 + std::cos(kPi * x));
    }
    return height;
  }

  /// Motion of the car along its route, each component over time.
  struct Body {
    Signal north, east, up, heading, heave, pitch, roll;
    Signal hop[3], lane_offset, engine;
    explicit Body(size_t n)
        : north(n),
          east(n),
          up(n),
          heading(n),
          heave(n),
          pitch(n),
          roll(n),
          hop{Signal(n), Signal(n), Signal(n)},
          lane_offset(n),
          engine(n) {}
  };

  Motion ride() {
    Random random(seed_, 121);
    const Signal speed = derivative(distance_);
    Body body(n_);
    follow_road(speed, random, body);
    shake(speed, random, body);
    return phone(speed, body, mount(random));
  }

  /// Along the route, over the road, on the suspension.
  void follow_road(const Signal& speed, Random& random, Body& b) const {
    const Signal pull = derivative(speed), ground = road();
    const auto under = [&](double s) {
      const double at = std::clamp((s + 10) / 0.05, 0.0, static_cast<double>(ground.size()) - 2.0);
      const auto i = static_cast<size_t>(at);
      return ground[i] + (at - static_cast<double>(i)) * (ground[i + 1] - ground[i]);
    };
    const double dive = random.uniform(0.003, 0.005), lean = random.uniform(0.005, 0.008);
    for (size_t i = 0; i < n_; ++i) {
      const auto place = route_.at(distance_[i]);
      b.north[i] = place.north_east.x(), b.east[i] = place.north_east.y(), b.up[i] = place.up;
      b.heading[i] = place.heading;
      const double front = under(distance_[i] + 0.5 * kWheelbase_m), rear = under(distance_[i] - 0.5 * kWheelbase_m);
      b.heave[i] = 0.5 * (front + rear);
      b.pitch[i] = (front - rear) / kWheelbase_m + dive * pull[i];
      b.roll[i] = -lean * speed[i] * speed[i] * route_.curvature_at(distance_[i]);
    }
    smooth(b.north, 0.3, kDrive_hz), smooth(b.east, 0.3, kDrive_hz), smooth(b.up, 0.3, kDrive_hz);
    smooth(b.heading, 0.4, kDrive_hz), smooth(b.roll, 0.3, kDrive_hz);
    const double bounce = random.uniform(1.2, 1.6);
    follow_by_spring(b.heave, bounce, 0.3, kDrive_hz);
    follow_by_spring(b.pitch, 1.1 * bounce, 0.35, kDrive_hz);
    follow_by_spring(b.roll, 1.2 * bounce, 0.4, kDrive_hz);
    smooth(b.heave, 0.012, kDrive_hz), smooth(b.pitch, 0.012, kDrive_hz);
  }

  /// Wheel hop, steering and engine vibration.
  void shake(const Signal& speed, Random& random, Body& b) const {
    for (uint64_t k = 0; k < 3; ++k) {
      add_narrow_band(b.hop[k], Random(seed_, 122 + k), 11.0, 0.2, k == 0 ? 9e-5 : 6e-5, kDrive_hz);
      smooth(b.hop[k], 0.006, kDrive_hz);
    }
    add_gauss_markov(b.lane_offset, Random(seed_, 126), 6.0, 0.15, kDrive_hz);  // within the lane
    for (size_t i = 0; i < n_; ++i) b.lane_offset[i] *= std::min(1.0, distance_[i] / 30);
    smooth(b.lane_offset, 1.2, kDrive_hz);
    const double strength = random.uniform(0.06, 0.2);  // m/s^2
    double phase = 0;
    for (size_t i = 0; i < n_; ++i) {
      const double v = std::max(0.0, speed[i]);
      // Idle, or one gear per 6 m/s or so.
      const double rpm = v < 1.5 ? 800 + 400 * v / 1.5 : 1200 + 1300 * std::fmod(v - 1.5, 6.0) / 6.0;
      const double w = 2 * kPi * 2 * rpm / 60;
      phase += w / kDrive_hz;
      b.engine[i] = strength / (w * w) * std::sin(phase);
    }
  }

  /// From the phone to the car's forward-right-down axes, with a mounting error.
  static Eigen::Quaterniond mount(Random& random) {
    const double mount[3] = {0.015 * random.normal(), 0.015 * random.normal(), 0.02 * random.normal()};
    Eigen::Matrix3d axes;  // columns: the phone's x, y, z in forward-right-down axes
    axes << 0, 1, 0, -1, 0, 0, 0, 0, 1;
    return Eigen::AngleAxisd(mount[2], Vector3d::UnitZ()) * Eigen::AngleAxisd(mount[1], Vector3d::UnitY()) *
           Eigen::AngleAxisd(mount[0], Vector3d::UnitX()) * Eigen::Quaterniond(axes);
  }

  Motion phone(const Signal& speed, const Body& b, const Eigen::Quaterniond& mounted) const {
    const Vector3d on_roof(-0.2, 0.1, -c_.vehicle.camera_height_m);
    std::vector<Vector3d> p(n_);
    std::vector<Eigen::Quaterniond> q(n_);
    for (size_t i = 0; i < n_; ++i) {
      const double rough = std::min(1.5, speed[i] / 10);
      const Eigen::Quaterniond body =
          Eigen::AngleAxisd(b.heading[i], Vector3d::UnitZ()) *
          Eigen::AngleAxisd(b.pitch[i] + rough * 0.6 * b.hop[1][i], Vector3d::UnitY()) *
          Eigen::AngleAxisd(b.roll[i] + rough * b.hop[2][i] + 0.4 * b.engine[i], Vector3d::UnitX());
      const double h = b.heading[i];
      p[i] = Vector3d(b.north[i] - b.lane_offset[i] * std::sin(h), b.east[i] + b.lane_offset[i] * std::cos(h),
                      -(b.up[i] + b.heave[i] + rough * b.hop[0][i] + b.engine[i])) +
             body * (on_roof + Vector3d(0, 0.5 * b.engine[i], 0));
      q[i] = body * mounted;
      if (i > 0 && q[i].dot(q[i - 1]) < 0) q[i].coeffs() *= -1;
    }
    return {kDrive_hz, std::move(p), std::move(q)};
  }

  const Scenario& c_;
  const Route& route_;
  const uint64_t seed_;
  const double end_m_;
  std::vector<Stop> stops_;
  std::vector<double> bumps_, speed_;
  std::vector<Journey::Mark> marks_;
  size_t n_ = 0;
  Signal distance_;
};

}  // namespace

Journey make_drive(const Scenario& scenario, const Route& route, uint64_t seed) {
  return Car(scenario, route, seed).drive();
}

}  // namespace odograph
