// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/recording/kalibr.hpp"

#include <cmath>
#include <cstdio>
#include <vector>

#include "sdk/host/config/spec.hpp"
#include "sdk/math/time.hpp"
#include "sdk/tools/recording/distortion.hpp"
#include "sdk/tools/recording/phone_camera.hpp"

namespace odograph {
namespace {

/// All numbers below a node, in order.
bool numbers_of(const YamlNode& node, std::vector<double>& out) {
  if (node.kind == YamlNode::Kind::sequence) {
    for (const YamlNode& item : node.items)
      if (!numbers_of(item, out)) return false;
    return true;
  }
  const auto value = parse_quantity(node.text, "");
  if (node.kind != YamlNode::Kind::scalar || !value || !std::isfinite(*value)) return false;
  out.push_back(*value);
  return true;
}

/// The `count` numbers of a key; none if it is optional and missing.
Result<std::vector<double>> numbers(const std::string& file, const YamlNode& camera, const char* key, size_t count,
                                    bool required = true) {
  const YamlNode* node = camera.find(key);
  std::vector<double> values;
  if (!node && !required) return values;
  if (!node || !numbers_of(*node, values) || values.size() != count)
    return Failure{ODO_E_DATA, at(file, node ? node->mark : camera.mark,
                                  std::string(key) + ": expected " + std::to_string(count) + " numbers")};
  return values;
}

std::string list(const double* values, size_t count) {
  std::string out = "[";
  for (size_t i = 0; i < count; ++i) {
    char text[40];
    std::snprintf(text, sizeof text, "%s%.17g", i ? ", " : "", values[i]);
    out += text;
  }
  return out + "]";
}

}  // namespace

Result<odo_calibration> read_camchain(const std::filesystem::path& path) {
  const std::string file = path.string();
  const auto tree = read_yaml(file);
  if (!tree) return tree.failure();
  const YamlNode* camera = tree->find("cam0");
  if (!camera) return Failure{ODO_E_DATA, file + ": no 'cam0'; expected Kalibr's camchain"};
  const auto word = [&](const char* key) { return camera->find(key) ? camera->find(key)->text : std::string(); };
  const auto refused = [&](const char* key, const char* expected) {
    return Failure{ODO_E_DATA, at(file, camera->find(key) ? camera->find(key)->mark : camera->mark,
                                  std::string(key) + " '" + word(key).substr(0, 40) + "'; expected " + expected)};
  };
  const std::string distortion = word("distortion_model");
  if (word("camera_model") != "pinhole") return refused("camera_model", "pinhole");
  if (distortion != "radtan" && distortion != "equidistant" && distortion != "none")
    return refused("distortion_model", "radtan, equidistant or none");
  auto c = make_message<odo_calibration>(ODO_TYPE_CALIBRATION, 0);
  const auto lens = numbers(file, *camera, "intrinsics", 4), size = numbers(file, *camera, "resolution", 2);
  const auto k = numbers(file, *camera, "distortion_coeffs", 4, distortion != "none");
  const char* mount_key = camera->find("T_cam_imu") ? "T_cam_imu" : "T_imu_cam";
  const auto mount = numbers(file, *camera, mount_key, 16, false);
  const auto shift = numbers(file, *camera, "timeshift_cam_imu", 1, false);
  const auto row = numbers(file, *camera, "line_delay", 1, false);
  for (const auto* part : {&lens, &size, &k, &mount, &shift, &row})
    if (!*part) return part->failure();
  c.fx = (*lens)[0], c.fy = (*lens)[1], c.cx = (*lens)[2], c.cy = (*lens)[3];
  if (!((*size)[0] >= 1 && (*size)[0] <= 16384 && (*size)[1] >= 1 && (*size)[1] <= 16384))
    return refused("resolution", "1 to 16384 pixels");
  c.width = static_cast<uint32_t>((*size)[0]), c.height = static_cast<uint32_t>((*size)[1]);
  if (const std::string fault = take_distortion(c, distortion, *k); !fault.empty())
    return Failure{ODO_E_DATA, at(file, camera->mark, fault)};
  if (!mount->empty()) {
    double rows[12];
    std::copy_n(mount->begin(), 12, rows);
    Eigen::Map<Eigen::Matrix<double, 3, 4, Eigen::RowMajor>> T(rows);
    if (mount_key == std::string("T_imu_cam")) {  // the inverse, as OpenVINS writes it
      const Eigen::Matrix3d R = T.leftCols<3>().transpose();
      T.col(3) = (-R * T.col(3)).eval(), T.leftCols<3>() = R;
    }
    if (!phone::set_mount(c, rows)) return refused(mount_key, "a rotation and at most 10 m");
  }
  if (!shift->empty() && !(std::abs((*shift)[0]) <= 3600)) return refused("timeshift_cam_imu", "at most an hour, in s");
  if (!row->empty() && !((*row)[0] >= 0 && (*row)[0] < 1e-3)) return refused("line_delay", "0 to 0.001 s");
  if (!shift->empty()) c.time_offset_ns = nanoseconds((*shift)[0]), c.header.flags |= ODO_CALIBRATION_TIME_OFFSET;
  if (!row->empty() && (*row)[0] > 0)
    c.line_time_ns = nanoseconds((*row)[0]), c.header.flags |= ODO_CALIBRATION_LINE_TIME;
  if (const std::string fault = message_fault(c.header); !fault.empty())
    return Failure{ODO_E_DATA, at(file, camera->mark, fault)};
  return c;
}

std::string camera_yaml(const odo_calibration& c) {
  const double lens[4] = {c.fx, c.fy, c.cx, c.cy};
  const char* names[4] = {"fx", "fy", "cx", "cy"};
  std::string yaml = std::string("model: ") + (c.model == ODO_CAMERA_KANNALA_BRANDT ? "kannala_brandt" : "pinhole") +
                     "\nwidth: " + std::to_string(c.width) + "\nheight: " + std::to_string(c.height) + "\n";
  for (size_t i = 0; i < 4; ++i) {
    const std::string number = list(&lens[i], 1);
    yaml += std::string(names[i]) + ": " + number.substr(1, number.size() - 2) + "\n";
  }
  yaml += "distortion: " + list(c.distortion, c.distortion_count) + "\n";
  if (c.header.flags & ODO_CALIBRATION_EXTRINSICS)
    yaml += "q_b_c: " + list(c.q_b_c, 4) + "\np_b_c: " + list(c.p_b_c, 3) + "\n";
  if (c.header.flags & ODO_CALIBRATION_TIME_OFFSET)
    yaml += "time_offset: " + std::to_string(seconds(c.time_offset_ns)) + "\n";
  if (c.header.flags & ODO_CALIBRATION_LINE_TIME) yaml += "row_time: " + format_seconds(c.line_time_ns) + "\n";
  return yaml;
}

}  // namespace odograph
