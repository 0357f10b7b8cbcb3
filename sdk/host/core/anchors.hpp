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
#include "sdk/host/base/rigid.hpp"
#include "sdk/host/core/anchor_poses.hpp"
#include "sdk/host/core/smooth_pose.hpp"
#include "sdk/host/fusion/kept_poses.hpp"

namespace odograph {

struct SavedAnchor;

/// The app's anchors. The pipeline reports changes of the track; the app creates, queries and removes anchors. A local
/// anchor is a fixed offset from the nearest kept pose (KeptPoses); where none is available, each correction moves it
/// as a whole. Thread-safe; a call holds the lock for microseconds.
class Anchors {
 public:
  struct Parameters {
    size_t max_anchors = 1024;        ///< anchors
    double max_smooth_jump_m = 1e-6;  ///< m, smaller changes are not blended
    double surface_drift = 0.01;      ///< error along a surface by the phone's track, relative to the distance
    SmoothPose::Parameters smooth;
  };

  /// Height of the ground at a point of n, m downwards, given the height nearby; nothing if no model covers it.
  using Ground = std::function<std::optional<double>(double north_m, double east_m, double near_down_m)>;

  /// A local anchor and the body pose or the surface (with its sigma) on which it was placed, in the corrected world.
  struct Placement {
    int64_t t_ns = 0;
    Rigid T_n_b, T_n_a;
    bool on_surface = false;
    double sigma_m = 0, hit_sigma_m = 0;  ///< of the surface; of the hit
  };

  /// State of an anchor, apart from the phone's pose.
  struct State {
    odo_anchor anchor{};  ///< id, kind, name, state, reason; TRACKING if its position is known
    Rigid T_n_a, smooth_T_n_a;
    std::optional<std::array<double, 3>> geodetic;
    double position_variance = 0, view_variance = 0, yaw_variance = 0;
  };

  static constexpr size_t kLongestName = sizeof(odo_anchor::name) - 1;  ///< bytes

  explicit Anchors(Geodesy& geodesy) : geodesy_(geodesy) {}

  // [any]
  /// Returns the id, or 0 if there are too many anchors.
  uint64_t add_local(const odo_anchor_place& place, const Placement& placement);
  uint64_t add_geodetic(const odo_anchor_place& place);
  bool remove(uint64_t id);
  std::vector<uint64_t> ids() const;
  /// State at a time, which the blending needs; nothing if the anchor does not exist. `drawn`: a pose of that time is
  /// known, so that the anchor may be seen there; its blending continues from it.
  std::optional<State> get(uint64_t id, int64_t t_ns, bool drawn = true) const;

  // [process]
  /// Sets the ground model, called on the pipeline's thread.
  void set_ground(Ground ground) { ground_ = std::move(ground); }
  /// The track advanced or was corrected. `correction` is null unless a correction was announced.
  void update(KeptPoses& poses, int64_t t_ns, const Rigid* correction);
  /// A surface was refined; the anchors on `id` move to `into`, which may be another one.
  void follow_surface(uint64_t id, uint64_t into, const Rigid& T_n_s, double sigma_m);
  /// There is no such surface any more: its anchors are local ones, where they are.
  void leave_surface(uint64_t id);
  /// The localizer restarts and keeps no poses any more.
  void drop_kept_poses();

  // [control]
  /// All anchors, for the next session; empty if there are none.
  std::vector<uint8_t> save() const;
  /// Adds saved anchors to the present ones. False, and nothing changed, if the blob is damaged.
  bool load(std::span<const uint8_t> blob);
  /// The local anchors that are placed, in the frame of that map; if this is not known, those that came with it.
  std::vector<uint8_t> save_in(const std::optional<Rigid>& T_n_m, uint32_t source, uint64_t map) const;
  /// Adds them in a later session: placed once the map of that plugin is recognised. A name that is there already is
  /// left out.
  bool load_in(std::span<const uint8_t> blob, uint32_t source, uint64_t map);

 private:
  enum class Reference { geodetic, pose, track, awaiting_pose, navigation, surface, map };
  static bool stays_in_n(Reference r) {
    return r == Reference::geodetic || r == Reference::navigation || r == Reference::map;
  }
  struct Anchor {
    uint64_t id = 0;
    uint32_t kind = 0;
    std::string name;
    Reference reference = Reference::track;
    bool placed = false;
    uint32_t lost_reason = 0;  // ODO_REASON_*
    Rigid T_n_a;
    SmoothPose smooth;
    // relative to a pose
    int64_t seen_ns = 0;
    Rigid T_b_a;  // before it is attached to a kept pose
    Attachment to_pose;
    uint64_t surface = 0;     // T_b_a is then in its axes
    uint32_t map_source = 0;  // in the map of which plugin T_b_a is, and in which
    uint64_t map = 0;
    // geodetic
    std::array<double, 3> geodetic{};
    Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
    uint32_t height_above = 0;
    double sigma_m = 0, hit_sigma_m = 0;
  };
  /// Of an anchor's position in n and relative to the view, m^2, in n, and of its heading, rad^2.
  struct Covariance {
    Eigen::Matrix3d place, view;
    double yaw_variance = 0;
  };

  Anchor& add(const odo_anchor_place& place, Reference reference);
  Anchor& add(const SavedAnchor& saved, Reference reference);
  void find_map(Anchor& anchor, const KeptPoses& poses);
  void attach_to_pose(Anchor& anchor, KeptPoses& poses);
  void take_hand_overs(KeptPoses& poses);
  void georeference(Anchor& anchor, const KeptPose& now);
  void blend(Anchor& anchor, const Rigid& before, int64_t t_ns);
  Covariance covariance_of(const Anchor& anchor) const;

  Parameters p_;
  Geodesy& geodesy_;
  Ground ground_;
  mutable std::mutex mutex_;
  std::vector<Anchor> anchors_;
  KeptPoseCache poses_;         // those that anchors refer to
  bool removed_ = false;        // an anchor, since the newest update
  KeptPose now_;                // the body at the newest update
  int64_t now_ns_ = INT64_MIN;  // time of that
  uint64_t last_id_ = 0;
  bool placed_ = false;  // n is placed, by the configured start or by a fix
  mutable int64_t queried_ns_ = INT64_MIN;
};

}  // namespace odograph
