// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/skyline/vanishing_point.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <opencv2/imgproc.hpp>

#include "plugins/fix/skyline/sky_rays.hpp"

namespace odograph::skyline {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using Eigen::Vector3d;

std::vector<SeenLine> lines_of(const cv::Mat& grey, const cv::Mat& mask, const CameraModel& camera,
                               const VanishingPointParameters& p) {
  std::vector<cv::Vec4f> segments;
  cv::createLineSegmentDetector(cv::LSD_REFINE_STD)->detect(grey, segments);
  std::vector<SeenLine> lines;
  for (const cv::Vec4f& s : segments) {
    const Vector2d from(static_cast<double>(s[0]), static_cast<double>(s[1]));
    const Vector2d to(static_cast<double>(s[2]), static_cast<double>(s[3]));
    if ((to - from).norm() < p.min_length_px) continue;
    const Vector2d middle = 0.5 * (from + to);
    const cv::Point at(std::clamp(static_cast<int>(middle.x()), 0, grey.cols - 1),
                       std::clamp(static_cast<int>(middle.y()), 0, grey.rows - 1));
    if (!mask.empty() && mask.at<uint8_t>(at) == 0) continue;
    Vector3d a, b;
    if (!ray_of(camera, from, p.farthest_rad, a) || !ray_of(camera, to, p.farthest_rad, b)) continue;
    const Vector3d n = a.cross(b);
    const double sine = n.norm();
    if (sine > 1e-6) lines.push_back({n / sine, std::asin(std::min(1.0, sine)), a, b});
  }
  return lines;
}

std::optional<SeenZenith> vanishing_zenith(const std::vector<SeenLine>& lines, const Vector3d& prior_up_c,
                                           const VanishingPointParameters& p) {
  SeenZenith found{.up_c = prior_up_c.normalized()};
  Matrix2d A, squares;
  for (double scale = p.first_scale_rad;; scale = std::max(p.last_scale_rad, 0.5 * scale)) {
    const bool last = scale <= p.last_scale_rad;
    for (int round = 0; round < (last ? 4 : 2); ++round) {
      const Vector3d x = found.up_c.unitOrthogonal(), y = found.up_c.cross(x);
      A.setZero();
      Vector2d b = Vector2d::Zero();
      squares.setZero();
      found.lines = 0;
      for (const SeenLine& line : lines) {
        const double off = line.normal_c.dot(found.up_c), ratio = off / scale;
        if (std::abs(ratio) > 3) continue;
        const double robust = 1 / ((1 + ratio * ratio) * (1 + ratio * ratio));
        const double weight = robust * line.length_rad * line.length_rad;
        const Vector2d by(line.normal_c.dot(x), line.normal_c.dot(y));
        A += weight * by * by.transpose(), b -= weight * off * by;
        squares += weight * weight * off * off * by * by.transpose();
        found.lines += std::abs(ratio) < 1;
      }
      const Eigen::LDLT<Matrix2d> ldlt(A);
      if (found.lines < p.min_lines || !(A.determinant() > 0)) return std::nullopt;
      const Vector2d step = ldlt.solve(b);
      found.up_c = (found.up_c + step.x() * x + step.y() * y).normalized();
      if (found.up_c.dot(prior_up_c.normalized()) < std::cos(p.max_off_rad)) return std::nullopt;
    }
    if (last) break;
  }
  // Sandwich covariance from the residuals (White 1980), since far and short lines have larger errors than near and
  // long ones.
  const Matrix2d covariance = p.alike * A.inverse() * squares * A.inverse();
  found.sigma_rad = std::sqrt(std::max(covariance(0, 0), covariance(1, 1)));
  if (found.sigma_rad > p.max_sigma_rad) return std::nullopt;
  return found;
}

}  // namespace odograph::skyline
