// SPDX-License-Identifier: Apache-2.0
//
// Visual odometries side by side: `odograph bench vo`.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include <Eigen/Dense>
#include <nlohmann/json.hpp>

#include "sdk/cli/commands.hpp"
#include "sdk/cli/kept_recordings.hpp"
#include "sdk/cli/runner.hpp"

namespace odograph {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr double kLeastWay_m = 0.03;  // of a frame whose direction means something
constexpr double kTrueWindow_m = 10;

struct VoArguments {
  std::vector<std::string> configs = {"samples/configs/monocular.yaml", "samples/configs/monocular_antigny2019.yaml",
                                      "samples/configs/monocular_gakne2018.yaml",
                                      "samples/configs/monocular_odograph.yaml"};
  std::vector<std::string> scenarios = {"samples/scenarios/street_short.yaml"}, recordings;
  std::string keep = "out/bench";
  uint64_t seeds = 1, first_seed = 1;
  bool stress = false, json = false;
};

/// How much larger the squared errors of the motions are than their covariances say, per degree of freedom.
struct Consistency {
  std::vector<double> rotation, direction;
};

Consistency consistency_of(const Trajectory& truth, const std::vector<odo_vo_motion>& motions) {
  Consistency result;
  const auto pose_at = [&](int64_t t_ns) -> const StampedPose* {
    const auto at = std::lower_bound(truth.begin(), truth.end(), t_ns - 1'000'000,
                                     [](const StampedPose& p, int64_t t) { return p.t_ns < t; });
    return at != truth.end() && std::abs(at->t_ns - t_ns) < 2'000'000 ? &*at : nullptr;
  };
  for (const odo_vo_motion& m : motions) {
    const StampedPose *from = pose_at(m.t_from_ns), *to = pose_at(m.header.t_ns);
    if (!from || !to || (m.header.flags & ODO_VO_COVARIANCE) == 0) continue;
    const Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>> covariance(m.covariance);
    const Eigen::Quaterniond seen(m.q_c0_c1[0], m.q_c0_c1[1], m.q_c0_c1[2], m.q_c0_c1[3]);
    const Eigen::AngleAxisd off(seen * (from->q.conjugate() * to->q).conjugate());
    const Eigen::Vector3d turn = off.angle() * off.axis();
    result.rotation.push_back(turn.dot(covariance.topLeftCorner<3, 3>().inverse() * turn) / 3);
    const Eigen::Vector3d way = from->q.conjugate() * (to->p - from->p), seen_way(m.p_c0_c1);
    if (way.norm() < kLeastWay_m) continue;
    const Eigen::Vector3d across = seen_way - seen_way.norm() / way.norm() * way;
    result.direction.push_back(across.dot(covariance.bottomRightCorner<3, 3>().inverse() * across) / 2);
  }
  return result;
}

double mean_of(const std::vector<double>& values) { return values.empty() ? std::nan("") : statistics_of(values).mean; }

Result<Json> run_one(const Recording& recording, const std::string& config, const std::string& name) {
  Progress progress(name + " " + fs::path(config).stem().string());
  RunOptions options;
  options.config = config;
  options.progress = [&](size_t i, size_t n) { progress.show(i, n); };
  const auto result = replay(recording, options);
  if (!result) return result.failure();
  const Pairs pairs = associate(recording.truth, result->track, 0.02);
  if (pairs.reference.size() < 10) return Failure{ODO_E_DATA, name + ": fewer than ten frames have a true pose"};
  double scale = 1;
  const double length = path_length(pairs.reference), percent = 100 / std::max(length, 1e-9);
  const Trajectory aligned = align(pairs, Alignment::sim3, &scale);
  const auto end_with = [&](double window_m) {
    return absolute_errors(pairs.reference, with_true_lengths(pairs, window_m).track).translation_m.back() * percent;
  };
  std::vector<double> turn_deg;
  for (const double rad : relative_errors(pairs.reference, aligned, 1, false).rotation_rad)
    turn_deg.push_back(rad * 180 / EIGEN_PI);
  std::vector<double> changes;
  for (const double change : scale_changes(pairs, kTrueWindow_m)) changes.push_back(100 * std::abs(change));
  const Consistency nees = consistency_of(recording.truth, result->motions);
  const auto part = [&](uint32_t state) {
    return static_cast<double>(std::count(result->states.begin(), result->states.end(), state)) /
           static_cast<double>(std::max<size_t>(1, result->states.size()));
  };
  return Json{{"recording", name},
              {"config", config},
              {"path_m", length},
              {"ape_percent", statistics_of(absolute_errors(pairs.reference, aligned).translation_m).rmse * percent},
              {"true_lengths_end_percent", end_with(0)},
              {"true_windows_end_percent", end_with(kTrueWindow_m)},
              {"scale_change_median_percent", changes.empty() ? std::nan("") : percentile(changes, 0.5)},
              {"scale_change_p95_percent", changes.empty() ? std::nan("") : percentile(changes, 0.95)},
              {"rotation_median_deg", percentile(turn_deg, 0.5)},
              {"tracking", part(ODO_TRACKING)},
              {"lost", part(ODO_LOST)},
              {"rotation_nees", mean_of(nees.rotation)},
              {"direction_nees", mean_of(nees.direction)},
              {"frame_ms_median", percentile(result->frame_ms, 0.5)},
              {"frame_ms_p99", percentile(result->frame_ms, 0.99)}};
}

void print_row(const Json& row, const std::string& name) {
  const auto value = [&](const char* key) { return row[key].is_null() ? std::nan("") : row[key].get<double>(); };
  std::printf("%-26s %-24s %7.2f %9.2f %9.2f %7.2f %7.2f %9.4f %7.0f %5.0f %7.2f %7.2f %7.1f %7.1f\n", name.c_str(),
              fs::path(row["config"].get<std::string>()).stem().c_str(), value("ape_percent"),
              value("true_lengths_end_percent"), value("true_windows_end_percent"),
              value("scale_change_median_percent"), value("scale_change_p95_percent"), value("rotation_median_deg"),
              100 * value("tracking"), 100 * value("lost"), value("rotation_nees"), value("direction_nees"),
              value("frame_ms_median"), value("frame_ms_p99"));
}

/// The median over recordings of everything that a row has.
Json medians(const std::vector<Json>& rows, const std::string& config) {
  Json out = {{"config", config}};
  for (const auto& [key, first] : rows.front().items()) {
    if (!first.is_number()) continue;
    std::vector<double> values;
    for (const Json& row : rows)
      if (row["config"] == config && row[key].is_number() && std::isfinite(row[key].get<double>()))
        values.push_back(row[key].get<double>());
    out[key] = values.empty() ? std::nan("") : percentile(values, 0.5);
  }
  return out;
}

Result<std::vector<fs::path>> recordings_of(const VoArguments& a) {
  std::vector<fs::path> files(a.recordings.begin(), a.recordings.end());
  if (!files.empty()) return files;
  std::vector<fs::path> scenarios(a.scenarios.begin(), a.scenarios.end());
  if (a.stress) {
    scenarios.clear();
    for (const auto& entry : fs::directory_iterator(fs::path(a.scenarios.front()).parent_path()))
      if (entry.path().filename().string().starts_with("stress_")) scenarios.push_back(entry.path());
    std::sort(scenarios.begin(), scenarios.end());
    if (scenarios.empty()) return Failure{ODO_E_NOT_FOUND, "no stress_*.yaml beside " + a.scenarios.front()};
  }
  for (const fs::path& scenario : scenarios)
    for (uint64_t seed = a.first_seed; seed < a.first_seed + a.seeds; ++seed) {
      auto file = kept_recording(scenario, seed, a.keep, 0);
      if (!file) return file.failure();
      files.push_back(*file);
    }
  return files;
}

int bench_vo(const VoArguments& a) {
  const auto files = recordings_of(a);
  if (!files) return complain(files.failure());
  std::vector<Json> rows;
  for (const fs::path& file : *files) {
    const auto recording = read_recording(file);
    if (!recording) return complain(recording.failure());
    const std::string name = file.stem().string();
    for (const std::string& config : a.configs) {
      const auto row = run_one(*recording, config, name.substr(0, 26));
      if (!row) return complain(row.failure());
      rows.push_back(*row);
    }
  }
  if (a.json) {
    std::printf("%s\n", Json(rows).dump(2).c_str());
    return kDone;
  }
  std::printf("%-26s %-24s %7s %9s %9s %7s %7s %9s %7s %5s %7s %7s %7s %7s\n", "recording", "config", "APE", "lengths",
              "windows", "scale", "scale", "turn", "track", "lost", "NEES", "NEES", "ms", "ms");
  std::printf("%-26s %-24s %7s %9s %9s %7s %7s %9s %7s %5s %7s %7s %7s %7s\n", "", "", "%", "end %", "end %",
              "median %", "95 %", "deg", "%", "%", "turn", "way", "median", "99 %");
  for (const Json& row : rows) print_row(row, row["recording"].get<std::string>().substr(0, 26));
  if (files->size() > 1)
    for (const std::string& config : a.configs) print_row(medians(rows, config), "median");
  std::printf(
      "\nAPE: after Sim(3), of the path. lengths, windows: error at the end when each frame's displacement, or each "
      "%.0f m of\n"
      "the path, is given its true length. scale: how much it\n"
      "changes from one half of such a stretch to the other. turn: rotation error of a frame, median. NEES: normalised "
      "error squared of "
      "a\n"
      "frame's turn and of its direction, by degree of freedom; 1 is consistent.\n",
      kTrueWindow_m);
  return kDone;
}

}  // namespace

void add_bench_vo(CLI::App& bench, int& status) {
  auto a = std::make_shared<VoArguments>();
  auto* command =
      bench.add_subcommand("vo", "Visual odometries side by side, on simulated walks or recordings with truth");
  command->add_option("recordings", a->recordings, "recordings with true poses; none: simulated ones");
  command->add_option("-c,--config", a->configs, "pipeline configs to compare")->capture_default_str();
  command->add_option("--scenario", a->scenarios, "what is simulated")->capture_default_str();
  command->add_flag("--stress", a->stress, "the stress_*.yaml beside the scenario instead");
  command->add_option("--seeds", a->seeds, "how many of each")->capture_default_str()->check(CLI::Range(1, 1000));
  command->add_option("--first-seed", a->first_seed, "the first of them")->capture_default_str();
  command->add_option("--keep", a->keep, "recordings are kept here and rendered once")->capture_default_str();
  command->add_flag("--json", a->json, "print one JSON array, an entry for each run");
  command->callback([a, &status] { status = bench_vo(*a); });
}

}  // namespace odograph
