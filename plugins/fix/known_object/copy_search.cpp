// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/known_object/copy_search.hpp"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

namespace odograph::known_object {

using Eigen::Vector3d;

namespace {

/// Correlation of the object with the valid part of `flat` under it, its corner at (x, y).
struct Likeness {
  double value = 0, part = 0;
};

Likeness likeness_at(const cv::Mat& flat, const cv::Mat& valid, const cv::Mat& object, int x, int y) {
  double n = 0, a = 0, b = 0, aa = 0, bb = 0, ab = 0;
  for (int j = std::max(0, -y); j < std::min(object.rows, flat.rows - y); ++j) {
    const auto *o = object.ptr<float>(j), *f = flat.ptr<float>(y + j), *v = valid.ptr<float>(y + j);
    for (int i = std::max(0, -x); i < std::min(object.cols, flat.cols - x); ++i) {
      if (v[x + i] == 0) continue;
      const double p = o[i], q = f[x + i];
      n += 1, a += p, b += q, aa += p * p, bb += q * q, ab += p * q;
    }
  }
  Likeness l;
  l.part = n / static_cast<double>(object.rows * object.cols);
  if (n < 8) return l;
  const double va = aa / n - a * a / (n * n), vb = bb / n - b * b / (n * n);
  if (va > 1e-9 && vb > 1e-9) l.value = (ab / n - a * b / (n * n)) / std::sqrt(va * vb);
  return l;
}

}  // namespace

CopySearch::CopySearch(const Parameters& parameters, const std::vector<PlaneObject>& objects) : p_(parameters) {
  for (const PlaneObject& o : objects) {
    const double cell_m = std::min(o.width_m, o.height_m) / p_.object_cells;
    const cv::Size size(static_cast<int>(std::lround(o.width_m / cell_m)),
                        static_cast<int>(std::lround(o.height_m / cell_m)));
    cv::Mat small, values;
    cv::resize(o.picture, small, size, 0, 0, cv::INTER_AREA);
    small.convertTo(values, CV_32F);
    templates_.push_back({normalised(values, cv::Mat(size, CV_32F, cv::Scalar(1)), p_.flatten * p_.object_cells),
                          o.width_m / size.width, o.height_m / size.height});
  }
}

cv::Mat CopySearch::normalised(const cv::Mat& values, const cv::Mat& valid, double sigma_cells) const {
  const auto mean = [&](const cv::Mat& of) {
    cv::Mat sum, weight;
    cv::GaussianBlur(of.mul(valid), sum, {0, 0}, sigma_cells, sigma_cells, cv::BORDER_CONSTANT);
    cv::GaussianBlur(valid, weight, {0, 0}, sigma_cells, sigma_cells, cv::BORDER_CONSTANT);
    return cv::Mat(sum / (weight + 1e-6));
  };
  const cv::Mat off = values - mean(values);
  cv::Mat contrast;
  cv::sqrt(mean(off.mul(off)), contrast);
  return off / (contrast + p_.contrast_grey);
}

std::optional<CopySearch::Rectified> CopySearch::rectify(const Template& known, const cv::Mat& grey,
                                                         const cv::Mat& mask, const RollingLens& lens,
                                                         const Pose& pose) const {
  const cv::Mat& object = known.flat;
  // Room for a copy beyond the widest gap on each side.
  const cv::Point reach(static_cast<int>(std::lround((1 + p_.max_gap + p_.reach) * object.cols)),
                        static_cast<int>(std::lround((1 + p_.max_gap + p_.reach) * object.rows)));
  const cv::Size size(object.cols + 2 * reach.x, object.rows + 2 * reach.y);
  const auto middle = lens.project(pose.t_c_o);
  if (!middle) return std::nullopt;
  const Eigen::Matrix2d px_by_m = middle->by_point * pose.R_c_o.leftCols<2>();
  const double cell_px = std::sqrt(std::abs(px_by_m.determinant()) * known.cell_x_m * known.cell_y_m);
  cv::Mat smooth;
  cv::GaussianBlur(grey, smooth, {0, 0}, std::max(0.3, p_.blur * cell_px));
  cv::Mat map(size, CV_32FC2, cv::Scalar(-1, -1)), valid(size, CV_32F, cv::Scalar(0));
  for (int j = 0; j < size.height; ++j)
    for (int i = 0; i < size.width; ++i) {
      const Vector3d x_o((i + 0.5 - 0.5 * size.width) * known.cell_x_m, (j + 0.5 - 0.5 * size.height) * known.cell_y_m,
                         0);
      const auto seen = lens.project(pose * x_o);
      if (!seen || !lens.is_inside(seen->pixel, 1)) continue;
      const cv::Point at(static_cast<int>(seen->pixel.x()), static_cast<int>(seen->pixel.y()));
      if (!mask.empty() && mask.at<uint8_t>(at) == 0) continue;
      map.at<cv::Vec2f>(j, i) = {static_cast<float>(seen->pixel.x()), static_cast<float>(seen->pixel.y())};
      valid.at<float>(j, i) = 1;
    }
  cv::Mat values;
  cv::remap(smooth, values, map, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_CONSTANT, cv::Scalar(0));
  values.convertTo(values, CV_32F);
  return Rectified{normalised(values, valid, p_.flatten * p_.object_cells), valid, reach};
}

std::array<bool, kSides> CopySearch::search_sides(const Template& known, const Rectified& flat, Result& result) const {
  const cv::Mat& object = known.flat;
  std::array<bool, kSides> open{};
  for (int y = 0; y <= 2 * flat.object.y; ++y)
    for (int x = 0; x <= 2 * flat.object.x; ++x) {
      const double across = static_cast<double>(x - flat.object.x) / object.cols,
                   down = static_cast<double>(y - flat.object.y) / object.rows;
      if (std::abs(across) < p_.overlap && std::abs(down) < p_.overlap) continue;
      const Likeness l = likeness_at(flat.picture, flat.valid, object, x, y);
      if (l.part < p_.min_part) continue;
      if (l.value > result.second) {
        result.second = l.value;
        result.offset_m = {(x - flat.object.x) * known.cell_x_m, (y - flat.object.y) * known.cell_y_m};
      }
      if (l.value < p_.unclear_likeness * result.self) continue;
      for (size_t side = 0; side < kSides; ++side) {
        const double along = kSideOffsets[side][0] * across + kSideOffsets[side][1] * down,
                     beside = kSideOffsets[side][1] * across + kSideOffsets[side][0] * down;
        open[side] = open[side] || (along > p_.overlap && std::abs(beside) < p_.align);
      }
    }
  return open;
}

CopySearch::Result CopySearch::search(size_t number, const cv::Mat& grey, const cv::Mat& mask, const RollingLens& lens,
                                      const Pose& pose) const {
  const Template& known = templates_[number];
  const cv::Mat& object = known.flat;
  auto flat = rectify(known, grey, mask, lens, pose);
  if (!flat) return {};
  const auto likeness = [&](int x, int y) {
    return likeness_at(flat->picture, flat->valid, object, flat->object.x + x, flat->object.y + y);
  };
  Result result;
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx) result.self = std::max(result.self, likeness(dx, dy).value);
  if (result.self < p_.min_likeness) return result;
  // Copies do not overlap the object, whose own lines of text resemble one another.
  flat->valid(cv::Rect(flat->object, object.size())).setTo(0);
  const std::array<bool, kSides> open = search_sides(known, *flat, result);
  result.has_copy = result.second > p_.copy_likeness * result.self;
  if (result.has_copy) return result;
  for (size_t side = 0; side < kSides; ++side) {
    const auto x = static_cast<int>(std::lround(kSideOffsets[side][0] * (1 + p_.max_gap) * object.cols)),
               y = static_cast<int>(std::lround(kSideOffsets[side][1] * (1 + p_.max_gap) * object.rows));
    result.clear[side] = !open[side] && likeness(x, y).part >= p_.min_part;
  }
  return result;
}

}  // namespace odograph::known_object
