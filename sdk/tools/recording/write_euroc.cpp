// SPDX-License-Identifier: Apache-2.0
//
// Writes a recording as an EuRoC/ASL folder (Burri et al., IJRR 2016), with calibration files in Kalibr's form.
#include <cstdio>
#include <fstream>
#include <map>

#include <opencv2/imgcodecs.hpp>

#include "sdk/host/messages/imu_joiner.hpp"
#include "sdk/math/rotation.hpp"
#include "sdk/math/time.hpp"
#include "sdk/tools/recording/odo_file.hpp"
#include "sdk/tools/recording/recording.hpp"

namespace odograph {
namespace fs = std::filesystem;

namespace {

/// Formats numbers with full precision, so that reading yields the same bits.
std::string text(double x) {
  char buffer[40];
  std::snprintf(buffer, sizeof buffer, "%.17g", x);
  return buffer;
}

template <class Numbers>
std::string list(const Numbers& numbers, size_t count, const char* separator = ", ") {
  std::string s;
  for (size_t i = 0; i < count; ++i) s += (i ? separator : "") + text(numbers[i]);
  return s;
}

class EurocWriter {
 public:
  EurocWriter(const Recording& recording, const fs::path& folder) : r_(recording), folder_(folder) {}

  Result<EurocWritten> write(const std::function<void(size_t, size_t)>& progress) {
    std::error_code error;
    if (fs::exists(folder_ / "mav0", error))
      return Failure{ODO_E_ARGUMENT, folder_.string() + ": holds a recording (mav0) already; expected another folder"};
    std::vector<const char*> parts = {"mav0/imu0", "mav0/state_groundtruth_estimate0"};
    if (r_.has(ODO_TYPE_FRAME)) parts.push_back("mav0/cam0/data");  // an empty folder could not be read again
    for (const char* part : parts)
      if (fs::create_directories(folder_ / part, error); error)
        return Failure{ODO_E_IO, (folder_ / part).string() + ": cannot be created"};
    for (const auto& m : r_.messages) {
      if (m.message.header().type == ODO_TYPE_CALIBRATION) camera_ = as<odo_calibration>(m.message.header());
      if (m.message.header().type == ODO_TYPE_IMU_NOISE) noise_ = as<odo_imu_noise>(m.message.header());
    }
    write_text("mav0/body.yaml", "# General sensor definitions.\ncomment: " + r_.format + "\n");
    if (const auto done = write_data(progress); !done) return done.failure();
    if (r_.has(ODO_TYPE_FRAME)) write_camera();
    write_imu();
    write_truth();
    if (!complete_) return Failure{ODO_E_IO, folder_.string() + ": writing failed; is the disk full?"};
    written_.true_states = r_.true_states.size();
    if (r_.true_states.empty() && !r_.truth.empty())
      written_.left_out = std::to_string(r_.truth.size()) + " true poses";
    for (const auto& [type, count] : left_out_)
      written_.left_out += (written_.left_out.empty() ? "" : ", ") + std::to_string(count) + " " + message_name(type);
    return written_;
  }

 private:
  void write_text(const fs::path& name, const std::string& content) {
    std::ofstream out(folder_ / name, std::ios::binary);
    out << content;
    complete_ = complete_ && out.flush();
  }

  Result<bool> write_data(const std::function<void(size_t, size_t)>& progress) {
    std::string frames = "#timestamp [ns],filename\n";
    std::string imu =
        "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],"
        "a_RS_S_x [m s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]\n";
    ImuJoiner joiner;  // phones deliver the two sensors separately
    size_t done = 0;
    for (const auto& m : r_.messages) {
      const odo_header& header = m.message.header();
      const std::string stamp = std::to_string(header.t_ns);
      if (progress) progress(++done, r_.messages.size());
      if (header.type == ODO_TYPE_IMU) {
        joiner.push(as<odo_imu>(header), [&](const odo_imu& s) {
          if ((s.header.flags & ODO_IMU_ACCEL) == 0) {  // the format has only complete samples
            ++left_out_[ODO_TYPE_IMU];
            return;
          }
          ++written_.messages;
          imu += std::to_string(s.header.t_ns) + "," + list(s.gyro_b, 3, ",") + "," + list(s.accel_b, 3, ",") + "\n";
        });
      } else if (header.type == ODO_TYPE_FRAME) {
        const auto frame = load_frame(m);
        if (!frame) {
          ++written_.pictures_lost;
          continue;
        }
        const auto picture = encode_picture(*frame, 0);
        frame->loan.release(frame->loan.owner);
        if (!picture) return picture.failure();
        write_text("mav0/cam0/data/" + stamp + ".png", std::string(picture->begin(), picture->end()));
        frames += stamp + "," + stamp + ".png\n";
        ++frames_;
        ++written_.messages;
      } else if (header.type == ODO_TYPE_CALIBRATION || header.type == ODO_TYPE_IMU_NOISE) {
        ++written_.messages;
      } else {
        ++left_out_[header.type];
      }
    }
    if (frames_ > 0) write_text("mav0/cam0/data.csv", frames);
    write_text("mav0/imu0/data.csv", imu);
    return true;
  }

  double rate(uint32_t type) const {
    int64_t first = 0, last = 0;
    size_t n = 0;
    for (const auto& m : r_.messages)
      if (m.message.header().type == type) {
        if (n++ == 0) first = m.message.header().t_ns;
        last = m.message.header().t_ns;
      }
    return n > 1 ? static_cast<double>(n - 1) * 1e9 / static_cast<double>(last - first) : 0.0;
  }

  static std::string rows(const Eigen::Matrix4d& T, const std::string& indent) {
    std::string s;
    for (int i = 0; i < 4; ++i)
      s += indent + "- [" + text(T(i, 0)) + ", " + text(T(i, 1)) + ", " + text(T(i, 2)) + ", " + text(T(i, 3)) + "]\n";
    return s;
  }

  /// Kalibr's name for the line time, in s; nothing for a global shutter.
  std::string line_delay(const std::string& indent) const {
    for (const auto& m : r_.messages)
      if (m.message.header().type == ODO_TYPE_FRAME) {
        const int64_t line_ns = as<odo_frame>(m.message.header()).line_time_ns;
        return line_ns > 0 ? indent + "line_delay: " + text(seconds(line_ns)) + "\n" : "";
      }
    return "";
  }

  void write_camera() {
    Eigen::Isometry3d T_b_c = Eigen::Isometry3d::Identity();
    T_b_c.linear() = raw_quaternion(camera_.q_b_c).toRotationMatrix();
    T_b_c.translation() = Eigen::Vector3d::Map(camera_.p_b_c);
    const bool fisheye = camera_.model == ODO_CAMERA_KANNALA_BRANDT;
    const double intrinsics[4] = {camera_.fx, camera_.fy, camera_.cx, camera_.cy};
    const size_t coefficients = std::max<size_t>(4, camera_.distortion_count);
    const std::string size = "[" + std::to_string(camera_.width) + ", " + std::to_string(camera_.height) + "]";
    std::string data;
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j) data += (data.empty() ? "" : ", ") + text(T_b_c.matrix()(i, j));
    write_text("mav0/cam0/sensor.yaml",
               "# General sensor definitions.\nsensor_type: camera\ncomment: " + r_.format +
                   "\nT_BS:\n  cols: 4\n  rows: 4\n  data: [" + data + "]\nrate_hz: " + text(rate(ODO_TYPE_FRAME)) +
                   "\nresolution: " + size + "\ncamera_model: pinhole\nintrinsics: [" + list(intrinsics, 4) +
                   "]\ndistortion_model: " + (fisheye ? "equidistant" : "radial-tangential") +
                   "\ndistortion_coefficients: [" + list(camera_.distortion, coefficients) + "]\n" + line_delay(""));
    write_text("camchain-imucam.yaml",
               "cam0:\n  T_cam_imu:\n" + rows(T_b_c.inverse().matrix(), "  ") +
                   "  camera_model: pinhole\n  intrinsics: [" + list(intrinsics, 4) +
                   "]\n  distortion_model: " + (fisheye ? "equidistant" : "radtan") + "\n  distortion_coeffs: [" +
                   list(camera_.distortion, 4) + "]\n  resolution: " + size + "\n  rostopic: /cam0/image_raw\n" +
                   "  timeshift_cam_imu: " + text(seconds(camera_.time_offset_ns)) + "\n" + line_delay("  "));
  }

  void write_imu() {
    const std::string densities = "gyroscope_noise_density: " + text(noise_.gyro_noise) +
                                  "\ngyroscope_random_walk: " + text(noise_.gyro_walk) +
                                  "\naccelerometer_noise_density: " + text(noise_.accel_noise) +
                                  "\naccelerometer_random_walk: " + text(noise_.accel_walk) + "\n";
    const std::string rate_hz = text(rate(ODO_TYPE_IMU));
    write_text(
        "mav0/imu0/sensor.yaml",
        "# General sensor definitions.\nsensor_type: imu\ncomment: " + r_.format +
            "\nT_BS:\n  cols: 4\n  rows: 4\n  data: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]\nrate_hz: " +
            rate_hz + "\n" + densities);
    write_text("imu.yaml", densities + "rostopic: /imu0\nupdate_rate: " + rate_hz + "\n");
  }

  void write_truth() {
    std::string csv =
        "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z [], "
        "v_RS_R_x [m s^-1], v_RS_R_y [m s^-1], v_RS_R_z [m s^-1], b_w_RS_S_x [rad s^-1], b_w_RS_S_y [rad s^-1], "
        "b_w_RS_S_z [rad s^-1], b_a_RS_S_x [m s^-2], b_a_RS_S_y [m s^-2], b_a_RS_S_z [m s^-2]\n";
    for (const TrueState& s : r_.true_states) {
      const Eigen::Vector4d q(s.q.w(), s.q.x(), s.q.y(), s.q.z());
      csv += std::to_string(s.t_ns);
      for (const auto& numbers : {list(s.p, 3, ","), list(q, 4, ","), list(s.v, 3, ","), list(s.gyro_bias, 3, ","),
                                  list(s.accel_bias, 3, ",")})
        csv += "," + numbers;
      csv += "\n";
    }
    if (!r_.true_states.empty()) write_text("mav0/state_groundtruth_estimate0/data.csv", csv);
  }

  const Recording& r_;
  const fs::path folder_;
  odo_calibration camera_{};
  odo_imu_noise noise_{};
  size_t frames_ = 0;
  EurocWritten written_;
  std::map<uint32_t, size_t> left_out_;  // by type
  bool complete_ = true;
};

}  // namespace

Result<EurocWritten> write_euroc(const Recording& recording, const fs::path& folder,
                                 const std::function<void(size_t, size_t)>& progress) {
  return EurocWriter(recording, folder).write(progress);
}

}  // namespace odograph
