// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdio>
#include <optional>
#include <set>

#include <nlohmann/json.hpp>

#include "sdk/math/time.hpp"
#include "sdk/host/base/output_file.hpp"
#include "sdk/tools/command_line/commands.hpp"
#include "sdk/tools/page/run_page.hpp"
#include "sdk/tools/replay/runner.hpp"
#include "sdk/tools/recording/run_track.hpp"
#include "sdk/tools/text/text.hpp"

namespace odograph {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

struct EvalArguments {
  std::string reference, estimate, alignment = "none", rpe_unit = "frames", plot;
  double max_difference_s = 0.01, rpe_delta = 1, window_m = 10, align_first_m = 10;
  double true_window_m = 0, offset_s = 0;
  bool true_lengths = false, json = false;
};

/// A reference: a trajectory, or the waypoints of a walk.
struct Reference {
  StampedPoses trajectory;
  std::vector<Waypoint> waypoints;
  RecordingLoss loss;
};

Result<Reference> read_reference(const fs::path& path) {
  std::error_code error;
  Reference reference;
  if (fs::is_directory(path, error) && fs::exists(path / "trajectory.tum", error)) {
    auto trajectory = read_tum(path / "trajectory.tum");
    if (!trajectory) return trajectory.failure();
    reference.trajectory = std::move(*trajectory);
    return reference;
  }
  const bool is_file = !fs::is_directory(path, error);
  if (is_file && path.extension() != ".odo") {
    const fs::path times = path.parent_path() / "times.txt";
    auto trajectory = read_poses(path, fs::exists(times, error) && path.filename() == "poses.txt" ? times : fs::path());
    if (trajectory) {
      reference.trajectory = std::move(*trajectory);
      return reference;
    }
    if (auto walk = read_indoor_location(path)) {
      reference.waypoints = walk->waypoints();
      return reference;
    }
    return trajectory.failure();
  }
  auto recording = open_recording(path);
  if (!recording) return recording.failure();
  reference.loss = recording->loss;
  reference.trajectory = std::move(recording->truth);
  reference.waypoints = recording->waypoints();
  if (reference.trajectory.empty() && reference.waypoints.empty())
    return Failure{ODO_E_DATA, path.string() + ": this recording has no truth"};
  return reference;
}

Result<StampedPoses> read_estimate(const fs::path& path) {
  std::error_code error;
  return fs::is_directory(path, error) ? read_tum(path / "trajectory.tum") : read_poses(path);
}

/// Times that cannot be those of the poses: most are repeated, as whole seconds are.
std::optional<Failure> time_fault(const std::string& name, const StampedPoses& track) {
  std::set<int64_t> times;
  for (const StampedPose& pose : track) times.insert(pose.t_ns);
  if (2 * times.size() > track.size() || track.size() < 4) return std::nullopt;
  return Failure{ODO_E_DATA, name + ": its " + std::to_string(track.size()) + " poses have " +
                                 std::to_string(times.size()) + " different times: were they rounded to seconds?"};
}

/// KITTI's poses have no times: row i of one file can only be row i of the other.
std::optional<Failure> row_fault(const StampedPoses& reference, const StampedPoses& estimate) {
  const auto counted = [](const StampedPoses& track) {
    for (size_t i = 0; i < track.size(); ++i)
      if (track[i].t_ns != kKittiInterval_ns * static_cast<int64_t>(i)) return false;
    return track.size() > 1;
  };
  if (reference.size() == estimate.size() || !counted(reference) || !counted(estimate)) return std::nullopt;
  return Failure{ODO_E_DATA, "the estimate has " + std::to_string(estimate.size()) + " poses, the truth " +
                                 std::to_string(reference.size()) +
                                 ", and KITTI's files have no times: which belong together is unknown; give all rows, "
                                 "or TUM files with times"};
}

Json json_of(const Statistics& s) {
  return {{"rmse", s.rmse}, {"mean", s.mean}, {"median", s.median}, {"std", s.std},
          {"min", s.min},   {"max", s.max},   {"sse", s.sse}};
}

Json cdf_of(const std::vector<double>& errors) {
  Json cdf = Json::object();
  for (const int p : {10, 25, 50, 68, 75, 90, 95, 99}) cdf[std::to_string(p)] = percentile(errors, p / 100.0);
  return cdf;
}

std::vector<double> degrees(std::vector<double> radians) {
  for (double& x : radians) x *= 180.0 / EIGEN_PI;
  return radians;
}

Json evaluate_waypoints(const StampedPoses& track, const std::vector<Waypoint>& waypoints, double metres) {
  const double rotation = heading_offset(track, waypoints, metres);
  const WaypointErrors errors = waypoint_errors(align_to_waypoints(track, waypoints, rotation), waypoints);
  return {{"waypoints", waypoints.size()},
          {"reference_m", errors.reference_m},
          {"estimate_m", errors.estimate_m},
          {"distance_error_percent", 100 * errors.distance_error()},
          {"heading_offset_rad", rotation},
          {"position_m", json_of(statistics_of(errors.position_m))},
          {"position_cdf_m", cdf_of(errors.position_m)}};
}

Json evaluate_true_lengths(const Pairs& pairs, double window_m, double length_m) {
  const TrueLengths scaled = with_true_lengths(pairs, window_m);
  const PoseErrors errors = absolute_errors(pairs.reference, scaled.track);
  const auto directions = degrees(scaled.direction_error_rad);
  const Statistics ape = statistics_of(errors.translation_m);
  const double percent = length_m > 0 ? 100.0 / length_m : 0.0;
  return {{"window_m", window_m},
          {"end_error_m", errors.translation_m.back()},
          {"end_error_percent", errors.translation_m.back() * percent},
          {"ape_m", json_of(ape)},
          {"ape_percent_of_path", ape.rmse * percent},
          {"direction_median_deg", percentile(directions, 0.5)},
          {"direction_p90_deg", percentile(directions, 0.9)},
          {"backwards", std::count_if(directions.begin(), directions.end(), [](double d) { return d > 90; })},
          {"without_motion", scaled.without_motion}};
}

Result<Json> evaluate_trajectory(const StampedPoses& reference, const StampedPoses& estimate, const EvalArguments& a,
                                 Alignment alignment) {
  const Pairs pairs = associate(reference, estimate, a.max_difference_s);
  if (pairs.reference.size() < 2)
    return Failure{ODO_E_DATA, "only " + std::to_string(pairs.reference.size()) +
                                   " poses of reference and estimate are within " + std::to_string(a.max_difference_s) +
                                   " s of each other; are the clocks the same? (--offset, --max-diff)"};
  double scale = 1;
  const StampedPoses aligned = align(pairs, alignment, &scale);
  const PoseErrors ape = absolute_errors(pairs.reference, aligned);
  const PoseErrors rpe = relative_errors(pairs.reference, aligned, a.rpe_delta, a.rpe_unit == "metres");
  const double length = path_length(pairs.reference);
  const auto ratios = scale_along_path(pairs.reference, aligned, a.window_m);
  std::vector<double> horizontal, ratio_values;
  for (size_t i = 0; i < aligned.size(); ++i)
    horizontal.push_back((aligned[i].p - pairs.reference[i].p).head<2>().norm());
  Json ratio_rows = Json::array();
  for (const auto& [s, r] : ratios) ratio_rows.push_back({s, r}), ratio_values.push_back(r);
  const double percent = length > 0 ? 100.0 / length : 0.0;
  Json out = {{"n", pairs.reference.size()},
              {"n_estimate", estimate.size()},
              {"n_reference", reference.size()},
              {"alignment", a.alignment},
              {"scale", scale},
              {"path_m", length},
              {"path_estimate_m", path_length(aligned)},
              {"ape_m", json_of(statistics_of(ape.translation_m))},
              {"ape_deg", json_of(statistics_of(degrees(ape.rotation_rad)))},
              {"rpe_m", json_of(statistics_of(rpe.translation_m))},
              {"rpe_deg", json_of(statistics_of(degrees(rpe.rotation_rad)))},
              {"rpe_delta", a.rpe_delta},
              {"rpe_unit", a.rpe_unit},
              {"ape_percent_of_path", statistics_of(ape.translation_m).rmse * percent},
              {"end_error_m", ape.translation_m.back()},
              {"end_error_percent", ape.translation_m.back() * percent},
              {"horizontal_m", json_of(statistics_of(horizontal))},
              {"horizontal_cdf_m", cdf_of(horizontal)},
              {"scale_ratio",
               {{"median", percentile(ratio_values, 0.5)},
                {"p10", percentile(ratio_values, 0.1)},
                {"p90", percentile(ratio_values, 0.9)},
                {"along_path", ratio_rows}}}};
  if (a.true_lengths) out["true_lengths"] = evaluate_true_lengths(pairs, a.true_window_m, length);
  return out;
}

void print_true_lengths(const Json& t) {
  std::printf(
      "with the true length of each %s: error at the end %.3f m, %.3f %% of the path; APE rmse %.3f m, %.3f %%\n",
      t["window_m"].get<double>() > 0 ? "window" : "frame's displacement", t["end_error_m"].get<double>(),
      t["end_error_percent"].get<double>(), t["ape_m"]["rmse"].get<double>(), t["ape_percent_of_path"].get<double>());
  std::printf(
      "direction of the displacements: median error %.3f deg, 90 %% %.3f deg; %zu backwards; %zu frames without any\n",
      t["direction_median_deg"].get<double>(), t["direction_p90_deg"].get<double>(), t["backwards"].get<size_t>(),
      t["without_motion"].get<size_t>());
}

void print(const Json& json, const std::string& head) {
  const auto line = [](const char* name, const Json& s, const char* unit) {
    std::printf("%-22s rmse %-11.6g mean %-11.6g median %-11.6g std %-11.6g min %-11.6g max %-11.6g sse %-11.6g %s\n",
                name, s["rmse"].get<double>(), s["mean"].get<double>(), s["median"].get<double>(),
                s["std"].get<double>(), s["min"].get<double>(), s["max"].get<double>(), s["sse"].get<double>(), unit);
  };
  std::printf("%s\n", head.c_str());
  if (json.contains("waypoints")) {
    const Json& w = json["waypoints"];
    std::printf("waypoints              %zu, %.2f m along them, track %.2f m: distance error %+.2f %%\n",
                w["waypoints"].get<size_t>(), w["reference_m"].get<double>(), w["estimate_m"].get<double>(),
                w["distance_error_percent"].get<double>());
    line("position at waypoints", w["position_m"], "m");
  }
  if (!json.contains("n")) return;
  const size_t matched = json["n"].get<size_t>();
  const size_t could = std::min(json["n_estimate"].get<size_t>(), json["n_reference"].get<size_t>());
  if (matched < could)
    std::printf("%zu of %zu poses have no match in time and are skipped (--max-diff)\n", could - matched, could);
  std::printf("poses %zu, path %.3f m, alignment %s, scale %.6f\n", json["n"].get<size_t>(),
              json["path_m"].get<double>(), json["alignment"].get<std::string>().c_str(), json["scale"].get<double>());
  line("APE translation", json["ape_m"], "m");
  line("APE rotation", json["ape_deg"], "deg");
  line("RPE translation", json["rpe_m"], "m");
  line("RPE rotation", json["rpe_deg"], "deg");
  line("horizontal error", json["horizontal_m"], "m");
  std::printf("APE is %.3f %% of the path; error at the end %.3f m, %.3f %% of the path\n",
              json["ape_percent_of_path"].get<double>(), json["end_error_m"].get<double>(),
              json["end_error_percent"].get<double>());
  std::printf("horizontal error below:");
  for (const auto& [p, value] : json["horizontal_cdf_m"].items())
    std::printf("  %s %%: %.3f m", p.c_str(), value.get<double>());
  const Json& ratio = json["scale_ratio"];
  std::printf("\nscale ratio along the path (windows of the path): median %.4f, 10 %%: %.4f, 90 %%: %.4f\n",
              ratio["median"].get<double>(), ratio["p10"].get<double>(), ratio["p90"].get<double>());
  if (json.contains("true_lengths")) print_true_lengths(json["true_lengths"]);
}

/// Writes the page of a run for any two trajectories.
Result<bool> write_plot(const EvalArguments& a, const Reference& reference, const StampedPoses& estimate,
                        Alignment alignment, const Json& result) {
  Recording recording;
  recording.path = a.reference, recording.format = "the truth", recording.truth = reference.trajectory;
  for (const Waypoint& w : reference.waypoints) {
    auto waypoint = make_message<odo_waypoint>(ODO_TYPE_WAYPOINT, w.t_ns);
    Eigen::Vector3d::Map(waypoint.p_n) = w.p_n;
    recording.add(waypoint.header);
  }
  RunResult run;
  run.track = estimate;
  run.states.assign(estimate.size(), ODO_TRACKING);
  PageOptions::Evaluation shown{alignment, "--align " + a.alignment, {}, {}};
  const auto figure = [&](const char* name, const char* key, const char* unit) {
    if (!result.contains(key)) return;
    shown.figures.emplace_back(name, text("%.4g %s rms, median %.4g, largest %.4g", result[key]["rmse"].get<double>(),
                                          unit, result[key]["median"].get<double>(), result[key]["max"].get<double>()));
  };
  figure("APE, translation", "ape_m", "m"), figure("APE, rotation", "ape_deg", "degrees");
  figure("RPE, translation", "rpe_m", "m"), figure("RPE, rotation", "rpe_deg", "degrees");
  figure("Horizontal error", "horizontal_m", "m");
  const Pairs pairs = associate(reference.trajectory, estimate, a.max_difference_s);
  double scale = 1;
  const auto delta = static_cast<size_t>(std::max(1.0, a.rpe_delta));
  if (a.rpe_unit == "frames" && pairs.estimate.size() > delta) {
    const auto relative = relative_errors(pairs.reference, align(pairs, alignment, &scale), a.rpe_delta, false);
    for (size_t k = 0; k < relative.translation_m.size() && (k + 1) * delta < pairs.estimate.size(); ++k)
      shown.relative_m.emplace_back(seconds(pairs.estimate[(k + 1) * delta].t_ns - estimate.front().t_ns),
                                    relative.translation_m[k]);
  }
  PageOptions options;
  options.command = "odograph eval --ref " + a.reference + " --est " + a.estimate + " --align " + a.alignment;
  options.evaluation = std::move(shown);
  return write_whole_file(a.plot, run_page(recording, {{fs::path(a.estimate).filename().string(), &run}}, options));
}

Result<Json> evaluate(const Reference& reference, const StampedPoses& estimate, const EvalArguments& a,
                      Alignment alignment) {
  Json out = Json::object();
  if (reference.waypoints.size() >= 2)
    out["waypoints"] = evaluate_waypoints(estimate, reference.waypoints, a.align_first_m);
  if (reference.trajectory.empty()) return out;
  const auto result = evaluate_trajectory(reference.trajectory, estimate, a, alignment);
  if (!result) return result.failure();
  out.update(*result);
  return out;
}

/// Of a run, both tracks: as an app saw it, and with later corrections.
void print_all(const Json& out, const EvalArguments& a) {
  const std::string against = " against " + a.reference;
  if (!out.contains("corrected")) return print(out, a.estimate + against);
  print(out, a.estimate + "/trajectory.tum, as published," + against);
  std::printf("\n");
  print(out["corrected"], a.estimate + "/corrected.tum, with later corrections," + against);
}

int eval(const EvalArguments& a) {
  const auto alignment = parse_alignment(a.alignment);
  if (!alignment) return print_failure(alignment.failure());
  const auto reference = read_reference(a.reference);
  if (!reference) return print_failure(reference.failure());
  auto estimate = read_estimate(a.estimate);
  if (!estimate) return print_failure(estimate.failure());
  for (const auto& fault : {time_fault(a.reference, reference->trajectory), time_fault(a.estimate, *estimate),
                            row_fault(reference->trajectory, *estimate)})
    if (fault) return print_failure(*fault);
  const auto shift = [&](StampedPoses& track) {
    for (StampedPose& pose : track) pose.t_ns += nanoseconds(a.offset_s);
  };
  shift(*estimate);
  const auto evaluated = evaluate(*reference, *estimate, a, *alignment);
  if (!evaluated) return print_failure(evaluated.failure());
  Json out = *evaluated;
  if (const fs::path corrected = fs::path(a.estimate) / "corrected.tum"; fs::exists(corrected)) {
    auto track = read_tum(corrected);
    if (!track) return print_failure(track.failure());
    shift(*track);
    const auto later = evaluate(*reference, *track, a, *alignment);
    if (!later) return print_failure(later.failure());
    out["corrected"] = *later;
  }
  if (!a.plot.empty())
    if (const auto written = write_plot(a, *reference, *estimate, *alignment, out); !written)
      return print_failure(written.failure());
  if (a.json)
    std::printf("%s\n", out.dump(2).c_str());
  else
    print_all(out, a);
  return exit_status(reference->loss, kDone);
}

}  // namespace

void add_eval(CLI::App& app, int& status) {
  auto* command = app.add_subcommand("eval", "Compare a track with the truth");
  auto a = std::make_shared<EvalArguments>();
  command
      ->add_option("--ref", a->reference,
                   "truth: TUM, KITTI or EuRoC poses, a recording that has truth, or a walk with waypoints")
      ->required();
  command->add_option("--est", a->estimate, "track: TUM or KITTI poses, or the folder of a run")->required();
  command->add_option("--align", a->alignment, "alignment of the track with the truth: none, first, yaw, se3 or sim3")
      ->capture_default_str();
  command->add_option("--max-diff", a->max_difference_s, "maximum time difference of a pair, s")->capture_default_str();
  command
      ->add_option("--offset", a->offset_s, "added to the times of the estimate, s, for a reference with another clock")
      ->check(CLI::Range(-4e9, 4e9));
  command->add_option("--rpe-delta", a->rpe_delta, "interval of the relative error (RPE)")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  command->add_option("--rpe-unit", a->rpe_unit, "unit of --rpe-delta: frames or metres")
      ->capture_default_str()
      ->check(CLI::IsMember({"frames", "metres"}));
  command->add_option("--window", a->window_m, "length of a window of the scale ratio along the path, m")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  command
      ->add_option("--align-first", a->align_first_m,
                   "waypoints: distance from the start over which the heading is fitted, m")
      ->capture_default_str();
  command->add_flag(
      "--true-lengths", a->true_lengths,
      "also print the errors with the true length of each frame's displacement, as with a perfect scale source");
  command
      ->add_option("--true-window", a->true_window_m,
                   "with --true-lengths: one factor per window of this path length, m; 0: per frame")
      ->capture_default_str()
      ->check(CLI::NonNegativeNumber);
  command->add_option("--plot", a->plot,
                      "write a page (HTML): both tracks, the estimate coloured by its error, coordinates, angles and "
                      "errors over time");
  command->add_flag("--json", a->json, "print one JSON object");
  command->callback([a, &status] { status = eval(*a); });
}

}  // namespace odograph
