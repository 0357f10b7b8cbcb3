// SPDX-License-Identifier: Apache-2.0
//
// Frames of a replayed recording with the poses and landmarks of the pipeline, for figures of fix/map.
#pragma once

#include <cstdio>
#include <functional>
#include <map>
#include <optional>

#include "plugins/fix/map/place_types.hpp"
#include "plugins/shared/camera/frame_view.hpp"
#include "sdk/math/rotation.hpp"
#include "sdk/tools/recording/recording.hpp"
#include "sdk/tools/replay/replayed.hpp"

namespace odograph::place_map {

using Eigen::Quaterniond;
using Eigen::Vector3d;

/// A frame of a replayed recording.
struct Shot {
  Picture picture;
  Rigid T_n_c;                 // as estimated
  std::optional<Rigid> truth;  // of the recording
  std::vector<Landmark> landmarks;
  double scale_sigma = 1;
};

/// Replays a recording and collects its frames with pose and landmarks.
class Collector {
 public:
  Collector(const Recording& recording, std::function<void(Shot&&)> take)
      : recording_(recording), take_(std::move(take)) {}

  bool run(const std::string& config) {
    RunOptions options;
    options.config = config;
    auto session = replay_session(options);
    if (!session) return std::fprintf(stderr, "%s\n", session.failure().text.c_str()), false;
    const uint32_t wanted[] = {ODO_TYPE_POSE, ODO_TYPE_POINTS};
    odo_session_set_callback(session->get(), wanted, 2, on_event, this);
    for (const RecordedMessage& message : recording_.messages) {
      const odo_header& header = message.message.header();
      if (header.type == ODO_TYPE_CALIBRATION) lens_ = camera_of(copy_as<odo_calibration>(header));
      if (header.type != ODO_TYPE_FRAME) {
        odo_session_push(session->get(), &header);
        continue;
      }
      const auto frame = load_frame(message);
      if (!frame) continue;
      grey_[header.t_ns] = grey_of(*frame);
      if (grey_.size() > 8) grey_.erase(grey_.begin());
      odo_session_push(session->get(), &frame->header);
      frame->loan.release(frame->loan.owner);
    }
    odo_session_flush(session->get());
    return true;
  }

 private:
  static void on_event(void* user, const odo_header* event) {
    auto& self = *static_cast<Collector*>(user);
    if (event->type == ODO_TYPE_POINTS) self.hold(*reinterpret_cast<const odo_points*>(event));
    if (event->type == ODO_TYPE_POSE) self.pose(copy_as<odo_pose>(*event));
  }
  void hold(const odo_points& points) {
    points_.clear(), points_ns_ = points.header.t_ns;
    for (uint32_t i = 0; i < points.count; ++i)
      if (const odo_point* point = ODO_POINTS_AT(&points, i)) points_.push_back(*point);
  }
  void pose(const odo_pose& pose) {
    constexpr uint32_t needed = ODO_POSE_POSITION | ODO_POSE_ORIENTATION | ODO_POSE_CAMERA;
    const auto grey = grey_.find(pose.header.t_ns);
    if ((pose.header.flags & needed) != needed || grey == grey_.end()) return;
    Shot shot;
    shot.picture.t_ns = pose.header.t_ns, shot.picture.grey = grey->second, shot.picture.lens = lens_;
    shot.T_n_c = {quaternion(pose.q_n), Vector3d(pose.p_n)};
    shot.picture.down_c = shot.T_n_c.q.conjugate() * Vector3d::UnitZ();
    shot.picture.tilt_sigma_rad = std::max(0.005, std::sqrt(0.5 * (pose.covariance[0] + pose.covariance[7])));
    if (const auto truth = pose_at(recording_.truth, pose.header.t_ns, 0.1)) shot.truth = Rigid{truth->q, truth->p};
    shot.scale_sigma = pose.scale > 0 && pose.scale_sigma > 0 ? pose.scale_sigma / pose.scale : 1;
    if (points_ns_ == pose.header.t_ns && pose.header.flags & ODO_POSE_METRIC)
      for (const odo_point& point : points_) {
        if (point.flags & (ODO_POINT_UNCERTAIN | ODO_POINT_LOST) || point.age < 3) continue;
        Landmark& landmark = shot.landmarks.emplace_back();
        landmark.id = point.id, landmark.pixel = Eigen::Vector2f::Map(point.pixel).cast<double>();
        landmark.p_c = pose.scale * Eigen::Vector3f::Map(point.p_c).cast<double>();
        const float* c = point.covariance;
        Eigen::Matrix3f P;
        P << c[0], c[1], c[2], c[1], c[3], c[4], c[2], c[4], c[5];
        landmark.covariance = pose.scale * pose.scale * P.cast<double>();
      }
    take_(std::move(shot));
  }

  const Recording& recording_;
  std::function<void(Shot&&)> take_;
  CameraModel lens_;
  std::map<int64_t, cv::Mat> grey_;
  std::vector<odo_point> points_;
  int64_t points_ns_ = 0;
};

}  // namespace odograph::place_map
