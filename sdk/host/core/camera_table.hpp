// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <mutex>
#include <optional>
#include <string>

#include <Eigen/Geometry>

#include <odograph/samples.h>

namespace odograph {

/// Picture size, clock offset and mount of each camera, by header.source. [any]
class CameraTable {
 public:
  /// Pose of the camera in b.
  struct Mount {
    Eigen::Quaterniond q_b_c = Eigen::Quaterniond::Identity();
    Eigen::Vector3d p_b_c = Eigen::Vector3d::Zero();
  };

  /// `configured`: the config's calibration, which replaces pushed values (mount, time offset and line time only if the
  /// config states them).
  explicit CameraTable(const std::optional<odo_calibration>& configured) : configured_(configured) {}

  /// Stores a calibration and converts it for the plugins: removes the time offset, which complete() applies.
  void take_calibration(odo_calibration& calibration);
  /// Converts a frame's time to the IMU clock, and gives it the calibration's line time if it has none. Describes a
  /// mismatch between the frame's size and the calibrated size; empty if they match or the frame has its own
  /// intrinsics.
  std::string complete(odo_frame& frame) const;
  /// Nothing while it is unknown.
  std::optional<Mount> mount(uint32_t source) const;
  /// The newest calibration; nothing while there is none.
  std::optional<odo_calibration> calibration(uint32_t source) const;

 private:
  struct Camera {
    odo_calibration calibration{};
    bool config_line_time = false;  // the config's line time replaces the frames'
    std::optional<Mount> mount;
  };

  std::optional<Camera> find(uint32_t source) const;
  static std::string size_fault(const Camera& camera, const odo_frame& frame);

  const std::optional<odo_calibration> configured_;
  mutable std::mutex mutex_;
  std::map<uint32_t, Camera> cameras_;
};

}  // namespace odograph
