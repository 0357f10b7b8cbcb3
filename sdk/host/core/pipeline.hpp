// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <set>
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
#include "sdk/host/core/scale_group_numbers.hpp"
#include "sdk/host/core/scale_join.hpp"
#include "sdk/host/core/sensor_watch.hpp"
#include "sdk/host/core/source_watch.hpp"
#include "sdk/host/core/surface_updates.hpp"
#include "sdk/host/fusion/paper_fusion.hpp"
#include "sdk/host/messages/imu_joiner.hpp"

namespace odograph {

/// Sensors -> plugins -> fusion -> pose. Takes messages in time order and publishes every event. Each sample goes to
/// the plugins that want it, one after the other; the events that a plugin emits are copied into a queue and handled in
/// order before the next plugin is called. Not thread-safe. The output depends only on the messages, the config and the
/// seed.
///
/// Several plugins may provide attitudes, steps, modes and motions: those of the first active plugin in the config's
/// order are used, the others' are only published. Scales of several sources are combined (see ScaleJoin); all fixes
/// are used.
class Pipeline {
 public:
  using Publish = std::function<void(const odo_header&)>;

  struct Parameters {
    size_t events_per_sample = 512;  ///< twice what one call of a plugin may emit; a walk gives fewer than ten
  };

  struct Counters {
    uint64_t frames = 0, steps = 0, fixes_accepted = 0, fixes_rejected = 0, events_dropped = 0, unknown = 0;
  };

  /// Objects that a pipeline uses; they outlive it.
  struct Surroundings {
    HostServices& host;
    InputChecks& checks;
    Geodesy& geodesy;
    PoseStream& poses;        ///< receives every pose, attitude and state
    Anchors& anchors;         ///< updated with the estimate
    Scene& scene;             ///< the same
    std::mutex& world_mutex;  ///< held while a correction moves poses, anchors and scene
  };

  /// Loads and starts the plugins. `publish` is called for every event, from within process().
  static Result<std::unique_ptr<Pipeline>> make(const PipelineConfig& config, const Surroundings& surroundings,
                                                Publish publish);

  void process(const odo_header& message);
  /// Calls the plugins that requested it (odo.wake/1), as process() does before each message.
  void wake();
  /// Restarts after the sensor clock was set back. Geodetic origin, counters and calibrations are retained.
  void reset();

  /// State that the plugins and anchors save, as a blob of this host (docs/embed.md).
  std::vector<uint8_t> save() const { return save_state(roster_, anchors_); }
  /// Passes each plugin its saved state and skips that of other plugins. Changes nothing if the blob is damaged.
  Result<bool> load(std::span<const uint8_t> blob) { return load_state(blob, roster_, anchors_); }
  /// Maps of places, with anchors; empty if there are none. [control]
  std::vector<uint8_t> save_maps() const { return odograph::save_maps(roster_, anchors_, *fusion_); }
  Result<bool> load_maps(std::span<const uint8_t> blob) { return odograph::load_maps(blob, roster_, anchors_); }

  /// header.source of the front-end's camera; 0 before the first camera. [any]
  uint32_t camera() const { return roster_.camera(); }
  const Counters& counters() const { return counters_; }
  double state_s(uint32_t state) const { return publisher_.state_s(state); }
  uint64_t plugin_faults() const { return roster_.faults(); }
  uint64_t gaps() const { return watch_.gaps(); }
  double distance_m() const { return fusion_->distance_m(); }
  ScaleKnowledge scale_knowledge() const { return fusion_->scale_knowledge(); }

 private:
  Pipeline(const PipelineConfig& config, const Surroundings& surroundings, Publish publish);

  void on_pause();
  void on_imu(const odo_imu& imu);
  bool is_of_main_camera(const odo_vo_motion& motion);
  void dispatch(const odo_header& message);
  void enqueue(const AnyMessage& event);
  void handle_events();
  void handle(AnyMessage& event);
  void on_attitude(odo_attitude& attitude, bool used);
  void on_step(const odo_step& step, bool used);
  void on_points(odo_points& points, bool used);
  void on_surface(odo_surface& surface, bool used);
  uint32_t group_of(const odo_header& event, uint32_t group);
  void on_vo_motion(odo_vo_motion& motion);
  void on_fix(odo_fix& fix);
  void on_place(auto& place);
  void publish_and_forward(const odo_header& event);
  void publish();
  void on_scale(odo_scale& scale);
  void publish_scale(odo_scale& scale, ScaleUse use);
  const odo_scale* scale_for(const odo_vo_motion& motion);

  PluginRoster roster_;
  bool wants_poses_ = false, wants_corrections_ = false;  // some plugin wants them
  const CouplingConfig coupling_;
  const StartPose start_;
  const FusionInputs inputs_;
  std::unique_ptr<Fusion> fusion_;
  Outputs outputs_;            // of the fusion, not yet published
  bool places_moved_ = false;  // key frames, since they were published
  bool broken_ = false;        // a pose was not finite
  HostServices& host_;
  InputChecks& checks_;
  std::set<uint32_t> unused_;  // types of input that no plugin uses, reported
  Geodesy& geodesy_;
  PoseStream& poses_;
  Anchors& anchors_;
  Scene& scene_;
  SurfaceUpdates surfaces_;
  EventQueue events_;
  ImuJoiner joiner_;
  SensorWatch watch_;
  Publish publish_;
  Counters counters_;
  ScaleGroupNumbers groups_;
  SourceWatch sources_;
  ScaleJoin scale_join_;
  NorthReference north_;
  PosePublisher publisher_;
};

}  // namespace odograph
