// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <odograph/anchor.h>

#include "sdk/host/base/geodesy.hpp"
#include "sdk/host/core/smooth_pose.hpp"
#include "sdk/host/localizer/held_poses.hpp"

namespace odograph {

/// A rigid transform: axes and place of one frame in another.
struct Rigid {
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
  Eigen::Vector3d p = Eigen::Vector3d::Zero();  ///< m

  Rigid operator*(const Rigid& inner) const { return {(q * inner.q).normalized(), p + q * inner.p}; }
  Rigid inverse() const { return {q.conjugate(), -(q.conjugate() * p)}; }
};

/// The app's anchors. The pipeline tells what has become of the track; the app makes, asks and ends them. A local
/// anchor hangs on a pose that is held (HeldPoses::hold_pose); where that cannot be, it goes with every
/// correction as a whole. Thread-safe, every call holds the lock for microseconds.
class Anchors {
 public:
  struct Parameters {
    size_t most = 1024;               ///< anchors; each costs under 1 us per update
    double max_smooth_jump_m = 1e-6;  ///< below it a change is not worth blending
    SmoothPose::Parameters smooth;
  };

  /// Height of the ground at a place of n, given the height nearby, downwards, m; nothing where no model knows it.
  using Ground = std::function<std::optional<double>(double north_m, double east_m, double near_down_m)>;

  /// A local anchor that was seen from a pose of the body: both in the corrected world.
  struct Seen {
    int64_t t_ns = 0;
    Rigid T_n_b, T_n_a;
  };

  /// What is known of an anchor, but for the phone's pose.
  struct Known {
    odo_anchor anchor{};  ///< id, kind, name, state, reason; TRACKING where it is placed
    Rigid T_n_a, smooth_T_n_a;
    std::optional<std::array<double, 3>> geodetic;
    double position_variance = 0, view_variance = 0, yaw_variance = 0;
  };

  explicit Anchors(Geodesy& geodesy) : geodesy_(geodesy) {}

  // [any]
  /// The id, or 0 when there are too many.
  uint64_t add_local(const odo_anchor_place& place, const Seen& seen);
  uint64_t add_geodetic(const odo_anchor_place& place);
  bool remove(uint64_t id);
  std::vector<uint64_t> ids() const;
  /// At a time, for the blending; nothing where there is no such anchor.
  std::optional<Known> get(uint64_t id, int64_t t_ns) const;

  // [process]
  /// Where the ground is, asked on the pipeline's thread.
  void set_ground(Ground ground) { ground_ = std::move(ground); }
  /// The track was corrected (null: not by an announced correction), or has gone on.
  void follow(HeldPoses& poses, int64_t t_ns, const Rigid* correction);
  /// The localizer begins anew and holds nothing any more.
  void lose_holds();

  // [control]
  /// All anchors, for the next session; empty where there are none.
  std::vector<uint8_t> save() const;
  /// False, and nothing changed, when the blob is damaged. They come in addition to those that are there.
  bool load(std::span<const uint8_t> blob);

 private:
  enum class Hangs { on_earth, on_pose, on_track, awaits_pose, in_n };
  struct Anchor {
    uint64_t id = 0;
    uint32_t kind = 0;
    std::string name;
    Hangs hangs = Hangs::on_track;
    bool placed = false;
    uint32_t why_not = 0;  // ODO_REASON_*
    Rigid T_n_a;
    SmoothPose smooth;
    // on a pose
    int64_t seen_ns = 0;
    Rigid T_b_a;
    uint64_t held = 0;
    // on the Earth
    std::array<double, 3> geodetic{};
    Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
    uint32_t height_above = 0;
    double sigma_m = 0;
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();       // of its place in n, m^2
    Eigen::Matrix3d view_covariance = Eigen::Matrix3d::Zero();  // of what is seen of it, in n
    double yaw_variance = 0;
  };

  Anchor& add(const odo_anchor_place& place, Hangs hangs);
  void hang(Anchor& anchor, HeldPoses& poses);
  void put_on_earth(Anchor& anchor, const HeldPose& now);
  void judge(Anchor& anchor, const HeldPose* held, const HeldPose& now) const;
  Eigen::Quaterniond axes_at(const std::array<double, 3>& geodetic) const;

  Parameters p_;
  Geodesy& geodesy_;
  Ground ground_;
  mutable std::mutex mutex_;
  std::vector<Anchor> anchors_;
  std::vector<uint64_t> to_let_go_;  // held poses of anchors that have ended
  uint64_t last_id_ = 0;
  bool placed_ = false;  // n, by the start that was given or by a fix
  mutable int64_t asked_ns_ = INT64_MIN;
};

}  // namespace odograph
