// SPDX-License-Identifier: Apache-2.0
//
// The pose stream that an app draws with, in simulated time: `odograph bench stream`.
#include "sdk/tools/benchmarks/benchmarks.hpp"
#include "sdk/tools/replay/app_stream.hpp"

namespace odograph {
namespace {

struct StreamBenchmark : Benchmark {
  StreamBenchmark()
      : Benchmark("stream", "Poses ahead of time, as an app asks for them, in simulated time; camera and IMU",
                  kConfigs | kSeeds | kSimulated | kRecordings) {
    options.configs = {"samples/configs/walk.yaml"};
    options.scenarios = {"samples/scenarios/street_short.yaml"};
  }
  void add_options(CLI::App& command) override {
    command.add_option("--ahead", timing.ahead_ms, "ms ahead of the poll");
    command.add_option("--frame-late", timing.late.frame_late_ms, "ms from a picture's time to its pose");
    command.add_option("--imu-late", timing.late.imu_late_ms, "ms from a sample's time to its arrival");
    command.add_option("--settle", settle_s, "seconds left out at the start");
  }

  Result<Json> measure(const BenchCase& one, const ShowProgress&) const override {
    const auto recording = read_recording(one.files.front());
    if (!recording) return recording.failure();
    const auto stream = app_stream(*recording, one.run, timing);
    if (!stream) return stream.failure();
    const int64_t start_ns = recording->messages.front().message.header().t_ns + static_cast<int64_t>(settle_s * 1e9);
    const StreamFigures f = stream_figures(stream->poses, recording->truth, start_ns);
    return row_of("stream",
                  {{"", "frames", "frames", 0, f.frames},
                   {"orientation", "deg median", "orientation_deg_median", 2, part_of(f.orientation_deg, 0.5)},
                   {"deg", "99 %", "orientation_deg_p99", 2, part_of(f.orientation_deg, 0.99)},
                   {"position", "mm median", "position_mm_median", 1, 1e3 * part_of(f.position_m, 0.5)},
                   {"mm", "99 %", "position_mm_p99", 1, 1e3 * part_of(f.position_m, 0.99)},
                   {"no", "position", "without_position", 0, f.without_position},
                   {"repeated", "polls", "repeated", 0, f.repeated},
                   {"", "corrections", "corrections", 0, stream->corrections},
                   {"jump", "cm", "jump_cm", 1, 100 * f.jump_m},
                   {"smooth", "cm", "smooth_jump_cm", 1, 100 * f.smooth_jump_m},
                   {"get_pose", "us median", "get_pose_us_median", 2, percentile(stream->poll_us, 0.5)},
                   {"us", "99 %", "get_pose_us_p99", 2, percentile(stream->poll_us, 0.99)},
                   {"statistics", "us, 99 %", "get_statistics_us_p99", 2, percentile(stream->statistics_us, 0.99)}});
  }

  BenchReport report(const Rows& rows) const override {
    return {recordings_text(rows, "stream") +
            text("\nPoses asked %.0f ms ahead, against the pipeline's own later ones; the first %.0f s left out. "
                 "Gyroscope and\naccelerometer (%.0f Hz) apart and %.0f ms late, pictures %.0f ms. jump: the longest "
                 "step between two polls at\n%.0f Hz beyond the true one, from the start on.\n",
                 timing.ahead_ms, settle_s, timing.late.accel_hz, timing.late.imu_late_ms, timing.late.frame_late_ms,
                 timing.poll_hz)};
  }

  AppTiming timing;
  double settle_s = 8;
};

}  // namespace

std::shared_ptr<Benchmark> bench_stream() { return std::make_shared<StreamBenchmark>(); }

}  // namespace odograph
