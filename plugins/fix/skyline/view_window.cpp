// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/skyline/view_window.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace odograph::skyline {

bool ViewWindow::adds_information(const Eigen::Vector3d& p_n, const Eigen::Quaterniond& q_n_c) const {
  if (views_.empty()) return true;
  const View& newest = views_.back();
  return (p_n - newest.p_n).head<2>().norm() >= p_.apart_m || q_n_c.angularDistance(newest.q_n_c) >= p_.turned_rad;
}

void ViewWindow::add(View view, double path_m) {
  views_.push_back(std::move(view));
  path_m_.push_back(path_m);
  ++fresh_;
  size_t gone = views_.size() > p_.most ? views_.size() - p_.most : 0;
  while (path_m - path_m_[gone] > p_.longest_m) ++gone;
  views_.erase(views_.begin(), views_.begin() + static_cast<std::ptrdiff_t>(gone));
  path_m_.erase(path_m_.begin(), path_m_.begin() + static_cast<std::ptrdiff_t>(gone));
}

void ViewWindow::inflate_covariance(Match& match, double drift) {
  if (views_.empty()) return;
  const double all = static_cast<double>(views_.size()), fresh = static_cast<double>(std::max<size_t>(1, fresh_));
  const double times = std::max(1.0, all / fresh);
  const double path_m = 0.5 * drift * (views_.back().p_n - views_.front().p_n).head<2>().norm();
  match.covariance = times * (match.covariance + path_m * path_m * Eigen::Matrix2d::Identity());
  const double place = std::sqrt(0.5 * match.covariance.trace()) / p_.doubt_over_m;
  match.yaw_sigma_rad = std::hypot(std::sqrt(times) * match.yaw_sigma_rad, place);
  fresh_ = 0;
}

void ViewWindow::correct(const Eigen::Quaterniond& q, const Eigen::Vector3d& p) {
  for (View& view : views_) {
    view.p_n = q * view.p_n + p;
    view.q_n_c = (q * view.q_n_c).normalized();
  }
}

}  // namespace odograph::skyline
