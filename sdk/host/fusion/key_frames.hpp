// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <odograph/types.h>

#include "sdk/host/fusion/kept_poses.hpp"
#include "sdk/host/fusion/pose_filter.hpp"

namespace odograph {

/// Key frames of map plugins, and updates by what is recognised: a loop relates two poses of the track, a map pose one
/// of them and the place of a map in n, which is a state of the filter (PoseFilter::keep_frame). Not thread-safe.
class KeyFrames {
 public:
  struct Parameters {
    size_t max = 1024;    ///< key frames of each instance, the newest ones; events.h
    size_t max_maps = 4;  ///< places of maps, those recognised last; events.h
    /// Consecutive rejections of a map, after which its place in n is taken to be as wrong as it seems, up to the
    /// largest rotation; as of fixes.
    int max_rejected = 5;
    double moved_m = 0.01;    ///< m, and ...
    double moved_rad = 2e-3;  ///< rad: a smaller change of a key frame is not published; judgement
    double largest_rotation_rad =
        0.5;  ///< rad: a heading error beyond it is not corrected by one linear update; judgement
  };
  struct Context {
    TrackPoint then, now;  ///< the track at the time of recognition, and its newest point
    double tilt_sigma_rad = 0;
    StateSet considered;  ///< states that are not changed
  };

  /// Writes the pose into the message.
  void add(odo_key_frame& message, const Attachment& body, const PoseFilter& filter);
  /// Calls each(message) with the key frames that have moved since they were published.
  template <class Each>
  void publish_moved(const PoseFilter& filter, Each&& each) {
    for (KeyFrame& frame : frames_)
      if (fill(frame, filter, p_.moved_m, p_.moved_rad)) each(frame.message);
  }
  void hand_over(const HandOver& hand_over);
  bool refer_to(uint64_t pose_id) const;
  /// The body at a key frame.
  std::optional<Attachment> find(uint32_t source, int64_t t_ns) const;

  /// The kept frame of a map; 0: it was not recognised yet.
  uint64_t map_frame(uint32_t source, uint64_t map) const;

  /// `from`: the body at the earlier time.
  UpdateResult use(PoseFilter& filter, const odo_relative_pose& loop, const Attachment& from, const Context& at) const;
  /// `takes_frame`: n is arbitrary, and becomes the frame of the map.
  UpdateResult use(PoseFilter& filter, const odo_map_pose& place, bool takes_frame, const Context& at);

 private:
  struct KeyFrame {
    odo_key_frame message;  ///< with the pose that was last published
    Attachment body;
  };
  struct Map {
    uint32_t source = 0;
    uint64_t map = 0, pose_id = 0;
    int64_t recognised_ns = 0;
    int rejected = 0;  ///< consecutive
  };

  /// Writes the present pose into the message if it differs from the one there by more than that.
  static bool fill(KeyFrame& frame, const PoseFilter& filter, double moved_m, double moved_rad);
  UpdateResult update(PoseFilter& filter, Innovation& seen, const Context& at) const;

  Parameters p_;
  std::vector<KeyFrame> frames_;  // in order of time for each source
  std::vector<Map> maps_;
};

}  // namespace odograph
