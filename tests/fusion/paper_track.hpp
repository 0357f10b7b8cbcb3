// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "tests/support/test_fusion.hpp"

namespace odograph {

/// A fusion by the papers' rules, with one call per input and output.
struct PaperTrack {
  TestFusion fusion;

  PaperTrack(const CouplingConfig& config, const StartPose& start, FusionInputs inputs)
      : fusion(config, start, inputs) {}
  void on_calibration(const odo_calibration& calibration) { fusion->on_calibration(calibration); }
  void on_imu(const odo_imu& imu) { fusion->on_imu(imu); }
  std::optional<odo_pose> on_attitude(const odo_attitude& attitude) {
    fusion.update(&attitude);
    return take_pose();
  }
  odo_pose on_first_frame(int64_t t_ns) {
    fusion.update(FrameTime{t_ns});
    return take_pose().value();
  }
  odo_pose on_vo_motion(odo_vo_motion motion, const odo_scale* scale) {
    fusion->prepare(motion);
    fusion.update(RelativeMotion{&motion, scale});
    return take_pose().value();
  }
  std::optional<odo_pose> on_step(const odo_step& step) {
    fusion.update(&step);
    return take_pose();
  }
  UpdateResult on_fix(const odo_fix& fix) { return fusion.update(&fix); }
  std::optional<odo_pose> take_pose() {
    odo_pose pose;
    return fusion.take_pose(pose) ? std::optional(pose) : std::nullopt;
  }
  std::optional<odo_pose> take_correction() {
    Correction correction;
    odo_pose pose;
    return fusion.take_correction(correction, pose) ? std::optional(pose) : std::nullopt;
  }
  int32_t pose_at(int64_t t_ns, odo_pose& out) const {
    Estimate then;
    const int32_t status = fusion.at(t_ns, then);
    out = then.pose;
    return status;
  }
  double distance_m() const { return fusion->distance_m(); }
};

}  // namespace odograph
