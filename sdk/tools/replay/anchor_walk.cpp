// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/replay/anchor_walk.hpp"

#include <algorithm>
#include <optional>

#include <Eigen/Geometry>
#include <odograph/anchor.h>

#include "sdk/math/rotation.hpp"
#include "sdk/tools/replay/arrivals.hpp"
#include "sdk/tools/replay/replayed.hpp"

namespace odograph {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector2d;
using Eigen::Vector3d;

struct Pose {
  Quaterniond q;
  Vector3d p;
  Vector3d operator*(const Vector3d& x) const { return p + q * x; }
  Vector3d into(const Vector3d& x) const { return q.conjugate() * (x - p); }
};

/// Content drawn at a known position of the simulated street.
struct Content {
  uint64_t id;
  int64_t since_ns;
  Vector3d p_true;
};

class Walk {
 public:
  Walk(const Recording& recording, const AnchorWalkOptions& a) : recording_(recording), a_(a) {
    for (const RecordedMessage& message : recording.messages)
      if (message.message.header().type == ODO_TYPE_CALIBRATION)
        lens_ = copy_as<odo_calibration>(message.message.header());
  }

  Result<AnchorFigures> run(const RunOptions& run) {
    const auto session = replay_session(run);
    if (!session) return session.failure();
    odo_session* raw = session->get();
    session_ = raw;
    const uint32_t wanted[] = {ODO_TYPE_CORRECTION};
    odo_session_set_callback(raw, wanted, 1, on_correction, this);
    for (const Arrival& arrival : arrivals_of(recording_, {})) {
      if (!arrival.other) {
        odo_session_push(raw, &arrival.imu.header);
        continue;
      }
      const odo_header& header = arrival.other->message.header();
      if (header.type == ODO_TYPE_WAYPOINT) continue;  // marks of the recording
      const auto truth = header.type == ODO_TYPE_FRAME ? truth_at(header.t_ns) : std::nullopt;
      if (truth) draw(*truth, header.t_ns);
      if (const auto failure = push(raw, *arrival.other)) return *failure;
      if (truth) place(*truth, header.t_ns);
    }
    finish();
    return sums_;
  }

 private:
  static void on_correction(void* user, const odo_header* event) {
    const auto correction = copy_as<odo_correction>(*event);
    auto& self = *static_cast<Walk*>(user);
    const Quaterniond q = raw_quaternion(correction.q_n);
    self.app_anchor_ = q * self.app_anchor_ + Vector3d(correction.p_n);
  }

  std::optional<Pose> truth_at(int64_t t_ns) const {
    const auto found = std::lower_bound(recording_.truth.begin(), recording_.truth.end(), t_ns,
                                        [](const StampedPose& pose, int64_t t) { return pose.t_ns < t; });
    if (found == recording_.truth.end() || found->t_ns - t_ns > 2'000'000) return std::nullopt;
    return Pose{found->q, found->p};
  }

  std::optional<Pose> pose_at(int64_t t_ns) const {
    odo_pose pose{};
    pose.header.struct_size = sizeof pose;
    if (odo_session_get_pose(session_, t_ns, &pose) != ODO_OK) return std::nullopt;
    if ((pose.header.flags & (ODO_POSE_POSITION | ODO_POSE_METRIC)) != (ODO_POSE_POSITION | ODO_POSE_METRIC))
      return std::nullopt;
    return Pose{raw_quaternion(pose.q_n), Vector3d(pose.p_n)};
  }

  odo_anchor get(uint64_t id, uint32_t world, int64_t t_ns) const {
    odo_anchor anchor{};
    anchor.struct_size = sizeof anchor;
    odo_anchor_get(session_, id, world, t_ns, &anchor);
    return anchor;
  }

  std::optional<Vector2d> project(const Vector3d& p_c) const {
    if (p_c.z() < 0.2) return std::nullopt;
    const Vector2d px(lens_.fx * p_c.x() / p_c.z() + lens_.cx, lens_.fy * p_c.y() / p_c.z() + lens_.cy);
    const bool inside = px.x() >= 0 && px.y() >= 0 && px.x() < lens_.width && px.y() < lens_.height;
    return inside ? std::optional(px) : std::nullopt;
  }

  /// Shows a picture on arrival with everything drawn on it: queries the pose for its time before the pipeline has
  /// processed it.
  void draw(const Pose& truth, int64_t t_ns) {
    for (const Content& content : contents_) {
      const Vector3d p_c = truth.into(content.p_true);
      if (static_cast<double>(t_ns - content.since_ns) < 1e9 * a_.young_s) continue;
      if (p_c.norm() < a_.nearest_m || p_c.norm() > a_.farthest_m) continue;
      const auto there = project(p_c);
      if (!there) continue;
      for (const auto& [world, px] :
           {std::pair{ODO_WORLD_CORRECTED, &sums_.px}, std::pair{ODO_WORLD_SMOOTH, &sums_.smooth_px}}) {
        const odo_anchor anchor = get(content.id, world, t_ns);
        if ((anchor.flags & ODO_ANCHOR_VIEW_POSE) == 0) continue;
        const Vector3d p_view(anchor.p_view);
        if (p_view.z() < 0.2) continue;
        px->push_back(
            (Vector2d(lens_.fx * p_view.x() / p_view.z() + lens_.cx, lens_.fy * p_view.y() / p_view.z() + lens_.cy) -
             *there)
                .norm());
      }
    }
  }

  /// Places new anchors ahead of the camera: straight ahead, to both sides, and farther, to be approached.
  void place(const Pose& truth, int64_t t_ns) {
    const auto pose = pose_at(t_ns);
    if (!pose) return;
    if (first_ns_ == INT64_MIN) first_ns_ = t_ns;
    if (static_cast<double>(t_ns - first_ns_) < 1e9 * a_.settle_s || t_ns < next_ns_) return;
    next_ns_ = t_ns + static_cast<int64_t>(1e9 * a_.every_s);
    if (!map_) {  // Alignment of n with the truth, from the start only: translation and yaw
      const Quaterniond off = pose->q * truth.q.conjugate();
      const Quaterniond q = Quaterniond(off.w(), 0, 0, off.z()).normalized();
      map_ = Pose{q, pose->p - q * truth.p};
    }
    std::erase_if(contents_, [&](const Content& c) {
      const bool old = t_ns - c.since_ns > 10'000'000'000;
      if (old) odo_anchor_remove(session_, c.id);
      return old;
    });
    for (const Vector3d& p : {Vector3d(0, 0, a_.ahead_m), Vector3d(0.4 * a_.ahead_m, 0, a_.ahead_m),
                              Vector3d(-0.4 * a_.ahead_m, 0, a_.ahead_m), Vector3d(0.3, 0.2, 2 * a_.ahead_m)}) {
      const auto id = make(p, t_ns);
      if (id) contents_.push_back({*id, t_ns, truth * p});
    }
    if (start_) return;
    const Vector3d p(0, 0, a_.ahead_m);
    if (const auto id = make(p, t_ns)) {
      start_ = Content{*id, t_ns, truth * p};
      app_anchor_ = *pose * p;
    }
  }

  std::optional<uint64_t> make(const Vector3d& p, int64_t t_ns) {
    odo_anchor_place place{};
    place.struct_size = sizeof place;
    place.kind = ODO_ANCHOR_VIEW;
    place.t_ns = t_ns;
    Vector3d::Map(place.p) = p;
    uint64_t id = 0;
    if (odo_anchor_create(session_, &place, &id) != ODO_OK) return std::nullopt;
    return id;
  }

  /// Gives the session the camera's true position, with sigma mark_sigma_m.
  void finish() {
    odo_session_flush(session_);
    const auto before = pose_at(ODO_TIME_LATEST);
    if (!before || !start_ || recording_.truth.empty()) return;
    const StampedPose& last = recording_.truth.back();
    const Vector3d here = *map_ * last.p, content = *map_ * start_->p_true;
    const auto then = pose_at(last.t_ns);
    if (!then) return;
    sums_.drift_m = (then->p - here).norm();
    sums_.view_sigma_m = get(start_->id, ODO_WORLD_CORRECTED, last.t_ns).view_sigma_m;
    odo_statistics statistics{};
    statistics.struct_size = sizeof statistics;
    for (int i = 0; i < 6; ++i) {  // repeated taps, so that even a diverged track is corrected
      auto mark = make_message<odo_waypoint>(ODO_TYPE_WAYPOINT, last.t_ns + i);
      mark.header.flags = ODO_WAYPOINT_VERTICAL;
      Vector3d::Map(mark.p_n) = here;
      mark.sigma_m = a_.mark_sigma_m;
      odo_session_push(session_, &mark.header);
      odo_session_flush(session_);
      odo_session_get_statistics(session_, &statistics);
      if (statistics.fixes_accepted > 0) break;
    }
    sums_.fixed = statistics.fixes_accepted > 0;
    const odo_anchor anchor = get(start_->id, ODO_WORLD_CORRECTED, last.t_ns);
    sums_.start_off_m = (Vector3d(anchor.p_n) - content).norm();
    sums_.by_newest_m = (app_anchor_ - content).norm();
  }

  const Recording& recording_;
  const AnchorWalkOptions& a_;
  odo_calibration lens_{};
  odo_session* session_ = nullptr;
  std::optional<Pose> map_;
  std::optional<Content> start_;
  Vector3d app_anchor_ = Vector3d::Zero();
  std::vector<Content> contents_;
  int64_t first_ns_ = INT64_MIN, next_ns_ = INT64_MIN;
  AnchorFigures sums_;
};

}  // namespace

Result<AnchorFigures> anchor_walk(const Recording& recording, const RunOptions& run, const AnchorWalkOptions& options) {
  return Walk(recording, options).run(run);
}

}  // namespace odograph
