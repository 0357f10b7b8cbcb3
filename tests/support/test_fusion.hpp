// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <memory>

#include "sdk/host/fusion/paper_fusion.hpp"

namespace odograph {

/// A camera frame, whose motion follows later.
struct FrameTime {
  int64_t t_ns = 0;
};

/// A front-end's motion with its scale, or null.
struct RelativeMotion {
  const odo_vo_motion* motion = nullptr;
  const odo_scale* scale = nullptr;
};

/// A fusion whose outputs wait in queues.
class TestFusion {
 public:
  TestFusion(const CouplingConfig& config, const StartPose& start, FusionInputs inputs)
      : fusion_(make_fusion(config, start, inputs)) {}

  UpdateResult update(const FrameTime& frame) { return fusion_->on_frame(frame.t_ns, out_), collect(); }
  UpdateResult update(const RelativeMotion& m) { return fusion_->on_motion(*m.motion, m.scale, out_), collect(); }
  UpdateResult update(const odo_attitude* attitude) { return collect(fusion_->on_attitude(*attitude, out_)); }
  UpdateResult update(const odo_step* step) { return collect(fusion_->on_step(*step, out_)); }
  UpdateResult update(const odo_scale* scale) { return collect(fusion_->on_scale(*scale, out_)); }
  UpdateResult update(const odo_fix* fix) { return collect(fusion_->on_fix(*fix, out_)); }
  UpdateResult update(const odo_barometer* barometer) { return collect(fusion_->on_barometer(*barometer, out_)); }

  bool take_pose(odo_pose& pose) { return take(poses_, pose); }
  bool take_correction(Correction& correction) { return take(corrections_, correction); }
  bool take_correction(Correction& correction, odo_pose& pose) {
    return take(corrections_, correction) && (pose = correction.pose, true);
  }
  bool take_step_reference(odo_fix& reference) { return take(references_, reference); }
  Notice take_notice() {
    Notice notice;
    take(notices_, notice);
    return notice;
  }

  int32_t at(Instant t, Estimate& out) const { return fusion_->at(t, out); }
  const PoseFilter& filter() const { return fusion_->filter(); }
  Fusion* operator->() { return fusion_.get(); }
  const Fusion* operator->() const { return fusion_.get(); }

 private:
  template <class T>
  static bool take(std::deque<T>& from, T& out) {
    if (from.empty()) return false;
    out = from.front();
    from.pop_front();
    return true;
  }
  UpdateResult collect(UpdateResult result = {true, 0, 0}) {
    if (out_.correction) corrections_.push_back(*out_.correction);
    for (const odo_pose& pose : out_.poses) poses_.push_back(pose);
    if (out_.step_reference) references_.push_back(*out_.step_reference);
    for (const Notice& notice : out_.notices) notices_.push_back(notice);
    out_.clear();
    return result;
  }

  std::unique_ptr<Fusion> fusion_;
  Outputs out_;
  std::deque<odo_pose> poses_;
  std::deque<Correction> corrections_;
  std::deque<odo_fix> references_;
  std::deque<Notice> notices_;
};

}  // namespace odograph
