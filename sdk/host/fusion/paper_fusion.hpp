// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "sdk/host/fusion/fusion.hpp"

namespace odograph {

/// Motions by the papers' rules: each frame's displacement is multiplied by that frame's scale (Antigny et al. 2019,
/// eq. (5) to (7)), and the front-end's rotation is used as it is.
class PaperOdometry : public Odometry {
 public:
  using Odometry::apply;
  using Odometry::Odometry;
  UpdateResult apply(const odo_scale&) override { return {}; }

 protected:
  void begin_scale() override {}
  void select(Motion& motion) const override;
  void level(Motion& motion) const override;
  double heading_variance(const Motion& motion) const override;
  bool to_metres(Motion& motion, const odo_scale* scale) override;
};

/// `coupling: paper`: a scale for each motion, whole steps while the camera does not move, and fixes that move the
/// position, not the path.
class PaperFusion : public Fusion {
 public:
  PaperFusion(const CouplingConfig& config, const StartPose& start, FusionInputs inputs);
  UpdateResult on_barometer(const odo_barometer&, Outputs&) override { return {}; }

 protected:
  void move_by(const odo_step& step, Outputs& out) override;
  void settle_steps(int64_t, Outputs&) override {}
  void count(const Odometry::Motion& motion) override { distance_m_ += motion.caught_up_m + motion.d_o.norm(); }
  void count(const odo_pose&) override {}
  bool has_position() const override { return true; }
  /// Without a scale source, the track is published up to scale.
  bool is_metric() const override { return shown_ && (!inputs_.vo || odometry_->metric() || inputs_.scale); }
  bool has_scale() const override { return Fusion::has_scale() || (inputs_.scale && shown_); }
};

/// The fusion of a config's coupling.
inline std::unique_ptr<Fusion> make_fusion(const CouplingConfig& config, const StartPose& start, FusionInputs inputs) {
  if (config.type == CouplingType::paper) return std::make_unique<PaperFusion>(config, start, inputs);
  return std::make_unique<Fusion>(config, start, inputs);
}

}  // namespace odograph
