// SPDX-License-Identifier: Apache-2.0
//
// What an app's anchors do on the screen and through a fix, in simulated time: `odograph bench anchors`.
#include "sdk/tools/benchmarks/benchmarks.hpp"
#include "sdk/tools/replay/anchor_walk.hpp"

namespace odograph {
namespace {

struct Anchors : Benchmark {
  Anchors()
      : Benchmark("anchors", "Anchors on the screen and through a fix, in simulated time; camera, IMU and truth",
                  kConfigs | kSeeds | kSimulated | kRecordings) {
    options.configs = {"samples/configs/walk_marks.yaml"};
    options.scenarios = {"samples/scenarios/street_short.yaml"};
  }
  void add_options(CLI::App& command) override {
    command.add_option("--settle", walk.settle_s, "seconds from the first position to the first anchor");
    command.add_option("--ahead", walk.ahead_m, "m from the camera to a new anchor");
  }

  Result<Json> measure(const BenchCase& one, const ShowProgress&) const override {
    const auto recording = read_recording(one.files.front());
    if (!recording) return recording.failure();
    const auto f = anchor_walk(*recording, one.run, walk);
    if (!f) return f.failure();
    return row_of("anchors", {{"", "looks", "looks", 0, f->px.size()},
                              {"corrected", "px median", "px_median", 2, part_of(f->px, 0.5)},
                              {"px", "95 %", "px_p95", 2, part_of(f->px, 0.95)},
                              {"smooth", "px median", "smooth_px_median", 2, part_of(f->smooth_px, 0.5)},
                              {"px", "95 %", "smooth_px_p95", 2, part_of(f->smooth_px, 0.95)},
                              {"drift", "m", "drift_m", 2, f->drift_m},
                              {"sigma", "m", "view_sigma_m", 2, f->view_sigma_m},
                              {"fix", "accepted", "fixed", 0, f->fixed},
                              {"start", "m", "start_off_m", 3, f->start_off_m},
                              {"newest", "m", "by_newest_m", 3, f->by_newest_m}});
  }

  BenchReport report(const Rows& rows) const override {
    return {
        recordings_text(rows, "anchors") +
        text("\npx: how far off an anchor is drawn that was placed %.0f m ahead and is %.0f to %.0f m away, on each "
             "picture as it\narrives and before it has been used; the first %.0f s left out. drift: of the phone at "
             "the end, and sigma what was\nsaid of it; start: how far off content placed at the start is after a fix "
             "at the end (sigma %.0f cm), and newest: if\nit had been moved as the phone was.\n",
             walk.ahead_m, walk.nearest_m, walk.farthest_m, walk.settle_s, 100 * walk.mark_sigma_m)};
  }

  AnchorWalkOptions walk;
};

}  // namespace

std::shared_ptr<Benchmark> bench_anchors() { return std::make_shared<Anchors>(); }

}  // namespace odograph
