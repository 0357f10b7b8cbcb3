// SPDX-License-Identifier: Apache-2.0
#include "plugins/shared/camera/two_view.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Dense>
#include <opencv2/calib3d.hpp>

#include "plugins/shared/median.hpp"
#include "sdk/math/rotation.hpp"

namespace odograph {
namespace {

const Eigen::Vector3d kDirections[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {-1, 0, 1}, {0, 1, 1}, {0, -1, 1}};

Eigen::Vector3d ray(const cv::Point2d& normalized) {
  return Eigen::Vector3d(normalized.x, normalized.y, 1.0).normalized();
}

/// Sampson distance of a match to an epipolar geometry, in normalized coordinates.
double sampson(const Eigen::Matrix3d& E, const cv::Point2d& a, const cv::Point2d& b) {
  const Eigen::Vector3d x0(a.x, a.y, 1), x1(b.x, b.y, 1);
  const Eigen::Vector3d l1 = E * x0, l0 = E.transpose() * x1;
  const double weight = l1.x() * l1.x() + l1.y() * l1.y() + l0.x() * l0.x() + l0.y() * l0.y();
  return x1.dot(l1) / std::sqrt(std::max(weight, 1e-18));
}

void refine(TwoView& view, const std::vector<cv::Point2d>& first, const std::vector<cv::Point2d>& second,
            double threshold, const TwoViewParameters& p) {
  using Vector5d = Eigen::Matrix<double, 5, 1>;
  using Matrix5d = Eigen::Matrix<double, 5, 5>;
  for (int iteration = 0; iteration < 10; ++iteration) {
    Eigen::Vector3d u = view.t_1_0.unitOrthogonal();
    const Eigen::Vector3d v = view.t_1_0.cross(u);
    const auto essential = [&](const Vector5d& d) -> Eigen::Matrix3d {
      return skew((view.t_1_0 + d[3] * u + d[4] * v).normalized()) * exp_rotation_matrix(d.head<3>()) * view.R_1_0;
    };
    const double h = 1e-6;
    const Eigen::Matrix3d E = essential(Vector5d::Zero());
    Eigen::Matrix3d moved[5];
    for (int k = 0; k < 5; ++k) moved[k] = essential(h * Vector5d::Unit(k));
    Matrix5d H = Matrix5d::Identity() * 1e-12;
    Vector5d g = Vector5d::Zero();
    for (size_t i = 0; i < first.size(); ++i) {
      if (!view.inliers[i]) continue;
      const double error = sampson(E, first[i], second[i]);
      const double weight = std::min(1.0, p.huber_part * threshold / std::max(std::abs(error), 1e-12));
      Vector5d J;
      for (int k = 0; k < 5; ++k) J[k] = (sampson(moved[k], first[i], second[i]) - error) / h;
      H += weight * J * J.transpose();
      g += weight * error * J;
    }
    const Vector5d step = -H.ldlt().solve(g);
    view.t_1_0 = (view.t_1_0 + step[3] * u + step[4] * v).normalized();
    view.R_1_0 = exp_rotation_matrix(step.head<3>()) * view.R_1_0;
    if (step.norm() < 1e-9) break;
  }
}

/// Chooses the sign of the translation that puts most points in front of both cameras.
void face_forward(TwoView& view, const std::vector<cv::Point2d>& first, const std::vector<cv::Point2d>& second) {
  int sign = 0;
  for (size_t i = 0; i < first.size(); ++i) {
    const Eigen::Vector3d x0 = view.R_1_0 * Eigen::Vector3d(first[i].x, first[i].y, 1), x1(second[i].x, second[i].y, 1);
    // z1 x1 = z0 R x0 + t, times x1.
    sign += x1.cross(view.t_1_0).dot(x1.cross(x0)) < 0 ? 1 : -1;
  }
  if (sign < 0) view.t_1_0 = -view.t_1_0;
}

double bounded_cost(const TwoView& view, const std::vector<cv::Point2d>& first, const std::vector<cv::Point2d>& second,
                    double threshold) {
  const Eigen::Matrix3d E = skew(view.t_1_0) * view.R_1_0;
  double sum = 0;
  for (size_t i = 0; i < first.size(); ++i) {
    const double error = sampson(E, first[i], second[i]);
    sum += std::min(error * error, threshold * threshold);
  }
  return sum;
}

/// Inliers of a refined pair and their parallax; false without any.
bool measure(TwoView& result, const std::vector<cv::Point2d>& first, const std::vector<cv::Point2d>& second,
             double threshold) {
  const Eigen::Matrix3d E_refined = skew(result.t_1_0) * result.R_1_0;
  std::vector<double> angles;
  result.count = 0;
  for (size_t i = 0; i < first.size(); ++i) {
    if (result.inliers[i] && std::abs(sampson(E_refined, first[i], second[i])) > threshold) result.inliers[i] = 0;
    if (!result.inliers[i]) continue;
    ++result.count;
    angles.push_back((result.R_1_0 * ray(first[i]) - ray(second[i])).norm());
  }
  if (angles.empty()) return false;
  result.median_parallax_rad = median(std::move(angles));
  return true;
}

}  // namespace

std::optional<PureRotation> pure_rotation(const std::vector<cv::Point2d>& first, const std::vector<cv::Point2d>& second,
                                          const TwoViewParameters& p) {
  const size_t n = first.size();
  if (n < p.min_matches) return std::nullopt;
  std::vector<double> residuals(n, 0.0);
  PureRotation result{Eigen::Matrix3d::Identity(), 0.0};
  double limit = 1e9;
  for (int iteration = 0; iteration < 4; ++iteration) {  // repeated least squares on the better half of the matches
    Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
    for (size_t i = 0; i < n; ++i)
      if (residuals[i] <= limit) H += ray(second[i]) * ray(first[i]).transpose();
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(H, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const double side = (svd.matrixU() * svd.matrixV().transpose()).determinant();
    result.R_1_0 = svd.matrixU() * Eigen::Vector3d(1, 1, side).asDiagonal() * svd.matrixV().transpose();
    for (size_t i = 0; i < n; ++i) residuals[i] = (result.R_1_0 * ray(first[i]) - ray(second[i])).norm();
    limit = result.median_residual_rad = median(residuals);
  }
  return result;
}

std::optional<TwoView> two_view(const std::vector<cv::Point2d>& first, const std::vector<cv::Point2d>& second,
                                double threshold, int trials, const TwoViewParameters& p) {
  if (first.size() < p.min_matches) return std::nullopt;
  cv::Mat mask;
  const cv::Matx33d K = cv::Matx33d::eye();
  cv::Mat E = cv::findEssentialMat(first, second, K, cv::RANSAC, p.confidence, threshold, trials, mask);
  if (E.rows != 3 || E.cols != 3) return std::nullopt;
  cv::Mat R, t;
  cv::recoverPose(E, first, second, K, R, t, p.farthest, mask);
  TwoView result;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) result.R_1_0(i, j) = R.at<double>(i, j);
    result.t_1_0[i] = t.at<double>(i);
  }
  result.inliers.resize(first.size(), 0);
  for (size_t i = 0; i < first.size(); ++i) {
    if (!mask.at<uchar>(static_cast<int>(i))) continue;
    result.inliers[i] = 1;
    ++result.count;
  }
  if (result.count < static_cast<int>(p.min_matches)) return std::nullopt;
  refine(result, first, second, threshold, p);
  if (!measure(result, first, second, threshold)) return std::nullopt;
  return result;
}

std::optional<TwoView> two_view_near(const std::vector<cv::Point2d>& first, const std::vector<cv::Point2d>& second,
                                     const Eigen::Matrix3d& R_1_0, double threshold, int trials,
                                     const TwoViewParameters& p) {
  struct Candidate {
    TwoView view;
    double cost;
  };
  std::vector<Candidate> candidates;
  const auto consider = [&](TwoView view) {
    for (const double bound : {p.first_bound * threshold, p.second_bound * threshold}) {
      const Eigen::Matrix3d E = skew(view.t_1_0) * view.R_1_0;
      view.inliers.resize(first.size());
      for (size_t i = 0; i < first.size(); ++i) view.inliers[i] = std::abs(sampson(E, first[i], second[i])) < bound;
      refine(view, first, second, threshold, p);
    }
    face_forward(view, first, second);
    candidates.push_back({view, bounded_cost(view, first, second, threshold)});
  };
  if (const auto pair = two_view(first, second, threshold, trials, p)) consider(*pair);
  for (const Eigen::Vector3d& t : kDirections) consider({.R_1_0 = R_1_0, .t_1_0 = t.normalized()});
  const auto best = std::min_element(candidates.begin(), candidates.end(),
                                     [](const Candidate& a, const Candidate& b) { return a.cost < b.cost; });
  for (const Candidate& other : candidates)
    if (std::abs(other.view.t_1_0.dot(best->view.t_1_0)) < p.same_direction &&
        other.cost < p.ambiguous_ratio * best->cost)
      return std::nullopt;
  TwoView result = best->view;
  if (!measure(result, first, second, threshold) || result.count < static_cast<int>(p.min_matches)) return std::nullopt;
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

}  // namespace odograph
