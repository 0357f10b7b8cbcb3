// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "sdk/host/fusion/fusion_state.hpp"
#include "sdk/host/fusion/kept_poses.hpp"
#include "sdk/host/fusion/key_frames.hpp"

namespace odograph {

/// Keeps poses of the track for anchors and key frames. Not thread-safe.
class PoseKeeper : public KeptPoses {
 public:
  struct Parameters {
    double tilt_sigma_rad = 0.01;  ///< rad, of the inclination that front-ends and attitude sources maintain
    double near_sigma_rad = 5e-3;  ///< rad, and ...
    double near_sigma_m = 0.02;    ///< m, of the track to a kept pose that another can refer to; empirical
  };

  explicit PoseKeeper(FusionState& state) : state_of_track_(state) {}

  Attachment keep_pose(int64_t t_ns) override;
  std::vector<HandOver> take_hand_overs() override { return std::exchange(hand_overs_, {}); }
  void release_pose(uint64_t id) override;
  bool kept_pose(uint64_t id, KeptPose& out) const override;
  uint64_t map_frame(uint32_t source, uint64_t map) const override { return key_frames_.map_frame(source, map); }

  /// Keeps the pose at its time and writes it into the message.
  void on_key_frame(odo_key_frame& frame);
  template <class Each>
  void publish_moved_key_frames(Each&& each) {
    key_frames_.publish_moved(state_of_track_.filter, each);
  }

 protected:
  static double tilt_variance() { return squared(Parameters().tilt_sigma_rad); }
  /// Updates the filter by a recognised place. `kept`: states that it does not change, besides the scale;
  /// `takes_frame`: n becomes the frame of a map.
  UpdateResult use(const odo_relative_pose& loop, const TrackPoint& then, StateSet kept, bool takes_frame);
  UpdateResult use(const odo_map_pose& place, const TrackPoint& then, StateSet kept, bool takes_frame);

 private:
  KeyFrames::Context context(const TrackPoint& then, StateSet kept) const;

  Parameters keeper_;
  KeyFrames key_frames_;
  FusionState& state_of_track_;
  std::vector<HandOver> hand_overs_;  // not taken yet
};

}  // namespace odograph
