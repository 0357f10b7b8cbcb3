// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "sdk/host/estimator/displacement_reference.hpp"
#include "sdk/host/estimator/estimator.hpp"
#include "sdk/host/estimator/per_frame_coupling.hpp"

namespace odograph {

/// The papers' estimator behind the host's interface: each frame's displacement times that frame's scale (Antigny et
/// al. 2019, eq. (5) to (8)), corrected by gated fixes. Velocity is that of the last motion; biases are not estimated.
class PaperEstimator : public Estimator {
 public:
  PaperEstimator(const CouplingConfig& config, const StartPose& start, EstimatorInputs inputs);

  void on_calibration(const odo_calibration& calibration) override { coupling_.on_calibration(calibration); }
  void on_imu_noise(const odo_imu_noise&) override {}  // the papers' coupling has no noise model of the IMU
  void propagate(const odo_imu& imu) override { coupling_.on_imu(imu); }
  UpdateResult update(const Measurement& measurement) override;
  void prepare(odo_vo_motion& motion) const override { coupling_.prepare(motion); }
  int32_t at(int64_t t_ns, Estimate& out) const override;
  bool take_pose(odo_pose& pose) override;
  bool take_correction(Correction& correction, odo_pose& pose) override;
  bool take_step_reference(odo_fix& reference) override;
  double distance_m() const override { return coupling_.distance_m(); }
  uint64_t hold_pose(int64_t t_ns) override;
  void let_go(uint64_t id) override;
  bool held_pose(uint64_t id, HeldPose& out) const override;
  bool pose_now(HeldPose& out) const override;
  bool is_placed() const override { return fixed_m_ >= 0; }
  void reset() override;

 private:
  UpdateResult apply(const FrameTime& frame);
  UpdateResult apply(const odo_attitude* attitude);
  UpdateResult apply(const RelativeMotion& relative);
  UpdateResult apply(const odo_step* step);
  UpdateResult apply(const odo_fix* fix);
  /// Scales come with the motion they belong to; the papers use neither height nor mode.
  UpdateResult apply(const odo_scale*) { return {}; }
  UpdateResult apply(const odo_barometer*) { return {}; }
  UpdateResult apply(const odo_motion_mode*) { return {}; }

  /// A pose that is held moves by its share of each correction: the papers have no covariance over time.
  struct Held {
    uint64_t id;
    double path_m;
    HeldPose pose;
  };
  void correct_held(const Correction& correction, double fixed_m);

  EstimatorInputs inputs_;
  bool start_given_;
  PerFrameCoupling coupling_;
  std::vector<Held> held_;
  uint64_t last_held_ = 0;
  double fixed_m_, corrected_from_m_;  ///< of the path, where the position was known last, and before the newest fix
  DisplacementReference displacement_reference_{{.stretch_m = 20}};  // long beside a step: single frames are scaled
  std::optional<odo_pose> pose_;
  std::optional<odo_fix> reference_;
  bool camera_started_ = false, corrected_pending_ = false;
};

}  // namespace odograph
