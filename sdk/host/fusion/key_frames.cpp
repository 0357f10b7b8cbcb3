// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/fusion/key_frames.hpp"

#include <algorithm>
#include <cmath>

#include "sdk/math/rotation.hpp"

namespace odograph {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix4d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr int kYaw = 0;  // row of an innovation; position follows
constexpr double kUninformedVariance = 1e12;

double yaw_of(const Quaterniond& q) { return std::remainder(2 * std::atan2(q.z(), q.w()), 2 * EIGEN_PI); }

/// A pose of the body in the axes of a kept pose, with the covariance of its (rotation, position).
struct Seen {
  Rigid T_kept_b;
  Eigen::Matrix<double, 6, 6> covariance;
};

Seen seen_as(const double* q, const double* p, const double* covariance) {
  return {{quaternion(q), Vector3d(p)}, Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(covariance)};
}

/// Covariance of (heading, position) in n of that pose.
Matrix4d noise_of(const Seen& seen, const Quaterniond& q_n_kept) {
  const Matrix3d R = q_n_kept.toRotationMatrix();
  Eigen::Matrix<double, 4, 6> by = Eigen::Matrix<double, 4, 6>::Zero();
  by.topLeftCorner<1, 3>() = R.row(2);
  by.bottomRightCorner<3, 3>() = R;
  return by * seen.covariance * by.transpose();
}

/// The body at that time, relative to a kept pose: eq. (10) with the pose of eq. (11) in the place of n's origin.
Innovation innovation_of(const PoseFilter& filter, uint64_t id, const KeptPose& kept, const Seen& seen,
                         const KeyFrames::Context& at) {
  const Quaterniond q_n_o = filter.q_n_o(), q_n_b = q_n_o * at.then.q_o_b;
  const Vector3d since_n = q_n_o * (at.now.p_o_b - at.then.p_o_b);
  const Vector3d from_kept_n = kept.q_n_b * seen.T_kept_b.p;
  Innovation out(4);
  out.residual[kYaw] = yaw_of(kept.q_n_b * seen.T_kept_b.q * q_n_b.conjugate());
  out.residual.tail<3>() = kept.p_n_b + from_kept_n - (filter.p_n() - since_n);
  out.H(kYaw, kHeading) = 1;
  out.H.block<3, 3>(1, kNorth).setIdentity();
  out.H.block<3, 1>(1, kHeading) = -across(since_n);
  out.H.block<3, 1>(1, kLogScale) = -since_n;
  out.kept[0].id = id;
  out.kept[0].H = -Matrix4d::Identity();
  // By the predicted position, not the measured one: a rotation of n as a whole must not be observable.
  out.kept[0].H.block<3, 1>(1, 0) = -across(filter.p_n() - since_n - kept.p_n_b);
  out.noise = noise_of(seen, kept.q_n_b);
  out.noise.diagonal().tail<3>().array() += squared(at.tilt_sigma_rad) * from_kept_n.squaredNorm();
  out.drift_then = drift_of(at.then), out.drift_now = drift_of(at.now);
  return out;
}

}  // namespace

void KeyFrames::add(odo_key_frame& message, const Attachment& body, const PoseFilter& filter) {
  const auto of_source = [&](const KeyFrame& frame) { return frame.message.header.source == message.header.source; };
  if (static_cast<size_t>(std::count_if(frames_.begin(), frames_.end(), of_source)) >= p_.max)
    frames_.erase(std::find_if(frames_.begin(), frames_.end(), of_source));
  frames_.push_back({message, body});
  odo_key_frame& kept = frames_.back().message;
  kept.header.struct_size = sizeof kept;  // without what a later version has behind it
  fill(frames_.back(), filter, -1, -1);
  message.header.flags = kept.header.flags;
  std::copy(kept.q_n_b, kept.q_n_b + 4, message.q_n_b), std::copy(kept.p_n_b, kept.p_n_b + 3, message.p_n_b);
}

bool KeyFrames::fill(KeyFrame& frame, const PoseFilter& filter, double moved_m, double moved_rad) {
  KeptPose kept;
  if (!filter.kept_pose(frame.body.pose_id, 0, kept)) return false;
  const Rigid T_n_b = Rigid{kept.q_n_b, kept.p_n_b} * frame.body.T_kept_x;
  odo_key_frame& message = frame.message;
  const bool moved = (T_n_b.p - Vector3d(message.p_n_b)).norm() > moved_m ||
                     T_n_b.q.angularDistance(raw_quaternion(message.q_n_b)) > moved_rad;
  if (!moved) return false;
  message.header.flags |= ODO_FLAG_NAVIGATION;
  put_quaternion(T_n_b.q, message.q_n_b);
  Vector3d::Map(message.p_n_b) = T_n_b.p;
  return true;
}

void KeyFrames::hand_over(const HandOver& hand_over) {
  for (KeyFrame& frame : frames_) hand_over.apply(frame.body);
}

bool KeyFrames::refer_to(uint64_t pose_id) const {
  return std::any_of(frames_.begin(), frames_.end(),
                     [&](const KeyFrame& frame) { return frame.body.pose_id == pose_id; }) ||
         std::any_of(maps_.begin(), maps_.end(), [&](const Map& map) { return map.pose_id == pose_id; });
}

std::optional<Attachment> KeyFrames::find(uint32_t source, int64_t t_ns) const {
  for (const KeyFrame& frame : frames_)
    if (frame.message.header.source == source && frame.message.header.t_ns == t_ns) return frame.body;
  return std::nullopt;
}

uint64_t KeyFrames::map_frame(uint32_t source, uint64_t map) const {
  for (const Map& known : maps_)
    if (known.source == source && known.map == map) return known.pose_id;
  return 0;
}

/// A heading error that grew along a path moved its end along an arc, of which a linear update knows the tangent: the
/// difference is added to the noise.
UpdateResult KeyFrames::update(PoseFilter& filter, Innovation& seen, const Context& at) const {
  const double rotation_rad = seen.residual[kYaw];
  if (std::abs(rotation_rad) > p_.largest_rotation_rad) return {false, 0.0, 4};
  const Innovation::Square expected = filter.covariance_of(seen);
  if (expected(kYaw, kYaw) > 0) {
    const double lever_m = expected.col(kYaw).tail(3).norm() / expected(kYaw, kYaw);
    seen.noise.diagonal().tail(3).array() += squared(0.5 * squared(rotation_rad) * lever_m);
  }
  return filter.update(seen, kGate[4], at.considered);
}

UpdateResult KeyFrames::use(PoseFilter& filter, const odo_relative_pose& loop, const Attachment& from,
                            const Context& at) const {
  KeptPose kept;
  if (!filter.kept_pose(from.pose_id, 0, kept)) return {};
  Seen seen = seen_as(loop.q_b0_b1, loop.p_b0_b1, loop.covariance);
  // From the axes of the body then to those of the kept pose.
  const Matrix3d R = from.T_kept_x.q.toRotationMatrix();
  Eigen::Matrix<double, 6, 6> turned = Eigen::Matrix<double, 6, 6>::Zero();
  turned.topLeftCorner<3, 3>() = turned.bottomRightCorner<3, 3>() = R;
  seen.covariance = (turned * seen.covariance * turned.transpose()).eval();
  seen.T_kept_b = from.T_kept_x * seen.T_kept_b;
  Innovation innovation = innovation_of(filter, from.pose_id, kept, seen, at);
  const Vector3d lever_n = kept.q_n_b * (seen.T_kept_b.p - from.T_kept_x.p);
  Matrix4d by = Matrix4d::Identity(), to_n = Matrix4d::Identity();
  by.block<3, 1>(1, 0) = across(lever_n);
  to_n.bottomRightCorner<3, 3>() = kept.q_n_b.toRotationMatrix();
  innovation.noise += by * to_n * from.covariance * to_n.transpose() * by.transpose();
  return update(filter, innovation, at);
}

UpdateResult KeyFrames::use(PoseFilter& filter, const odo_map_pose& place, bool takes_frame, const Context& at) {
  const Seen seen = seen_as(place.q_m_b, place.p_m_b, place.covariance);
  Eigen::Vector4d floor;
  floor << squared(place.map_sigma_rad), Vector3d::Constant(squared(place.map_sigma_m));
  const auto known = std::find_if(maps_.begin(), maps_.end(), [&](const Map& map) {
    return map.source == place.header.source && map.map == place.map;
  });
  if (KeptPose kept; known != maps_.end() && filter.kept_pose(known->pose_id, 0, kept)) {
    Innovation innovation = innovation_of(filter, known->pose_id, kept, seen, at);
    // The track has drifted farther than it knows: things in the map must be where they are seen.
    if (known->rejected >= p_.max_rejected && std::abs(innovation.residual[kYaw]) <= p_.largest_rotation_rad)
      filter.inflate_kept(known->pose_id, (innovation.kept[0].H.inverse() * innovation.residual).cwiseAbs2());
    // The error of the map itself stays, however often it is recognised.
    const Innovation::Square expected = filter.covariance_of(innovation);
    for (int i = 0; i < 4; ++i) {
      const double gained = expected(i, i) - floor[i];
      const double least = gained > 0 ? expected(i, i) * floor[i] / gained : kUninformedVariance;
      innovation.noise(i, i) = std::max(innovation.noise(i, i), std::min(least, kUninformedVariance));
    }
    const UpdateResult result = update(filter, innovation, at);
    known->rejected = result.accepted ? 0 : known->rejected + 1;
    if (result.accepted) known->recognised_ns = place.header.t_ns;
    return result;
  }

  const Quaterniond q_n_b = filter.q_n_o() * at.then.q_o_b;
  uint64_t id = 0;
  if (takes_frame) {
    const Vector3d p_n_b = filter.p_n() - filter.q_n_o() * (at.now.p_o_b - at.then.p_o_b);
    filter.rotate(yaw_of(seen.T_kept_b.q * q_n_b.conjugate()), p_n_b);
    const Matrix4d noise = noise_of(seen, Quaterniond::Identity()) + Matrix4d(floor.asDiagonal());
    filter.inflate_heading(std::sqrt(noise(0, 0)));
    filter.place({seen.T_kept_b.p - p_n_b, Vector3d::Ones(), noise.bottomRightCorner<3, 3>(), {}}, at.then, at.now);
    id = filter.keep_origin();
  } else {
    const Rigid T_b_m = seen.T_kept_b.inverse();
    const Quaterniond q_n_m = about_down(yaw_of(q_n_b * T_b_m.q));
    Matrix4d by = -Matrix4d::Identity();
    by.block<3, 1>(1, 0) = across(q_n_m * seen.T_kept_b.p);
    Matrix4d noise = by * noise_of(seen, q_n_m) * by.transpose();
    noise.diagonal() += floor;
    noise.diagonal().tail<3>().array() += squared(at.tilt_sigma_rad) * seen.T_kept_b.p.squaredNorm();
    id = filter.keep_frame(at.then, at.now, T_b_m, noise);
  }
  if (id == 0) return {};
  std::erase_if(maps_, [&](const Map& map) { return map.source == place.header.source && map.map == place.map; });
  if (maps_.size() >= p_.max_maps) {
    const auto oldest = std::min_element(maps_.begin(), maps_.end(),
                                         [](const Map& a, const Map& b) { return a.recognised_ns < b.recognised_ns; });
    filter.release_pose(oldest->pose_id);
    maps_.erase(oldest);
  }
  maps_.push_back({place.header.source, place.map, id, place.header.t_ns});
  return {true, 0.0, 4};
}

}  // namespace odograph
