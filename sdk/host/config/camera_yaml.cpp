// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/config/camera_yaml.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "sdk/host/base/nearest.hpp"
#include "sdk/math/time.hpp"

namespace odograph {

namespace {

/// Pose of the camera on the body, and the timing of its rows.
std::vector<Spec> mount_and_timing() {
  return {
      {.name = "q_b_c",
       .type = SpecType::reals,
       .min = -1,
       .max = 1,
       .fallback = "[0, 1, 0, 0]",
       .help = "camera to body, w x y z; default a phone's rear camera",
       .count = 4},
      {.name = "p_b_c",
       .type = SpecType::reals,
       .unit = "m",
       .min = -100,
       .max = 100,
       .fallback = "[0, 0, 0]",
       .help = "camera's position in the body",
       .count = 3},
      {.name = "time_offset",
       .type = SpecType::real,
       .unit = "s",
       .min = -10,
       .max = 10,
       .fallback = "0",
       .help = "IMU time minus camera time"},
      {.name = "row_time",
       .type = SpecType::real,
       .unit = "s",
       .min = 0,
       .max = 1e-3,
       .fallback = "0",
       .help = "rolling shutter: from one row to the next; 0 = global shutter. Overrides the frames' own"},
  };
}

}  // namespace

const Spec& camera_spec() {
  static const Spec spec = [] {
    const auto pixels = [](const char* name, double min, const char* help) {
      return Spec{.name = name,
                  .type = SpecType::real,
                  .unit = "px",
                  .min = min,
                  .max = 100000,
                  .help = help,
                  .required = true};
    };
    const auto size = [](const char* name) {
      return Spec{.name = name, .type = SpecType::integer, .min = 1, .max = 16384, .help = "pixels", .required = true};
    };
    Spec root{.name = "camera", .type = SpecType::map, .help = "Intrinsics, mount and timing of a camera"};
    root.children = {
        {.name = "model",
         .type = SpecType::choice,
         .fallback = "pinhole",
         .choices = "pinhole|kannala_brandt",
         .help = "pinhole: radial-tangential distortion"},
        size("width"),
        size("height"),
        pixels("fx", 1, "focal length"),
        pixels("fy", 1, "focal length"),
        pixels("cx", -100000, "principal point, first pixel's centre is 0"),
        pixels("cy", -100000, "principal point"),
        {.name = "distortion",
         .type = SpecType::list,
         .help = "0, 4, 5 or 8 coefficients in OpenCV's order",
         .children = {{.name = "k", .type = SpecType::real, .min = -1e4, .max = 1e4}}},
        {.name = "fps",
         .type = SpecType::real,
         .unit = "Hz",
         .min = 0.1,
         .max = 1000,
         .fallback = "30",
         .help = "frame rate of a folder of images"},
    };
    std::vector<Spec> further = mount_and_timing();
    for (Spec& each : further) root.children.push_back(std::move(each));
    return root;
  }();
  return spec;
}

Result<odo_calibration> read_camera_yaml(const std::filesystem::path& file, double* fps) {
  auto node = read_yaml(file.string());
  if (!node) return node.failure();
  // Do not quote the content of a file that is not a camera description: it may be unrelated and untrusted.
  const auto& keys = camera_spec().children;
  if (std::none_of(keys.begin(), keys.end(), [&](const Spec& key) { return node->find(key.name) != nullptr; }))
    return Failure{ODO_E_CONFIG, at(file.string(), node->mark,
                                    "no camera's description; expected a map with width, height, fx, fy, cx, cy, ...")};
  const PluginResolver none = [](const std::string&, const std::string&) -> Result<const std::vector<Spec>*> {
    return Failure{ODO_E_CONFIG, "no plugins here"};
  };
  const auto checked = validate(*node, camera_spec(), file.string(), none);
  if (!checked) return checked.failure();
  const Value& v = *checked;
  odo_calibration c;
  std::memset(&c, 0, sizeof c);
  c.header.struct_size = sizeof c;
  c.header.type = ODO_TYPE_CALIBRATION;
  c.model = v["model"].text == "kannala_brandt" ? ODO_CAMERA_KANNALA_BRANDT : ODO_CAMERA_PINHOLE;
  c.width = static_cast<uint32_t>(v["width"].integer);
  c.height = static_cast<uint32_t>(v["height"].integer);
  c.fx = v["fx"].real, c.fy = v["fy"].real, c.cx = v["cx"].real, c.cy = v["cy"].real;
  const auto& k = v["distortion"].items;
  if (k.size() != 0 && k.size() != 4 && k.size() != 5 && k.size() != 8)
    return Failure{ODO_E_CONFIG,
                   at(file.string(), v["distortion"].mark,
                      "distortion: " + std::to_string(k.size()) + " coefficients; expected 0, 4, 5 or 8")};
  c.distortion_count = static_cast<uint32_t>(k.size());
  for (size_t i = 0; i < k.size(); ++i) c.distortion[i] = k[i].real;
  if (v["q_b_c"].given || v["p_b_c"].given) {
    const auto& q = v["q_b_c"].reals;
    const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    if (!(std::abs(norm - 1) < 0.01))
      return Failure{ODO_E_CONFIG, at(file.string(), v["q_b_c"].mark,
                                      "q_b_c: norm " + std::to_string(norm) + "; expected a unit quaternion w x y z")};
    for (size_t i = 0; i < 4; ++i) c.q_b_c[i] = q[i] / norm;
    for (size_t i = 0; i < 3; ++i) c.p_b_c[i] = v["p_b_c"].reals[i];
    c.header.flags |= ODO_CALIBRATION_EXTRINSICS;
  }
  if (v["time_offset"].given) {
    c.time_offset_ns = nanoseconds(v["time_offset"].real);
    c.header.flags |= ODO_CALIBRATION_TIME_OFFSET;
  }
  if (v["row_time"].given) {
    c.line_time_ns = nanoseconds(v["row_time"].real);
    c.header.flags |= ODO_CALIBRATION_LINE_TIME;
  }
  if (fps) *fps = v["fps"].real;
  return c;
}

}  // namespace odograph
