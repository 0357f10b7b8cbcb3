// SPDX-License-Identifier: Apache-2.0
//
// Tracking of corners through recordings, to compare simulated pictures with real ones.
#include "sdk/tools/benchmarks/benchmarks.hpp"
#include "sdk/tools/evaluation/evaluation.hpp"
#include "sdk/tools/evaluation/excitation.hpp"
#include "sdk/tools/replay/picture_source.hpp"

namespace odograph {
namespace {

constexpr double kWindows_s[] = {4, 8};
constexpr size_t kFrames = 200;  // of each recording

struct Tracks : Benchmark {
  Tracks()
      : Benchmark("tracks", "Tracking of corners through recordings: track lengths, inliers, flow",
                  kConfigs | kRecordings, {"monocular_odograph"}) {}
  void add_options(CLI::App& command) override {
    command.add_flag("--excitation-only", excitation_only,
                     "only S, N and the pull: rms of the true motion about a quadratic in time, rms error of a visual "
                     "trajectory (of the first config; vision only) after Sim(3), and S^2/(S^2+N^2), in windows of 4 "
                     "and 8 s (medians; overlapping by half; without windows below 0.25 m/s)");
  }

  Result<std::vector<BenchCase>> recordings() override {
    options.configs.resize(1);
    std::error_code error;
    with_error = std::filesystem::exists(options.configs.front().substr(0, options.configs.front().find('?')), error);
    return Benchmark::recordings();
  }
  Result<bool> complete(BenchCase& one) const override {
    if (!with_error) one.run.config.clear();
    return true;
  }

  Result<Json> measure_recording(const BenchCase& one, const Recording& recording) const override {
    Json row = Json::object();
    if (recording.truth.size() >= 10) {
      Pairs pairs{recording.truth, recording.truth};
      if (with_error) {
        const auto result = replay(recording, one.run);
        if (!result) return result.failure();
        // If a recording does not state its camera's clock offset, the offset may exceed the tolerance of an
        // evaluation.
        pairs = associate(recording.truth, result->track, 0.045);
      }
      std::vector<Figure> figures;
      for (const double window_s : kWindows_s) {
        const Excitation e = excitation_of(pairs, {.window_s = window_s});
        const std::string key = text("window_%.0f_s/", window_s), head = text("%.0f s windows", window_s);
        figures.push_back({head, "S mm", key + "motion_mm", 1, 1e3 * e.motion_m});
        figures.push_back({"", "N mm", key + "error_mm", 1, with_error ? Json(1e3 * e.error_m) : Json()});
        figures.push_back({"", "pull", key + "pull", 2, with_error ? Json(e.attenuation) : Json()});
        figures.push_back({"", "n", key + "windows", 0, e.windows});
      }
      row = row_of(figures);
    }
    if (excitation_only) return row;
    const auto tracks = measure_corner_flow(recording, kFrames, one.run.progress);
    if (!tracks) return tracks.failure();
    row.update(row_of({{"", "frames", "frames", 0, tracks->frames},
                       {"", "Hz", "rate_hz", 1, tracks->rate_hz},
                       {"track length", "", "_lengths", 0, tracks->lengths, {.parts = {0.25, 0.5, 0.75}}},
                       {"found again", "", "_kept", 3, tracks->kept, {.parts = {0.5, 0.1}}},
                       {"one motion", "", "_inliers", 3, tracks->inliers, {.parts = {0.5, 0.1}}},
                       {"flow px", "", "_flow_px", 2, tracks->flow_px, {.parts = {0.5, 0.9}}}},
                      "tracks"));
    return row;
  }

  std::string heading(const Rows& rows) const override {
    const auto columns = columns_of(rows, "tracks");
    std::string out;
    if (!excitation_only)
      out = text(
                "Up to %d corners, pyramidal Lucas-Kanade with a forward-backward check of 0.7 px, five-point RANSAC "
                "within 1 px; lengths in frames.\n\n",
                kMaxCorners) +
            table_text({"", {{"recording", "recording"}}, columns}, summaries_of(rows, "recording", columns)) + '\n';
    out += text(
        "S: rms of the true motion about the best-fitting quadratic in time of a window; N: the same for the error of "
        "%s\nafter Sim(3) in that window. Medians over windows that overlap by half, without those at rest.\nPull: S^2 "
        "/ (S^2 + N^2).\n\n",
        options.configs.front().c_str());
    if (with_error) return out;
    return out + options.configs.front() +
           ": no such file (run from the source folder, or give its path), so there is no N.\n\n";
  }

  bool excitation_only = false, with_error = false;
};

}  // namespace

Benchmarks tracks_benchmarks() { return {std::make_shared<Tracks>()}; }

}  // namespace odograph
