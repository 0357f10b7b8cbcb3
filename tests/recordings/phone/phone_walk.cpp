// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <cmath>

#include "sdk/math/rotation.hpp"
#include "sdk/tools/recording/odo_file.hpp"
#include "tests/recordings/phone/app_files.hpp"
#include "tests/support/runs.hpp"

namespace {

/// A frame's picture in grey, rotated if the phone is upright.
cv::Mat picture_of(const RecordedMessage& message, bool upright) {
  const auto frame = required(load_frame(message));
  const cv::Mat grey(static_cast<int>(frame->height), static_cast<int>(frame->width), CV_8U,
                     const_cast<uint8_t*>(frame->planes[0].data), static_cast<size_t>(frame->planes[0].row_stride));
  cv::Mat picture = grey.clone();
  if (upright) cv::rotate(grey, picture, cv::ROTATE_90_CLOCKWISE);
  frame->loan.release(frame->loan.owner);
  return picture;
}

}  // namespace

PhoneWalk phone_walk(const Recording& walk, bool upright) {
  PhoneWalk phone;
  phone.recording.format = "walk", phone.recording.path = walk.path;
  for (const auto& m : walk.messages)
    if (m.message.header().type == ODO_TYPE_CALIBRATION && phone.lens.fx == 0)
      phone.lens = as<odo_calibration>(m.message.header());
  odo_calibration& c = phone.lens;
  const Eigen::Quaterniond q_b_c = raw_quaternion(c.q_b_c);
  const double r = std::sqrt(0.5);
  Eigen::Quaterniond q_d_c =
      upright ? Eigen::Quaterniond(0, 1, 0, 0) : Eigen::Quaterniond(0, r, -r, 0);  // the phone's axes d
  // The picture rotated clockwise: its x is the old -y.
  const Eigen::Quaterniond q_c_k(Eigen::AngleAxisd(upright ? -EIGEN_PI / 2 : 0, Eigen::Vector3d::UnitZ()));
  const Eigen::Quaterniond q_d_b = q_d_c * q_c_k.conjugate() * q_b_c.conjugate();
  const int64_t shift_ns = kEpoch_ns - walk.messages.front().message.header().t_ns;
  const auto rotate = [&](double* v) {
    Eigen::Map<Eigen::Vector3d> x(v);
    x = (q_d_b * Eigen::Vector3d(x)).eval();
  };
  rotate(c.p_b_c);
  put_quaternion(q_d_c, c.q_b_c);
  c.header.flags |= ODO_CALIBRATION_EXTRINSICS;
  c.header.flags &= ~static_cast<uint32_t>(ODO_CALIBRATION_TIME_OFFSET);
  if (upright) {
    std::swap(c.fx, c.fy);
    const double cx = c.height - 1.0 - c.cy;
    c.cy = c.cx, c.cx = cx;
    std::swap(c.width, c.height);
  }
  c.header.t_ns = kEpoch_ns;  // before the first sample, as from the readers
  phone.recording.add(c.header);
  for (const auto& m : walk.messages) {
    RecordedMessage moved = m;
    odo_header& h = moved.message.header();
    h.t_ns += shift_ns;
    if (h.type == ODO_TYPE_IMU)
      rotate(reinterpret_cast<odo_imu&>(h).gyro_b), rotate(reinterpret_cast<odo_imu&>(h).accel_b);
    if (h.type == ODO_TYPE_MAGNETOMETER) rotate(reinterpret_cast<odo_magnetometer&>(h).field_b);
    const bool taken = h.type == ODO_TYPE_IMU || h.type == ODO_TYPE_MAGNETOMETER || h.type == ODO_TYPE_BAROMETER ||
                       h.type == ODO_TYPE_GNSS || h.type == ODO_TYPE_FRAME;
    if (!taken) continue;
    if (h.type == ODO_TYPE_FRAME) {
      phone.pictures.push_back(picture_of(m, upright));
      phone.times_ns.push_back(h.t_ns);
    }
    phone.recording.messages.push_back(std::move(moved));
  }
  for (StampedPose pose : walk.truth) {
    pose.t_ns += shift_ns;
    pose.q = pose.q * q_c_k;
    phone.recording.truth.push_back(pose);
  }
  return phone;
}

void write_direct(const PhoneWalk& walk, const fs::path& file) {
  auto writer = required(OdoWriter::create(file, 0));
  size_t picture = 0;
  for (const auto& m : walk.recording.messages) {
    if (m.message.header().type != ODO_TYPE_FRAME) {
      REQUIRE((*writer)->write(m.message.header()).ok());
      continue;
    }
    auto frame = make_message<odo_frame>(ODO_TYPE_FRAME, m.message.header().t_ns);
    const cv::Mat& pixels = walk.pictures[picture++];
    frame.format = ODO_FORMAT_GREY8, frame.plane_count = 1;
    frame.width = static_cast<uint32_t>(pixels.cols), frame.height = static_cast<uint32_t>(pixels.rows);
    frame.planes[0] = {pixels.data, static_cast<int64_t>(pixels.step[0]), 1, 0};
    REQUIRE((*writer)->write(frame.header).ok());
  }
  for (const StampedPose& pose : walk.recording.truth) REQUIRE((*writer)->write_truth(pose).ok());
  REQUIRE((*writer)->finish().ok());
}

namespace {

/// Half a minute's begin: 12 m of a street, with jitter of the inertial samples.
const Recording& street() {
  static const TemporaryFolder folder;
  static const Recording recording = [] {
    Scenario s;
    s.camera.width = 320, s.camera.height = 240, s.camera.focal_px = 250, s.camera.row_time_s = 0;
    s.imu.jitter_s = 2e-4;
    s.walk_m = 14;
    return recorded(s, 5, folder / "walk.odo");
  }();
  return recording;
}

}  // namespace

const PhoneWalk& street_walk(bool upright) {
  static const PhoneWalk wide = phone_walk(street(), false), tall = phone_walk(street(), true);
  return upright ? tall : wide;
}
