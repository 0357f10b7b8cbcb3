// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/city/street_places.hpp"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

namespace odograph {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kFootCell_m = 20;  // of the lookup cells of the buildings' lowest corners

/// Map of buildings and ground height: the terrain where the model has some, otherwise the lowest corner of the
/// buildings within 20 to 40 m.
class Ground {
 public:
  Ground(const CityModel& city, double cell_m) : cell_m_(cell_m), low_(city.low.head<2>()) {
    const Vector2d size = (city.high - city.low).head<2>();
    built_ =
        cv::Mat(static_cast<int>(size.x() / cell_m) + 1, static_cast<int>(size.y() / cell_m) + 1, CV_8U, cv::Scalar(0));
    terrain_ = cv::Mat(built_.size(), CV_32F, cv::Scalar(kNone));
    foot_ = cv::Mat(static_cast<int>(size.x() / kFootCell_m) + 1, static_cast<int>(size.y() / kFootCell_m) + 1, CV_32F,
                    cv::Scalar(-kNone));
    for (const auto& face : city.faces) city.objects[face.object].is_building ? add_building(face) : add_terrain(face);
    cv::erode(foot_, foot_, cv::Mat());  // the lowest of a cell and its neighbours
  }

  bool is_built(const Vector2d& at) const { return pixel(built_, at, cell_m_) != 0; }
  double up_m(const Vector2d& at) const {
    const int y = index(at.x() - low_.x(), cell_m_, terrain_.rows),
              x = index(at.y() - low_.y(), cell_m_, terrain_.cols);
    if (const float up = terrain_.at<float>(y, x); up > kNone) return static_cast<double>(up);
    const float foot = foot_.at<float>(index(at.x() - low_.x(), kFootCell_m, foot_.rows),
                                       index(at.y() - low_.y(), kFootCell_m, foot_.cols));
    return foot < -kNone ? static_cast<double>(foot) : 0.0;
  }

 private:
  static constexpr float kNone = -1e9f;

  static int index(double m, double cell_m, int n) { return std::clamp(static_cast<int>(m / cell_m), 0, n - 1); }
  uint8_t pixel(const cv::Mat& map, const Vector2d& at, double cell_m) const {
    return map.at<uint8_t>(index(at.x() - low_.x(), cell_m, map.rows), index(at.y() - low_.y(), cell_m, map.cols));
  }

  void add_building(const CityModel::Face& face) {
    std::vector<cv::Point> corners;
    for (const Vector3d& corner : face.corners) {
      const Vector2d at = corner.head<2>() - low_;
      corners.emplace_back(static_cast<int>(at.y() / cell_m_), static_cast<int>(at.x() / cell_m_));
      float& foot = foot_.at<float>(index(at.x(), kFootCell_m, foot_.rows), index(at.y(), kFootCell_m, foot_.cols));
      foot = std::min(foot, static_cast<float>(-corner.z()));
    }
    cv::fillConvexPoly(built_, corners, cv::Scalar(255));
  }

  void add_terrain(const CityModel::Face& face) {
    const auto& c = face.corners;
    const Vector2d u = (c[1] - c[0]).head<2>(), v = (c[2] - c[0]).head<2>();
    const double det = u.x() * v.y() - u.y() * v.x();
    if (std::abs(det) < 1e-9) return;
    Vector2d least = c[0].head<2>(), most = least;
    for (const Vector3d& corner : c) least = least.cwiseMin(corner.head<2>()), most = most.cwiseMax(corner.head<2>());
    least -= low_, most -= low_;
    for (int y = index(least.x(), cell_m_, terrain_.rows); y <= index(most.x(), cell_m_, terrain_.rows); ++y)
      for (int x = index(least.y(), cell_m_, terrain_.cols); x <= index(most.y(), cell_m_, terrain_.cols); ++x) {
        const Vector2d w = low_ + cell_m_ * Vector2d(y + 0.5, x + 0.5) - c[0].head<2>();
        const double a = (w.x() * v.y() - w.y() * v.x()) / det, b = (u.x() * w.y() - u.y() * w.x()) / det;
        if (a < 0 || b < 0 || a + b > 1) continue;
        float& up = terrain_.at<float>(y, x);
        up = std::max(up, static_cast<float>(-(c[0].z() + a * (c[1] - c[0]).z() + b * (c[2] - c[0]).z())));
      }
  }

  double cell_m_;
  Vector2d low_;
  cv::Mat built_, terrain_, foot_;
};

Failure too_many(size_t most) {
  return {ODO_E_ARGUMENT, "more than " + std::to_string(most) + " places; take a larger --spacing"};
}

}  // namespace

Result<std::vector<Vector3d>> places_of_grid(const CityModel& city, const StreetPlaceParameters& p) {
  const Vector2d size = (city.high - city.low).head<2>() / p.spacing_m;
  if ((size.x() + 1) * (size.y() + 1) > static_cast<double>(p.most)) return too_many(p.most);
  const Ground ground(city, p.cell_m);
  std::vector<Vector3d> places;
  for (int y = 0; y <= static_cast<int>(size.x()); ++y)
    for (int x = 0; x <= static_cast<int>(size.y()); ++x) {
      const Vector2d at = city.low.head<2>() + p.spacing_m * Vector2d(y, x);
      if (!ground.is_built(at)) places.emplace_back(at.x(), at.y(), -ground.up_m(at) - p.eye_m);
    }
  return places;
}

Result<std::vector<Vector3d>> places_along(const CityModel& city, const std::vector<Vector2d>& line,
                                           const StreetPlaceParameters& p) {
  const Ground ground(city, p.cell_m);
  std::vector<Vector3d> places;
  const auto add = [&](const Vector2d& at) { places.emplace_back(at.x(), at.y(), -ground.up_m(at) - p.eye_m); };
  for (size_t i = 0; i + 1 < line.size(); ++i) {
    const double length = (line[i + 1] - line[i]).norm(), steps = std::ceil(length / p.spacing_m);
    if (static_cast<double>(places.size()) + steps > static_cast<double>(p.most)) return too_many(p.most);
    for (int k = 0; k < static_cast<int>(steps); ++k) add(line[i] + (line[i + 1] - line[i]) * (k / steps));
  }
  if (!line.empty()) add(line.back());
  return places;
}

}  // namespace odograph
