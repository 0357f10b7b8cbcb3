// SPDX-License-Identifier: Apache-2.0
//
// Output to an app: the poses for drawing, its anchors, and the consistency of the stated covariances.
#include "sdk/math/time.hpp"
#include "sdk/tools/benchmarks/benchmarks.hpp"
#include "sdk/tools/evaluation/pose_consistency.hpp"
#include "sdk/tools/replay/anchor_walk.hpp"
#include "sdk/tools/replay/app_stream.hpp"
#include "sdk/tools/replay/marked_run.hpp"

namespace odograph {
namespace {

struct StreamBenchmark : Benchmark {
  StreamBenchmark()
      : Benchmark("stream", "Poses predicted ahead for an app, in simulated time; camera and IMU",
                  kConfigs | kSimulated | kRecordings, {"walk"}) {}
  void add_options(CLI::App& command) override {
    command.add_option("--ahead", timing.ahead_ms, "prediction time, ms");
    command.add_option("--settle", settle_s, "time excluded at the start, s");
  }

  Result<Json> measure_recording(const BenchCase& one, const Recording& recording) const override {
    const auto stream = app_stream(recording, one.run, timing);
    if (!stream) return stream.failure();
    const int64_t start_ns = recording.messages.front().message.header().t_ns + nanoseconds(settle_s);
    const StreamFigures f = stream_figures(stream->poses, recording.truth, start_ns);
    return row_of(
        {{"", "frames", "frames", 0, f.frames},
         {"orientation", "deg median", "orientation_deg_median", 2, percentile_or_nan(f.orientation_deg, 0.5)},
         {"deg", "99 %", "orientation_deg_p99", 2, percentile_or_nan(f.orientation_deg, 0.99)},
         {"position", "mm median", "position_mm_median", 1, 1e3 * percentile_or_nan(f.position_m, 0.5)},
         {"mm", "99 %", "position_mm_p99", 1, 1e3 * percentile_or_nan(f.position_m, 0.99)},
         {"no", "position", "without_position", 0, f.without_position},
         {"repeated", "polls", "repeated", 0, f.repeated},
         {"", "corrections", "corrections", 0, stream->corrections},
         {"jump", "cm", "jump_cm", 1, 100 * f.jump_m},
         {"smooth", "cm", "smooth_jump_cm", 1, 100 * f.smooth_jump_m},
         {"lag", "s", "smooth_lag_s", 2, f.smooth_lag_s},
         {"jerk", "m/s^3", "smooth_jerk_mps3", 1, f.smooth_jerk_mps3},
         {"behind", "cm median", "live_cm_median", 1, 100 * percentile_or_nan(f.live_m, 0.5)},
         {"smooth", "cm median", "smooth_cm_median", 1, 100 * percentile_or_nan(f.smooth_m, 0.5)},
         {"cm", "95 %", "smooth_cm_p95", 1, 100 * percentile_or_nan(f.smooth_m, 0.95)},
         {"get_pose", "us median", "get_pose_us_median", 2, percentile(stream->poll_us, 0.5)},
         {"us", "99 %", "get_pose_us_p99", 2, percentile(stream->poll_us, 0.99)},
         {"statistics", "us, 99 %", "get_statistics_us_p99", 2, percentile(stream->statistics_us, 0.99)}});
  }

  std::string notes(const Rows&) const override {
    return text(
        "\nPoses predicted %.0f ms ahead, compared with the pipeline's later ones, without the first %.0f s. Gyroscope "
        "and\naccelerometer (%.0f Hz) separate and %.0f ms late, pictures %.0f ms. jump: the largest excess of a step "
        "between two\npolls at %.0f Hz over the true one, from the start on.\n",
        timing.ahead_ms, settle_s, timing.late.accel_hz, timing.late.imu_late_ms, timing.late.frame_late_ms,
        timing.poll_hz);
  }

  AppTiming timing;
  double settle_s = 8;
};

struct Anchors : Benchmark {
  Anchors()
      : Benchmark("anchors", "Anchors on the screen and through a fix, in simulated time; camera, IMU and truth",
                  kConfigs | kSimulated | kRecordings, {"walk_marks"}) {}
  void add_options(CLI::App& command) override {
    command.add_option("--settle", walk.settle_s, "time from the first position to the first anchor, s");
    command.add_option("--ahead", walk.ahead_m, "distance from the camera to a new anchor, m");
  }

  Result<Json> measure_recording(const BenchCase& one, const Recording& recording) const override {
    const auto f = anchor_walk(recording, one.run, walk);
    if (!f) return f.failure();
    return row_of({{"", "looks", "looks", 0, f->px.size()},
                   {"corrected", "px median", "px_median", 2, percentile_or_nan(f->px, 0.5)},
                   {"px", "95 %", "px_p95", 2, percentile_or_nan(f->px, 0.95)},
                   {"smooth", "px median", "smooth_px_median", 2, percentile_or_nan(f->smooth_px, 0.5)},
                   {"px", "95 %", "smooth_px_p95", 2, percentile_or_nan(f->smooth_px, 0.95)},
                   {"drift", "m", "drift_m", 2, f->drift_m},
                   {"sigma", "m", "view_sigma_m", 2, f->view_sigma_m},
                   {"fix", "accepted", "fixed", 0, f->fixed},
                   {"start", "m", "start_off_m", 3, f->start_off_m},
                   {"newest", "m", "by_newest_m", 3, f->by_newest_m}});
  }

  std::string notes(const Rows&) const override {
    return text(
        "\npx: error of a drawn anchor that was placed %.0f m ahead and is %.0f to %.0f m away, in each picture on "
        "arrival, before\nit is processed, without the first %.0f s. drift: of the phone at the end; sigma: its stated "
        "value; start: error of\ncontent placed at the start, after a fix at the end (sigma %.0f cm); newest: the same "
        "if the phone's correction had\nmoved it.\n",
        walk.ahead_m, walk.nearest_m, walk.farthest_m, walk.settle_s, 100 * walk.mark_sigma_m);
  }

  AnchorWalkOptions walk;
};

struct Consistency : Benchmark {
  Consistency()
      : Benchmark("consistency", "Consistency of the stated covariances, and cost", kConfigs | kRecordings | kSensors,
                  {"walk"}) {
    below = "mean, longest";
    read.true_states = false;  // they would add to the measured memory of the pipeline
  }
  void add_options(CLI::App& command) override {
    command.add_option("--first", first_s, "length of the run from the start, s");
    command.add_option(
        "--marks", marks.sigma_m,
        "push true positions with this error on each axis, m; needs a config with fix/waypoint and `use: all`");
    command.add_option("--every", marks.every_s, "time between two positions of --marks, s");
    command.add_option("--seed", sensor_seed, "seed of the errors of --marks and --sensors");
  }

  Result<Json> measure_recording(const BenchCase& one, const Recording& recording) const override {
    const auto run = marked_run(recording, one.run, {marks.sigma_m, marks.every_s, sensor_seed}, first_s);
    if (!run) return run.failure();
    const PoseConsistency f = pose_consistency(run->poses, recording.truth);
    const auto known = [&](double x) { return f.poses < 3 ? Json() : Json(x); };
    const Format mean{.aggregate = Aggregate::mean, .absolute = true};
    return row_of({{"", "", "poses", -1, f.poses},
                   {"path", "m", "path_m", 1, known(f.path_m), mean},
                   {"APE yaw", "%", "ape_percent", 2, known(100 * f.ape_m / f.path_m), mean},
                   {"scale", "%", "scale_percent", 2, known(100 * f.scale_error), {true, Aggregate::mean, 0, true}},
                   {"NEES", "position", "position_nees", 2, known(f.position_nees), mean},
                   {"NEES", "heading", "heading_nees", 2, known(f.heading_nees), mean},
                   {"beyond 3 sigma", "position s", "position_beyond_s", 1, known(f.position_beyond_s), kWorst},
                   {"beyond 3 sigma", "heading s", "heading_beyond_s", 1, known(f.heading_beyond_s), kWorst},
                   {"times", "realtime", "times_realtime", 1, run->times_realtime, mean},
                   {"peak", "MB", "peak_rss_mb", 0, peak_rss_mb(), kWorst}});
  }

  std::string notes(const Rows&) const override {
    return "\nNEES: error squared over its covariance, per degree of freedom, mean over the poses, after alignment of "
           "the first\npose; 1 is consistent. beyond 3 sigma: the longest continuous time. times realtime: recorded "
           "time over one core's\ntime, including picture decoding. peak: resident memory of the run's process.\n";
  }

  double first_s = 1e9;
  MarkOptions marks;
};

}  // namespace

Benchmarks app_benchmarks() {
  return {std::make_shared<StreamBenchmark>(), std::make_shared<Anchors>(), std::make_shared<Consistency>(),
          surfaces_benchmark(), map_benchmark()};
}

}  // namespace odograph
