// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <mutex>
#include <optional>
#include <string>

#include <Eigen/Geometry>

#include <odograph/samples.h>

namespace odograph {

/// What is known of each camera, by header.source: the size of its pictures, its clock and its mount. [any]
class CameraTable {
 public:
  /// The camera in b.
  struct Mount {
    Eigen::Quaterniond q_b_c = Eigen::Quaterniond::Identity();
    Eigen::Vector3d p_b_c = Eigen::Vector3d::Zero();
  };

  /// `configured`: the config's calibration, whose values replace those that are pushed (mount, time offset and row
  /// time only where it has them).
  explicit CameraTable(const std::optional<odo_calibration>& configured) : configured_(configured) {}

  /// Notes a calibration and brings it to what plugins are given: the time offset, which put_timing applies, is taken
  /// out.
  void take_calibration(odo_calibration& calibration);
  /// Brings a frame onto the IMU's clock. One without a row time gets the calibration's.
  void put_timing(odo_frame& frame) const;
  /// A lens is known for one size of picture, unless the frame brings its own intrinsics. Empty where the size is
  /// right.
  std::string size_fault(const odo_frame& frame) const;
  Mount mount(uint32_t source) const;

 private:
  struct Camera {
    odo_calibration calibration{};
    bool config_line_time = false;  // the config's row time replaces the frames'
    Mount mount;
  };

  std::optional<Camera> find(uint32_t source) const;

  const std::optional<odo_calibration> configured_;
  mutable std::mutex mutex_;
  std::map<uint32_t, Camera> cameras_;
};

}  // namespace odograph
