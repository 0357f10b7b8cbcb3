// SPDX-License-Identifier: Apache-2.0
//
// MCAP for Foxglove and other readers of its schemas (docs.foxglove.dev/docs/visualization/message-schemas), as JSON.
#include <cmath>
#include <cstring>

#include <nlohmann/json.hpp>

#include "sdk/host/base/geodesy.hpp"
#include "sdk/math/scalar.hpp"
#include "sdk/math/rotation.hpp"
#include "sdk/tools/export/exported_run.hpp"
#include "sdk/tools/page/page_pictures.hpp"
#include "sdk/tools/recording/mcap_writer.hpp"
#include "sdk/tools/recording/odo_file.hpp"

namespace odograph {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char *kWorld = "world", *kCamera = "camera", *kImu = "imu";

/// The JSON schema of a value like this one.
Json schema_of(const Json& value) {
  if (value.is_array()) return {{"type", "array"}, {"items", schema_of(value.empty() ? Json(0.0) : value.front())}};
  if (!value.is_object())
    return {{"type", value.is_string()         ? "string"
                     : value.is_boolean()      ? "boolean"
                     : value.is_number_float() ? "number"
                                               : "integer"}};
  Json fields = Json::object();
  for (const auto& [name, field] : value.items()) fields[name] = schema_of(field);
  if (value.contains("data")) fields["data"]["contentEncoding"] = "base64";
  return {{"type", "object"}, {"properties", fields}};
}

Json time_of(int64_t t_ns) {
  const int64_t t = std::max<int64_t>(t_ns, 0);
  return {{"sec", t / 1'000'000'000}, {"nsec", t % 1'000'000'000}};
}
Json vector_of(const Eigen::Vector3d& v) { return {{"x", v.x()}, {"y", v.y()}, {"z", v.z()}}; }
Json quaternion_of(const Eigen::Quaterniond& q) { return {{"x", q.x()}, {"y", q.y()}, {"z", q.z()}, {"w", q.w()}}; }
Json pose_of(const StampedPose& pose) {
  return {{"position", vector_of(pose.p)}, {"orientation", quaternion_of(pose.q)}};
}

/// North-East-Down to East-North-Up.
StampedPose in_world(const StampedPose& pose) {
  static const Eigen::Quaterniond q_e_n(0, std::sqrt(0.5), std::sqrt(0.5), 0);
  return {pose.t_ns, q_e_n * pose.q, q_e_n * pose.p};
}

class FoxgloveWriter {
 public:
  FoxgloveWriter(const ExportedRun& run, McapWriter& out) : run_(run), out_(out), lens_(camera_of(run.recording)) {
    if (run.origin) geodesy_.set_origin(*run.origin);
  }

  Result<Exported> write(const ExportProgress& progress) {
    write_track();
    write_tables();
    size_t pose = 0, done = 0;
    const auto& messages = run_.recording.messages;
    const auto frames = frames_of(run_.recording, lens_);
    for (const RecordedMessage& m : messages) {
      if (progress) progress(++done, messages.size());
      for (; pose < run_.track.size() && run_.track[pose].t_ns <= m.message.header().t_ns; ++pose)
        write_pose(run_.track[pose]);
      if (m.message.header().type == ODO_TYPE_FRAME) {
        if (lens_ && m.message.header().source != lens_->header.source) continue;
        if (const auto written = write_picture(m); !written) return written.failure();
      } else {
        write_sample(m.message.header());
      }
    }
    for (; pose < run_.track.size(); ++pose) write_pose(run_.track[pose]);
    exported_.poses = run_.track.size();
    return exported_;
  }

 private:
  void put(const char* topic, const char* type, int64_t t_ns, const Json& message) {
    const auto [known, fresh] = topics_.try_emplace(topic, uint16_t(0));
    if (fresh) {
      Json schema = {{"title", type}};
      schema.update(schema_of(message));
      known->second = out_.add({topic, "json", type, "jsonschema", schema.dump()});
    }
    out_.write(known->second, t_ns, message.dump(-1, ' ', false, Json::error_handler_t::replace));
  }

  void write_transform(int64_t t_ns, const char* parent, const char* child, const StampedPose& pose) {
    put("/tf", "foxglove.FrameTransform", t_ns,
        {{"timestamp", time_of(t_ns)},
         {"parent_frame_id", parent},
         {"child_frame_id", child},
         {"translation", vector_of(pose.p)},
         {"rotation", quaternion_of(pose.q)}});
  }

  const char* moved() const { return lens_ ? kCamera : kImu; }

  void write_pose(const StampedPose& pose_n) {
    const StampedPose pose = in_world(pose_n);
    write_transform(pose.t_ns, kWorld, moved(), pose);
    put("/pose", "foxglove.PoseInFrame", pose.t_ns,
        {{"timestamp", time_of(pose.t_ns)}, {"frame_id", kWorld}, {"pose", pose_of(pose)}});
    if (!run_.origin) return;
    const auto place = geodesy_.to_geodetic({pose_n.p.x(), pose_n.p.y(), pose_n.p.z()});
    write_place("/track/fix", pose.t_ns, place, nullptr);
  }

  void write_points(int64_t t_ns) {
    constexpr int kFloat32 = 7;
    std::vector<unsigned char> data(run_.points.size() * sizeof(Eigen::Vector3f));
    for (size_t i = 0; i < run_.points.size(); ++i) {
      const Eigen::Vector3f& n = run_.points[i];
      const Eigen::Vector3f world(n.y(), n.x(), -n.z());
      std::memcpy(data.data() + i * sizeof world, world.data(), sizeof world);
    }
    Json fields = Json::array();
    for (const auto& [name, offset] : {std::pair{"x", 0}, {"y", 4}, {"z", 8}})
      fields.push_back({{"name", name}, {"offset", offset}, {"type", kFloat32}});
    put("/points", "foxglove.PointCloud", t_ns,
        {{"timestamp", time_of(t_ns)},
         {"frame_id", kWorld},
         {"pose", pose_of({t_ns, Eigen::Quaterniond::Identity(), Eigen::Vector3d::Zero()})},
         {"point_stride", sizeof(Eigen::Vector3f)},
         {"fields", fields},
         {"data", base64(data)}});
  }

  /// All poses at once, as a line in space, and the camera's mount.
  void write_track() {
    const int64_t t_ns =
        run_.track.empty() ? run_.recording.messages.front().message.header().t_ns : run_.track[0].t_ns;
    Json poses = Json::array();
    for (const StampedPose& pose : run_.track) poses.push_back(pose_of(in_world(pose)));
    if (!poses.empty())
      put("/track", "foxglove.PosesInFrame", t_ns,
          {{"timestamp", time_of(t_ns)}, {"frame_id", kWorld}, {"poses", poses}});
    if (!run_.points.empty()) write_points(t_ns);
    if (!lens_ || !(lens_->header.flags & ODO_CALIBRATION_EXTRINSICS)) return;
    const Eigen::Quaterniond q_c_b = raw_quaternion(lens_->q_b_c).conjugate();
    write_transform(t_ns, kCamera, kImu, {t_ns, q_c_b, -(q_c_b * Eigen::Vector3d::Map(lens_->p_b_c))});
  }

  void write_tables() {
    for (const auto& s : run_.scales)
      put("/scale", "odograph.Scale", s.t_ns,
          {{"timestamp", time_of(s.t_ns)},
           {"scale", s.scale},
           {"sigma", s.sigma},
           {"source", s.source},
           {"used", s.used}});
    for (const auto& s : run_.states)
      put("/state", "odograph.State", s.t_ns,
          {{"timestamp", time_of(s.t_ns)}, {"state", s.state}, {"reason", s.reason}});
  }

  void write_place(const char* topic, int64_t t_ns, const std::array<double, 3>& place, const double* covariance_n) {
    Json covariance = Json::array();
    constexpr int kAxis[3] = {1, 0, 2}, kSign[3] = {1, 1, -1};
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        covariance.push_back(covariance_n ? kSign[i] * kSign[j] * covariance_n[3 * kAxis[i] + kAxis[j]] : 0.0);
    put(topic, "foxglove.LocationFix", t_ns,
        {{"timestamp", time_of(t_ns)},
         {"frame_id", moved()},
         {"latitude", place[0] * kDeg_per_rad},
         {"longitude", place[1] * kDeg_per_rad},
         {"altitude", place[2]},
         {"position_covariance", covariance},
         {"position_covariance_type", covariance_n ? 3 : 0}});
  }

  Result<bool> write_picture(const RecordedMessage& m) {
    const int64_t t_ns = m.message.header().t_ns + (lens_ ? lens_->time_offset_ns : 0);
    const auto bytes = picture_as_file(m);
    if (!bytes) return bytes.failure();
    if (bytes->empty()) {
      ++exported_.pictures_lost;
      return true;
    }
    put("/camera", "foxglove.CompressedImage", t_ns,
        {{"timestamp", time_of(t_ns)},
         {"frame_id", kCamera},
         {"data", base64(*bytes)},
         {"format", bytes->front() == 0xFF ? "jpeg" : "png"}});
    ++exported_.pictures;
    return true;
  }

  void write_lens(const odo_calibration& c) {
    const bool fisheye = c.model == ODO_CAMERA_KANNALA_BRANDT;
    Json d = Json::array();
    for (uint32_t i = 0; i < c.distortion_count; ++i) d.push_back(c.distortion[i]);
    while (!fisheye && d.size() < 5) d.push_back(0.0);
    put("/camera/calibration", "foxglove.CameraCalibration", c.header.t_ns,
        {{"timestamp", time_of(c.header.t_ns)},
         {"frame_id", kCamera},
         {"width", c.width},
         {"height", c.height},
         {"distortion_model", fisheye        ? "kannala_brandt"
                              : d.size() > 5 ? "rational_polynomial"
                                             : "plumb_bob"},
         {"D", d},
         {"K", {c.fx, 0.0, c.cx, 0.0, c.fy, c.cy, 0.0, 0.0, 1.0}},
         {"R", {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0}},
         {"P", {c.fx, 0.0, c.cx, 0.0, 0.0, c.fy, c.cy, 0.0, 0.0, 0.0, 1.0, 0.0}}});
  }

  static Json header_of(int64_t t_ns) {
    const Json time = time_of(t_ns);
    return {{"stamp", {{"sec", time["sec"]}, {"nanosec", time["nsec"]}}}, {"frame_id", kImu}};
  }

  /// For sensors without a Foxglove schema: ROS schemas, as JSON.
  void write_sample(const odo_header& header) {
    const int64_t t_ns = header.t_ns;
    if (header.type == ODO_TYPE_CALIBRATION && lens_ && header.source == lens_->header.source) {
      write_lens(as<odo_calibration>(header));
    } else if (header.type == ODO_TYPE_IMU) {
      const auto& imu = as<odo_imu>(header);
      Json message = {{"header", header_of(t_ns)},
                      {"angular_velocity", vector_of(Eigen::Vector3d(imu.gyro_b))},
                      {"linear_acceleration", vector_of(Eigen::Vector3d(imu.accel_b))}};
      for (const auto& [name, flag] :
           {std::pair{"angular_velocity_covariance", ODO_IMU_GYRO}, {"linear_acceleration_covariance", ODO_IMU_ACCEL}})
        message[name] = {header.flags & flag ? 0.0 : -1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0};  // -1: not measured
      put("/imu", "sensor_msgs/msg/Imu", t_ns, message);
    } else if (header.type == ODO_TYPE_MAGNETOMETER) {
      put("/magnetometer", "sensor_msgs/msg/MagneticField", t_ns,
          {{"header", header_of(t_ns)},
           {"magnetic_field", vector_of(Eigen::Vector3d(as<odo_magnetometer>(header).field_b))}});
    } else if (header.type == ODO_TYPE_BAROMETER) {
      put("/barometer", "sensor_msgs/msg/FluidPressure", t_ns,
          {{"header", header_of(t_ns)}, {"fluid_pressure", as<odo_barometer>(header).pressure_pa}});
    } else if (header.type == ODO_TYPE_GNSS && (header.flags & ODO_GNSS_POSITION)) {
      const auto& g = as<odo_gnss>(header);
      write_place("/gnss", t_ns, {g.latitude_rad, g.longitude_rad, g.height_m},
                  (header.flags & ODO_GNSS_COVARIANCE) ? g.covariance_n : nullptr);
    }
  }

  const ExportedRun& run_;
  McapWriter& out_;
  const odo_calibration* lens_;
  Geodesy geodesy_;
  std::map<std::string, uint16_t> topics_;
  Exported exported_;
};

}  // namespace

Result<Exported> write_foxglove(const ExportedRun& run, const std::filesystem::path& file,
                                const ExportProgress& progress) {
  auto out = McapWriter::create(file, "");
  if (!out) return out.failure();
  const auto exported = FoxgloveWriter(run, **out).write(progress);
  if (!exported) return exported;
  if (const auto done = (*out)->finish(); !done) return done.failure();
  return exported;
}

}  // namespace odograph
