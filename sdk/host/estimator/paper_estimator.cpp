// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/base/rotation.hpp"
#include "sdk/host/estimator/paper_estimator.hpp"

#include <algorithm>
#include <utility>

namespace odograph {
namespace {

constexpr double kScaleSigma = 0.01;  // relative, of a scale without steps: 0.8 % in nine walks (docs/accuracy.md)

template <class T>
bool take(std::optional<T>& from, T& out) {
  if (!from) return false;
  out = *std::exchange(from, std::nullopt);
  return true;
}

Eigen::Matrix<double, 6, 6> covariance_of(const odo_pose& pose) {
  return Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(pose.covariance);
}

}  // namespace

PaperEstimator::PaperEstimator(const CouplingConfig& config, const StartPose& start, EstimatorInputs inputs)
    : inputs_(inputs),
      start_given_(start.given),
      coupling_(config, start, inputs),
      fixed_m_(start.given ? 0 : -1),
      corrected_from_m_(fixed_m_) {}

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
  if (const auto reference = displacement_reference_.see(*pose_, metric_without_steps ? kScaleSigma : 0))
    reference_ = *reference;
  return {relative.motion->state != ODO_LOST, 0.0, 0};
}

UpdateResult PaperEstimator::apply(const odo_step* step) {
  if (const auto pose = coupling_.on_step(*step)) pose_ = *pose;
  return {true, 0.0, 0};
}

UpdateResult PaperEstimator::apply(const odo_fix* fix) {
  const UpdateResult result = coupling_.on_fix(*fix);
  if (!result.accepted) return result;
  displacement_reference_.fixed(fix->header.t_ns);
  if (!corrected_pending_) corrected_from_m_ = fixed_m_;
  corrected_pending_ = true;
  constexpr uint32_t kHorizontal = ODO_FIX_NORTH | ODO_FIX_EAST;
  if ((fix->header.flags & kHorizontal) == kHorizontal) fixed_m_ = coupling_.distance_m();
  return result;
}

int32_t PaperEstimator::at(int64_t t_ns, Estimate& out) const {
  const int32_t status = coupling_.pose_at(t_ns, out.pose);
  if (status != ODO_OK) return status;
  const bool camera = (out.pose.header.flags & ODO_POSE_CAMERA) != 0;
  out.q_n_b = camera ? raw_quaternion(out.pose.q_n) * coupling_.q_b_c().conjugate() : raw_quaternion(out.pose.q_n);
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
    correct_held(correction, fixed_m_);
    return true;
  }
  if (coupling_.pose_at(coupling_.last_pose_ns(), before) != ODO_OK) return false;
  const auto after = coupling_.take_correction();
  if (!after) return false;
  pose = *after;
  correction.t_ns = after->header.t_ns;
  correction.q = (raw_quaternion(after->q_n) * raw_quaternion(before.q_n).conjugate()).normalized();
  correction.p = Eigen::Vector3d(after->p_n) - correction.q * Eigen::Vector3d(before.p_n);
  correction.reason = kCorrectionFix;
  correct_held(correction, std::exchange(corrected_pending_, false) ? corrected_from_m_ : fixed_m_);
  return true;
}

bool PaperEstimator::take_step_reference(odo_fix& reference) { return take(reference_, reference); }

void PaperEstimator::reset() {
  coupling_.reset();
  displacement_reference_.reset();
  pose_.reset();
  reference_.reset();
  camera_started_ = corrected_pending_ = false;
  held_.clear();
  fixed_m_ = start_given_ ? 0 : -1;
}

uint64_t PaperEstimator::hold_pose(int64_t t_ns) {
  Estimate then;
  if (t_ns > coupling_.last_pose_ns() || at(t_ns, then) != ODO_OK) return 0;
  held_.push_back({++last_held_, coupling_.distance_m(), {}});
  held_.back().pose.q_n_b = then.q_n_b;
  held_.back().pose.p_n_b = then.p_n_b;
  held_.back().pose.own = covariance_of(then.pose);
  return last_held_;
}

void PaperEstimator::let_go(uint64_t id) {
  std::erase_if(held_, [id](const Held& held) { return held.id == id; });
}

bool PaperEstimator::held_pose(uint64_t id, HeldPose& out) const {
  const auto found = std::find_if(held_.begin(), held_.end(), [id](const Held& held) { return held.id == id; });
  if (found == held_.end() || !pose_now(out)) return false;
  out.q_n_b = found->pose.q_n_b, out.p_n_b = found->pose.p_n_b;
  out.own = found->pose.own;
  out.cross.setZero();  // what it has in common with now is not followed
  return true;
}

bool PaperEstimator::pose_now(HeldPose& out) const {
  Estimate now;
  if (at(coupling_.last_pose_ns(), now) != ODO_OK) return false;
  out.q_n_b = now.q_n_b, out.p_n_b = now.p_n_b;
  out.own = out.now = out.cross = covariance_of(now.pose);
  return true;
}

/// What is held is turned by its share about where it is, and moved by its share of what the newest pose was moved by.
void PaperEstimator::correct_held(const Correction& correction, double fixed_m) {
  odo_pose now{};
  if (held_.empty() || coupling_.pose_at(coupling_.last_pose_ns(), now) != ODO_OK) return;
  const Eigen::Vector3d after(now.p_n), moved = after - correction.q.conjugate() * (after - correction.p);
  for (Held& held : held_) {
    const double share = share_of_correction(held.path_m, fixed_m, coupling_.distance_m());
    const Eigen::Quaterniond q = Eigen::Quaterniond::Identity().slerp(share, correction.q);
    held.pose.p_n_b = share < 1 ? Eigen::Vector3d(held.pose.p_n_b + share * moved)
                                : Eigen::Vector3d(correction.q * held.pose.p_n_b + correction.p);
    held.pose.q_n_b = (q * held.pose.q_n_b).normalized();
    held.pose.own = (1 - share) * (1 - share) * held.pose.own + share * share * covariance_of(now);
  }
}

}  // namespace odograph
