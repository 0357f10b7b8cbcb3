// SPDX-License-Identifier: Apache-2.0
//
// How far `odograph calibrate --imu` is from what recordings say of themselves, started from wrong values:
// `odograph bench calibrate-imu`.
#include <cmath>

#include "sdk/host/base/rotation.hpp"
#include "sdk/tools/benchmarks/benchmarks.hpp"
#include "sdk/tools/replay/camera_imu_source.hpp"

namespace odograph {
namespace {

constexpr double kDegrees = 57.29577951308232;
constexpr double kFocalWrong = 1.02, kRowWrong = 0.6, kOffsetWrong_s = 0.1;

struct CalibrateImu : Benchmark {
  CalibrateImu()
      : Benchmark("calibrate-imu", "Mount, offset, row time of recordings against what they say", kRecordings) {}
  void add_options(CLI::App& command) override {
    command.add_flag("--keep-lens", keep_lens, "start from the right lens and do not touch it");
  }

  Result<Json> measure(const BenchCase& one, const ShowProgress& progress) const override {
    const std::string file = one.files.front().string();
    const auto recording = read_recording(file);
    if (!recording) return recording.failure();
    auto data = camera_imu_data(*recording, progress);
    if (!data) return data.failure();
    const odo_calibration said = data->given;
    const double row_s = data->given_row_time_s;
    if (!(said.header.flags & ODO_CALIBRATION_EXTRINSICS))
      return Failure{ODO_E_DATA, file + ": does not say how its camera is mounted"};
    const double offset_s =
        said.header.flags & ODO_CALIBRATION_TIME_OFFSET ? static_cast<double>(said.time_offset_ns) * 1e-9 : 0;
    data->given.header.flags = ODO_CALIBRATION_TIME_OFFSET;
    data->given.time_offset_ns = std::llround((offset_s + kOffsetWrong_s) * 1e9);
    data->given_row_time_s = row_s * kRowWrong;
    if (!keep_lens) data->given.fx *= kFocalWrong, data->given.fy *= kFocalWrong;
    const auto found = calibrate_camera_imu(*data, {.refine_lens = !keep_lens});
    if (!found) return found.failure();
    const Eigen::Quaterniond q = raw_quaternion(said.q_b_c);
    const auto error = [](const Estimate& e, double truth, double unit) {
      return e.observable ? Json(unit * (e.value - truth)) : Json();
    };
    const auto sigma = [](const Estimate& e, double unit) { return e.observable ? Json(unit * e.sigma) : Json(); };
    return row_of("calibrate", {{"mount", "deg", "mount_deg", 3, kDegrees * found->q_b_c.angularDistance(q)},
                                {"", "sigma", "mount_sigma_deg", 3, (kDegrees * found->rotation_sigma_rad).norm()},
                                {"offset", "ms", "offset_ms", 3, error(found->time_offset_s, offset_s, 1e3), true},
                                {"", "sigma", "offset_sigma_ms", 3, sigma(found->time_offset_s, 1e3)},
                                {"row time", "us", "row_time_us", 3, error(found->row_time_s, row_s, 1e6), true},
                                {"", "sigma", "row_time_sigma_us", 3, sigma(found->row_time_s, 1e6)},
                                {"fx", "px", "fx_px", 3, error(found->focal_px, said.fx, 1), true},
                                {"", "sigma", "fx_sigma_px", 3, sigma(found->focal_px, 1)},
                                {"rms", "px", "rms_px", 3, found->rms_px},
                                {"", "corr.", "correlation", 3, found->correlation}});
  }

  BenchReport report(const Rows& rows) const override {
    return {text("Found minus what the recording says; started from an unknown mount, an offset %.0f ms and a focal "
                 "length %.0f %% off, %.0f %% of the row time. -: kept\n\n",
                 1e3 * kOffsetWrong_s, 100 * (kFocalWrong - 1), 100 * kRowWrong) +
            recordings_text(rows, "calibrate")};
  }

  bool keep_lens = false;
};

}  // namespace

std::shared_ptr<Benchmark> bench_calibrate_imu() { return std::make_shared<CalibrateImu>(); }

}  // namespace odograph
