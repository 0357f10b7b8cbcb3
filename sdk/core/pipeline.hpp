// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "sdk/core/imu_joiner.hpp"
#include "sdk/config/pipeline_config.hpp"
#include "sdk/core/geodesy.hpp"
#include "sdk/core/sensor_watch.hpp"
#include "sdk/estimator/estimator.hpp"
#include "sdk/plugin_host/instance.hpp"

namespace odograph {

/// Sensors -> plugins -> coupling -> pose. Takes messages in order of time and publishes every event. One thread at a
/// time; output depends on the messages, the config and the seed alone.
class Pipeline {
 public:
  using Publish = std::function<void(const odo_header&)>;

  struct Counters {
    uint64_t frames = 0, steps = 0, fixes_accepted = 0, fixes_rejected = 0;
    double state_s[4] = {0, 0, 0, 0};  // by ODO_TRACKING ...
  };

  /// Loads and starts the plugins. `publish` is called for every event, within process.
  static Result<std::unique_ptr<Pipeline>> make(const PipelineConfig& config, HostServices& host, Geodesy& geodesy,
                                                Publish publish);

  void process(const odo_header& message);
  /// Estimator::at. [any]
  int32_t pose_at(int64_t t_ns, odo_pose& out) const;
  /// Starts anew, for a sensor clock that was set back. Geodetic origin and counters stay.
  void reset();

  /// What the plugins have learnt and want to keep, as a blob of this host's (docs/embed.md).
  std::vector<uint8_t> save() const;
  /// Gives each plugin what it saved; other plugins' parts are passed over. A failure says what is wrong; nothing is
  /// changed where the blob itself is damaged.
  Result<bool> load(std::span<const uint8_t> blob);

  const Counters& counters() const { return counters_; }
  uint64_t plugin_faults() const;
  uint64_t gaps() const { return watch_.gaps(); }
  double distance_m() const { return estimator_->distance_m(); }

 private:
  Pipeline(const PipelineConfig& config, Geodesy& geodesy, Publish publish);

  void on_imu(const odo_imu& imu);
  void on_steps(std::span<AnyMessage> events);
  void on_frame(const odo_frame& frame);
  void on_vo_events(std::span<AnyMessage> events);
  void on_vo_motion(odo_vo_motion& motion);
  void on_fixes(std::span<AnyMessage> events);
  void offer_to_fixers(const odo_header& message);
  void publish_pose();
  void publish_correction();
  void teach_steps();
  void set_state(int64_t t_ns, uint32_t state, uint32_t reason);
  bool any_dead() const;
  std::vector<PluginInstance*> instances() const;

  std::unique_ptr<PluginInstance> attitude_, step_, vo_, scale_;
  std::vector<std::unique_ptr<PluginInstance>> fixers_;
  std::unique_ptr<Estimator> estimator_;
  Geodesy& geodesy_;
  ImuJoiner joiner_;
  SensorWatch watch_;
  Publish publish_;
  Counters counters_;
  uint32_t state_ = 0;
  uint32_t reason_ = ODO_REASON_INITIALISING;
  int64_t state_since_ns_ = 0;
};

}  // namespace odograph
