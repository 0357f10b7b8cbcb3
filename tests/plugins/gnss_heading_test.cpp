// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>

#include "plugins/fix/gnss/correlated_error.hpp"
#include "plugins/fix/gnss/path_heading.hpp"
#include "sdk/host/plugin_host/instance.hpp"
#include "sdk/math/rotation.hpp"
#include "sdk/tools/simulation/random.hpp"
#include "tests/support/messages.hpp"
#include "tests/support/support.hpp"

using namespace odograph::gnss;
using Eigen::Vector2d;

TEST_SUITE_BEGIN("gnss_heading");

namespace {

/// Transformation of a whole walk.
struct Change {
  double steps_rad = 0;   ///< offset of the attitude's heading and hence of the steps
  double places_rad = 0;  ///< rotation of the satellites' n
  bool mirrored = false;  ///< mirrored left to right
  int64_t later_ns = 0;
  Vector2d origin_m = Vector2d::Zero();
};

/// All yaws reported in a walk around two corners, with wandering positions and a jump.
std::vector<PathHeading::Yaw> yaws_of(uint64_t seed, const Change& change) {
  PathHeading path({});
  Random random(seed, 5);
  const double keep = std::exp(-1 / 20.0), kick = 6 * std::sqrt(1 - keep * keep), mirror = change.mirrored ? -1 : 1;
  const Eigen::Rotation2D<double> rotated(change.places_rad);
  const auto seen = [&](const Vector2d& v) { return rotated * Vector2d(v.x(), mirror * v.y()); };
  Vector2d error = 6 * Vector2d{random.normal(), random.normal()}, place(0, 0);
  std::vector<PathHeading::Yaw> told;
  for (int s = 0; s < 100; ++s) {
    const double heading = s < 40 ? 0.2 : s < 70 ? 1.7 : -2.9;
    const Vector2d by(0.675 * std::cos(heading), 0.675 * std::sin(heading));
    const int64_t t_ns = change.later_ns + 1'000'000'000LL * s;
    for (int half = 0; half < 2 && s >= 4; ++half) {
      const int64_t start_ns = t_ns + 500'000'000LL * half;
      path.add_step(start_ns, start_ns + 500'000'000, 0.71,
                    mirror * (heading + 0.1 * random.normal() + 0.002 * s) + change.steps_rad);
    }
    error = keep * error + kick * Vector2d{random.normal(), random.normal()};
    path.add_position(t_ns, seen(place + error + Vector2d(s > 60 && s < 80 ? 40 : 0, 0)) + change.origin_m, 6);
    path.add_velocity(t_ns, seen(s > 4 ? Vector2d(2 * by) : Vector2d(0, 0)) + Vector2d::Constant(0), 0.4);
    if (s >= 4) place += 2 * by;
    if (const auto news = path.new_information()) told.push_back(*news);
  }
  return told;
}

double apart(double a, double b) { return std::abs(std::remainder(a - b, 2 * M_PI)); }

/// Checks that the reports follow the change: the same number and sigmas, the yaw larger by `by`.
void follows(const std::vector<PathHeading::Yaw>& plain, const std::vector<PathHeading::Yaw>& changed, double sign,
             double by, double within) {
  REQUIRE(plain.size() == changed.size());
  for (size_t k = 0; k < plain.size(); ++k) {
    CHECK(apart(changed[k].rad, sign * plain[k].rad + by) < within);
    CHECK(std::abs(changed[k].sigma_rad / plain[k].sigma_rad - 1) < within);
  }
}

}  // namespace

TEST_CASE("the reported yaw of a path is independent of the offset of the attitude's heading") {
  for (const uint64_t seed : {1u, 2u, 3u}) {
    const auto plain = yaws_of(seed, {});
    REQUIRE(plain.size() >= 4);
    for (int k = 1; k < 72; ++k) follows(plain, yaws_of(seed, {.steps_rad = 0.0873 * k}), 1, -0.0873 * k, 1e-6);
    // Reports of nearly half a turn may have either sign.
    for (const auto& yaw : plain)
      for (const double beside : {-0.01, 0.01})
        follows(plain, yaws_of(seed, {.steps_rad = yaw.rad + M_PI + beside}), 1, -yaw.rad - M_PI - beside, 1e-6);
  }
}

TEST_CASE("the yaw rotates with n, changes sign when mirrored, and is independent of time and origin") {
  const auto plain = yaws_of(4, {});
  REQUIRE(plain.size() >= 4);
  for (const double rotation : {0.4, 1.9, 3.1, -2.6})
    follows(plain, yaws_of(4, {.places_rad = rotation}), 1, rotation, 1e-6);
  follows(plain, yaws_of(4, {.mirrored = true}), -1, 0, 1e-6);
  follows(plain, yaws_of(4, {.later_ns = 1'700'000'000'000'000'000}), 1, 0, 1e-6);
  follows(plain, yaws_of(4, {.origin_m = {300, -500}}), 1, 0, 1e-3);  // of a position with a sigma of 100 km
}

TEST_CASE("a yaw offset is the attitude's error: positive if the path lies to the left of the positions") {
  for (const auto& yaw : yaws_of(5, {.steps_rad = -0.8})) CHECK(apart(yaw.rad, 0.8) < 4 * yaw.sigma_rad + 0.2);
}

TEST_CASE("correlated errors, jumps and path corrections equal a reference calculation") {
  const CorrelatedError::Parameters p;
  int jumps = 0, corrections = 0;
  for (const uint64_t seed : {1u, 2u, 3u, 4u, 5u}) {
    Random random(seed, 3);
    CorrelatedError error(p);
    Vector2d path(0, 0), bias(0, 0), last(0, 0);
    double t = 0, variance = 0, walked = 0, last_walked = 0, last_t = -1;
    const auto coth = [](double x) { return std::cosh(x) / std::sinh(x); };
    for (int k = 0; k < 120; ++k) {
      const double dt = k % 17 == 16 ? 11 : random.uniform(0.5, 3), heading = k % 31 == 30 ? 3 : 0.2;
      t += dt;
      const bool corrected = k % 23 == 22;
      const Vector2d moved = corrected ? Vector2d(20, -9) : Vector2d(1.3 * dt, 0.2);
      if (moved.norm() > 5)
        last -= moved, ++corrections;
      else
        walked += k > 0 ? moved.norm() : 0;
      path += moved;
      error.on_path(std::llround(t * 1e9), path, heading);
      const double sigma = random.uniform(2, 6);
      const Vector2d seen = path + Vector2d{random.normal(), random.normal()} + (k % 40 < 20 ? 0 : 50) * Vector2d(0, 1);
      const auto found = error.on_position(std::llround(t * 1e9), seen, sigma);
      // Reference calculation.
      const double age = last_t < 0 ? 0 : t - last_t, decay = std::exp(-age / p.bias_s);
      bias *= decay, variance *= decay * decay;
      Vector2d place = seen - bias;
      bool jumped = false;
      if (last_t >= 0 && age < p.longest_s) {
        const double by_path = (walked - last_walked) * std::hypot(p.path_error, std::min(p.max_heading_rad, heading));
        const double doubt = 2 * sigma * sigma * (1 - std::exp(-age / p.correlation_s)) + by_path * by_path + 1;
        const Vector2d change = place - path - last;
        jumped = change.norm() > p.gate_sigma * std::sqrt(doubt);
        if (jumped) bias += change, variance += doubt, place -= change;
      }
      const double alike = age > 0 ? coth(age / (2 * p.correlation_s)) : 1,
                   by_bias = age > 0 ? coth(age / (2 * p.bias_s)) : 1;
      const double forgotten = age > 0 ? 0.25 * bias.squaredNorm() : 0;
      CHECK((found.position_m - place).norm() < 1e-6);
      CHECK(std::abs(found.sigma_m / std::sqrt(sigma * sigma * alike + by_bias * (variance + forgotten)) - 1) < 1e-6);
      CHECK(found.jumped == jumped);
      CHECK((error.bias_m() - bias).norm() < 1e-6);
      last = place - path, last_walked = walked, last_t = t, jumps += jumped;
    }
    error.reset();
    CHECK(error.bias_m().norm() == 0);
    CHECK(error.on_position(std::llround(t * 1e9) + 1, {500, 500}, 3).sigma_m == 3);  // nothing is known before it
  }
  CHECK(jumps > 10);
  CHECK(corrections > 10);
}

TEST_CASE(
    "the path follows the gyroscope's heading: a compass that swings by a radian does not bend the reported yaw") {
  double raised_rad = 0;  // of the display, from face up
  SUBCASE("held in front of the face") { raised_rad = 0.7; }
  SUBCASE("held flat, where it has no heading") {}
  const auto config = required(
      read_pipeline_config("odograph: 1\nabsolute_fixers: [{plugin: fix/gnss}]\n", "<text>", {plugin_folder()}));
  HostServices host(0, {}, nullptr);
  auto plugin = required(PluginInstance::make(config->fixers.front(), LibraryCheck::hash, 1, host));
  // Walks north with the phone's top to the north.
  const Eigen::Quaterniond flat(0, std::sqrt(0.5), std::sqrt(0.5), 0);
  const Eigen::Quaterniond true_n_b = flat * Eigen::AngleAxisd(raised_rad, Eigen::Vector3d::UnitX());
  int reports = 0;
  for (int k = 0; k < 1200; ++k) {
    const double t_s = 0.1 * k, compass_rad = std::sin(2 * M_PI * t_s / 40);
    const int64_t t_ns = 1'000'000'000 + k * 100'000'000LL;
    (*plugin)->process(imu_at(t_ns, {0, 0, 0}, {0, 0, 0}, ODO_IMU_GYRO).header);
    (*plugin)->process(attitude_at(t_ns, Eigen::AngleAxisd(compass_rad, Eigen::Vector3d::UnitZ()) * true_n_b).header);
    if (k % 5 == 0) {
      auto step = step_between(t_ns - 500'000'000, t_ns, t_ns, 0.7, 0.05);
      step.heading_rad = compass_rad;
      (*plugin)->process(step.header);
    }
    if (k % 10 != 0) continue;
    auto position = make_message<odo_gnss>(ODO_TYPE_GNSS, t_ns);
    position.header.flags = ODO_GNSS_POSITION | ODO_GNSS_COVARIANCE;
    position.latitude_rad = 0.8 + 1.4 * t_s / 6.37e6;
    for (const int axis : {0, 4, 8}) position.covariance_n[axis] = 9;
    for (const AnyMessage& event : (*plugin)->process(position.header)) {
      const auto& fix = reinterpret_cast<const odo_fix&>(event.header());
      if (event.header().type != ODO_TYPE_FIX || (fix.header.flags & ODO_FIX_YAW) == 0) continue;
      CHECK(apart(fix.yaw_rad, 0) < 0.06);
      ++reports;
    }
  }
  CHECK(reports > 3);
}
