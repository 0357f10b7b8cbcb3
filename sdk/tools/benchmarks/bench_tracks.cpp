// SPDX-License-Identifier: Apache-2.0
//
// `odograph bench tracks`: how well corners can be followed through the pictures of recordings, real beside simulated.
#include <algorithm>

#include "sdk/tools/benchmarks/benchmarks.hpp"
#include "sdk/tools/evaluation/excitation.hpp"
#include "sdk/tools/replay/picture_source.hpp"

namespace odograph {
namespace {

constexpr double kWindows_s[] = {4, 8};

struct Tracks : Benchmark {
  Tracks()
      : Benchmark("tracks", "How corners can be followed through recordings: lengths of tracks, inliers, flow",
                  kConfigs | kPlot | kRecordings) {
    options.configs = {"samples/configs/monocular_odograph.yaml"};
  }
  void add_options(CLI::App& command) override {
    command.add_option("--frames", frames, "the first so many of each");
    command.add_flag(
        "--excitation-only", excitation_only,
        "S, N and the pull alone: rms of the true motion about a quadratic in time, rms error of a visual trajectory "
        "(of the first config; vision alone) after Sim(3), and S^2/(S^2+N^2), in windows of 4 and 8 s (medians; "
        "overlapping by half; windows with less than 0.25 m/s left out)");
  }

  Result<std::vector<BenchCase>> cases() override {
    options.configs.resize(1);
    auto all = Benchmark::cases();
    std::error_code error;
    with_error = std::filesystem::exists(options.configs.front().substr(0, options.configs.front().find('?')), error);
    for (BenchCase& one : *all)
      if (!with_error) one.run.config.clear();
    return all;
  }

  Result<Json> measure(const BenchCase& one, const ShowProgress& progress) const override {
    const auto recording = read_recording(one.files.front());
    if (!recording) return recording.failure();
    Json row = Json::object();
    if (recording->truth.size() >= 10) {
      Pairs pairs{recording->truth, recording->truth};
      if (with_error) {
        const auto result = replay(*recording, one.run);
        if (!result) return result.failure();
        // A camera's clock that the recording does not know of may be off by more than an evaluation would forgive.
        pairs = associate(recording->truth, result->track, 0.045);
      }
      for (const double window_s : kWindows_s) {
        const Excitation e = excitation_of(pairs, {.window_s = window_s});
        Json& window = row[text("window_%.0f_s", window_s)];
        window = {{"motion_mm", 1e3 * e.motion_m}, {"windows", e.windows}};
        if (with_error) window["error_mm"] = 1e3 * e.error_m, window["pull"] = e.pull;
      }
    }
    if (excitation_only) return row;
    const auto tracks = followed_corners(*recording, frames, progress);
    if (!tracks) return tracks.failure();
    row["frames"] = tracks->frames, row["rate_hz"] = tracks->rate_hz;
    row["_lengths"] = tracks->lengths, row["_kept"] = tracks->kept;
    row["_inliers"] = tracks->inliers, row["_flow_px"] = tracks->flow_px;
    return row;
  }

  BenchReport report(const Rows& rows) const override {
    BenchReport report;
    if (!excitation_only) report.text = tracks_text(rows) + '\n';
    report.text += text(
        "S: true motion about the quadratic in time that fits a window best, rms; N: error of %s after Sim(3) in that\n"
        "window, about a quadratic too, rms. Medians over windows that overlap by half, standing ones left out.\n"
        "Pull: S^2 / (S^2 + N^2).\n\n",
        options.configs.front().c_str());
    if (!with_error)
      report.text +=
          options.configs.front() + ": no such file (run from the source folder, or say where), so there is no N.\n\n";
    Table table{"", {{"recording", "recording"}}, {}};
    for (const double window_s : kWindows_s) {
      const std::string key = text("window_%.0f_s/", window_s), head = text("%.0f s windows", window_s);
      table.columns.push_back({head, "S mm", key + "motion_mm", 1});
      table.columns.push_back({"", "N mm", key + "error_mm", 1});
      table.columns.push_back({"", "pull", key + "pull", 2});
      table.columns.push_back({"", "n", key + "windows", 0});
    }
    report.text += table_text(table, rows);
    report.plot = {.title = "Corners still followed", .x_label = "frames", .y_label = "part"};
    for (const Json& row : rows) {
      const auto lengths = numbers_at({row}, "_lengths");
      PlotSeries series{.name = row["recording"].get<std::string>(), .style = "lines"};
      for (double k = 1; !lengths.empty() && k <= std::min(number_at(row, "frames") / 2, 60.0); ++k)
        series.points.emplace_back(
            k, static_cast<double>(std::count_if(lengths.begin(), lengths.end(), [k](double l) { return l >= k; })) /
                   static_cast<double>(lengths.size()));
      if (!series.points.empty()) report.plot.series.push_back(std::move(series));
    }
    return report;
  }

  static std::string tracks_text(const Rows& rows) {
    std::vector<Column> columns = {{"", "frames", "frames", 0, false, "", Over::first},
                                   {"", "Hz", "rate_hz", 1, false, "", Over::first}};
    const auto add = [&](const char* head, const std::string& from, int digits, std::initializer_list<double> parts) {
      for (const double part : parts)
        columns.push_back({head, text("%.0f %%", 100 * part), text("%s_%.0f", from.c_str(), 100 * part), digits, false,
                           from, Over::percentile, part});
    };
    add("track length", "_lengths", 0, {0.25, 0.5, 0.75});
    add("found again", "_kept", 3, {0.5, 0.1});
    add("one motion", "_inliers", 3, {0.5, 0.1});
    add("flow px", "_flow_px", 2, {0.5, 0.9});
    return text(
               "Up to %d corners, pyramidal Lucas-Kanade there and back within 0.7 px, five-point RANSAC within 1 px; "
               "lengths in frames.\n\n",
               kFollowedCorners) +
           table_text({"", {{"recording", "recording"}}, columns}, summaries_of(rows, "recording", columns));
  }

  size_t frames = 200;
  bool excitation_only = false, with_error = false;
};

}  // namespace

std::shared_ptr<Benchmark> bench_tracks() { return std::make_shared<Tracks>(); }

}  // namespace odograph
