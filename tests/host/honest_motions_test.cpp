// SPDX-License-Identifier: Apache-2.0
//
// Motions and positions that look like mistakes and are none: curves leaned into, swings, turntables, ships, a phone
// that is turned in the hand, positions that buildings reflect.
#include <cmath>
#include <functional>
#include <random>
#include <string>

#include "sdk/host/checks/input_checks.hpp"
#include "sdk/math/rotation.hpp"
#include "sdk/math/time.hpp"
#include "tests/support/messages.hpp"
#include "tests/support/support.hpp"

using namespace odograph;
using Eigen::AngleAxisd;
using Eigen::Quaterniond;
using Eigen::Vector3d;

TEST_SUITE_BEGIN("honest_motions");

namespace {

Quaterniond turned(double angle_rad, const Vector3d& axis) { return Quaterniond(AngleAxisd(angle_rad, axis)); }
const Vector3d kX = Vector3d::UnitX(), kY = Vector3d::UnitY(), kZ = Vector3d::UnitZ();
const Quaterniond kHeld = turned(0.8, Vector3d(1, 2, 0.5).normalized());  // in a mount or a hand, askew

struct Honest {
  std::string name;
  std::function<Vector3d(double)> p_n;
  std::function<Quaterniond(double)> q_n_b;
  double seconds = 60, walk_mps2 = 0;
  double gnss_m = 3, stated_m = 3;  ///< error of a position, correlated over 20 s, and what it states
};

/// Keys of the faults that are found.
std::string said_of(const Honest& m, uint32_t seed) {
  std::string said;
  HostServices host(1, {}, [&](const Report& r) { said += r.severity >= ODO_SEVERITY_WARNING ? r.key + " " : ""; });
  InputChecks checks(host);
  std::mt19937 random(seed);
  const auto noise = [&](double sigma) -> Vector3d {
    return sigma * Vector3d::NullaryExpr([&] { return std::normal_distribution<double>()(random); });
  };
  constexpr double kHz = 100, kStep_s = 1e-3, kEarth_m = 6371000;
  Vector3d off_m = noise(m.gnss_m);
  for (int i = 0; i < m.seconds * kHz; ++i) {
    const double t = 1 + i / kHz;
    const Vector3d a_n = (m.p_n(t + kStep_s) - 2 * m.p_n(t) + m.p_n(t - kStep_s)) / (kStep_s * kStep_s);
    const Vector3d rate_b = log_rotation(m.q_n_b(t - kStep_s).conjugate() * m.q_n_b(t + kStep_s)) / (2 * kStep_s);
    const Vector3d walk = m.walk_mps2 * Vector3d(std::sin(11 * t), 0.6 * std::sin(22 * t + 1), std::sin(22 * t));
    const Vector3d force_b = m.q_n_b(t).conjugate() * (a_n + walk - Vector3d(0, 0, 9.81));
    const int64_t t_ns = int64_t(1e9 * t);
    const odo_imu imu = imu_at(t_ns, rate_b + noise(0.003) + Vector3d(0.02, 0.02, 0.02), force_b + noise(0.05));
    checks.on_push(imu.header), checks.on_imu(imu);
    if (i % 100 != 0) continue;
    off_m = 0.95 * off_m + noise(0.31 * m.gnss_m);
    const Vector3d place = m.p_n(t) + off_m;
    auto gnss = make_message<odo_gnss>(ODO_TYPE_GNSS, t_ns);
    gnss.header.flags = ODO_GNSS_POSITION | ODO_GNSS_COVARIANCE | ODO_GNSS_VELOCITY;
    Vector3d::Map(gnss.velocity_n) = (m.p_n(t + kStep_s) - m.p_n(t - kStep_s)) / (2 * kStep_s) + noise(0.1);
    gnss.latitude_rad = 0.84 + place.x() / kEarth_m;
    gnss.longitude_rad = 0.2 + place.y() / kEarth_m / std::cos(0.84);
    gnss.covariance_n[0] = gnss.covariance_n[4] = gnss.covariance_n[8] = m.stated_m * m.stated_m;
    checks.on_sample(gnss.header);
  }
  return said;
}

/// On a circle, b turning with it and leaning inwards.
Honest circle(std::string name, double radius_m, double speed_mps, double lean_rad) {
  const double rate = speed_mps / radius_m;
  return {std::move(name),
          [=](double t) -> Vector3d { return radius_m * Vector3d(std::cos(rate * t), std::sin(rate * t), 0); },
          [=](double t) { return turned(rate * t, kZ) * turned(lean_rad, kY) * kHeld; }};
}

/// Leaning so that the force stays in b.
Honest leaned(std::string name, double speed_mps, double lean_rad) {
  return circle(std::move(name), speed_mps * speed_mps / 9.81 / std::tan(lean_rad), speed_mps, lean_rad);
}

Honest swing(std::string name, double length_m, double peak_rad) {
  const double rate = std::sqrt(9.81 / length_m) * (1 - peak_rad * peak_rad / 16);
  const auto angle = [=](double t) { return peak_rad * std::sin(rate * t); };
  return {std::move(name),
          [=](double t) -> Vector3d { return length_m * Vector3d(std::sin(angle(t)), 0, std::cos(angle(t))); },
          [=](double t) { return turned(angle(t), kY) * kHeld; }};
}

Honest ship() {
  const auto roll = [](double t) { return 0.4 * std::sin(0.6 * t); };
  return {"a ship that rolls, turns and drifts",
          [=](double t) -> Vector3d {
            return Vector3d(100 * std::sin(0.05 * t), 100 - 100 * std::cos(0.05 * t) + 3 * t, 2 * std::sin(0.7 * t)) +
                   turned(0.05 * t, kZ) * (15 * Vector3d(0, std::sin(roll(t)), -std::cos(roll(t))));
          },
          [=](double t) { return turned(0.05 * t, kZ) * turned(roll(t), kX) * kHeld; }, 300};
}

/// A hand that turns the phone by up to `peak_rad` every eight seconds.
double look(double t, double peak_rad) {
  const auto to = [&](double n) { return peak_rad * std::sin(12.9898 * n * n + 78.233 * n); };
  const double n = std::floor(t / 8), s = std::min(1.0, t - 8 * n);
  return to(n) + (to(n + 1) - to(n)) * s * s * (3 - 2 * s);
}

Honest looking_around(std::string name, double speed_mps) {
  return {std::move(name),
          [=](double t) -> Vector3d { return Vector3d(speed_mps * t, 0, 0); },
          [](double t) { return turned(look(t, 1.7), kZ) * kHeld; },
          1200,
          speed_mps > 0 ? 2.0 : 0.0,
          12,
          3};
}

}  // namespace

TEST_CASE("curves, swings, turntables and ships are no mistakes") {
  for (const Honest& motion : {circle("a car in a roundabout", 12, 8, 0), circle("a turntable", 0.2, 0.6, 0),
                               circle("a chair that spins", 0.4, 1.6, 0), leaned("a motorcycle in a curve", 14, 0.8),
                               leaned("a chairoplane", 9, 0.75), leaned("an aircraft in a steep turn", 50, 1.0),
                               swing("a swing", 2.5, 0.8), swing("a high swing", 4, 1.0), ship()}) {
    CAPTURE(motion.name);
    for (const uint32_t seed : {1u, 2u, 3u}) CHECK(said_of(motion, seed) == "");
  }
}

TEST_CASE("positions reflected by buildings and a phone turned in the hand are no mirrored way") {
  for (const double speed_mps : {0.0, 1.3, 8.0})
    for (uint32_t seed = 1; seed <= 8; ++seed) {
      CAPTURE(speed_mps);
      CHECK(said_of(looking_around("looking around", speed_mps), seed) == "");
    }
}

TEST_CASE("the velocity of a straight path fits, however far the positions are off") {
  for (const double speed_mps : {0.0, 1.3, 10.0})
    for (const double north : {1.0, 0.7})
      for (const double gnss_m : {1.0, 3.0, 4.0, 6.0})
        for (uint32_t seed = 1; seed <= 4; ++seed) {
          const Vector3d ahead(north, std::sqrt(1 - north * north), 0);
          const Honest straight{
              "straight",
              [=](double t) -> Vector3d { return speed_mps * t * ahead + Vector3d(0, 0.3 * std::sin(1.1 * t), 0); },
              [](double) { return kHeld; },
              400,
              speed_mps > 0 ? 2.0 : 0.0,
              gnss_m,
              3};
          CAPTURE(speed_mps);
          CAPTURE(gnss_m);
          CHECK(said_of(straight, seed) == "");
        }
}
