// SPDX-License-Identifier: Apache-2.0
#include "plugins/vo/gakne2018/sky_odometry.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <utility>

#include <Eigen/Dense>

#include "sdk/math/rotation.hpp"

namespace odograph::gakne2018 {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kFar = 1e3;  // for a point that does not meet the plane

/// The rigid motion with the most inliers, and these inliers.
std::vector<double> ransac(const std::vector<Vector2d>& p, const std::vector<Vector2d>& q,
                           const SkyOdometry::Parameters& parameters, double max_rotation) {
  const double threshold = parameters.inlier_rad;
  std::minstd_rand random(1);  // fixed seed: identical pictures give identical results
  std::vector<double> best(p.size(), 0.0);
  size_t most = 0;
  for (int trial = 0; trial < parameters.trials; ++trial) {
    const size_t i = random() % p.size(), j = random() % p.size();
    const Vector2d a = p[j] - p[i], b = q[j] - q[i];
    if (a.norm() < parameters.apart || std::abs(a.norm() - b.norm()) > 2 * threshold) continue;
    const double rotation_rad =
        std::clamp(std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b)), -max_rotation, max_rotation);
    const Matrix2d R = Eigen::Rotation2Dd(rotation_rad).toRotationMatrix();
    const Vector2d T = 0.5 * (q[i] + q[j] - R * (p[i] + p[j]));
    std::vector<double> in(p.size(), 0.0);
    size_t count = 0;
    for (size_t k = 0; k < p.size(); ++k)
      if ((R * p[k] + T - q[k]).squaredNorm() < threshold * threshold) in[k] = 1.0, ++count;
    if (count > most) most = count, best.swap(in);
  }
  return best;
}

/// The same with its rotation limited to `max_rotation`.
Rigid2d limited(Rigid2d rigid, const std::vector<Vector2d>& p, const std::vector<Vector2d>& q,
                const std::vector<double>& weights, double max_rotation) {
  const double rotation_rad = std::atan2(rigid.R(1, 0), rigid.R(0, 0));
  if (std::abs(rotation_rad) <= max_rotation) return rigid;
  rigid.R = Eigen::Rotation2Dd(std::copysign(max_rotation, rotation_rad)).toRotationMatrix();
  double total = 0;
  rigid.T.setZero();
  for (size_t i = 0; i < p.size(); ++i) total += weights[i], rigid.T += weights[i] * (q[i] - rigid.R * p[i]);
  rigid.T /= total;
  return rigid;
}

}  // namespace

Rigid2d rigid_motion(const std::vector<Vector2d>& p, const std::vector<Vector2d>& q,
                     const std::vector<double>& weights) {
  double total = 0;
  Vector2d p0 = Vector2d::Zero(), q0 = Vector2d::Zero();
  for (size_t i = 0; i < p.size(); ++i) total += weights[i], p0 += weights[i] * p[i], q0 += weights[i] * q[i];
  if (total <= 0) return {};
  p0 /= total, q0 /= total;
  Matrix2d S = Matrix2d::Zero();
  for (size_t i = 0; i < p.size(); ++i) S += weights[i] * (p[i] - p0) * (q[i] - q0).transpose();
  const Eigen::JacobiSVD<Matrix2d> svd(S, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double side = (svd.matrixV() * svd.matrixU().transpose()).determinant();
  Rigid2d motion;
  motion.R = svd.matrixV() * Vector2d(1, side).asDiagonal() * svd.matrixU().transpose();
  motion.T = q0 - motion.R * p0;
  return motion;
}

Eigen::Quaterniond levelled(const Vector3d& up_c) {
  const Eigen::Quaterniond upright(0, 1, 0, 0);  // x of the picture remains x
  return (shortest_rotation(upright * up_c, -Vector3d::UnitZ()) * upright).normalized();
}

Height height_of(const Vector2d& flow, const Vector2d& T, double flow_sigma, double height_sigma) {
  const double information = T.squaredNorm() / (flow_sigma * flow_sigma);
  const double prior = 1 / (height_sigma * height_sigma);
  const double inverse = (prior + T.dot(flow) / (flow_sigma * flow_sigma)) / (prior + information);
  const double sigma = 1 / std::sqrt(prior + information);
  const double bounded = std::max(inverse, sigma);  // a point that moves against the fit is far, not below
  return {1 / bounded, sigma / bounded};
}

SkyOdometry::SkyOdometry(const Parameters& parameters, const CameraModel& camera)
    : p_(parameters), camera_(camera), orb_(cv::ORB::create(parameters.features)), matcher_(cv::NORM_HAMMING, true) {}

SkyOdometry::Picture SkyOdometry::detect(const cv::Mat& grey, const cv::Mat& mask, const Eigen::Quaterniond& q_l_c) {
  Picture now;
  now.q_l_c = q_l_c;
  orb_->detectAndCompute(grey, mask, now.keypoints, now.descriptors);
  std::vector<cv::Point2f> pixels;
  for (const auto& keypoint : now.keypoints) pixels.push_back(keypoint.pt);
  std::vector<cv::Point2d> normalized;
  camera_.undistort(pixels, normalized);
  for (const auto& n : normalized) {
    const Vector3d ray = q_l_c * Vector3d(n.x, n.y, 1).normalized();
    now.on_plane.push_back(ray.z() < -p_.lowest ? Vector2d(ray.head<2>() / -ray.z()) : Vector2d(kFar, kFar));
  }
  now.tracks.assign(now.keypoints.size(), {});
  return now;
}

std::vector<SkyOdometry::Pair> SkyOdometry::matches(const Picture& now) {
  std::vector<Pair> pairs;
  if (before_.descriptors.empty() || now.descriptors.empty()) return pairs;
  std::vector<cv::DMatch> matches;
  matcher_.match(before_.descriptors, now.descriptors, matches);
  for (const auto& match : matches) {
    const auto i = static_cast<size_t>(match.queryIdx), j = static_cast<size_t>(match.trainIdx);
    const Vector2d &a = before_.on_plane[i], &b = now.on_plane[j];
    if (a.x() < kFar && b.x() < kFar && match.distance < p_.max_distance && (a - b).norm() < p_.near)
      pairs.push_back({i, j});
  }
  return pairs;
}

Motion SkyOdometry::process(const cv::Mat& grey, const cv::Mat& mask, const Eigen::Quaterniond& q_l_c,
                            double max_rotation) {
  Picture now = detect(grey, mask, q_l_c);
  const std::vector<Pair> pairs = matches(now);
  std::vector<Vector2d> p, q;
  for (const Pair& pair : pairs) p.push_back(before_.on_plane[pair.before]), q.push_back(now.on_plane[pair.now]);
  Motion motion;
  points_.clear();
  motion.matches = static_cast<unsigned>(p.size());
  if (p.size() >= p_.min_inliers) {
    std::vector<double> weights = ransac(p, q, p_, max_rotation);
    motion.inliers = static_cast<unsigned>(std::count(weights.begin(), weights.end(), 1.0));
    if (motion.inliers >= p_.min_inliers) {
      const std::vector<double> inlier = weights;
      Rigid2d rigid;
      double square = 0;
      for (int iteration = 0; iteration < 5; ++iteration) {
        rigid = rigid_motion(p, q, weights);
        rigid = limited(rigid, p, q, weights, max_rotation);
        square = 0;
        for (size_t i = 0; i < p.size(); ++i) {
          const double error = (rigid.R * p[i] + rigid.T - q[i]).norm();
          weights[i] = inlier[i] * std::min(1.0, p_.huber_part * p_.inlier_rad / std::max(error, 1e-9));
          square += inlier[i] * error * error;
        }
      }
      // The points move by R and T, the camera by the inverse.
      const double rotation_rad = std::atan2(rigid.R(1, 0), rigid.R(0, 0));
      const Eigen::Quaterniond q_l0_l1(Eigen::AngleAxisd(-rotation_rad, Vector3d::UnitZ()));
      const Vector2d displacement = -rigid.R.transpose() * rigid.T;
      motion.q_c0_c1 = (before_.q_l_c.conjugate() * q_l0_l1 * now.q_l_c).normalized();
      motion.p_c0_c1 = before_.q_l_c.conjugate() * Vector3d(displacement.x(), displacement.y(), 0);
      motion.position_sigma = std::sqrt(square / motion.inliers) / std::sqrt(static_cast<double>(motion.inliers));
      motion.rotation_sigma_rad = 2 * motion.position_sigma;
      motion.valid = true;
      locate(pairs, inlier, rigid, now);
    }
  }
  for (Picture::Track& track : now.tracks)
    if (track.age == 0) track = {next_id_++, 1};
  before_ = std::move(now);
  return motion;
}

void SkyOdometry::locate(const std::vector<Pair>& pairs, const std::vector<double>& inlier, const Rigid2d& rigid,
                         Picture& now) {
  for (size_t i = 0; i < pairs.size(); ++i) {
    if (inlier[i] == 0) continue;
    const Picture::Track& track = before_.tracks[pairs[i].before];
    now.tracks[pairs[i].now] = {track.id, track.age + 1};
    const Vector2d &p = before_.on_plane[pairs[i].before], &q = now.on_plane[pairs[i].now];
    const double slant = 1 + q.squaredNorm();  // of the plane against the picture's ray: errors on it grow
    const Height height =
        height_of(q - rigid.R * p, rigid.T, std::numbers::sqrt2 * p_.match_sigma * slant, p_.height_sigma);
    points_.push_back({.id = now.tracks[pairs[i].now].id,
                       .age = now.tracks[pairs[i].now].age,
                       .pixel = now.keypoints[pairs[i].now].pt,
                       .p_c = now.q_l_c.conjugate() * (height.value * Vector3d(q.x(), q.y(), -1)),
                       .relative_sigma = height.relative_sigma,
                       .ray_sigma_rad = p_.match_sigma});
  }
  std::sort(points_.begin(), points_.end(),
            [](const SkyPoint& a, const SkyPoint& b) { return a.relative_sigma < b.relative_sigma; });
}

}  // namespace odograph::gakne2018
