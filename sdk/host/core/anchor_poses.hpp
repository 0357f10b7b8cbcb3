// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "sdk/host/fusion/kept_poses.hpp"
#include "sdk/math/rotation.hpp"

namespace odograph {

/// Kept poses as they were at the newest update, by id.
class KeptPoseCache {
 public:
  const KeptPose* find(uint64_t id) const {
    if (id == 0) return nullptr;
    for (size_t i = 0; i < poses_.size(); ++i, ++found_)  // anchors of one pose follow each other
      if (const auto& kept = poses_[found_ % poses_.size()]; kept.first == id) return &kept.second;
    return nullptr;
  }
  /// False if it is not kept.
  bool add(uint64_t id, const KeptPoses& poses) {
    if (find(id)) return true;
    KeptPose kept;
    if (!poses.kept_pose(id, kept)) return false;
    poses_.emplace_back(id, kept);
    return true;
  }
  void update(const KeptPoses& poses) {
    std::erase_if(poses_, [&](auto& kept) { return !poses.kept_pose(kept.first, kept.second); });
  }
  template <class IsUsed>
  void release_unused(KeptPoses& poses, IsUsed&& is_used) {
    std::erase_if(poses_, [&](const auto& kept) {
      const bool used = is_used(kept.first);
      if (!used) poses.release_pose(kept.first);
      return !used;
    });
  }
  void erase(uint64_t id) {
    std::erase_if(poses_, [id](const auto& kept) { return kept.first == id; });
  }
  void clear() { poses_.clear(); }

 private:
  std::vector<std::pair<uint64_t, KeptPose>> poses_;
  mutable size_t found_ = 0;  // where the last one was found
};

/// Covariances of something on a kept pose: of its position in n, and relative to the body now, m^2, in n.
struct RelativeCovariance {
  Eigen::Matrix3d place, view;
};
/// With s from the kept pose to it and l from the body, the position error is dp_h - s x theta_h, and the error in the
/// view is that - dp + l x theta.
inline RelativeCovariance covariance_on(const KeptPose& kept, const Attachment& attachment, const Eigen::Vector3d& p_n,
                                        const KeptPose& now) {
  Eigen::Matrix<double, 3, 6> by_now, by_kept;
  by_now << skew(p_n - now.p_n_b), -Eigen::Matrix3d::Identity();
  by_kept << -skew(p_n - kept.p_n_b), Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d R = kept.q_n_b.toRotationMatrix();
  const Eigen::Matrix3d offset = R * attachment.covariance.bottomRightCorner<3, 3>() * R.transpose();
  const Eigen::Matrix3d place = by_kept * kept.own * by_kept.transpose() + offset;
  const Eigen::Matrix3d common = by_kept * kept.cross * by_now.transpose();
  return {place, by_now * now.now * by_now.transpose() + place + common + common.transpose()};
}

}  // namespace odograph
