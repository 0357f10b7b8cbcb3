// SPDX-License-Identifier: Apache-2.0
//
// How far `odograph calibrate --imu` is from what recordings say of themselves, started from wrong values:
// `odograph bench calibrate-imu`.
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "sdk/tools/benchmarks/benchmarks.hpp"
#include "sdk/tools/console/console.hpp"
#include "sdk/tools/replay/camera_imu_source.hpp"

namespace odograph {
namespace {

constexpr double kDegrees = 57.29577951308232;

struct BenchArguments {
  std::vector<std::string> recordings;
  double focal_wrong = 1.02, row_wrong = 0.6, offset_wrong_s = 0.1;
  bool keep_lens = false;
};

Result<bool> one(const BenchArguments& a, const std::string& file) {
  const auto recording = open_recording(file);
  if (!recording) return recording.failure();
  Progress progress(file);
  auto data = camera_imu_data(*recording, [&](size_t done, size_t all) { progress.show(done, all); });
  if (!data) return data.failure();
  const odo_calibration said = data->given;
  const double row_s = data->given_row_time_s;
  if (!(said.header.flags & ODO_CALIBRATION_EXTRINSICS))
    return Failure{ODO_E_DATA, file + ": does not say how its camera is mounted"};
  const double offset_s =
      said.header.flags & ODO_CALIBRATION_TIME_OFFSET ? static_cast<double>(said.time_offset_ns) * 1e-9 : 0;
  data->given.header.flags = ODO_CALIBRATION_TIME_OFFSET;
  data->given.time_offset_ns = std::llround((offset_s + a.offset_wrong_s) * 1e9);
  data->given_row_time_s = row_s * a.row_wrong;
  if (!a.keep_lens) data->given.fx *= a.focal_wrong, data->given.fy *= a.focal_wrong;
  const auto found = calibrate_camera_imu(*data, {.refine_lens = !a.keep_lens});
  if (!found) return found.failure();
  const Eigen::Quaterniond q(said.q_b_c[0], said.q_b_c[1], said.q_b_c[2], said.q_b_c[3]);
  const auto shown = [](const Estimate& e, double error, double unit, char* text) {
    if (e.observable)
      std::snprintf(text, 40, "%+.3f +- %.3f", unit * error, unit * e.sigma);
    else
      std::snprintf(text, 40, "kept");
    return text;
  };
  char offset[40], row[40], focal[40];
  const Eigen::Vector3d s = kDegrees * found->rotation_sigma_rad;
  std::printf("%-28s %6.3f +- %-6.3f %18s %18s %18s %7.3f %7.3f\n",
              std::filesystem::path(file).filename().string().c_str(), kDegrees * found->q_b_c.angularDistance(q),
              s.norm(), shown(found->time_offset_s, found->time_offset_s.value - offset_s, 1e3, offset),
              shown(found->row_time_s, found->row_time_s.value - row_s, 1e6, row),
              shown(found->focal_px, found->focal_px.value - said.fx, 1, focal), found->rms_px, found->correlation);
  return true;
}

int bench(const BenchArguments& a) {
  std::printf(
      "Found minus what the recording says; started from an unknown mount, an offset %.0f ms and a focal length %.0f "
      "%% "
      "off, %.0f %% of the row time\n\n%-28s %16s %18s %18s %18s %7s %7s\n",
      1e3 * a.offset_wrong_s, 100 * (a.focal_wrong - 1), 100 * a.row_wrong, "", "mount (deg)", "offset (ms)",
      "row time (us)", "fx (px)", "rms px", "corr.");
  for (const std::string& file : a.recordings)
    if (const auto done = one(a, file); !done) return complain(done.failure());
  return kDone;
}

}  // namespace

void add_bench_calibrate_imu(CLI::App& bench_command, int& status) {
  auto a = std::make_shared<BenchArguments>();
  auto* command =
      bench_command.add_subcommand("calibrate-imu", "Mount, offset, row time of recordings against what they say");
  command->add_option("recordings", a->recordings, "with camera and IMU, simulated or with a known calibration")
      ->required();
  command->add_flag("--keep-lens", a->keep_lens, "start from the right lens and do not touch it");
  command->callback([a, &status] { status = bench(*a); });
}

}  // namespace odograph
