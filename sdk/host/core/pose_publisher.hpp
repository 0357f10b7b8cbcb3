// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <mutex>
#include <optional>
#include <utility>

#include "sdk/host/checks/input_checks.hpp"
#include "sdk/host/core/anchors.hpp"
#include "sdk/host/core/north_reference.hpp"
#include "sdk/host/core/plugin_roster.hpp"
#include "sdk/host/core/pose_stream.hpp"
#include "sdk/host/core/scene.hpp"
#include "sdk/host/core/sensor_watch.hpp"
#include "sdk/host/fusion/fusion.hpp"

namespace odograph {

/// Publishes poses, corrections of earlier poses, and the tracking state to the listener, the pose stream and the
/// anchors. Not thread-safe.
class PosePublisher {
 public:
  struct Parameters {
    /// rad: with a smaller sigma, a heading counts as one against north; 20 degrees, half a street.
    double north_sigma_rad = 0.35;
  };

  /// Objects that it uses; they outlive it.
  struct Surroundings {
    const PluginRoster& roster;
    const SensorWatch& watch;
    const InputChecks& checks;
    const NorthReference& north;
    PoseStream& poses;        ///< receives every pose and state
    Anchors& anchors;         ///< updated with the estimate
    Scene& scene;             ///< the same
    std::mutex& world_mutex;  ///< held while a correction moves poses, anchors and scene
  };
  using Send = std::function<void(const odo_header&)>;

  /// `publish`: to the listener. `notify_plugins`: to the plugins that want poses and corrections.
  PosePublisher(const Surroundings& surroundings, Send publish, Send notify_plugins)
      : s_(surroundings), publish_(std::move(publish)), notify_plugins_(std::move(notify_plugins)) {}

  /// Publishes corrections and poses in time order: a correction and its corrected pose before newer poses. False if
  /// one is not finite: it is not published, nor is what follows.
  bool publish(Fusion& fusion, const Outputs& outputs);
  /// All sensors were silent (SensorWatch::pause): the pose is lost from then until the next one.
  void pause();
  /// Call after each message: detects silence and wrong input that no pose reports.
  void check_input();
  /// The clock was set back: the next pose is announced as a correction of the last one.
  void reset();

  /// Sensor time spent in a state, s.
  double state_s(uint32_t state) const { return state_s_[state]; }

 private:
  void publish_pose(Fusion& fusion, odo_pose pose, bool is_new);
  void publish_correction(Fusion& fusion, const Correction& correction);
  void publish_restart(Fusion& fusion, const odo_pose& pose);
  void announce(int64_t t_ns, const Rigid& correction, uint32_t reason);
  void add_to_stream(const Fusion& fusion, const odo_pose& pose);
  bool sensor_silent() const;
  void set_state(int64_t t_ns, uint32_t state, uint32_t reason);

  Surroundings s_;
  Send publish_, notify_plugins_;
  std::optional<odo_pose> before_restart_, last_;
  uint32_t state_ = 0, reason_ = ODO_REASON_INITIALISING;
  int64_t state_since_ns_ = 0;
  double state_s_[4] = {0, 0, 0, 0};  // index: ODO_TRACKING ...
};

}  // namespace odograph
