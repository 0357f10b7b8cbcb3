// SPDX-License-Identifier: Apache-2.0
#include "sdk/math/rotation.hpp"
#include "sdk/math/time.hpp"
#include "sdk/tools/calibration/camera_imu_start.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>
#include <ceres/jet.h>

namespace odograph {
namespace {

using Eigen::Matrix3d, Eigen::Quaterniond, Eigen::Vector2d, Eigen::Vector3d;

constexpr double kBetween_s = 0.1;   // spacing of the compared frames: small rotations, corners still visible
constexpr double kCoarse_s = 0.004;  // step of the search; hands change their rotation within 0.1 s and more
constexpr double kFine_s = 0.0005;
constexpr int kReweighted = 5;
constexpr size_t kMaxPairs = 1000, kMinPairs = 40;
constexpr double kMinCorrelation = 0.5;  // chance correlation is below 0.2 (some hundred pairs)

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Proper rotation R that minimises sum |a - R b|^2, from M = sum a b^T.
Matrix3d nearest_rotation(const Matrix3d& M) {
  const Eigen::JacobiSVD<Matrix3d> svd(M, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double side = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
  return svd.matrixU() * Vector3d(1, 1, side).asDiagonal() * svd.matrixV().transpose();
}

/// Rotation vector q_c0_c1 of a pair, from its corners only.
Vector3d seen_rotation(const CameraImuData& data, const FramePair& pair) {
  std::vector<Vector3d> a, b;
  for (const auto& [i, k] : pair.corners) {
    a.push_back(ray_of(data.given, data.frames[pair.first].pixels[i]).ray.homogeneous().normalized());
    b.push_back(ray_of(data.given, data.frames[pair.second].pixels[k]).ray.homogeneous().normalized());
  }
  std::vector<double> left(a.size(), 0.0);
  Matrix3d R = Matrix3d::Identity();
  double scale = 1;
  for (int pass = 0; pass < kReweighted; ++pass) {
    Matrix3d M = Matrix3d::Zero();
    for (size_t i = 0; i < a.size(); ++i) M += a[i] * b[i].transpose() / (1 + std::pow(left[i] / scale, 2));
    R = nearest_rotation(M);
    for (size_t i = 0; i < a.size(); ++i) left[i] = (a[i] - R * b[i]).norm();
    scale = std::max(1e-5, median(left));
  }
  return log_rotation(Quaterniond(R));
}

struct Seen {
  double from_s, to_s;  ///< camera's clock, after the first IMU sample
  Vector3d rate_c;      ///< rad/s
};

struct Match {
  Matrix3d R_b_c = Matrix3d::Identity();
  Vector3d bias_b = Vector3d::Zero();
  double cost = INFINITY;  ///< robust, of the part of the camera's rotation not explained by the gyroscope
  double correlation = 0;
};

/// Best mount and bias for one time offset.
Match match_at(const std::vector<Seen>& seen, const GyroOrientation& gyro, double offset_s) {
  std::vector<Vector3d> g(seen.size());
  std::vector<double> left(seen.size(), 0.0);
  for (size_t i = 0; i < seen.size(); ++i)
    g[i] = log_rotation(gyro.at(seen[i].from_s + offset_s).conjugate() * gyro.at(seen[i].to_s + offset_s)) /
           (seen[i].to_s - seen[i].from_s);
  Match match;
  double scale = 1;
  for (int pass = 0; pass < kReweighted; ++pass) {
    double sum = 0;
    Vector3d mean_g = Vector3d::Zero(), mean_c = Vector3d::Zero();
    std::vector<double> weight(seen.size());
    for (size_t i = 0; i < seen.size(); ++i) {
      weight[i] = 1 / (1 + std::pow(left[i] / scale, 2));
      sum += weight[i], mean_g += weight[i] * g[i], mean_c += weight[i] * seen[i].rate_c;
    }
    mean_g /= sum, mean_c /= sum;
    Matrix3d M = Matrix3d::Zero();
    double gg = 0, cc = 0;
    for (size_t i = 0; i < seen.size(); ++i) {
      const Vector3d dg = g[i] - mean_g, dc = seen[i].rate_c - mean_c;
      M += weight[i] * dg * dc.transpose();
      gg += weight[i] * dg.squaredNorm(), cc += weight[i] * dc.squaredNorm();
    }
    match.R_b_c = nearest_rotation(M);
    match.bias_b = mean_g - match.R_b_c * mean_c;
    match.correlation = (match.R_b_c.transpose() * M).trace() / std::sqrt(std::max(1e-300, gg * cc));
    for (size_t i = 0; i < seen.size(); ++i) left[i] = (g[i] - match.bias_b - match.R_b_c * seen[i].rate_c).norm();
    scale = std::max(1e-4, median(left));
  }
  match.cost = scale;
  return match;
}

}  // namespace

LensRay ray_of(const odo_calibration& lens, const cv::Point2f& pixel) {
  // Newton's method from the undistorted ray; derivatives by the lens from the implicit function theorem.
  using Jet = ceres::Jet<double, 6>;
  const Lens model = lens.model == ODO_CAMERA_KANNALA_BRANDT ? Lens::kannala_brandt : Lens::pinhole;
  Jet parameters[12] = {};
  parameters[0] = Jet(lens.fx), parameters[1] = Jet(lens.fy);
  parameters[0].v[2] = lens.fx, parameters[1].v[2] = lens.fy;
  parameters[2] = Jet(lens.cx, 3), parameters[3] = Jet(lens.cy, 4);
  for (size_t i = 0; i < 8; ++i) parameters[4 + i] = Jet(lens.distortion[i]);
  parameters[4].v[5] = 1;
  const Vector2d measured(pixel.x, pixel.y);
  LensRay out;
  out.ray = {(measured.x() - lens.cx) / lens.fx, (measured.y() - lens.cy) / lens.fy};
  for (int step = 0; step < 20; ++step) {
    const auto modelled = project(model, parameters, 8, Jet(out.ray.x(), 0), Jet(out.ray.y(), 1));
    Eigen::Matrix2d by_ray;
    Eigen::Matrix<double, 2, 4> by_lens;
    for (int i = 0; i < 2; ++i) {
      const Jet& of = modelled[static_cast<size_t>(i)];
      by_ray.row(i) = of.v.head<2>(), by_lens.row(i) = of.v.tail<4>();
    }
    const Eigen::Matrix2d inverse = by_ray.inverse();
    out.by_lens = -inverse * by_lens;
    const Vector2d move = inverse * (measured - Vector2d(modelled[0].a, modelled[1].a));
    if (!move.allFinite()) break;
    out.ray += move;
    if (move.squaredNorm() < 1e-20) break;
  }
  return out;
}

std::vector<FramePair> pairs_of(const std::vector<TrackedFrame>& frames, double apart_s, size_t most, size_t fewest) {
  std::vector<FramePair> pairs;
  const size_t stride = std::max<size_t>(1, (frames.size() + most - 1) / std::max<size_t>(1, most));
  for (size_t i = 0; i < frames.size(); i += stride) {
    const auto wanted_ns = frames[i].t_ns + nanoseconds(apart_s);
    size_t k = i + 1;
    while (k + 1 < frames.size() && std::abs(frames[k + 1].t_ns - wanted_ns) <= std::abs(frames[k].t_ns - wanted_ns))
      ++k;
    if (k >= frames.size() || frames[k].t_ns - frames[i].t_ns > static_cast<int64_t>(2e9 * apart_s)) continue;
    FramePair pair{.first = i, .second = k, .corners = {}};
    for (size_t a = 0, b = 0; a < frames[i].ids.size() && b < frames[k].ids.size();) {
      if (frames[i].ids[a] == frames[k].ids[b])
        pair.corners.emplace_back(a++, b++);
      else
        ++(frames[i].ids[a] < frames[k].ids[b] ? a : b);
    }
    if (pair.corners.size() >= fewest) pairs.push_back(std::move(pair));
  }
  return pairs;
}

Result<CameraImuStart> find_camera_imu_start(const CameraImuData& data, const GyroOrientation& gyro,
                                             const CameraImuOptions& options) {
  const double around_s =
      data.given.header.flags & ODO_CALIBRATION_TIME_OFFSET ? seconds(data.given.time_offset_ns) : 0;
  std::vector<Seen> seen;
  for (const FramePair& pair : pairs_of(data.frames, kBetween_s, kMaxPairs, options.min_corners)) {
    const double from = gyro.seconds(data.frames[pair.first].t_ns), to = gyro.seconds(data.frames[pair.second].t_ns);
    if (!gyro.covers(from + around_s - options.search_s, to + around_s + options.search_s, options.gap_s)) continue;
    seen.push_back({from, to, seen_rotation(data, pair) / (to - from)});
  }
  if (seen.size() < kMinPairs)
    return Failure{ODO_E_DATA,
                   "pairs of frames with enough corners and IMU samples around them: " + std::to_string(seen.size()) +
                       "; at least " + std::to_string(kMinPairs) + " are needed, half a minute is good"};
  CameraImuStart start{.q_b_c = {}, .time_offset_s = around_s, .bias_b = {}, .correlation = 0, .across_rps = 0};
  Match best;
  for (const bool fine : {false, true}) {
    const double middle = start.time_offset_s, half = fine ? kCoarse_s : options.search_s;
    const double step = fine ? kFine_s : kCoarse_s;
    for (int k = -static_cast<int>(half / step); k <= static_cast<int>(half / step); ++k) {
      const Match match = match_at(seen, gyro, middle + k * step);
      if (match.cost >= best.cost) continue;
      best = match;
      start.time_offset_s = middle + k * step;
    }
  }
  start.q_b_c = Quaterniond(best.R_b_c);
  start.bias_b = best.bias_b, start.correlation = best.correlation;
  for (const Seen& s : seen) {
    const double from = s.from_s + start.time_offset_s, to = s.to_s + start.time_offset_s;
    const Vector3d g = log_rotation(gyro.at(from).conjugate() * gyro.at(to)) / (to - from) - best.bias_b;
    start.across_rps += (best.R_b_c.transpose() * g).head<2>().squaredNorm();
  }
  start.across_rps = std::sqrt(start.across_rps / static_cast<double>(seen.size()));
  if (best.correlation < kMinCorrelation)
    return Failure{ODO_E_DATA, "the rotation of the pictures does not match the gyroscope's (correlation " +
                                   std::to_string(best.correlation).substr(0, 4) +
                                   "): are they of one recording, is the focal length about right, is there enough to "
                                   "see, is the time offset within the search?"};
  return start;
}

}  // namespace odograph
