// SPDX-License-Identifier: Apache-2.0
#include "plugins/vo/five_point/two_view.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>
#include <opencv2/calib3d.hpp>

namespace odograph::five_point {
namespace {

Eigen::Vector3d ray(const cv::Point2d& normalized) { return Eigen::Vector3d(normalized.x, normalized.y, 1.0).normalized(); }

}  // namespace

std::optional<TwoView> two_view(const std::vector<cv::Point2d>& first, const std::vector<cv::Point2d>& second,
                                double threshold) {
  if (first.size() < 12) return std::nullopt;
  cv::Mat mask;
  const cv::Matx33d K = cv::Matx33d::eye();
  cv::Mat E = cv::findEssentialMat(first, second, K, cv::RANSAC, 0.9999, threshold, 1000, mask);
  if (E.rows != 3 || E.cols != 3) return std::nullopt;
  cv::Mat R, t;
  cv::recoverPose(E, first, second, K, R, t, 1e5, mask);
  TwoView result;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) result.R_1_0(i, j) = R.at<double>(i, j);
    result.t_1_0[i] = t.at<double>(i);
  }
  std::vector<double> angles;
  result.inliers.resize(first.size(), 0);
  for (size_t i = 0; i < first.size(); ++i) {
    if (!mask.at<uchar>(static_cast<int>(i))) continue;
    result.inliers[i] = 1;
    ++result.count;
    angles.push_back(std::acos(std::min(1.0, (result.R_1_0 * ray(first[i])).dot(ray(second[i])))));
  }
  if (angles.empty()) return std::nullopt;
  std::nth_element(angles.begin(), angles.begin() + static_cast<std::ptrdiff_t>(angles.size() / 2), angles.end());
  result.median_parallax_rad = angles[angles.size() / 2];
  return result;
}

std::optional<Eigen::Vector3d> triangulate(const std::vector<Sighting>& sightings, double threshold,
                                           double min_parallax_rad) {
  Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  const Eigen::Vector3d first = sightings.front().T_w_c.linear() * ray(sightings.front().normalized);
  double widest = 0.0;
  for (const Sighting& s : sightings) {
    const Eigen::Vector3d r = s.T_w_c.linear() * ray(s.normalized);
    const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - r * r.transpose();
    A += across;
    b += across * s.T_w_c.translation();
    widest = std::max(widest, std::acos(std::clamp(first.dot(r), -1.0, 1.0)));
  }
  if (widest < min_parallax_rad) return std::nullopt;
  Eigen::Vector3d X = A.ldlt().solve(b);
  for (int iteration = 0; iteration < 3; ++iteration) {
    Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
    Eigen::Vector3d g = Eigen::Vector3d::Zero();
    double largest = 0.0;
    for (const Sighting& s : sightings) {
      const Eigen::Matrix3d R_c_w = s.T_w_c.linear().transpose();
      const Eigen::Vector3d x = R_c_w * (X - s.T_w_c.translation());
      if (x.z() <= 1e-6) return std::nullopt;
      const Eigen::Vector2d error(x.x() / x.z() - s.normalized.x, x.y() / x.z() - s.normalized.y);
      largest = std::max(largest, error.norm());
      Eigen::Matrix<double, 2, 3> J;
      J << 1 / x.z(), 0, -x.x() / (x.z() * x.z()), 0, 1 / x.z(), -x.y() / (x.z() * x.z());
      J = (J * R_c_w).eval();
      H += J.transpose() * J;
      g += J.transpose() * error;
    }
    if (iteration == 2) return largest < threshold ? std::optional(X) : std::nullopt;
    X -= H.ldlt().solve(g);
  }
  return std::nullopt;
}

}  // namespace odograph::five_point
