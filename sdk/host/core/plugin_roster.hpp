// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "sdk/host/config/pipeline_config.hpp"
#include "sdk/host/plugin_host/instance.hpp"

namespace odograph {

/// The plugins of a pipeline: their calling order, the messages that each receives, whose events are used, and what
/// each receives again after a reset. Not thread-safe, except camera().
class PluginRoster {
 public:
  using Plugins = std::vector<PluginInstance*>;
  using Emit = std::function<void(const AnyMessage&)>;

  /// `emit` is called for each event of a plugin. `host` outlives this object.
  PluginRoster(HostServices& host, Emit emit) : host_(host), emit_(std::move(emit)) {}
  /// Loads and starts the plugins of a config. Call once.
  Result<bool> start(const PipelineConfig& config);

  /// Passes a sample to the plugins that want it. The attitude plugin comes first: its output is a prior for the others
  /// on the same sample. `handled` is called after each. False if no plugin wants it.
  bool dispatch(const odo_header& message, const std::function<void()>& handled);
  /// Passes an event to the plugins that want it, except its sender, and except the scale sources if they have received
  /// it already.
  void forward_event(const odo_header& event, bool scale_sources_too = true);
  /// Passes a message to the plugins of one kind that want it.
  /// Passes an event to the plugin that it is from.
  void return_event(const odo_header& event);
  void forward_to_kind(const char* interface_id, const odo_header& message);
  /// Calls the plugins that requested it (odo.wake/1); `handled` after each.
  void wake(const std::function<void()>& handled);
  /// Returns to the state after activation, with the plugins' saved state.
  void reset();

  /// Stores the newest calibration of each camera and the newest noise of each IMU.
  void store_description(const odo_header& description);
  const std::vector<AnyMessage>& descriptions() const { return descriptions_; }
  /// The plugin was reset: sends the stored descriptions, which it has no more.
  void send_descriptions(PluginInstance& plugin);

  /// Whether a message belongs to the front-end's camera: the first with a calibration or a frame.
  bool is_main_camera(const odo_header& message);
  bool has_camera() const { return camera_ != kNoCamera; }
  /// Its header.source; 0 before there is one. [any]
  uint32_t camera() const { return has_camera() ? static_cast<uint32_t>(camera_) : 0; }

  /// Whether the event's sender is the first active plugin for this type, whose events are used.
  bool in_use(const odo_header& event) const;
  /// Whether any plugin wants messages of this type.
  bool wants(uint32_t type) const;
  /// Whether a plugin whose output the pose needs is restarting, or has failed without an active replacement. Fix
  /// plugins do not count.
  bool any_failed() const;
  uint64_t faults() const;
  /// How often the instance of this number has been reset.
  uint32_t resets(uint32_t number) const { return number - 1 < resets_.size() ? resets_[number - 1] : 0; }
  /// Height of the ground in n, m downwards, from the first plugin with a terrain model; nothing without one.
  std::optional<double> ground_at(double north_m, double east_m, double near_down_m) const;
  /// In the order of their numbers, from 1.
  const std::vector<std::unique_ptr<PluginInstance>>& plugins() const { return plugins_; }
  const Plugins& scale_sources() const { return scale_sources_; }
  bool has_attitude() const { return has_attitude_; }
  bool has_front_end() const { return has_front_end_; }
  /// The id of each plugin, with " #2" and so on for repetitions. The kind is left out, so that saved state survives a
  /// new version of the kind.
  std::vector<std::string> state_names() const;

 private:
  bool is_for(const PluginInstance& plugin, const odo_header& message) const;
  void deliver(PluginInstance& plugin, const odo_header& message);
  bool emits(uint32_t type) const;

  HostServices& host_;
  Emit emit_;
  std::vector<std::unique_ptr<PluginInstance>> plugins_;
  Plugins call_order_, scale_sources_;  // the same in calling order; the scale sources among them
  std::vector<uint32_t> resets_;        // by number
  bool has_attitude_ = false, has_front_end_ = false;
  std::vector<AnyMessage> descriptions_;
  static constexpr int64_t kNoCamera = -1;
  std::atomic<int64_t> camera_{kNoCamera};
};

}  // namespace odograph
