// SPDX-License-Identifier: Apache-2.0
//
// `odograph calibrate --imu RECORDING`: mount, time offset, row time and lens from the rotation of pictures and
// gyroscope.
#include "sdk/tools/command_line/calibrate_imu.hpp"

#include <algorithm>
#include <cstdio>

#include <nlohmann/json.hpp>

#include "sdk/host/config/camera_yaml.hpp"
#include "sdk/math/scalar.hpp"
#include "sdk/math/time.hpp"
#include "sdk/tools/command_line/commands.hpp"
#include "sdk/tools/replay/camera_imu_source.hpp"
#include "sdk/tools/text/text.hpp"

namespace odograph {
namespace {

namespace fs = std::filesystem;

std::string figures_of(const CameraImuCalibration& c) {
  std::string out;
  const auto add = [&](auto... words) { out += text(words...); };
  const auto one = [&](const char* name, const Estimate& e, double unit, const char* what) {
    if (e.observable)
      add("%-12s %10.3f +- %.3f %s (given: %.3f)\n", name, unit * e.value, unit * e.sigma, what, unit * e.given);
    else
      add("%-12s %10.3f %s as given\n", name, unit * e.given, what);
  };
  const auto& q = c.lens.q_b_c;
  if (c.lens.header.flags & ODO_CALIBRATION_EXTRINSICS)
    add("%-12s [%.5f, %.5f, %.5f, %.5f]", "q_b_c", q[0], q[1], q[2], q[3]);
  else
    add("%-12s unknown", "q_b_c");
  const Eigen::Vector3d s = kDeg_per_rad * c.rotation_sigma_rad;
  if (c.rotation_observable)
    add(" +- %.3f, %.3f, %.3f degrees about the camera's x, y, z; %.2f degrees from the given one\n", s.x(), s.y(),
        s.z(), kDeg_per_rad * c.q_b_c.angularDistance(c.given_q_b_c));
  else
    out += " as given\n";
  one("time offset", c.time_offset_s, 1e3, "ms");
  one("row time", c.row_time_s, 1e6, "us");
  one("focal length", c.focal_px, 1, "px"), one("cx", c.cx, 1, "px"), one("cy", c.cy, 1, "px"), one("k1", c.k1, 1, "");
  const Eigen::Vector3d b = kDeg_per_rad * c.gyro_bias_b;
  add("%-12s %.3f, %.3f, %.3f deg/s\n", "gyro bias", b.x(), b.y(), b.z());
  add("residual %.3f px (rms) of %zu corners in %zu windows of %zu frames; rotation %.0f, %.0f and %.0f deg/s rms "
      "about "
      "its axes, correlation with the pictures %.3f\n",
      c.rms_px, c.corners, c.windows, c.frames, kDeg_per_rad * c.rate_rms_rps[0], kDeg_per_rad * c.rate_rms_rps[1],
      kDeg_per_rad * c.rate_rms_rps[2], c.correlation);
  return out;
}

nlohmann::ordered_json json_of(const CameraImuCalibration& c, const std::vector<std::string>& warnings) {
  const auto one = [](const Estimate& e) {
    return nlohmann::ordered_json{
        {"value", e.value}, {"sigma", e.sigma}, {"given", e.given}, {"observable", e.observable}};
  };
  const auto list = [](const Eigen::Vector3d& v) { return std::vector<double>{v.x(), v.y(), v.z()}; };
  return {{"q_b_c", {c.q_b_c.w(), c.q_b_c.x(), c.q_b_c.y(), c.q_b_c.z()}},
          {"rotation_sigma_rad", list(c.rotation_sigma_rad)},
          {"rotation_observable", c.rotation_observable},
          {"time_offset_s", one(c.time_offset_s)},
          {"row_time_s", one(c.row_time_s)},
          {"fx", one(c.focal_px)},
          {"cx", one(c.cx)},
          {"cy", one(c.cy)},
          {"k1", one(c.k1)},
          {"gyro_bias_b", list(c.gyro_bias_b)},
          {"rotation_rms_rad_s", list(c.rate_rms_rps)},
          {"correlation", c.correlation},
          {"frames", c.frames},
          {"windows", c.windows},
          {"corners", c.corners},
          {"rms_px", c.rms_px},
          {"doubts", warnings}};
}

/// Initial values: a lens from a board, a camera.yaml, or the recording's own.
Result<bool> start_from(const CalibrateImuArguments& a, const LensCalibration* board, odo_calibration& given,
                        double& row_time_s) {
  odo_calibration lens = given;
  if (!a.camera.empty()) {
    const auto read = read_camera_yaml(a.camera, nullptr);
    if (!read) return read.failure();
    lens = *read;
    // Mount and time offset only if the file has them, as in a pipeline.
    if (!(lens.header.flags & ODO_CALIBRATION_EXTRINSICS)) {
      std::copy(std::begin(given.q_b_c), std::end(given.q_b_c), lens.q_b_c);
      std::copy(std::begin(given.p_b_c), std::end(given.p_b_c), lens.p_b_c);
    }
    if (!(lens.header.flags & ODO_CALIBRATION_TIME_OFFSET)) lens.time_offset_ns = given.time_offset_ns;
    lens.header.flags |= given.header.flags & (ODO_CALIBRATION_EXTRINSICS | ODO_CALIBRATION_TIME_OFFSET);
    if (lens.header.flags & ODO_CALIBRATION_LINE_TIME) row_time_s = seconds(lens.line_time_ns);
  }
  if (board) {
    lens.model = board->lens == Lens::pinhole ? ODO_CAMERA_PINHOLE : ODO_CAMERA_KANNALA_BRANDT;
    lens.width = static_cast<uint32_t>(board->size.width), lens.height = static_cast<uint32_t>(board->size.height);
    lens.fx = board->fx, lens.fy = board->fy, lens.cx = board->cx, lens.cy = board->cy;
    std::fill(std::begin(lens.distortion), std::end(lens.distortion), 0.0);
    std::copy(board->distortion.begin(), board->distortion.end(), lens.distortion);
    lens.distortion_count = static_cast<uint32_t>(board->distortion.size());
  }
  if (lens.width != given.width || lens.height != given.height)
    return Failure{ODO_E_DATA, "a lens of " + std::to_string(lens.width) + "x" + std::to_string(lens.height) +
                                   " pictures, frames of " + std::to_string(given.width) + "x" +
                                   std::to_string(given.height)};
  given = lens;
  return true;
}

}  // namespace

int calibrate_imu(const CalibrateImuArguments& a, const LensCalibration* board) {
  const auto recording = open_recording(a.recording);
  if (!recording) return print_failure(recording.failure());
  Result<CameraImuData> data = Failure{};
  {
    Progress progress("corners");
    data = camera_imu_data(*recording, [&](size_t done, size_t all) { progress.show(done, all); });
  }
  if (!data) return print_failure(data.failure());
  if (const auto started = start_from(a, board, data->given, data->given_row_time_s); !started)
    return print_failure(started.failure());
  Result<CameraImuCalibration> found = Failure{};
  {
    Progress progress("fit");
    found = calibrate_camera_imu(*data, {.refine_lens = !board && !a.keep_lens},
                                 [&](size_t done, size_t all) { progress.show(done, all); });
  }
  if (!found) return print_failure({found.failure().status, a.recording + ": " + found.failure().text});
  const auto warnings = warnings_about(*found);
  std::error_code error;
  fs::create_directories(a.output, error);
  if (const auto written = write_file(fs::path(a.output) / "camera.yaml", camera_yaml(*found)); !written)
    return print_failure(written.failure());
  if (a.json) {
    std::printf("%s\n", json_of(*found, warnings).dump(2).c_str());
    return exit_status(recording->loss, kDone);
  }
  std::printf("%s", figures_of(*found).c_str());
  for (const auto& warning : warnings) std::printf("beware: %s\n", warning.c_str());
  std::printf("%s/camera.yaml (in a config: 'camera: FILE')\n", a.output.c_str());
  return exit_status(recording->loss, kDone);
}

}  // namespace odograph
