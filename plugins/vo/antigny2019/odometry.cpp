// SPDX-License-Identifier: Apache-2.0
#include "plugins/vo/antigny2019/odometry.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <utility>

#include <opencv2/calib3d.hpp>

#include "plugins/shared/median.hpp"

namespace odograph::antigny2019 {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

cv::UsacParams msac(double threshold) {
  cv::UsacParams params;
  params.confidence = 0.999;
  params.maxIterations = 2000;
  params.score = cv::SCORE_METHOD_MSAC;
  params.loMethod = cv::LOCAL_OPTIM_INNER_LO;
  params.sampler = cv::SAMPLING_UNIFORM;
  params.threshold = threshold;
  params.randomGeneratorState = 1;  // fixed seed: identical pictures give identical results
  return params;
}

Matrix3d matrix(const cv::Mat& m) {
  Matrix3d out;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) out(i, j) = m.at<double>(i, j);
  return out;
}

Vector3d ray(const cv::Point2d& ideal, double f) { return {ideal.x / f, ideal.y / f, 1}; }

/// Midpoint of the closest approach of two rays, in the first's frame; nothing if it is behind one of the cameras.
std::optional<Vector3d> meet(const Vector3d& u, const Vector3d& v_in_second, const Isometry3d& T_1_2) {
  const Vector3d v = T_1_2.linear() * v_in_second, t = T_1_2.translation();
  const double uu = u.dot(u), vv = v.dot(v), uv = u.dot(v), det = uu * vv - uv * uv;
  if (det < 1e-12 * uu * vv) return std::nullopt;
  const double x = (vv * u.dot(t) - uv * v.dot(t)) / det, y = (uv * u.dot(t) - uu * v.dot(t)) / det;
  if (x <= 0 || y <= 0) return std::nullopt;
  return 0.5 * (x * u + t + y * v);
}

}  // namespace

Odometry::Odometry(const Parameters& parameters, const CameraModel& camera, cv::Size size)
    : p_(parameters),
      camera_(camera),
      size_(size),
      f_(camera.focal()),
      finder_(FeatureFinder::make(parameters.features, parameters.most)) {}

Odometry::Picture Odometry::look(const cv::Mat& grey, const cv::Mat& mask) {
  Picture picture;
  picture.features = sparse(finder_->find(grey, mask), size_, p_.cell_px, p_.in_a_cell);
  camera_.undistort(picture.features.pixels, picture.ideal);
  for (auto& p : picture.ideal) {
    p *= f_;
    picture.tracks.push_back(next_track_++);
  }
  return picture;
}

std::optional<Odometry::EpipolarPair> Odometry::epipolar(const Picture& a, const Picture& b,
                                                         const std::vector<std::pair<int, int>>& pairs) const {
  if (pairs.size() < p_.min_inliers) return std::nullopt;
  std::vector<cv::Point2d> first, second;
  for (const auto& [i, j] : pairs)
    first.push_back(a.ideal[static_cast<size_t>(i)]), second.push_back(b.ideal[static_cast<size_t>(j)]);
  const cv::Matx33d K(f_, 0, 0, 0, f_, 0, 0, 0, 1);
  cv::Mat mask, R, t;
  const cv::Mat E = cv::findEssentialMat(first, second, K, K, cv::noArray(), cv::noArray(), mask, msac(p_.inlier_px));
  if (E.rows != 3 || E.cols != 3) return std::nullopt;
  cv::recoverPose(E, first, second, K, R, t, 1e4, mask);
  EpipolarPair out;
  Isometry3d T_1_0 = Isometry3d::Identity();
  T_1_0.linear() = matrix(R);
  T_1_0.translation() = Vector3d(t.at<double>(0), t.at<double>(1), t.at<double>(2));
  out.T_0_1 = T_1_0.inverse();
  std::vector<double> parallax;
  for (size_t k = 0; k < pairs.size(); ++k) {
    if (!mask.at<uint8_t>(static_cast<int>(k))) continue;
    out.inliers.push_back(pairs[k]);
    const Vector3d turned = T_1_0.linear() * ray(first[k], f_);
    parallax.push_back(
        std::hypot(f_ * turned.x() / turned.z() - second[k].x, f_ * turned.y() / turned.z() - second[k].y));
  }
  if (out.inliers.size() < p_.min_inliers) return std::nullopt;
  out.parallax_px = median(std::move(parallax));
  return out;
}

/// Triangulates the points of a and b that are matched again, and estimates the pose from them by PnP.
bool Odometry::estimate_pose(const Picture& now, const std::vector<std::pair<int, int>>& pairs, Isometry3d& T_b_c,
                             Motion& motion) const {
  std::unordered_map<int, int> in_a;
  for (const auto& [i, j] : ab_) in_a[j] = i;
  std::vector<cv::Point3d> world;
  std::vector<cv::Point2d> image;
  // In units of the displacement from a to b: the solver's thresholds are absolute, and the scale of a group drifts.
  Isometry3d T_b_a = T_a_b_.inverse();
  T_b_a.translation() /= scale_;
  for (const auto& [j, k] : pairs) {
    const auto found = in_a.find(j);
    if (found == in_a.end()) continue;
    const auto X =
        meet(ray(b_->ideal[static_cast<size_t>(j)], f_), ray(a_->ideal[static_cast<size_t>(found->second)], f_), T_b_a);
    if (!X) continue;
    world.emplace_back(X->x(), X->y(), X->z());
    image.push_back(now.ideal[static_cast<size_t>(k)]);
  }
  if (world.size() < p_.min_inliers) return false;
  cv::Mat K = (cv::Mat_<double>(3, 3) << f_, 0, 0, 0, f_, 0, 0, 0, 1), r, t, inliers;
  if (!cv::solvePnPRansac(world, image, K, cv::noArray(), r, t, inliers, msac(2 * p_.inlier_px))) return false;
  if (inliers.total() < p_.min_inliers || 2 * inliers.total() < world.size()) return false;
  std::vector<cv::Point3d> good_world;
  std::vector<cv::Point2d> good_image;
  for (size_t k = 0; k < inliers.total(); ++k) {
    const auto i = static_cast<size_t>(inliers.at<int>(static_cast<int>(k)));
    good_world.push_back(world[i]), good_image.push_back(image[i]);
  }
  cv::solvePnPRefineLM(good_world, good_image, K, cv::noArray(), r, t);
  cv::Mat R;
  cv::Rodrigues(r, R);
  Isometry3d T_c_b = Isometry3d::Identity();
  T_c_b.linear() = matrix(R);
  T_c_b.translation() = Vector3d(t.at<double>(0), t.at<double>(1), t.at<double>(2));
  // Rejects a pose whose displacement is many times the last one, or whose rotation is close to half a circle.
  if (T_c_b.translation().norm() > 10) return false;
  if (Eigen::AngleAxisd(T_c_b.linear()).angle() > 0.6) return false;
  T_b_c = T_c_b.inverse();
  T_b_c.translation() *= scale_;
  double depth = 0;
  for (const auto& X : good_world) depth += scale_ * X.z;
  motion.inliers = static_cast<unsigned>(inliers.total());
  motion.rotation_sigma_rad = p_.inlier_px / f_ / std::sqrt(static_cast<double>(good_world.size()));
  motion.position_sigma = motion.rotation_sigma_rad * depth / static_cast<double>(good_world.size());
  return true;
}

/// The tracks of t-1 continue in the inliers of this picture.
void Odometry::follow(const std::vector<std::pair<int, int>>& inliers, Picture& now) {
  std::vector<char> used(now.tracks.size(), 0);
  for (const auto& [j, k] : inliers)
    now.tracks[static_cast<size_t>(k)] = b_->tracks[static_cast<size_t>(j)], used[static_cast<size_t>(k)] = 1;
  corners_.clear();
  for (size_t i = 0; i < now.tracks.size(); ++i) {
    const cv::Point2f& pixel = now.features.pixels[i];
    corners_.push_back({now.tracks[i], ray(now.ideal[i], f_), Vector3d::Zero(), {pixel.x, pixel.y}, used[i] != 0});
  }
}

Motion Odometry::process(const cv::Mat& grey, const cv::Mat& mask) {
  Motion motion;
  Picture now = look(grey, mask);
  if (!b_) {
    b_ = std::move(now);
    return motion;
  }
  const auto pairs = match(b_->features, now.features, p_.ratio);
  motion.matches = static_cast<unsigned>(pairs.size());
  const auto pair = epipolar(*b_, now, pairs);
  follow(pair ? pair->inliers : std::vector<std::pair<int, int>>{}, now);
  Isometry3d T_b_c = T_b_before_;
  bool located = false;
  unsigned next_group = group_;
  if (pair) {
    motion.inliers = static_cast<unsigned>(pair->inliers.size());
    located = a_ && estimate_pose(now, pair->inliers, T_b_c, motion);
    const bool parallax = pair->parallax_px > p_.parallax_px;
    if (!located) {  // the rotation is valid; the displacement only if it can start a new scale group
      T_b_c.linear() = pair->T_0_1.linear();
      motion.rotation_sigma_rad = p_.inlier_px / f_ / std::sqrt(static_cast<double>(pair->inliers.size()));
    }
    if (!located && parallax) {
      if (a_) next_group = ++group_;
      T_b_c.translation() = pair->T_0_1.translation();  // the group's unit of length
      motion.position_sigma = 0.1;
      located = true;
    }
    motion.outcome = located ? Outcome::tracking : Outcome::no_parallax;
    motion.rotation_valid = true;
    motion.translation_valid = located;
    motion.T_c0_c1 = T_b_before_.inverse() * T_b_c;
    if (located && parallax) {
      a_ = std::move(b_), b_ = std::move(now);
      ab_ = pair->inliers;
      T_a_b_ = T_b_c;
      scale_ = T_a_b_.translation().norm();
      if (scale_ > p_.max_drift || scale_ * p_.max_drift < 1)
        T_a_b_.translation() /= scale_, scale_ = 1, next_group = group_ + 1;
      T_b_before_.setIdentity();
      last_.reset();
    } else {
      T_b_before_ = T_b_c;
      last_ = std::move(now);
    }
  } else {  // no common points
    last_ = std::move(now);
    restart();
    next_group = group_;
  }
  motion.scale_group = std::exchange(group_, next_group);
  return motion;
}

void Odometry::restart() {
  if (!b_) return;
  if (last_) b_ = std::move(last_);
  last_.reset(), a_.reset(), ab_.clear();
  T_b_before_.setIdentity();
  scale_ = 1.0;
  ++group_;
}

}  // namespace odograph::antigny2019
