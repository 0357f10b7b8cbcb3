// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/fusion/kept_states.hpp"

#include <algorithm>
#include <limits>

namespace odograph {

using Eigen::Matrix3d;
using Eigen::Matrix4d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

void KeptStates::add(const Kept& kept, const Eigen::Matrix<double, 4, kStates>& of_state,
                     const Eigen::MatrixXd& of_kept, const Matrix4d& own) {
  const Eigen::Index n = with_state.rows();
  with_state.conservativeResize(n + 4, kStates);
  with_state.bottomRows<4>() = of_state;
  with_kept.conservativeResize(n + 4, n + 4);
  with_kept.topRightCorner(n, 4) = of_kept;
  with_kept.bottomLeftCorner(4, n) = of_kept.transpose();
  with_kept.bottomRightCorner<4, 4>() = own;
  poses.push_back(kept);
}

void KeptStates::release(uint64_t id) {
  const int row = row_of(id);
  if (row < 0) return;
  const Eigen::Index rest = with_state.rows() - row - 4;
  poses.erase(poses.begin() + row / 4);
  with_state.middleRows(row, rest) = with_state.bottomRows(rest).eval();
  with_kept.middleRows(row, rest) = with_kept.bottomRows(rest).eval();
  with_kept.middleCols(row, rest) = with_kept.rightCols(rest).eval();
  with_state.conservativeResize(row + rest, kStates);
  with_kept.conservativeResize(row + rest, row + rest);
}

std::optional<HandOver> KeptStates::crowded() const {
  if (!is_full()) return std::nullopt;
  const auto row = [](size_t pose) { return 4 * static_cast<Eigen::Index>(pose); };
  const auto block = [&](size_t one, size_t other) { return with_kept.block<4, 4>(row(one), row(other)); };
  double least = std::numeric_limits<double>::infinity();
  std::optional<size_t> before;  // in order of time
  size_t from = 0, to = 0;
  for (size_t i = 0; i < poses.size(); ++i) {
    if (poses[i].is_frame) continue;
    if (before) {
      const Matrix4d apart = block(i, i) + block(*before, *before) - 2 * block(i, *before);
      if (const double variance = apart.diagonal().tail<3>().sum(); variance < least)
        least = variance, from = i, to = *before;
    }
    before = i;
  }
  const auto place = [&](size_t i) { return Rigid{poses[i].q_n_b, poses[i].p_n_b}; };
  return HandOver{poses[from].id,    poses[to].id,  place(from),    place(to),
                  block(from, from), block(to, to), block(from, to)};
}

int KeptStates::row_of(uint64_t id) const {
  const auto found = std::find_if(poses.begin(), poses.end(), [id](const Kept& pose) { return pose.id == id; });
  return id == 0 || found == poses.end() ? -1 : 4 * static_cast<int>(found - poses.begin());
}

void KeptStates::rotate(const Quaterniond& q, const Vector3d& about_n) {
  const Matrix3d R = q.toRotationMatrix();
  for (size_t i = 0; i < poses.size(); ++i) {
    const Eigen::Index row = position_row(i);
    poses[i].q_n_b = (q * poses[i].q_n_b).normalized();
    poses[i].p_n_b = about_n + R * (poses[i].p_n_b - about_n);
    with_state.middleRows<3>(row) = (R * with_state.middleRows<3>(row)).eval();
    with_kept.middleRows<3>(row) = (R * with_kept.middleRows<3>(row)).eval();
    with_kept.middleCols<3>(row) = (with_kept.middleCols<3>(row) * R.transpose()).eval();
  }
  if (!poses.empty()) with_state.leftCols<3>() = (with_state.leftCols<3>() * R.transpose()).eval();
}

void KeptStates::inflate(uint64_t id, const Eigen::Vector4d& variance) {
  if (const int row = row_of(id); row >= 0) with_kept.diagonal().segment<4>(row) += variance;
}

void KeptStates::inflate_heading(double variance, const Vector3d& about_n) {
  Eigen::VectorXd by(4 * poses.size());  // rotated with the rest
  for (size_t i = 0; i < poses.size(); ++i)
    by.segment<4>(4 * static_cast<Eigen::Index>(i)) << 1, across(poses[i].p_n_b - about_n);
  with_kept += variance * by * by.transpose();
  for (const int i : {kHeading, kAttitudeHeading}) with_state.col(i) += variance * by;
}

void KeptStates::rotate_errors(const Vector3d& moved_n) {
  with_state.leftCols<3>() += with_state.col(kHeading) * across(moved_n).transpose();
  for (size_t pose = 0; pose < poses.size(); ++pose) {
    const Eigen::Index row = 4 * static_cast<Eigen::Index>(pose);
    const Vector3d by = across(poses[pose].moved_n);
    with_state.middleRows<3>(row + 1) += by * with_state.row(row);
    with_kept.middleRows<3>(row + 1) += by * with_kept.row(row);
    with_kept.middleCols<3>(row + 1) += with_kept.col(row) * by.transpose();
  }
}

}  // namespace odograph
