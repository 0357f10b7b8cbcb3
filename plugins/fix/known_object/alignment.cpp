// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/known_object/alignment.hpp"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "plugins/shared/median.hpp"

namespace odograph::known_object {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

constexpr double kByMedian = 1.4826;  // ratio of a normal distribution's sigma to its median absolute deviation

float at(const cv::Mat& picture, double x, double y) {
  x = std::clamp(x, 0.0, picture.cols - 1.001), y = std::clamp(y, 0.0, picture.rows - 1.001);
  const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
  const auto wx = static_cast<float>(x - x0), wy = static_cast<float>(y - y0);
  const auto *a = picture.ptr<float>(y0) + x0, *b = picture.ptr<float>(y0 + 1) + x0;
  return (1 - wy) * ((1 - wx) * a[0] + wx * a[1]) + wy * ((1 - wx) * b[0] + wx * b[1]);
}

struct Correlation {
  double n = 0, x = 0, y = 0, xx = 0, yy = 0, xy = 0;
  void add(double a, double b) { n += 1, x += a, y += b, xx += a * a, yy += b * b, xy += a * b; }
  double variance_x() const { return n > 0 ? std::max(0.0, xx / n - x * x / (n * n)) : 0; }
  double variance_y() const { return n > 0 ? std::max(0.0, yy / n - y * y / (n * n)) : 0; }
  double value() const {
    const double v = variance_x() * variance_y();
    return v > 1e-12 ? (xy / n - x * y / (n * n)) / std::sqrt(v) : 0.0;
  }
};

}  // namespace

Pyramid::Pyramid(const PlaneObject& object) : width_m_(object.width_m), height_m_(object.height_m) {
  cv::Mat level;
  object.picture.convertTo(level, CV_32F);
  for (levels_.push_back(level); std::min(level.cols, level.rows) >= 8;) {
    cv::resize(level, level, {}, 0.5, 0.5, cv::INTER_AREA);
    levels_.push_back(level.clone());
  }
}

float Pyramid::seen(const Vector2d& at_m, const Matrix2d& pixel_m, double sigma_px) const {
  // 5 x 5 samples out to two sigma, each from the level whose texel size matches the sample spacing.
  const double texels_x = width() / width_m_, texels_y = height() / height_m_;
  const double along = std::hypot(pixel_m(0, 0) * texels_x, pixel_m(1, 0) * texels_y);
  const double across = std::hypot(pixel_m(0, 1) * texels_x, pixel_m(1, 1) * texels_y);
  const double level = std::floor(std::log2(std::max(1.0, 0.9 * sigma_px * std::min(along, across))));
  const auto l = std::min(static_cast<size_t>(level), levels_.size() - 1);
  const cv::Mat& picture = levels_[l];
  const double scale_x = picture.cols / width_m_, scale_y = picture.rows / height_m_;
  static constexpr double kWeights[5] = {0.1353, 0.6065, 1, 0.6065, 0.1353};
  double sum = 0, weights = 0;
  for (int j = 0; j < 5; ++j)
    for (int i = 0; i < 5; ++i) {
      const Vector2d p = at_m + sigma_px * (pixel_m * Vector2d(i - 2, j - 2));
      const double w = kWeights[i] * kWeights[j];
      sum += w * odograph::known_object::at(picture, (p.x() + 0.5 * width_m_) * scale_x - 0.5,
                                            (p.y() + 0.5 * height_m_) * scale_y - 0.5);
      weights += w;
    }
  return static_cast<float>(sum / weights);
}

Aligner::Frame::Frame(const cv::Mat& grey, const cv::Mat& frame_mask, const Parameters& parameters) : mask(frame_mask) {
  cv::Mat sharp;
  grey.convertTo(sharp, CV_32F);
  for (const double sigma : parameters.blur_px) {
    cv::Mat level;
    if (sigma > 0)
      cv::GaussianBlur(sharp, level, {0, 0}, sigma);
    else
      level = sharp;
    blurred.push_back(level);
  }
}

struct Aligner::Sample {
  Vector3d x_o;
  double expected;
};

/// Samples spread evenly over the object, with the grey value expected for each pixel.
std::vector<Aligner::Sample> Aligner::expected(const RollingLens& lens, const Pyramid& picture, const Pose& pose,
                                               double sigma_px) const {
  const double aspect = picture.width_m() / picture.height_m();
  // Not denser than the pixels.
  const auto middle = lens.project(pose * Vector3d(0, 0, 0));
  if (!middle) return {};
  const Eigen::Matrix<double, 2, 2> scale = middle->by_point * pose.R_c_o.leftCols<2>();
  const double area_px = std::abs(scale.determinant()) * picture.width_m() * picture.height_m();
  const double wanted = std::clamp(area_px, 16.0, static_cast<double>(p_.points));
  const int columns = std::max(4, static_cast<int>(std::lround(std::sqrt(wanted * aspect))));
  const int rows = std::max(4, static_cast<int>(std::lround(wanted / columns)));
  std::vector<Sample> samples;
  samples.reserve(static_cast<size_t>(columns * rows));
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      const Vector3d x_o(((i + 0.5) / columns - 0.5) * picture.width_m(), ((j + 0.5) / rows - 0.5) * picture.height_m(),
                         0);
      const auto seen = lens.project(pose * x_o);
      if (!seen) continue;
      const Matrix2d px_by_m = seen->by_point * pose.R_c_o.leftCols<2>();
      if (std::abs(px_by_m.determinant()) < 1e-3) continue;
      // Near its rim a blurred frame mixes the object with its surroundings.
      const double rim_x_m = std::min(0.2 * picture.width_m(), p_.rim * sigma_px / px_by_m.col(0).norm());
      const double rim_y_m = std::min(0.2 * picture.height_m(), p_.rim * sigma_px / px_by_m.col(1).norm());
      if (std::abs(x_o.x()) > 0.5 * picture.width_m() - rim_x_m ||
          std::abs(x_o.y()) > 0.5 * picture.height_m() - rim_y_m)
        continue;
      samples.push_back({x_o, picture.seen(x_o.head<2>(), px_by_m.inverse(), sigma_px)});
    }
  return samples;
}

/// Gain and offset from all samples, so that illumination does not bias the pose.
Aligner::Illumination Aligner::initial_illumination(const cv::Mat& grey, const RollingLens& lens,
                                                    const std::vector<Sample>& samples, const Pose& pose) {
  Correlation c;
  for (const Sample& s : samples) {
    const auto seen = lens.project(pose * s.x_o);
    if (seen && lens.is_inside(seen->pixel, 1)) c.add(s.expected, at(grey, seen->pixel.x(), seen->pixel.y()));
  }
  Illumination light;
  if (c.n < 8 || c.variance_x() < 1) return light;
  light.gain = std::max(0.1, c.value() * std::sqrt(c.variance_y() / c.variance_x()));
  light.offset = c.y / c.n - light.gain * c.x / c.n;
  return light;
}

struct Aligner::Equations {
  Eigen::Matrix<double, 10, 10> H = Eigen::Matrix<double, 10, 10>::Zero();
  Eigen::Matrix<double, 10, 1> g = Eigen::Matrix<double, 10, 1>::Zero();
  double cost = 0;                ///< weighted
  std::vector<double> residuals;  ///< absolute, of the visible samples

  void add(const Eigen::Matrix<double, 10, 1>& J, double r, double most) {
    const double w = std::abs(r) <= most ? 1.0 : most / std::abs(r);
    H += w * J * J.transpose();
    g += w * r * J;
    residuals.push_back(std::abs(r));
    cost += w * r * r;
  }
  Eigen::Matrix<double, 10, 1> step() const {
    Eigen::Matrix<double, 10, 10> damped = H;
    damped.diagonal() *= 1 + 1e-6;
    damped.diagonal().array() += 1e-9;
    return -damped.ldlt().solve(g);
  }
  /// Information of the pose, with the illumination marginalised.
  Eigen::Matrix<double, 6, 6> pose_information() const {
    return H.topLeftCorner<6, 6>() -
           H.topRightCorner<6, 4>() * H.bottomRightCorner<4, 4>().inverse() * H.bottomLeftCorner<4, 6>();
  }
};

Aligner::Equations Aligner::equations(const cv::Mat& grey, const cv::Mat& mask, const RollingLens& lens,
                                      const Pyramid& picture, const std::vector<Sample>& samples, const Pose& pose,
                                      const Illumination& light, double noise) const {
  Equations e;
  for (const Sample& s : samples) {
    const Vector3d p_c = pose * s.x_o;
    const auto seen = lens.project(p_c);
    if (!seen || !lens.is_inside(seen->pixel, p_.margin_px)) continue;
    const Vector2d& u = seen->pixel;
    if (!mask.empty() && mask.at<uint8_t>(static_cast<int>(u.y()), static_cast<int>(u.x())) == 0) continue;
    const double x = s.x_o.x() / picture.width_m(), y = s.x_o.y() / picture.height_m();
    const double model = light.gain * s.expected + light.offset + light.slope_x * x + light.slope_y * y;
    const double r = at(grey, u.x(), u.y()) - model;
    Eigen::RowVector2d gradient;
    gradient << 0.5 * (at(grey, u.x() + 1, u.y()) - at(grey, u.x() - 1, u.y())),
        0.5 * (at(grey, u.x(), u.y() + 1) - at(grey, u.x(), u.y() - 1));
    const Eigen::RowVector3d by_point = gradient * seen->by_point;
    Eigen::Matrix<double, 10, 1> J;
    J.head<3>() = p_c.cross(by_point.transpose());
    J.segment<3>(3) = by_point.transpose();
    J.tail<4>() << -s.expected, -1, -x, -y;
    e.add(J, r, p_.huber * noise);
  }
  return e;
}

bool Aligner::refine(const Frame& frame, size_t level, const RollingLens& lens, const Pyramid& picture,
                     Alignment& a) const {
  const cv::Mat& grey = frame.blurred[level];
  const double sigma_px = std::hypot(p_.lens_blur_px, p_.blur_px[level]);
  Illumination light;
  std::vector<Sample> samples;
  double noise = p_.first_noise_grey;
  bool settled = false;
  for (int iteration = 0; iteration < p_.iterations && !settled; ++iteration) {
    if (iteration % (p_.iterations / p_.rounds) == 0) samples = expected(lens, picture, a.pose, sigma_px);
    if (iteration == 0) light = initial_illumination(grey, lens, samples, a.pose);
    const Equations e = equations(grey, frame.mask, lens, picture, samples, a.pose, light, noise);
    a.visible_part =
        samples.empty() ? 0 : static_cast<double>(e.residuals.size()) / static_cast<double>(samples.size());
    if (a.visible_part < p_.min_visible || e.residuals.size() < p_.min_samples) return false;
    noise = std::max(p_.min_noise_grey, kByMedian * median(e.residuals));
    const Eigen::Matrix<double, 10, 1> step = e.step();
    if (!step.allFinite() || step.head<3>().norm() > p_.max_step_rad) return false;
    // Displacement of the object's corners by this step.
    const double depth = std::max(p_.nearest_m, a.pose.t_c_o.z());
    const double motion_px = lens.camera.focal() * (step.segment<3>(3).norm() / depth + step.head<3>().norm());
    a.pose = a.pose.moved(step.head<6>());
    if (a.pose.t_c_o.z() < p_.nearest_m) return false;
    light.gain += step[6], light.offset += step[7], light.slope_x += step[8], light.slope_y += step[9];
    settled = iteration > 1 && motion_px < p_.converged_px;
    const double variance = noise * noise * p_.correlated_points;
    a.cost = e.cost / variance, a.noise_grey = noise;
    a.information = e.pose_information() / variance;
  }
  if (light.gain < p_.min_gain) return false;
  if (level + 1 == p_.blur_px.size()) score(grey, frame.mask, lens, picture, samples, light, a);
  return true;
}

void Aligner::score(const cv::Mat& grey, const cv::Mat& mask, const RollingLens& lens, const Pyramid& picture,
                    const std::vector<Sample>& samples, const Illumination& light, Alignment& a) const {
  std::vector<Correlation> parts(static_cast<size_t>(p_.parts * p_.parts));
  Correlation whole;
  for (const Sample& s : samples) {
    const auto seen = lens.project(a.pose * s.x_o);
    if (!seen || !lens.is_inside(seen->pixel, 1)) continue;
    const Vector2d& u = seen->pixel;
    if (!mask.empty() && mask.at<uint8_t>(static_cast<int>(u.y()), static_cast<int>(u.x())) == 0) continue;
    const double x = s.x_o.x() / picture.width_m(), y = s.x_o.y() / picture.height_m();
    const double model = light.gain * s.expected, is = at(grey, u.x(), u.y()) - light.slope_x * x - light.slope_y * y;
    whole.add(model, is);
    const auto part = [&](double v) { return std::clamp(static_cast<int>((v + 0.5) * p_.parts), 0, p_.parts - 1); };
    parts[static_cast<size_t>(part(y) * p_.parts + part(x))].add(model, is);
  }
  a.correlation = whole.value();
  int patterned = 0, agreeing = 0;
  for (const Correlation& part : parts) {
    // Parts without a pattern, or with one below the noise, carry no information.
    const bool pattern = part.n >= 6 && part.variance_x() > std::max(0.04 * whole.variance_x(), 9.0);
    patterned += pattern;
    agreeing += pattern && part.value() >= p_.part_correlation;
  }
  a.agreeing_part = patterned > 0 ? static_cast<double>(agreeing) / patterned : 0.0;
  const auto middle = lens.project(a.pose.t_c_o);
  const Matrix2d scale = middle ? Matrix2d(middle->by_point * a.pose.R_c_o.leftCols<2>()) : Matrix2d(Matrix2d::Zero());
  a.side_px = std::sqrt(std::abs(scale.determinant()) * picture.width_m() * picture.height_m());
  const double facing = a.pose.R_c_o.col(2).dot(a.pose.t_c_o.normalized());
  a.oblique_rad = std::acos(std::clamp(facing, -1.0, 1.0));
}

std::optional<Alignment> Aligner::align(const Frame& frame, const RollingLens& lens, const Pyramid& picture,
                                        const Pose& start, bool fine) const {
  Alignment a;
  a.pose = start;
  for (size_t level = fine ? p_.blur_px.size() - 2 : 0; level < p_.blur_px.size(); ++level)
    if (!refine(frame, level, lens, picture, a)) return {};
  if (a.oblique_rad > p_.max_oblique_rad) return {};
  return a;
}

}  // namespace odograph::known_object
