// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/city/photograph_drawing.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <opencv2/imgproc.hpp>

#include "sdk/tools/text/text.hpp"

namespace odograph {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

const cv::Scalar kRoofs(40, 90, 235), kShadow(255, 255, 255), kBuildings(150, 150, 150), kGuess(200, 140, 60),
    kPlaced(40, 140, 40), kInk(50, 50, 50);

void put_text(cv::Mat& map, const std::string& words, const cv::Point& at, double size, const cv::Scalar& colour) {
  cv::putText(map, words, at, cv::FONT_HERSHEY_SIMPLEX, size, cv::Scalar::all(255), 4, cv::LINE_AA);
  cv::putText(map, words, at, cv::FONT_HERSHEY_SIMPLEX, size, colour, 1, cv::LINE_AA);
}

/// Names beside points, each where no other is, beneath each other where points are close.
class Labels {
 public:
  explicit Labels(cv::Mat& map) : map_(map) {}
  void add(const std::string& name, const cv::Point& point) {
    constexpr double kScale = 0.4;
    const cv::Size size = cv::getTextSize(name, cv::FONT_HERSHEY_SIMPLEX, kScale, 1, nullptr) + cv::Size(2, 4);
    cv::Rect box;
    for (int row = 0; row < 40; ++row) {
      const int below = (row % 2 ? -1 : 1) * ((row + 1) / 2) * size.height;
      box = {point + cv::Point(8, below - size.height), size};
      if (std::none_of(used_.begin(), used_.end(), [&](const cv::Rect& other) { return (box & other).area() > 0; }))
        break;
    }
    used_.push_back(box);
    put_text(map_, name, box.tl() + cv::Point(1, size.height - 3), kScale, kInk);
  }

 private:
  cv::Mat& map_;
  std::vector<cv::Rect> used_;
};

}  // namespace

void draw_roofs(cv::Mat& bgr, double focal_px, const PhotographPose& placed, const PhotographLocalizer& placer) {
  const auto elevation = placer.skyline(placed.p_n);
  if (elevation.empty()) return;
  const size_t n = elevation.size();
  const auto pixel = [&](size_t j, cv::Point& at) {
    const double azimuth = (static_cast<double>(j) + 0.5) * 2 * std::numbers::pi / static_cast<double>(n);
    const double e = static_cast<double>(elevation[j]);
    const Vector3d ray = placed.q_n_c.conjugate() *
                         Vector3d(std::cos(e) * std::cos(azimuth), std::cos(e) * std::sin(azimuth), -std::sin(e));
    if (ray.z() < 0.2) return false;
    at = {static_cast<int>(0.5 * bgr.cols + focal_px * ray.x() / ray.z()),
          static_cast<int>(0.5 * bgr.rows + focal_px * ray.y() / ray.z())};
    return true;
  };
  const int width = std::max(2, bgr.cols / 400);
  for (const auto& [colour, thickness] : {std::pair(kShadow, 2 * width), std::pair(kRoofs, width)})
    for (size_t j = 0; j < n; ++j) {
      cv::Point from, to;
      if (elevation[j] > 0 && elevation[(j + 1) % n] > 0 && pixel(j, from) && pixel((j + 1) % n, to))
        cv::line(bgr, from, to, colour, thickness, cv::LINE_AA);
    }
}

cv::Mat map_of(const std::vector<MappedPhotograph>& photographs, const PhotographLocalizer& placer) {
  constexpr int kSide = 1200;
  Vector2d low(1e9, 1e9), high(-1e9, -1e9);
  const auto cover = [&](const Vector2d& p, double around) {
    low = low.cwiseMin(p - Vector2d(around, around)), high = high.cwiseMax(p + Vector2d(around, around));
  };
  for (const auto& photograph : photographs) {
    cover({photograph.guess.north_m, photograph.guess.east_m}, 40);
    if (photograph.placed.placed) cover(photograph.placed.p_n.head<2>(), 40);
  }
  const Vector2d middle = 0.5 * (low + high);
  const double side_m = (high - low).maxCoeff(), scale = kSide / side_m;
  const auto at = [&](const Vector2d& p) {
    return cv::Point(static_cast<int>(0.5 * kSide + (p.y() - middle.y()) * scale),
                     static_cast<int>(0.5 * kSide - (p.x() - middle.x()) * scale));
  };
  cv::Mat map(kSide, kSide, CV_8UC3, cv::Scalar(255, 255, 255));
  for (const auto& edge : placer.edges_near(middle, 0.75 * side_m + 50))
    cv::line(map, at(edge[0].head<2>()), at(edge[1].head<2>()), kBuildings, 1, cv::LINE_AA);
  std::vector<std::pair<std::string, cv::Point>> names;  // drawn last
  for (const auto& [name, guess, placed] : photographs) {
    const cv::Point before = at({guess.north_m, guess.east_m});
    cv::circle(map, before, std::max(2, static_cast<int>(guess.sigma_m * scale)), kGuess, 1, cv::LINE_AA);
    if (!placed.placed) {
      cv::drawMarker(map, before, kGuess, cv::MARKER_TILTED_CROSS, 12, 2);
      names.emplace_back(name, before);
      continue;
    }
    const Vector2d p = placed.p_n.head<2>();
    const double heading = placed.heading_rad();
    cv::line(map, before, at(p), kGuess, 1, cv::LINE_AA);
    cv::arrowedLine(map, at(p), at(p + 12 * Vector2d(std::cos(heading), std::sin(heading))), kPlaced, 2, cv::LINE_AA);
    names.emplace_back(name, at(p));
    cv::circle(map, at(p), std::max(3, static_cast<int>(placed.sigma_m() * scale)), kPlaced, 1, cv::LINE_AA);
  }
  Labels labels(map);
  for (const auto& [name, point] : names) labels.add(name, point);
  cv::line(map, {20, kSide - 20}, {20 + static_cast<int>(20 * scale), kSide - 20}, kInk, 2);
  const std::pair<const char*, cv::Scalar> legend[] = {{"20 m, north is up", kInk},
                                                       {"estimate: viewing direction, circle of one sigma", kPlaced},
                                                       {"prior: circle of one sigma; cross: not placed", kGuess},
                                                       {"edges of the model, as its surfaces are divided", kBuildings}};
  int y = kSide - 28;
  for (const auto& [words, colour] : legend) {
    put_text(map, words, {20, y}, 0.5, colour);
    y -= 20;
  }
  return map;
}

}  // namespace odograph
