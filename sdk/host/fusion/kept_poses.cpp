// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/fusion/kept_poses.hpp"

namespace odograph {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix4d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

/// Derivative of the (heading, position) of something at a lever by those of the pose that it is fixed to.
Matrix4d by_pose(const Vector3d& lever_n) {
  Matrix4d by = Matrix4d::Identity();
  by(1, 0) = -lever_n.y(), by(2, 0) = lever_n.x();
  return by;
}

/// Turns a (heading, position) from the axes of a pose to n.
Matrix4d turned(const Quaterniond& q) {
  Matrix4d out = Matrix4d::Identity();
  out.bottomRightCorner<3, 3>() = q.toRotationMatrix();
  return out;
}

}  // namespace

void HandOver::apply(Attachment& attachment) const {
  if (attachment.pose_id != from) return;
  const Vector3d p_n = (T_n_from * attachment.T_kept_x).p;
  const Matrix4d by_from = by_pose(p_n - T_n_from.p), by_to = by_pose(p_n - T_n_to.p);
  const Matrix4d both = by_from * common * by_to.transpose();
  const Matrix4d apart =
      by_from * of_from * by_from.transpose() + by_to * of_to * by_to.transpose() - both - both.transpose();
  const Matrix4d W_from = turned(T_n_from.q), W_to = turned(T_n_to.q);
  attachment.covariance = W_to.transpose() * (W_from * attachment.covariance * W_from.transpose() + apart) * W_to;
  attachment.T_kept_x = T_n_to.inverse() * T_n_from * attachment.T_kept_x;
  attachment.pose_id = to;
}

Attachment attach(const Attachment& body, const Rigid& T_b_x, const Quaterniond& q_n_kept) {
  const Vector3d lever_n = q_n_kept * (body.T_kept_x.q * T_b_x.p);
  const Matrix4d W = turned(q_n_kept), by = by_pose(lever_n);
  const Matrix4d in_n = by * (W * body.covariance * W.transpose()) * by.transpose();
  return {body.pose_id, body.T_kept_x * T_b_x, W.transpose() * in_n * W};
}

}  // namespace odograph
