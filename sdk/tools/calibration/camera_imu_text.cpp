// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "sdk/math/scalar.hpp"
#include "sdk/math/time.hpp"
#include "sdk/tools/calibration/camera_imu.hpp"
#include "sdk/tools/text/text.hpp"

namespace odograph {
namespace {

constexpr double kCertain = 3;  // standard deviations

}  // namespace

Shutter shutter_of(const CameraImuCalibration& c) {
  if (!c.row_time_s.observable) return Shutter::unknown;
  if (std::abs(c.row_time_s.value) < kCertain * c.row_time_s.sigma) return Shutter::global;
  return c.row_time_s.value > 0 ? Shutter::rolling : Shutter::rolling_up;
}

std::vector<std::string> warnings_about(const CameraImuCalibration& c) {
  std::vector<std::string> warnings;
  const auto weak = [&](const char* what, double sigma, const char* unit, const char* kept) {
    warnings.push_back(
        text("%s is not observable in this recording (known to %.3g %s only); %s", what, sigma, unit, kept));
  };
  if (!c.rotation_observable)
    weak("the camera's rotation against the IMU", c.rotation_sigma_rad.maxCoeff() * kDeg_per_rad, "degrees",
         "rotate the phone about all of its axes");
  if (!c.time_offset_s.observable)
    weak("the time offset", 1e3 * c.time_offset_s.sigma, "ms", "rotate back and forth faster");
  if (!c.row_time_s.observable)
    weak("the row time", 1e6 * c.row_time_s.sigma, "us", "rotate back and forth faster; the given value is kept");
  if (shutter_of(c) == Shutter::global)
    warnings.push_back(text("the row time, %.2f +- %.2f us, cannot be distinguished from that of a global shutter",
                            1e6 * c.row_time_s.value, 1e6 * c.row_time_s.sigma));
  if (shutter_of(c) == Shutter::rolling_up)
    warnings.push_back(
        text("the last row seems to be read first (row time %.2f us): are the pictures upside down? It is "
             "not written into camera.yaml",
             1e6 * c.row_time_s.value));
  if (c.lens_refined)
    for (const auto& [name, e] :
         {std::pair{"focal length", &c.focal_px}, {"cx", &c.cx}, {"cy", &c.cy}, {"k1", &c.k1}}) {
      if (e->observable) continue;
      warnings.push_back(e->sigma > 0
                             ? text("%s is not observable in this recording (known to %.3g only); the given one is "
                                    "kept",
                                    name, e->sigma)
                             : text("%s is not observable: too little rotation across the optical axis; the given "
                                    "one is kept",
                                    name));
    }
  if (c.correlation < 0.9)
    warnings.push_back(
        text("the rotations of pictures and gyroscope correlate weakly (correlation %.2f); use a more distant scene "
             "with more texture",
             c.correlation));
  if (c.rms_px > 1)
    warnings.push_back(
        text("the residual is %.2f px; below 0.6 is usual. Is the lens model right, is the scene static?", c.rms_px));
  return warnings;
}

std::string camera_yaml(const CameraImuCalibration& c) {
  const odo_calibration& lens = c.lens;
  const auto note = [](const Estimate& e, double unit, const char* name) {
    return e.observable ? text("  # +- %.3g %s", unit * e.sigma, name) : std::string("  # as given");
  };
  std::string yaml =
      text("# %zu corners in %zu windows against the gyroscope, residual %.3f px\n", c.corners, c.windows, c.rms_px) +
      text("model: %s\nwidth: %u\nheight: %u\n", lens.model == ODO_CAMERA_KANNALA_BRANDT ? "kannala_brandt" : "pinhole",
           lens.width, lens.height) +
      text("fx: %.6f", lens.fx) + note(c.focal_px, 1, "px") + text("\nfy: %.6f\ncx: %.6f", lens.fy, lens.cx) +
      note(c.cx, 1, "px") + text("\ncy: %.6f", lens.cy) + note(c.cy, 1, "px") + "\ndistortion: [";
  for (uint32_t i = 0; i < lens.distortion_count; ++i) yaml += text("%s%.9g", i ? ", " : "", lens.distortion[i]);
  yaml += "]" + (c.k1.observable ? text("  # k1 +- %.3g", c.k1.sigma) : std::string("  # as given")) + "\n";
  if (lens.header.flags & ODO_CALIBRATION_EXTRINSICS) {
    const Eigen::Vector3d s = kDeg_per_rad * c.rotation_sigma_rad;
    yaml += text("q_b_c: [%.9f, %.9f, %.9f, %.9f]", lens.q_b_c[0], lens.q_b_c[1], lens.q_b_c[2], lens.q_b_c[3]) +
            (c.rotation_observable
                 ? text("  # +- %.3f, %.3f, %.3f degrees about the camera's x, y, z\n", s.x(), s.y(), s.z())
                 : std::string("  # as given\n"));
    yaml += text("p_b_c: [%.6f, %.6f, %.6f]  # as given\n", lens.p_b_c[0], lens.p_b_c[1], lens.p_b_c[2]);
  }
  if (lens.header.flags & ODO_CALIBRATION_TIME_OFFSET)
    yaml += text("time_offset: %.6f", seconds(lens.time_offset_ns)) + note(c.time_offset_s, 1e3, "ms") + "\n";
  if (shutter_of(c) == Shutter::rolling)
    yaml += text("row_time: %.4g", c.row_time_s.value) + note(c.row_time_s, 1e6, "us") + "\n";
  if (shutter_of(c) == Shutter::global)
    yaml += text("row_time: 0  # not distinguishable from a global shutter: +- %.3g us\n", 1e6 * c.row_time_s.sigma);
  return yaml;
}

}  // namespace odograph
