// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/gnss/correlated_error.hpp"
#include "plugins/fix/gnss/path_heading.hpp"
#include "sdk/host/base/geodesy.hpp"
#include "sdk/host/fusion/outputs.hpp"
#include "sdk/host/messages/messages.hpp"
#include "sdk/tools/simulation/random.hpp"
#include "tests/support/runs.hpp"

using namespace odograph::gnss;

TEST_SUITE_BEGIN("gnss");

namespace {

/// A walk to the north at 1.3 m/s with a known path, and positions once a second with a Gauss-Markov error.
struct Canyon {
  CorrelatedError filter{CorrelatedError::Parameters{}};
  Random random;
  double sigma_m;
  Eigen::Vector2d error;
  int second = 0;

  Canyon(uint64_t seed, double sigma) : random(seed, 1), sigma_m(sigma), error{random.normal(), random.normal()} {
    error *= sigma;
  }
  Eigen::Vector2d place() const { return {1.3 * second, 0}; }
  CorrelatedError::Corrected next(const Eigen::Vector2d& reflection = Eigen::Vector2d::Zero()) {
    const double keep = std::exp(-1 / 20.0), kick = sigma_m * std::sqrt(1 - keep * keep);
    error = keep * error + kick * Eigen::Vector2d{random.normal(), random.normal()};
    ++second;
    const int64_t t_ns = second * 1'000'000'000LL;
    filter.on_path(t_ns, place(), 0.05);
    return filter.on_position(t_ns, place() + error + reflection, sigma_m);
  }
};

}  // namespace

TEST_CASE("the error of the mean of correlated positions matches their variance") {
  double squares = 0, variance = 0;
  for (uint64_t seed = 1; seed <= 200; ++seed) {
    Canyon canyon(seed, 12);
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    double weights = 0;
    for (int k = 0; k < 120; ++k) {
      const auto seen = canyon.next();
      const double weight = 1 / (seen.sigma_m * seen.sigma_m);
      sum += weight * (seen.position_m - canyon.place()), weights += weight;
    }
    squares += (sum / weights).squaredNorm() / 2 / 200, variance += 1 / weights / 200;
  }
  CHECK(squares / variance == Between{0.5, 1.6});  // independent ones would have a 40 times smaller variance
}

TEST_CASE("a reflection of 40 m for a minute is subtracted while it lasts, and leaves no bias") {
  int whole = 0;
  for (uint64_t seed = 1; seed <= 30; ++seed) {
    Canyon canyon(seed, 6);
    int jumps = 0;
    double worst_m = 0;
    for (int k = 0; k < 180; ++k) {
      const bool reflected = k >= 60 && k < 120;
      const auto seen = canyon.next(reflected ? Eigen::Vector2d(0, 40) : Eigen::Vector2d::Zero());
      jumps += seen.jumped;
      // Pull on an estimator that trusts the reported fix, for a prior of 5 m.
      const double gain = 25 / (25 + seen.sigma_m * seen.sigma_m);
      worst_m = std::max(worst_m, gain * (seen.position_m - canyon.place()).norm());
    }
    whole += jumps == 2;
    CHECK(worst_m < 10);
    CHECK(canyon.filter.bias_m().norm() < 25);
  }
  CHECK(whole >= 27);
}

TEST_CASE("a wandering error is no jump, and neither is a corrected path") {
  int jumps = 0;
  for (uint64_t seed = 1; seed <= 30; ++seed) {
    Canyon canyon(seed, 12);
    for (int k = 0; k < 200; ++k) jumps += canyon.next().jumped;
  }
  CHECK(jumps <= 6);  // of 6,000
  Canyon canyon(7, 3);
  for (int k = 0; k < 20; ++k) canyon.next();
  canyon.filter.on_path(20'500'000'000, canyon.place() + Eigen::Vector2d(30, -20), 0.05);
  CHECK_FALSE(canyon.filter.on_position(21'000'000'000, canyon.place(), 3).jumped);
}

namespace {

/// 75 s of a straight walk to the north with an attitude yaw offset `yaw`, positions with a Gauss-Markov error of 12 m
/// and an offset of 40 m to the east from 40 s on, and velocities if they have a sigma. Steps are 5 % too long with a
/// heading noise of 0.05 rad, and the attitude may drift; its yaw offset is `yaw` at the end.
void walk(PathHeading& path, uint64_t seed, double yaw, double velocity_sigma,
          std::vector<PathHeading::Yaw>* news = nullptr, double drift_radps = 0, double velocity_told = 0) {
  Random random(seed, 5);
  const double keep = std::exp(-1 / 20.0), kick = 12 * std::sqrt(1 - keep * keep);
  const double keep_v = std::exp(-0.5), kick_v = velocity_sigma * std::sqrt(1 - keep_v * keep_v);
  Eigen::Vector2d error = 12 * Eigen::Vector2d{random.normal(), random.normal()}, off(0, 0);
  for (int s = 0; s < 80; ++s) {
    for (int half = 0; half < 2 && s >= 4; ++half) {
      const int64_t start_ns = 1'000'000'000LL * s + 500'000'000LL * half;
      path.add_step(start_ns, start_ns + 500'000'000, 1.05 * 0.675,
                    0.05 * random.normal() - yaw + drift_radps * (80 - s - 0.5 * half));
    }
    error = keep * error + kick * Eigen::Vector2d{random.normal(), random.normal()};
    off = keep_v * off + kick_v * Eigen::Vector2d{random.normal(), random.normal()};
    const Eigen::Vector2d place(std::max(0, s - 4) * 1.35, s >= 40 ? 40 : 0);
    path.add_position(1'000'000'000LL * s, place + error, 12);
    if (velocity_sigma > 0)
      path.add_velocity(1'000'000'000LL * s, Eigen::Vector2d(s > 4 ? 1.35 : 0, 0) + off,
                        velocity_told > 0 ? velocity_told : velocity_sigma);
    if (const auto told = path.new_information(); told && news) news->push_back(*told);
  }
}

}  // namespace

TEST_CASE("a path's yaw by satellites reaches the attainable accuracy, and its error matches its sigma") {
  // The bound for 12 m, 20 s and 100 m is 9.2 degrees (README), so a median of 6.2; for an attitude with a drift of 5
  // mrad/s the yaw at the end of a path is less accurate than over it.
  for (const double velocity_sigma : {0.0, 0.5, 0.25}) {
    CAPTURE(velocity_sigma);
    std::vector<double> off_deg;
    double nis = 0;
    for (uint64_t seed = 1; seed <= 200; ++seed) {
      PathHeading path({});
      const double yaw = seed % 2 ? 0.3 : 2.5;
      walk(path, seed, yaw, velocity_sigma);
      const auto seen = required(path.yaw());
      const double off = std::remainder(seen->rad - yaw, 2 * EIGEN_PI);
      off_deg.push_back(std::abs(off) * 180 / EIGEN_PI);
      nis += off * off / (seen->sigma_rad * seen->sigma_rad) / 200;
    }
    MESSAGE("velocities of " << velocity_sigma << " m/s: median " << percentile(off_deg, 0.5) << " deg, 90 % "
                             << percentile(off_deg, 0.9));
    CHECK(percentile(off_deg, 0.5) < (velocity_sigma == 0 ? 8.0 : velocity_sigma == 0.5 ? 6.0 : 3.7));
    CHECK(nis == Between{0.5, 1.6});
  }
}

TEST_CASE("with a gyroscope bias the reported yaw of the attitude is the present one") {
  std::vector<double> off_deg;
  double nis = 0;
  for (uint64_t seed = 1; seed <= 60; ++seed) {
    PathHeading path({});
    walk(path, seed, 0.3, 0.25, nullptr, seed % 2 ? 0.006 : -0.006);  // by 26 degrees during the walk
    const auto seen = required(path.yaw());
    const double off = std::remainder(seen->rad - 0.3, 2 * EIGEN_PI);
    off_deg.push_back(std::abs(off) * 180 / EIGEN_PI);
    nis += off * off / (seen->sigma_rad * seen->sigma_rad) / 60;
  }
  MESSAGE("median " << percentile(off_deg, 0.5) << " deg, 90 % " << percentile(off_deg, 0.9));
  CHECK(percentile(off_deg, 0.5) < 4);  // its mean over the walk is 13 degrees off
  CHECK(nis < 1.6);
}

TEST_CASE("velocities are weighted by their observed accuracy, whatever their reported sigma") {
  for (const double sigma : {0.15, 0.25, 1.0}) {
    CAPTURE(sigma);
    std::vector<double> off_deg, known_deg;
    double nis = 0, learnt = 0;
    for (uint64_t seed = 1; seed <= 200; ++seed) {
      PathHeading path({}), known({});
      walk(path, seed, 0.3, sigma, nullptr, 0, 0.5);
      walk(known, seed, 0.3, sigma);
      const auto seen = path.yaw(), best = known.yaw();
      REQUIRE((seen && best));
      off_deg.push_back(std::abs(seen->rad - 0.3) * 180 / EIGEN_PI);
      known_deg.push_back(std::abs(best->rad - 0.3) * 180 / EIGEN_PI);
      nis += std::pow((seen->rad - 0.3) / seen->sigma_rad, 2) / 200;
      learnt += path.velocity_sigma(0.5) / 200;
    }
    MESSAGE(sigma << " m/s, learnt " << learnt << ": median " << percentile(off_deg, 0.5) << " deg, told the truth "
                  << percentile(known_deg, 0.5));
    CHECK(learnt / sigma == Between{0.7, 1.3});
    CHECK(percentile(off_deg, 0.5) < 1.1 * percentile(known_deg, 0.5) + 0.1);
    CHECK(nis == Between{0.25, 1.6});  // steps with less noise than assumed
  }
}

TEST_CASE("the successive reports of a yaw add up to its total information") {
  constexpr int kWalks = 30;
  double ratio = 0, squares = 0;
  for (uint64_t seed = 1; seed <= kWalks; ++seed) {
    PathHeading path({});
    std::vector<PathHeading::Yaw> news;
    walk(path, seed, 0.3, 0.5, &news);
    REQUIRE(news.size() >= 3);
    double information = 0, sum = 0;
    for (const auto& n : news) {
      const double w = 1 / (n.sigma_rad * n.sigma_rad);
      information += w, sum += w * n.rad;
    }
    const auto all = required(path.yaw());
    ratio += 1 / std::sqrt(information) / all->sigma_rad / kWalks;
    squares += std::pow((sum / information - all->rad) / all->sigma_rad, 2) / kWalks;
  }
  // Each report refers to its own time, and the present information has decayed: their sum is larger.
  MESSAGE("sigma of the sum " << ratio << " of the present one, yaw off by " << std::sqrt(squares) << " of it, rms");
  CHECK(ratio == Between{0.5, 0.7});
  CHECK(squares < 1);
}

TEST_CASE("there is no heading without motion, and none from steps without positions") {
  PathHeading still({}), blind({});
  for (int s = 0; s < 60; ++s) still.add_position(1'000'000'000LL * s, {0.1 * (s % 3), 0}, 5);
  CHECK_FALSE(still.new_information());
  for (int s = 0; s < 60; ++s) blind.add_step(1'000'000'000LL * s, 1'000'000'000LL * (s + 1), 0.7, 0);
  CHECK_FALSE(blind.new_information());
}

TEST_CASE(
    "an offset of 40 m for a minute in a street canyon pulls a simulated walk far less than independent fixes would") {
  const TemporaryFolder folder;
  Scenario s;
  s.walker.stand_s = 4;
  s.route = {{0, 0, 0}, {110, 0, 0}, {110, 90, 0}};
  s.gnss = {.sigma_m = 12, .canyon_sigma_m = 12, .correlation_s = 20, .availability = 1};
  std::vector<double> worst[2];
  for (const uint64_t seed : {11, 12, 13, 14, 15}) {
    Recording recording = recorded_sensors(s, seed);
    const auto& truth = recording.true_states;
    for (RecordedMessage& m : recording.messages) {
      if (m.message.header().type != ODO_TYPE_GNSS) continue;
      auto& gnss = reinterpret_cast<odo_gnss&>(m.message.header());
      const double t = static_cast<double>(gnss.header.t_ns - truth.front().t_ns) * 1e-9;
      if (t > 60 && t < 120) gnss.longitude_rad += 40 / (6378137.0 * std::cos(gnss.latitude_rad));
    }
    for (const int correlation : {0, 20}) {
      std::ofstream(folder / "p.yaml")
          << "odograph: 1\nattitude:\n  plugin: attitude/magyq\nstep_estimator:\n  plugin: "
             "step/odograph\ncoupling:\n  type: localizer\nabsolute_fixers:\n  - plugin: fix/gnss\n"
             "    parameters: {correlation: " +
                 std::to_string(correlation) + " s}\n";
      const RunResult result = run_of(recording, folder / "p.yaml");
      double largest = 0;
      size_t at = 0;
      for (const StampedPose& pose : result.track) {
        while (at + 1 < truth.size() && truth[at].t_ns < pose.t_ns) ++at;
        const double t = static_cast<double>(pose.t_ns - truth.front().t_ns) * 1e-9;
        if (t > 60 && t < 125) largest = std::max(largest, (pose.p - truth[at].p).head<2>().norm());
      }
      worst[correlation > 0].push_back(largest);
    }
  }
  MESSAGE("weighed " << percentile(worst[1], 0.5) << " m, independent " << percentile(worst[0], 0.5) << " m");
  CHECK(percentile(worst[1], 0.5) < 0.75 * percentile(worst[0], 0.5));
}

TEST_CASE("NED and geodetic coordinates are inverse to a micrometre over 20 km") {
  Geodesy geodesy;
  geodesy.set_origin({0.8238, -0.0271, 20.0});
  for (const std::array<double, 3> p : {std::array<double, 3>{0, 0, 0}, {20000, -15000, -300}, {-7, 12000, 40}}) {
    const auto back = geodesy.from_geodetic(geodesy.to_geodetic(p));
    for (size_t i = 0; i < 3; ++i) CHECK(std::abs(back[i] - p[i]) < 1e-6);
  }
  const auto north = geodesy.to_geodetic({1000, 0, 0}), east = geodesy.to_geodetic({0, 1000, 0}),
             down = geodesy.to_geodetic({0, 0, 5});
  CHECK(north[0] > 0.8238);
  CHECK(east[1] > -0.0271);
  CHECK(down[2] == doctest::Approx(15.0));
}

TEST_CASE("a fix with latitude and longitude only has north and east") {
  Geodesy geodesy;
  geodesy.set_origin({0.8238, -0.0271, 20.0});
  auto fix = make_message<odo_fix>(ODO_TYPE_FIX, 1);
  const auto there = geodesy.to_geodetic({30, -40, 0});
  fix.header.flags = ODO_FIX_GEODETIC | ODO_FIX_COVARIANCE;
  fix.latitude_rad = there[0], fix.longitude_rad = there[1], fix.height_m = there[2];
  geodesy.resolve(fix);
  CHECK((fix.header.flags & (ODO_FIX_NORTH | ODO_FIX_EAST)) == (ODO_FIX_NORTH | ODO_FIX_EAST));
  CHECK((fix.header.flags & ODO_FIX_DOWN) == 0);
  CHECK(std::abs(fix.p_n[0] - 30) < 1e-3);
  CHECK(std::abs(fix.p_n[1] + 40) < 1e-3);
}

TEST_CASE("a jump is subtracted, and decays with its time constant if the receiver stays there") {
  CorrelatedError error({});
  bool jumped = false;
  double then_m = 0;
  for (int s = 0; s <= 340; ++s) {
    error.on_path(1'000'000'000LL * s, Eigen::Vector2d::Zero(), 0.05);
    jumped |= error.on_position(1'000'000'000LL * s, Eigen::Vector2d(0, s < 40 ? 0 : 40), 3).jumped;
    if (s == 40) then_m = error.bias_m().norm();
  }
  CHECK(jumped);
  CHECK(then_m > 30);
  CHECK(error.bias_m().norm() < 1.5 * then_m * std::exp(-300.0 / 60));
}
