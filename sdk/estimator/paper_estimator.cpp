// SPDX-License-Identifier: Apache-2.0
#include "sdk/estimator/paper_estimator.hpp"

#include <utility>

namespace odograph {
namespace {

template <class T>
bool take(std::optional<T>& from, T& out) {
  if (!from) return false;
  out = *std::exchange(from, std::nullopt);
  return true;
}

Eigen::Quaterniond orientation(const odo_pose& pose) {
  return Eigen::Quaterniond(pose.q_n[0], pose.q_n[1], pose.q_n[2], pose.q_n[3]);
}

}  // namespace

PaperEstimator::PaperEstimator(const CouplingConfig& config, const StartPose& start, EstimatorInputs inputs)
    : inputs_(inputs), coupling_(config, start, inputs) {}

UpdateResult PaperEstimator::update(const Measurement& measurement) {
  return std::visit([this](const auto& what) { return apply(what); }, measurement);
}

UpdateResult PaperEstimator::apply(const FrameTime& frame) {
  if (!inputs_.vo || std::exchange(camera_started_, true)) return {};
  pose_ = coupling_.on_first_frame(frame.t_ns);
  return {true, 0.0, 0};
}

UpdateResult PaperEstimator::apply(const odo_attitude* attitude) {
  coupling_.on_attitude(*attitude);
  if (const auto first = coupling_.start_without_camera()) pose_ = *first;
  return {true, 0.0, 0};
}

UpdateResult PaperEstimator::apply(const RelativeMotion& relative) {
  pose_ = coupling_.on_vo_motion(*relative.motion, relative.scale);
  const bool metric_without_steps = inputs_.scale
                                        ? relative.scale && (relative.scale->header.flags & ODO_SCALE_NOT_BY_STEPS) != 0
                                        : (relative.motion->header.flags & ODO_VO_METRIC) != 0;
  if (const auto reference = teacher_.see(*pose_, metric_without_steps)) reference_ = *reference;
  return {relative.motion->state != ODO_LOST, 0.0, 0};
}

UpdateResult PaperEstimator::apply(const odo_step* step) {
  if (const auto pose = coupling_.on_step(*step)) pose_ = *pose;
  return {true, 0.0, 0};
}

UpdateResult PaperEstimator::apply(const odo_fix* fix) {
  const UpdateResult result = coupling_.on_fix(*fix);
  if (result.accepted) teacher_.fixed(fix->header.t_ns);
  return result;
}

int32_t PaperEstimator::at(int64_t t_ns, Estimate& out) const {
  const int32_t status = coupling_.pose_at(t_ns, out.pose);
  if (status != ODO_OK) return status;
  const bool camera = (out.pose.header.flags & ODO_POSE_CAMERA) != 0;
  out.q_n_b = camera ? orientation(out.pose) * coupling_.q_b_c().conjugate() : orientation(out.pose);
  out.p_n_b = Eigen::Vector3d(out.pose.p_n);  // the papers have no lever arm
  out.v_n_b = Eigen::Vector3d(out.pose.velocity_n);
  out.velocity_is_mean = true;
  return ODO_OK;
}

bool PaperEstimator::take_pose(odo_pose& pose) { return take(pose_, pose); }

bool PaperEstimator::take_correction(Correction& correction, odo_pose& pose) {
  odo_pose before{};
  if (const auto caught_up = coupling_.take_caught_up(); caught_up && pose_) {
    pose = *pose_;
    correction = {pose.header.t_ns, Eigen::Quaterniond::Identity(), *caught_up, kCorrectionScale};
    return true;
  }
  if (coupling_.pose_at(coupling_.last_pose_ns(), before) != ODO_OK) return false;
  const auto after = coupling_.take_correction();
  if (!after) return false;
  pose = *after;
  correction.t_ns = after->header.t_ns;
  correction.q = (orientation(*after) * orientation(before).conjugate()).normalized();
  correction.p = Eigen::Vector3d(after->p_n) - correction.q * Eigen::Vector3d(before.p_n);
  correction.reason = kCorrectionFix;
  return true;
}

bool PaperEstimator::take_step_reference(odo_fix& reference) { return take(reference_, reference); }

void PaperEstimator::reset() {
  coupling_.reset();
  teacher_.reset();
  pose_.reset();
  reference_.reset();
  camera_started_ = false;
}

}  // namespace odograph
