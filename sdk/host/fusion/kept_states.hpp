// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "sdk/host/fusion/filter_states.hpp"
#include "sdk/host/fusion/kept_poses.hpp"
#include "sdk/host/fusion/trajectory.hpp"

namespace odograph {

/// Poses of the past as states of the filter, with their covariances: (heading, position) of each with the filter's
/// state, and among themselves.
struct KeptStates {
  static constexpr int kMost = 64;

  struct Kept {
    uint64_t id = 0;
    TrackPoint point;  ///< when it was kept
    Eigen::Quaterniond q_n_b;
    Eigen::Vector3d p_n_b;
    bool is_frame = false;                              ///< of a map: never given up for others
    Eigen::Vector3d moved_n = Eigen::Vector3d::Zero();  ///< by the newest update
  };

  bool is_full() const { return poses.size() >= kMost; }
  uint64_t next_id() { return ++last_id_; }
  static Eigen::Index position_row(size_t pose) { return 4 * static_cast<Eigen::Index>(pose) + 1; }
  /// First row of a pose; -1 if it is not kept.
  int row_of(uint64_t id) const;
  void add(const Kept& kept, const Eigen::Matrix<double, 4, kStates>& of_state, const Eigen::MatrixXd& of_kept,
           const Eigen::Matrix4d& own);
  void release(uint64_t id);
  std::optional<HandOver> crowded() const;
  void rotate(const Eigen::Quaterniond& q, const Eigen::Vector3d& about_n);
  /// Adds variances to the (heading, position) of one pose.
  void inflate(uint64_t id, const Eigen::Vector4d& variance);
  void inflate_heading(double variance, const Eigen::Vector3d& about_n);
  /// PoseFilter::rotate_errors(), for the current position's shift.
  void rotate_errors(const Eigen::Vector3d& moved_n);

  std::vector<Kept> poses;
  Eigen::Matrix<double, Eigen::Dynamic, kStates, 0, 4 * kMost, kStates> with_state;
  Eigen::MatrixXd with_kept;

 private:
  uint64_t last_id_ = 0;
};

}  // namespace odograph
