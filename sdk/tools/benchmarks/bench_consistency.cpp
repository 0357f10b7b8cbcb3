// SPDX-License-Identifier: Apache-2.0
//
// Whether poses err by as much as they say, and what they cost: `odograph bench consistency`.
#include "sdk/tools/benchmarks/benchmarks.hpp"
#include "sdk/tools/evaluation/degrade.hpp"
#include "sdk/tools/evaluation/pose_consistency.hpp"
#include "sdk/tools/replay/marked_run.hpp"

namespace odograph {
namespace {

struct Consistency : Benchmark {
  Consistency()
      : Benchmark("consistency", "Do poses err by as much as they say; what they cost", kConfigs | kRecordings) {
    options.configs = {"samples/configs/walk.yaml"};
  }
  void add_options(CLI::App& command) override {
    command.add_option("--first", first_s, "s from the start that are run");
    command.add_option("--marks", marks.sigma_m,
                       "tell the session where it is, with errors of so many m on each axis; the config has "
                       "fix/waypoint with `use: all`");
    command.add_option("--every", marks.every_s, "s between two of --marks");
    command.add_flag("--sensors", sensors, "each recording as it is and with one fault of the sensors after the other")
        ->group(kCases);
    command.add_option("--seed", marks.seed, "of the errors of --marks and --sensors");
  }

  Result<std::vector<BenchCase>> cases() override {
    if (sensors) variants = names_of(sensor_qualities());
    return Benchmark::cases();
  }

  Result<Json> measure(const BenchCase& one, const ShowProgress&) const override {
    auto recording = read_recording(one.files.front(), {.true_states = false});
    if (!recording) return recording.failure();
    if (sensors) *recording = degraded(*recording, sensor_qualities()[one.variant], marks.seed);
    const auto run = marked_run(*recording, one.run, marks, first_s);
    if (!run) return run.failure();
    const PoseConsistency f = pose_consistency(run->poses, recording->truth);
    const auto known = [&](double x) { return f.poses < 3 ? Json() : Json(x); };
    return row_of("consistency", {{"", "", "poses", -1, f.poses},
                                  {"path", "m", "path_m", 1, known(f.path_m)},
                                  {"APE yaw", "%", "ape_percent", 2, known(100 * f.ape_m / f.path_m)},
                                  {"scale", "%", "scale_percent", 2, known(100 * f.scale_error), true},
                                  {"NEES", "position", "position_nees", 2, known(f.position_nees)},
                                  {"NEES", "heading", "heading_nees", 2, known(f.heading_nees)},
                                  {"beyond 3 sigma", "position s", "position_beyond_s", 1, known(f.position_beyond_s)},
                                  {"beyond 3 sigma", "heading s", "heading_beyond_s", 1, known(f.heading_beyond_s)},
                                  {"times", "realtime", "times_realtime", 1, run->times_realtime},
                                  {"peak", "MB", "peak_rss_mb", 0, peak_rss_mb()}});
  }

  BenchReport report(const Rows& rows) const override {
    std::vector<Column> columns = columns_of(rows, "consistency");
    for (Column& c : columns) {  // means, but of the times the longest, and of the scale the mean size
      const bool longest = c.key.ends_with("beyond_s") || c.key == "peak_rss_mb";
      c.over = longest ? Over::percentile : Over::mean, c.part = 1, c.absolute = true;
    }
    Rows all = rows;
    if (options.recordings.size() > 1)
      for (Json& mean : summaries_of(rows, "config", columns))
        mean["recording"] = "mean, longest", mean["_consistency"] = rows[0]["_consistency"], all.push_back(mean);
    return {recordings_text(all, "consistency") +
            "\nNEES: error squared over its covariance, per degree of freedom, mean over the poses, the first of them "
            "laid on\nthe truth; 1 is consistent. beyond 3 sigma: the longest time without a break. times realtime: of "
            "one core's time,\npictures decoded. peak: resident, of the process of the run.\n"};
  }

  double first_s = 1e9;
  MarkOptions marks;
  bool sensors = false;
};

}  // namespace

std::shared_ptr<Benchmark> bench_consistency() { return std::make_shared<Consistency>(); }

}  // namespace odograph
