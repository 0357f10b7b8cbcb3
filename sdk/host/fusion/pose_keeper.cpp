// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/fusion/pose_keeper.hpp"

namespace odograph {

Attachment PoseKeeper::keep_pose(int64_t t_ns) {
  if (!state_of_track_.started() || t_ns > state_of_track_.track.newest().t_ns) return {};
  const auto then = state_of_track_.track.stored(t_ns);
  if (!then) return {};
  Attachment near = state_of_track_.filter.nearest_kept(*then, state_of_track_.track.newest(), keeper_.near_sigma_m,
                                                        keeper_.near_sigma_rad);
  if (near.pose_id != 0) return near;
  if (const auto hand_over = state_of_track_.filter.crowded()) {
    key_frames_.hand_over(*hand_over);
    hand_overs_.push_back(*hand_over);
    state_of_track_.filter.release_pose(hand_over->from);
  }
  near.pose_id = state_of_track_.filter.keep_pose(*then, state_of_track_.track.newest());
  return near;
}

void PoseKeeper::release_pose(uint64_t id) {
  if (!key_frames_.refer_to(id)) state_of_track_.filter.release_pose(id);
}

bool PoseKeeper::kept_pose(uint64_t id, KeptPose& out) const {
  return state_of_track_.filter.kept_pose(id, tilt_variance(), out);
}

void PoseKeeper::on_key_frame(odo_key_frame& frame) {
  const Attachment body = keep_pose(frame.header.t_ns);
  if (body.pose_id != 0) key_frames_.add(frame, body, state_of_track_.filter);
}

/// The scale is considered: a place is in metres of the front-end itself, or of the session that made the map.
KeyFrames::Context PoseKeeper::context(const TrackPoint& then, StateSet kept) const {
  return {then, state_of_track_.track.newest(), keeper_.tilt_sigma_rad, kept | only({kLogScale})};
}

UpdateResult PoseKeeper::use(const odo_relative_pose& loop, const TrackPoint& then, StateSet kept, bool) {
  constexpr uint32_t kBoth = ODO_RELATIVE_POSE_TRANSLATION | ODO_RELATIVE_POSE_ROTATION;
  if ((loop.header.flags & kBoth) != kBoth) return {};
  auto from = key_frames_.find(loop.header.source, loop.t_from_ns);
  if (!from) from = keep_pose(loop.t_from_ns);
  return key_frames_.use(state_of_track_.filter, loop, *from, context(then, kept));
}

UpdateResult PoseKeeper::use(const odo_map_pose& place, const TrackPoint& then, StateSet kept, bool takes_frame) {
  return key_frames_.use(state_of_track_.filter, place, takes_frame, context(then, kept));
}

}  // namespace odograph
