// SPDX-License-Identifier: Apache-2.0
//
// `odograph bench canyon`: what satellite positions between houses do to a walk, with errors that stay alike and jump.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "sdk/tools/benchmarks/benchmarks.hpp"
#include "sdk/tools/console/console.hpp"
#include "sdk/tools/replay/runner.hpp"
#include "sdk/tools/simulation/random.hpp"
#include "sdk/tools/simulation/simulate.hpp"

namespace odograph {
namespace {

namespace fs = std::filesystem;

constexpr double kEquator_m = 6378137.0;
constexpr double kFrom_s = 60, kTo_s = 120, kAfter_s = 5;  // of the reflection, and how long its effect still counts
constexpr double kSettled_s = 20;                          // nothing before counts

struct CanyonArguments {
  std::vector<std::string> configs;
  uint64_t seeds = 10, first_seed = 1;
  double sigma_m = 12, reflection_m = 40, velocity_sigma_mps = 0;
  bool json = false;
};

/// Of one walk.
struct CanyonRow {
  double heading_deg = 0;      ///< error after 100 m
  double position_m = 0;       ///< median error
  double largest_m = 0;        ///< error
  double in_reflection_m = 0;  ///< largest error while the receiver is off, and shortly after
};

/// 200 m with a corner, a position each second.
Scenario canyon(double sigma_m) {
  Scenario s;
  s.walker.stand_s = 4;
  s.route = {{0, 0, 0}, {110, 0, 0}, {110, 90, 0}};
  s.gnss = {.sigma_m = sigma_m, .canyon_sigma_m = sigma_m, .correlation_s = 20, .availability = 1};
  return s;
}

/// The receiver is that far off to the east for a minute, and does not know it.
void reflect(Recording& recording, double off_m) {
  const int64_t start_ns = recording.true_states.front().t_ns;
  for (RecordedMessage& m : recording.messages) {
    if (m.message.header().type != ODO_TYPE_GNSS) continue;
    auto& gnss = reinterpret_cast<odo_gnss&>(m.message.header());
    const double t = static_cast<double>(gnss.header.t_ns - start_ns) * 1e-9;
    if (t > kFrom_s && t < kTo_s) gnss.longitude_rad += off_m / (kEquator_m * std::cos(gnss.latitude_rad));
  }
}

/// Velocities as receivers have them from Doppler shifts, which reflections off walls hardly touch: the mean over a
/// second, with an error in each component that is alike for two.
void add_velocities(Recording& recording, double sigma_mps, uint64_t seed) {
  constexpr size_t kHalf = 100;  // states, at 200 Hz
  const double keep = std::exp(-0.5);
  Random random(seed, 41);
  Eigen::Vector2d error = sigma_mps * Eigen::Vector2d(random.normal(), random.normal());
  const auto& truth = recording.true_states;
  size_t at = 0;
  for (RecordedMessage& m : recording.messages) {
    if (m.message.header().type != ODO_TYPE_GNSS) continue;
    auto& gnss = reinterpret_cast<odo_gnss&>(m.message.header());
    while (at + 1 < truth.size() && truth[at].t_ns < gnss.header.t_ns) ++at;
    const auto &from = truth[at > kHalf ? at - kHalf : 0], &to = truth[std::min(truth.size() - 1, at + kHalf)];
    const double dt_s = static_cast<double>(to.t_ns - from.t_ns) * 1e-9;
    const double kick = sigma_mps * std::sqrt(1 - keep * keep);
    error = keep * error + kick * Eigen::Vector2d(random.normal(), random.normal());
    const Eigen::Vector2d velocity = (to.p - from.p).head<2>() / std::max(0.1, dt_s) + error;
    gnss.header.flags |= ODO_GNSS_VELOCITY;
    gnss.velocity_n[0] = velocity.x(), gnss.velocity_n[1] = velocity.y();
  }
}

CanyonRow score(const Recording& recording, const RunResult& result) {
  CanyonRow row;
  const auto& truth = recording.true_states;
  std::vector<double> errors;
  size_t at = 0, walked_to = 0;
  double walked_m = 0;
  bool has_heading = false;
  for (const StampedPose& pose : result.track) {
    while (at + 1 < truth.size() && truth[at].t_ns < pose.t_ns) ++at;
    for (; walked_to + 20 <= at; walked_to += 20)  // a tenth of a second: what the hand does is no path
      walked_m += (truth[walked_to + 20].p - truth[walked_to].p).head<2>().norm();
    const double t = static_cast<double>(pose.t_ns - truth.front().t_ns) * 1e-9;
    const double error = (pose.p - truth[at].p).head<2>().norm();
    if (!has_heading && walked_m >= 100) {
      const Eigen::Quaterniond off = pose.q * truth[at].q.conjugate();
      row.heading_deg = std::abs(std::remainder(2 * std::atan2(off.z(), off.w()), 2 * EIGEN_PI)) * 180 / EIGEN_PI;
      has_heading = true;
    }
    if (t > kSettled_s) errors.push_back(error);
    if (t > kFrom_s && t < kTo_s + kAfter_s) row.in_reflection_m = std::max(row.in_reflection_m, error);
  }
  row.position_m = percentile(errors, 0.5), row.largest_m = percentile(errors, 1.0);
  return row;
}

int run_canyon(const CanyonArguments& a) {
  std::vector<std::vector<CanyonRow>> all(a.configs.size());
  const fs::path file = fs::temp_directory_path() / ("odograph-canyon-" + std::to_string(getpid()) + ".odo");
  Progress progress("bench canyon");
  for (uint64_t k = 0; k < a.seeds; ++k) {
    progress.show(k, a.seeds);
    const auto made = simulate(canyon(a.sigma_m), a.first_seed + k, file, {.threads = 1, .frames = false});
    if (!made) return complain(made.failure());
    auto recording = open_recording(file);
    std::error_code error;
    fs::remove(file, error);
    if (!recording) return complain(recording.failure());
    reflect(*recording, a.reflection_m);
    if (a.velocity_sigma_mps > 0) add_velocities(*recording, a.velocity_sigma_mps, a.first_seed + k);
    for (size_t c = 0; c < a.configs.size(); ++c) {
      RunOptions options;
      options.config = a.configs[c];
      const auto result = replay(*recording, options);
      if (!result) return complain(result.failure());
      all[c].push_back(score(*recording, *result));
    }
  }
  progress.show(a.seeds, a.seeds);
  const auto figures = [](const std::vector<CanyonRow>& rows, double CanyonRow::*member) {
    std::vector<double> values;
    for (const CanyonRow& row : rows) values.push_back(row.*member);
    return nlohmann::ordered_json{{"median", percentile(values, 0.5)}, {"worst", percentile(values, 1.0)}};
  };
  nlohmann::ordered_json table = nlohmann::json::array();
  for (size_t c = 0; c < a.configs.size(); ++c)
    table.push_back({{"config", a.configs[c]},
                     {"heading_after_100_m_deg", figures(all[c], &CanyonRow::heading_deg)},
                     {"position_m", figures(all[c], &CanyonRow::position_m)},
                     {"largest_m", figures(all[c], &CanyonRow::largest_m)},
                     {"largest_in_reflection_m", figures(all[c], &CanyonRow::in_reflection_m)}});
  if (a.json) {
    std::printf("%s\n", table.dump(2).c_str());
    return kDone;
  }
  std::printf(
      "%llu walks of 200 m, a position each second with an error of %g m that is alike for 20 s, and off by %g m from "
      "60 to "
      "120 s.\n\n%-46s %19s %19s %19s %19s\n%-46s",
      static_cast<unsigned long long>(a.seeds), a.sigma_m, a.reflection_m, "", "heading, 100 m (deg)", "position (m)",
      "largest error (m)", "in reflection (m)", "config");
  for (int k = 0; k < 4; ++k) std::printf(" %9s %9s", "median", "worst");
  std::printf("\n");
  for (const auto& r : table) {
    std::printf("%-46s", r["config"].get<std::string>().c_str());
    for (const char* key : {"heading_after_100_m_deg", "position_m", "largest_m", "largest_in_reflection_m"})
      std::printf(" %9.1f %9.1f", r[key]["median"].get<double>(), r[key]["worst"].get<double>());
    std::printf("\n");
  }
  return kDone;
}

}  // namespace

void add_bench_canyon(CLI::App& bench, int& status) {
  auto a = std::make_shared<CanyonArguments>();
  auto* command =
      bench.add_subcommand("canyon", "Simulated walks with satellite positions whose errors stay alike and jump");
  command->add_option("-c,--config", a->configs, "pipeline configs to compare")->required();
  command->add_option("--seeds", a->seeds, "how many walks")->capture_default_str()->check(CLI::Range(1, 1000));
  command->add_option("--first-seed", a->first_seed, "the first of them")->capture_default_str();
  command->add_option("--sigma", a->sigma_m, "standard deviation of each component, m")->capture_default_str();
  command->add_option("--reflection", a->reflection_m, "how far off for a minute, m")->capture_default_str();
  command
      ->add_option("--velocity-sigma", a->velocity_sigma_mps,
                   "the receiver tells velocities, off by that in each component, m/s; 0: it tells none")
      ->capture_default_str();
  command->add_flag("--json", a->json, "print one JSON array, an entry for each config");
  command->callback([a, &status] { status = run_canyon(*a); });
}

}  // namespace odograph
