// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/replay/camera_imu_source.hpp"

#include "sdk/math/time.hpp"
#include "sdk/tools/replay/picture_source.hpp"

namespace odograph {

Result<CameraImuData> camera_imu_data(const Recording& recording, const ProgressCallback& progress) {
  CameraImuData data;
  std::vector<const RecordedMessage*> frames;
  for (const RecordedMessage& m : recording.messages) {
    const odo_header& header = m.message.header();
    if (header.type == ODO_TYPE_CALIBRATION && data.given.header.type == 0) data.given = as<odo_calibration>(header);
    if (header.type == ODO_TYPE_FRAME) frames.push_back(&m);
    if (header.type != ODO_TYPE_IMU || !(header.flags & ODO_IMU_GYRO)) continue;
    if (data.gyro.empty() || header.t_ns > data.gyro.back().t_ns)
      data.gyro.push_back({header.t_ns, Eigen::Vector3d(as<odo_imu>(header).gyro_b)});
  }
  if (frames.empty()) return data;
  if (data.given.header.type == 0)
    return Failure{ODO_E_DATA,
                   recording.path.string() + ": contains no calibration; an initial focal length is needed"};
  CornerTracks tracks({});
  for (size_t i = 0; i < frames.size(); ++i) {
    if (progress) progress(i, frames.size());
    const auto frame = load_frame(*frames[i]);
    if (!frame) return frame.failure();
    const cv::Mat grey = grey_of(*frame);
    const int64_t t_ns = frame->header.t_ns;
    if (i == 0 && (frame->header.flags & ODO_FRAME_LINE_TIME)) data.given_row_time_s = seconds(frame->line_time_ns);
    frame->loan.release(frame->loan.owner);
    if (grey.cols != static_cast<int>(data.given.width) || grey.rows != static_cast<int>(data.given.height))
      return Failure{ODO_E_DATA, recording.path.string() + ": frames of " + std::to_string(grey.cols) + "x" +
                                     std::to_string(grey.rows) + ", a calibration of " +
                                     std::to_string(data.given.width) + "x" + std::to_string(data.given.height)};
    if (data.frames.empty() || t_ns > data.frames.back().t_ns) data.frames.push_back(tracks.follow(grey, t_ns));
  }
  return data;
}

}  // namespace odograph
