// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/skyline/picture_job.hpp"

namespace odograph::skyline {

Match PictureJob::propagated_to(const Eigen::Vector3d& now_n, const Eigen::Quaterniond& q_n_c_now, double drift) const {
  const Eigen::Quaterniond rotation = match->q_n_c * corrected(q_n_c).conjugate();
  const Eigen::Vector3d displacement = rotation * (now_n - corrected(p_n));
  const Eigen::Vector2d aside(-displacement.y(), displacement.x());
  Match later = *match;
  later.p_n += displacement;
  later.q_n_c = (rotation * q_n_c_now).normalized();
  later.covariance += match->yaw_sigma_rad * match->yaw_sigma_rad * aside * aside.transpose();
  later.covariance += Eigen::Matrix2d::Identity() * (drift * drift * displacement.squaredNorm());
  return later;
}

}  // namespace odograph::skyline
