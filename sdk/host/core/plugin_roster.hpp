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

/// The plugins of a pipeline: in which order they are given a message, which of them it is for, whose events are used,
/// and what each is given again after a reset. One thread at a time, but for camera().
class PluginRoster {
 public:
  using Plugins = std::vector<PluginInstance*>;
  using Emit = std::function<void(const AnyMessage&)>;

  /// `emit` is called for each event that a plugin answers with. `host` outlives it.
  PluginRoster(HostServices& host, Emit emit) : host_(host), emit_(std::move(emit)) {}
  /// Loads and starts the plugins of a config, once.
  Result<bool> start(const PipelineConfig& config);

  /// Hands a sample to the plugins that want it, the attitude first: it is a prior of what the others make of the same
  /// sample. `handled` is called after each. False where no plugin wants it.
  bool ask(const odo_header& message, const std::function<void()>& handled);
  /// Hands an event to the plugins that want it, but not to the one that it came from, nor to the scale sources where
  /// they have had it.
  void tell(const odo_header& event, bool scale_sources_too = true);
  /// Hands a message to the plugins of one kind that want it.
  void tell_kind(const char* interface_id, const odo_header& message);
  /// Calls the plugins that have asked for it (odo.wake/1); `handled` after each.
  void wake(const std::function<void()>& handled);
  /// Back to the state after activation, with what the plugins have learnt.
  void reset();

  /// Keeps the newest calibration of each camera and the newest noise of each IMU.
  void remember(const odo_header& description);
  const std::vector<AnyMessage>& descriptions() const { return descriptions_; }
  /// After a reset a plugin knows of no camera any more.
  void describe_sensors_to(PluginInstance& plugin);

  /// Whether a message is of the front-end's camera: the first that has a calibration or a frame.
  bool is_main_camera(const odo_header& message);
  bool has_camera() const { return camera_ != kNoCamera; }
  /// header.source of it; 0 before there is one. [any]
  uint32_t camera() const { return has_camera() ? static_cast<uint32_t>(camera_) : 0; }

  /// Whether an event is of the plugin whose events of this type are used: the first that is alive.
  bool in_use(const odo_header& event) const;
  /// Whether any wants messages of this type.
  bool wants(uint32_t type) const;
  /// A fixer's end, and that of a plugin whose place another one takes, costs no state.
  bool any_dead() const;
  uint64_t faults() const;
  /// Height of the ground downwards in n, m, by the first plugin with a terrain model; nothing without one.
  std::optional<double> ground_at(double north_m, double east_m, double near_down_m) const;
  /// In the order of their numbers, from 1.
  const std::vector<std::unique_ptr<PluginInstance>>& plugins() const { return plugins_; }
  const Plugins& scale_sources() const { return scale_sources_; }
  bool has_attitude() const { return has_attitude_; }
  bool has_front_end() const { return has_front_end_; }
  /// Of each plugin its id, and where that has been before " #2" and so on behind it. Not its kind: the next version of
  /// a kind is to keep what was estimated.
  std::vector<std::string> state_names() const;

 private:
  bool is_for(const PluginInstance& plugin, const odo_header& message) const;
  void take(PluginInstance& plugin, const odo_header& message);
  bool gives(uint32_t type) const;

  HostServices& host_;
  Emit emit_;
  std::vector<std::unique_ptr<PluginInstance>> plugins_;
  Plugins asked_, scale_sources_;  // the same in the order in which they are asked; the scale sources of them
  bool has_attitude_ = false, has_front_end_ = false;
  std::vector<AnyMessage> descriptions_;
  static constexpr int64_t kNoCamera = -1;
  std::atomic<int64_t> camera_{kNoCamera};
};

}  // namespace odograph
