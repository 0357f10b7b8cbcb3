// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "sdk/host/base/geodesy.hpp"
#include "sdk/host/config/pipeline_config.hpp"
#include "sdk/host/core/anchors.hpp"
#include "sdk/host/core/event_queue.hpp"
#include "sdk/host/core/north_reference.hpp"
#include "sdk/host/core/plugin_roster.hpp"
#include "sdk/host/core/pose_publisher.hpp"
#include "sdk/host/core/pose_stream.hpp"
#include "sdk/host/core/saved_state.hpp"
#include "sdk/host/core/scale_join.hpp"
#include "sdk/host/core/sensor_watch.hpp"
#include "sdk/host/localizer/composer.hpp"
#include "sdk/host/messages/imu_joiner.hpp"

namespace odograph {

/// Sensors -> plugins -> localizer -> pose. Takes messages in order of time and publishes every event. A sample goes to
/// the plugins that want it, one after the other; what each of them answers is copied into one queue and handled, first
/// in, first out, before the next one is asked. One thread at a time; output depends on the messages, the config and
/// the seed alone.
///
/// Of attitudes, steps, modes and motions several plugins may give: those of the first that is alive, in the config's
/// order, are used, the others' are published alone. Scales of several sources are joined (see ScaleJoin), all fixes
/// used.
class Pipeline {
 public:
  using Publish = std::function<void(const odo_header&)>;

  struct Parameters {
    size_t events_per_sample = 512;  ///< twice what one call of a plugin may emit; a walk gives fewer than ten
    /// From n's origin: beyond, n's vertical is off by more than 0.9 degrees (100 km / 6371 km) and its plane 785 m
    /// above the ground, so that a position there is a wrong origin or a wrong fix.
    double farthest_fix_m = 100e3;
  };

  struct Counters {
    uint64_t frames = 0, steps = 0, fixes_accepted = 0, fixes_rejected = 0, events_dropped = 0, unknown = 0;
  };

  /// What a pipeline works with; outlives it.
  struct Surroundings {
    HostServices& host;
    Geodesy& geodesy;
    PoseStream& poses;        ///< gets every pose, attitude and state
    Anchors& anchors;         ///< follow the estimate
    std::mutex& world_mutex;  ///< held while a correction moves poses and anchors
  };

  /// Loads and starts the plugins. `publish` is called for every event, within process.
  static Result<std::unique_ptr<Pipeline>> make(const PipelineConfig& config, const Surroundings& surroundings,
                                                Publish publish);

  void process(const odo_header& message);
  /// Calls the plugins that have asked for it (odo.wake/1), as process does before each message.
  void wake();
  /// Starts anew, for a sensor clock that was set back. Geodetic origin, counters and calibrations stay.
  void reset();

  /// What the plugins have learnt and want to keep, as a blob of this host's (docs/embed.md).
  std::vector<uint8_t> save() const { return save_state(roster_, anchors_); }
  /// Gives each plugin what it saved; other plugins' parts are passed over. A failure says what is wrong; nothing is
  /// changed where the blob itself is damaged.
  Result<bool> load(std::span<const uint8_t> blob) { return load_state(blob, roster_, anchors_); }

  /// header.source of the front-end's camera; 0 before there is one. [any]
  uint32_t camera() const { return roster_.camera(); }
  const Counters& counters() const { return counters_; }
  double state_s(uint32_t state) const { return publisher_.state_s(state); }
  uint64_t plugin_faults() const { return roster_.faults(); }
  uint64_t gaps() const { return watch_.gaps(); }
  double distance_m() const { return composer_.distance_m(); }
  ScaleKnowledge scale_knowledge() const { return composer_.scale_knowledge(); }

 private:
  Pipeline(const PipelineConfig& config, const Surroundings& surroundings, Publish publish);

  void on_pause();
  void on_imu(const odo_imu& imu);
  bool is_of_main_camera(const odo_vo_motion& motion);
  void ask(const odo_header& message);
  void enqueue(const AnyMessage& event);
  void handle_events();
  void handle(AnyMessage& event);
  void on_attitude(const odo_attitude& attitude);
  void on_vo_motion(odo_vo_motion& motion);
  void on_fix(odo_fix& fix);
  bool is_beyond_frame(const odo_fix& fix);
  void tell_notice();
  void on_scale(odo_scale& scale);
  void publish_scale(odo_scale& scale, bool accepted);
  const odo_scale* scale_for(const odo_vo_motion& motion);

  PluginRoster roster_;
  bool gives_poses_to_ = false, gives_corrections_to_ = false;  // some plugin wants them
  Composer composer_;
  HostServices& host_;
  Geodesy& geodesy_;
  PoseStream& poses_;
  Anchors& anchors_;
  EventQueue events_;
  ImuJoiner joiner_;
  SensorWatch watch_;
  Publish publish_;
  Counters counters_;
  ScaleJoin scale_join_;
  double odometry_covariance_ = 1;  ///< factor on what a front-end says
  const bool steps_alone_need_heading_;
  NorthReference north_;
  PosePublisher publisher_;
};

}  // namespace odograph
