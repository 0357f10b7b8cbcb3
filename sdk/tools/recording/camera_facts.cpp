// SPDX-License-Identifier: Apache-2.0
//
// Lens, mount and phone from an app's own files.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include <nlohmann/json.hpp>

#include "sdk/host/config/camera_yaml.hpp"
#include "sdk/math/rotation.hpp"
#include "sdk/tools/recording/distortion.hpp"
#include "sdk/tools/recording/kalibr.hpp"
#include "sdk/tools/recording/phone_camera.hpp"
#include "sdk/tools/recording/protobuf_fields.hpp"

namespace odograph::phone {
namespace fs = std::filesystem;

namespace {

using Json = nlohmann::json;
constexpr uint64_t kLargestText = 1 << 20;

Result<std::string> small_text(const fs::path& file) {
  std::error_code error;
  if (!fs::is_regular_file(file, error) || fs::file_size(file, error) > kLargestText)
    return Failure{ODO_E_DATA, file.string() + ": no file, or larger than it can be"};
  std::ifstream in(file, std::ios::binary);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

/// A number of a JSON object; NaN if missing.
double number_in(const Json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_number() ? found->get<double>() : std::nan("");
}

/// Spectacular AI's calibration.json: lens and mount of the first camera.
Result<bool> from_calibration_json(const fs::path& file, CameraFacts& facts) {
  const auto text = small_text(file);
  if (!text) return text.failure();
  const Json whole = Json::parse(*text, nullptr, false);
  const auto wrong = [&](const std::string& what) { return Failure{ODO_E_DATA, file.string() + ": " + what}; };
  if (whole.is_discarded()) return wrong("not JSON");
  if (!whole.contains("cameras") || !whole["cameras"].is_array() || whole["cameras"].empty() ||
      !whole["cameras"][0].is_object())
    return wrong("no 'cameras' with one camera");
  const Json& camera = whole["cameras"][0];
  odo_calibration& c = facts.calibration;
  const std::string model = camera.value("model", Json("pinhole")).is_string() ? camera.value("model", "pinhole") : "";
  if (model != "kannala-brandt4" && model != "pinhole" && model != "brown-conrady")
    return wrong("model '" + model.substr(0, 40) + "'; expected pinhole, brown-conrady or kannala-brandt4");
  c.fx = number_in(camera, "focalLengthX"), c.fy = number_in(camera, "focalLengthY");
  c.cx = number_in(camera, "principalPointX"), c.cy = number_in(camera, "principalPointY");
  if (!(c.fx > 0 && c.fy > 0)) return wrong("no focalLengthX and focalLengthY");
  const double width = number_in(camera, "imageWidth"), height = number_in(camera, "imageHeight");
  if (width >= 16 && width <= 16384 && height >= 16 && height <= 16384)
    c.width = static_cast<uint32_t>(width), c.height = static_cast<uint32_t>(height);
  std::vector<double> k;
  if (const auto found = camera.find("distortionCoefficients"); found != camera.end() && found->is_array())
    for (const Json& one : *found) k.push_back(one.is_number() ? one.get<double>() : std::nan(""));
  if (model == "pinhole" && k.size() == 3) k = {k[0], k[1], 0, 0, k[2]};  // radial only
  if (const std::string fault = take_distortion(c, model, k); !fault.empty()) return wrong(fault);
  facts.has_lens = true;
  const auto mount = camera.find("imuToCamera");
  double T[12];
  bool whole_mount = mount != camera.end() && mount->is_array() && mount->size() >= 3;
  for (size_t i = 0; whole_mount && i < 12; ++i) {
    const Json& row = (*mount)[i / 4];
    whole_mount = row.is_array() && row.size() == 4 && row[i % 4].is_number();
    if (whole_mount) T[i] = row[i % 4].get<double>();
  }
  facts.has_mount = whole_mount && set_mount(c, T);
  return true;
}

/// Stray Scanner's camera_matrix.csv: three rows of three numbers, for ARKit's picture.
Result<bool> from_matrix(const fs::path& file, CameraFacts& facts) {
  Table row{Stream::pose, "", "#1", TimeUnit::seconds, {"#1", "#2", "#3"}};
  Rows rows{&row, file, {}};
  if (const auto read = read_csv(file, rows); !read) return read.failure();
  if (rows.rows.size() != 3) return Failure{ODO_E_DATA, file.string() + ": expected three rows of three numbers"};
  odo_calibration& c = facts.calibration;
  c.model = ODO_CAMERA_PINHOLE;
  c.fx = rows.rows[0].v[0], c.cx = rows.rows[0].v[2], c.fy = rows.rows[1].v[1], c.cy = rows.rows[1].v[2];
  if (!(c.fx > 0 && c.fy > 0)) return Failure{ODO_E_DATA, file.string() + ": not a camera matrix"};
  return facts.has_lens = true;
}

std::vector<float> floats_of(const ProtobufField& field) {
  std::vector<float> values;
  if (field.kind == ProtobufField::Kind::fixed32) return {field.as_float()};
  for (size_t at = 0; field.kind == ProtobufField::Kind::bytes && at + 4 <= field.bytes.size() && at < 64; at += 4) {
    ProtobufField one;
    std::memcpy(&one.value, field.bytes.data() + at, 4);
    values.push_back(one.as_float());
  }
  return values;
}

/// VideoIMUCapture: CameraInfo, field 2 of VideoCaptureData: intrinsics (1), distortion (2), stabilisation (3, 4) and
/// the resolution (11) that they apply to.
void from_protobuf(const fs::path& file, CameraFacts& facts, std::vector<std::string>& warnings) {
  std::ifstream in(file, std::ios::binary);
  std::vector<unsigned char> head(1 << 16);  // the camera is written first
  in.read(reinterpret_cast<char*>(head.data()), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<size_t>(in.gcount()));
  ProtobufReader whole(head);
  while (const auto field = whole.next()) {
    if (field->number != 2 || field->kind != ProtobufField::Kind::bytes) continue;
    ProtobufReader camera(field->bytes);
    std::vector<float> lens, distortion;
    uint32_t size[2] = {0, 0};
    while (const auto one = camera.next()) {
      const auto numbers = floats_of(*one);
      if (one->number == 1) lens.insert(lens.end(), numbers.begin(), numbers.end());
      if (one->number == 2) distortion.insert(distortion.end(), numbers.begin(), numbers.end());
      if (one->number == 3 && one->value != 0)
        warnings.push_back("optical stabilisation was on: the lens moves against the phone; switch 'OIS' off");
      if (one->number == 4 && one->value != 0)
        warnings.push_back("video stabilisation was on: frames are shifted; switch 'DVS' off");
      if (one->number != 11 || one->kind != ProtobufField::Kind::bytes) continue;
      ProtobufReader pair(one->bytes);
      while (const auto side = pair.next())
        if (side->number == 1 || side->number == 2) size[side->number - 1] = static_cast<uint32_t>(side->value);
    }
    if (lens.size() < 4 || !(lens[0] > 0) || !(lens[1] > 0) || size[0] < 16 || size[1] < 16) continue;
    odo_calibration& c = facts.calibration;
    c.model = ODO_CAMERA_PINHOLE;
    c.fx = lens[0], c.fy = lens[1], c.cx = lens[2], c.cy = lens[3];
    c.width = std::min(size[0], 16384u), c.height = std::min(size[1], 16384u);
    if (distortion.size() >= 5) {  // Android: radial k1 k2 k3, tangential k4 k5
      const double k[5] = {distortion[0], distortion[1], distortion[3], distortion[4], distortion[2]};
      std::copy_n(k, 5, c.distortion);
      c.distortion_count = 5;
    } else if (!distortion.empty()) {
      warnings.push_back(std::to_string(distortion.size()) +
                         " distortion coefficients, which are not used; expected 5: put a camera.yaml beside");
    }
    facts.has_lens = true, facts.frames_have_lens = false;
  }
}

}  // namespace

bool set_mount(odo_calibration& c, const double (&T)[12]) {
  Eigen::Matrix3d R_c_b;
  Eigen::Vector3d p_c_b;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) R_c_b(i, j) = T[4 * i + j];
    p_c_b[i] = T[4 * i + 3];
  }
  if (!((R_c_b * R_c_b.transpose() - Eigen::Matrix3d::Identity()).norm() < 0.01) || !(R_c_b.determinant() > 0) ||
      !(p_c_b.norm() < 10))
    return false;
  const Eigen::Quaterniond q_b_c = Eigen::Quaterniond(R_c_b).normalized().conjugate();
  put_quaternion(q_b_c, c.q_b_c);
  Eigen::Vector3d::Map(c.p_b_c) = -(q_b_c * p_c_b);
  c.header.flags |= ODO_CALIBRATION_EXTRINSICS;
  return true;
}

Result<CameraFacts> camera_facts(const Files& files, std::vector<std::string>& warnings) {
  CameraFacts facts;
  facts.calibration = make_message<odo_calibration>(ODO_TYPE_CALIBRATION, 0);
  const auto has = [&](const char* name) {
    facts.lens_from = (files.folder / name).string();
    return !files.find(name).empty();
  };
  for (const char* name : {"camera.yaml", "camchain-imucam.yaml", "*camchain*.yaml"}) {
    if (!has(name)) continue;
    const fs::path file = files.folder / files.find(name);
    const auto camera = file.filename() == "camera.yaml" ? read_camera_yaml(file, nullptr) : read_camchain(file);
    if (!camera) return camera.failure();
    facts.lens_from = file.string();
    facts.calibration = *camera;
    facts.has_lens = true, facts.frames_have_lens = false;
    facts.has_mount = (camera->header.flags & ODO_CALIBRATION_EXTRINSICS) != 0;
    return facts;
  }
  Result<bool> read = true;
  if (has("calibration.json"))
    read = from_calibration_json(files.folder / "calibration.json", facts);
  else if (has("camera_matrix.csv"))
    read = from_matrix(files.folder / "camera_matrix.csv", facts);
  else if (has("video_meta.pb3"))
    from_protobuf(files.folder / "video_meta.pb3", facts, warnings);
  if (!read) return read.failure();
  return facts;
}

}  // namespace odograph::phone
