// SPDX-License-Identifier: Apache-2.0
//
// Drives and walks through real city models, drawn by seeds: `odograph bench city` prints how far off the pose is, how
// often the skyline tells a place, and how often it is wrong.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>

#include <nlohmann/json.hpp>

#include "sdk/tools/benchmarks/benchmarks.hpp"
#include "sdk/tools/city/city_scenario.hpp"
#include "sdk/tools/city/street_route.hpp"
#include "sdk/tools/console/console.hpp"
#include "sdk/tools/replay/kept_recordings.hpp"
#include "sdk/tools/replay/runner.hpp"

namespace odograph {
namespace {

namespace fs = std::filesystem;

struct CityArguments {
  std::vector<std::string> models, lenses = {"wide"};
  std::string config = "samples/configs/city_drive.yaml", skylines, keep = "out/bench";
  uint64_t drives = 1, first_seed = 1, skies = 1;
  double length_m = 300;
  bool json = false;
};

constexpr int64_t kTold_ns = 3'000'000'000;  // a fix is told so late at most

/// One run's figures.
struct CityRun {
  std::string name;
  std::vector<double> horizontal_m;  ///< of each frame's pose
  std::vector<double> tilt_deg;      ///< of each frame's pose: between its vertical and the true one
  std::vector<double> fix_m;         ///< of each accepted fix
  size_t accepted = 0, refused = 0;  ///< fixes, by the estimator
  size_t beyond = 0;                 ///< accepted fixes beyond three sigma of their own covariance
  size_t seconds = 0, with_fix = 0;  ///< with a skyline in view; of those with an accepted fix
  double frame_ms_99 = 0, thread_ms_99 = 0;
  double found_after_m = -1, found_off_m = 0;  ///< path until the first accepted fix, and its error; -1: none came
  std::map<std::string, RunResult::Notice> notices;
};

/// Seconds of the recording in which the truth has roofs in at least a third of the directions above ten degrees.
std::vector<int64_t> seconds_with_skyline(const Recording& recording) {
  std::vector<int64_t> seconds;
  for (const TrueSkyline& s : recording.true_skylines) {
    const auto high = std::count_if(s.elevation_rad.begin(), s.elevation_rad.end(), [](float e) { return e > 0.17f; });
    if (3 * static_cast<size_t>(high) >= s.elevation_rad.size()) seconds.push_back(s.t_ns);
  }
  return seconds;
}

double path_until(const Recording& recording, int64_t t_ns) {
  double path_m = 0;
  for (size_t i = 1; i < recording.truth.size() && recording.truth[i].t_ns <= t_ns; ++i)
    path_m += (recording.truth[i].p - recording.truth[i - 1].p).norm();
  return path_m;
}

void score(const Recording& recording, const RunResult& result, CityRun& run, bool from_first_fix) {
  int64_t from_ns = INT64_MIN;
  for (const auto& [fix, accepted] : result.fixes) {
    if (!accepted) continue;
    run.found_after_m = path_until(recording, fix.header.t_ns);
    run.found_off_m = (Eigen::Vector3d(fix.p_n) - position_at(recording.truth, fix.header.t_ns)).head<2>().norm();
    if (from_first_fix) from_ns = fix.header.t_ns + kTold_ns;
    break;
  }
  for (const StampedPose& truth : recording.truth) {
    if (truth.t_ns < from_ns) continue;
    const Eigen::Vector3d d = position_at(result.track, truth.t_ns) - truth.p;
    run.horizontal_m.push_back(d.head<2>().norm());
  }
  for (size_t i = 0, k = 0; i < result.track.size(); ++i) {
    while (k + 1 < recording.truth.size() && recording.truth[k].t_ns < result.track[i].t_ns) ++k;
    const Eigen::Vector3d down_c = recording.truth[k].q.conjugate() * Eigen::Vector3d::UnitZ();
    const double cosine = (result.track[i].q * down_c).z();
    if (recording.truth[k].t_ns == result.track[i].t_ns)
      run.tilt_deg.push_back(std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / EIGEN_PI);
  }
  std::vector<int64_t> times;
  for (const auto& [fix, accepted] : result.fixes) {
    if (!accepted) {
      ++run.refused;
      continue;
    }
    ++run.accepted;
    times.push_back(fix.header.t_ns);
    const Eigen::Vector2d d = (Eigen::Vector3d(fix.p_n) - position_at(recording.truth, fix.header.t_ns)).head<2>();
    Eigen::Matrix2d P;
    P << fix.covariance_n[0], fix.covariance_n[1], fix.covariance_n[3], fix.covariance_n[4];
    run.fix_m.push_back(d.norm());
    // 3 sigma of one axis holds 99.73 %; the same part of a plane lies within 11.83.
    if (d.dot(P.ldlt().solve(d)) > 11.83) ++run.beyond;
  }
  for (const int64_t t_ns : seconds_with_skyline(recording)) {
    ++run.seconds;
    run.with_fix +=
        std::any_of(times.begin(), times.end(), [&](int64_t t) { return std::abs(t - t_ns) <= 500'000'000; });
  }
  run.frame_ms_99 = percentile(result.frame_ms, 0.99);
  run.thread_ms_99 = percentile(result.frame_thread_ms, 0.99);
  run.notices = result.notices;
}

/// The config with this model and origin in place of its own.
Result<std::string> config_for(const std::string& config, const std::string& model, const std::string& skylines,
                               const Eigen::Vector3d& origin) {
  const auto text = text_of(config);
  if (!text) return text.failure();
  const std::string key = "model: city.json";
  const auto at = text->find(key);
  if (at == std::string::npos) return Failure{ODO_E_CONFIG, config + ": no line `model: city.json` to be replaced"};
  const auto line = text->rfind('\n', at) + 1;
  char with[400];
  std::snprintf(with, sizeof with, "model: %s\n%smodel_origin: [%.4f m, %.4f m, %.4f m]", model.c_str(),
                std::string(at - line, ' ').c_str(), origin.x(), origin.y(), origin.z());
  std::string replaced = std::string(*text).replace(at, key.size(), with);
  const std::string database = "skylines: city.skylines";
  if (const auto of = replaced.find(database); of != std::string::npos)
    replaced.replace(of, database.size(), "skylines: " + std::filesystem::absolute(skylines).string());
  return replaced;
}

constexpr uint64_t kOtherSky = 1000;  // added to a drive's seed for each sky after the first

Result<CityRun> run_one(const CityArguments& a, const std::string& model, const std::string& lens, uint64_t seed,
                        uint64_t sky) {
  const fs::path file(model);
  const std::string city = file.stem().stem().string();
  CityRun run{.name = city + ' ' + lens + ' ' + std::to_string(seed)};
  if (sky > 0) run.name += '+' + std::to_string(sky);
  const std::string stem = "city_" + city + '_' + lens + '_' + std::to_string(seed);
  std::error_code error;
  fs::create_directories(a.keep, error);
  const fs::path scenario = fs::path(a.keep) / (stem + ".yaml");
  const auto origin =
      write_city_scenario({model, scenario.string(), lens, lens == "forward" ? "walker" : "car", seed, a.length_m});
  if (!origin) return origin.failure();
  const auto kept = kept_recording(scenario, seed + kOtherSky * sky, a.keep, 0);
  if (!kept) return kept.failure();
  const auto recording = read_recording(*kept);
  if (!recording) return recording.failure();
  const auto config = config_for(a.config, file.filename().string(), a.skylines, *origin);
  if (!config) return config.failure();
  RunOptions options;
  options.config = (fs::path(a.keep) / (stem + ".pipeline.yaml")).string();
  options.asset_path = fs::absolute(file).parent_path().string();
  std::ofstream(options.config) << *config;
  Progress progress("run " + run.name);
  options.progress = [&](size_t i, size_t n) { progress.show(i, n); };
  const auto result = replay(*recording, options);
  if (!result) return result.failure();
  score(*recording, *result, run, !a.skylines.empty());
  return run;
}

double part(size_t of, size_t all) {
  return all > 0 ? 100.0 * static_cast<double>(of) / static_cast<double>(all) : 0.0;
}

void print(const CityRun& r) {
  std::printf("%-26s %7.2f %7.2f %7.2f %8.2f %8.2f %6zu %6zu %7.1f %7.0f %8.1f %8.1f %5.2f %5.2f ", r.name.c_str(),
              percentile(r.horizontal_m, 0.5), percentile(r.horizontal_m, 0.95), percentile(r.horizontal_m, 1.0),
              percentile(r.fix_m, 0.5), percentile(r.fix_m, 0.95), r.accepted, r.refused, part(r.beyond, r.accepted),
              part(r.with_fix, r.seconds), r.frame_ms_99, r.thread_ms_99, percentile(r.tilt_deg, 0.5),
              percentile(r.tilt_deg, 0.95));
  if (r.found_after_m >= 0)
    std::printf("%7.0f %7.2f ", r.found_after_m, r.found_off_m);
  else
    std::printf("%7s %7s ", "-", "-");
  for (const auto& [key, notice] : r.notices)
    if (const auto at = key.find("no_fix_"); at != std::string::npos)
      std::printf(" %s %llu", key.c_str() + at + 7, static_cast<unsigned long long>(notice.count));
  std::printf("\n");
}

void add(const CityRun& run, CityRun& all) {
  all.horizontal_m.insert(all.horizontal_m.end(), run.horizontal_m.begin(), run.horizontal_m.end());
  all.fix_m.insert(all.fix_m.end(), run.fix_m.begin(), run.fix_m.end());
  all.tilt_deg.insert(all.tilt_deg.end(), run.tilt_deg.begin(), run.tilt_deg.end());
  all.accepted += run.accepted, all.refused += run.refused, all.beyond += run.beyond;
  all.seconds += run.seconds, all.with_fix += run.with_fix;
  all.frame_ms_99 = std::max(all.frame_ms_99, run.frame_ms_99);
  all.thread_ms_99 = std::max(all.thread_ms_99, run.thread_ms_99);
}

int bench(const CityArguments& a) {
  std::vector<CityRun> runs;
  if (!a.json)
    std::printf("%-26s %7s %7s %7s %8s %8s %6s %6s %7s %7s %8s %8s %11s %7s %7s  %s\n", "model, lens, seed", "median",
                "95 %", "most", "fix 50 %", "fix 95 %", "used", "refus.", ">3s %", "secs. %", "ms 99 %", "cpu 99 %",
                "tilt, 95 %", "1st at", "off m", "no fix because of (frames)");
  for (const std::string& lens : a.lenses) {
    CityRun all{.name = "all, " + lens};
    for (const std::string& model : a.models)
      for (uint64_t k = 0; k < a.drives * a.skies; ++k) {
        auto run = run_one(a, model, lens, a.first_seed + k / a.skies, k % a.skies);
        if (!run) return complain(run.failure());
        if (!a.json) print(*run);
        std::fflush(stdout);
        add(*run, all);
        runs.push_back(std::move(*run));
      }
    if (!a.json) print(all);
    runs.push_back(std::move(all));
  }
  if (!a.json) return kDone;
  nlohmann::ordered_json rows = nlohmann::json::array();
  for (const CityRun& r : runs)
    rows.push_back(
        {{"name", r.name},
         {"horizontal_m", {{"50", percentile(r.horizontal_m, 0.5)}, {"95", percentile(r.horizontal_m, 0.95)}}},
         {"fixes", {{"used", r.accepted}, {"refused", r.refused}, {"beyond_3_sigma", r.beyond}}},
         {"seconds_with_skyline", r.seconds},
         {"seconds_with_fix", r.with_fix},
         {"first_fix", {{"after_m", r.found_after_m}, {"off_m", r.found_off_m}}},
         {"frame_ms_99", r.frame_ms_99},
         {"thread_ms_99", r.thread_ms_99},
         {"tilt_deg", {{"50", percentile(r.tilt_deg, 0.5)}, {"95", percentile(r.tilt_deg, 0.95)}}}});
  std::printf("%s\n", rows.dump(2).c_str());
  return kDone;
}

}  // namespace

void add_bench_city(CLI::App& app, int& status) {
  auto a = std::make_shared<CityArguments>();
  auto* command = app.add_subcommand(
      "bench", "Drives through the streets of city models, drawn and rendered by seeds: errors, fixes, integrity");
  command->add_option("model", a->models, "city models")->required();
  command->add_option("-c,--config", a->config, "pipeline with fix/skyline; its `model: city.json` is replaced")
      ->capture_default_str();
  command->add_option("--skylines", a->skylines,
                      "database that replaces `skylines: city.skylines`; errors count from the first fix on");
  command->add_option("--lens", a->lenses, "wide and narrow look up from a car, forward ahead from a walker's hand")
      ->capture_default_str()
      ->check(CLI::IsMember({"wide", "narrow", "forward"}));
  command->add_option("--drives", a->drives, "in each model")->capture_default_str()->check(CLI::Range(1, 1000));
  command->add_option("--first-seed", a->first_seed, "of route, sun, clouds and noise")->capture_default_str();
  command->add_option("--skies", a->skies, "each route under that many suns and clouds")
      ->capture_default_str()
      ->check(CLI::Range(1, 100));
  command->add_option("--length", a->length_m, "of each drive, m")->capture_default_str();
  command->add_option("--keep", a->keep, "recordings are kept here and rendered once")->capture_default_str();
  command->add_flag("--json", a->json, "print one JSON array");
  command->callback([a, &status] { status = bench(*a); });
}

}  // namespace odograph
