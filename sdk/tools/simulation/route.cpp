// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/simulation/route.hpp"

#include <algorithm>
#include <cmath>

#include "sdk/math/scalar.hpp"

namespace odograph {
namespace {

Eigen::Vector2d along(const Eigen::Vector2d& from, double heading, double curvature, double d) {
  if (std::abs(curvature) < 1e-12) return from + d * Eigen::Vector2d(std::cos(heading), std::sin(heading));
  const double h = heading + curvature * d;
  return from + Eigen::Vector2d(std::sin(h) - std::sin(heading), std::cos(heading) - std::cos(h)) / curvature;
}

}  // namespace

Route::Route(const std::vector<Eigen::Vector3d>& points, double radius) {
  for (const auto& p : points)
    if (points_.empty() || (p - points_.back()).head<2>().norm() > 1e-6) points_.push_back(p);
  if (points_.size() < 2) points_.push_back(points_.front() + Eigen::Vector3d(1, 0, 0));
  const auto flat = [&](size_t i) -> Eigen::Vector2d { return points_[i].head<2>(); };
  const Eigen::Vector2d first = flat(1) - flat(0);
  pieces_.push_back({0, 0, flat(0), std::atan2(first.y(), first.x()), 0});
  heights_.push_back({0, points_[0].z()});
  double cut = 0;  // removed from the leg's start by the arc before it
  for (size_t i = 1; i < points_.size(); ++i) {
    const Eigen::Vector2d leg = flat(i) - flat(i - 1);
    if (i + 1 == points_.size()) {
      add(leg.norm() - cut, 0);
    } else {
      const Eigen::Vector2d next = flat(i + 1) - flat(i);
      const double yaw_change = std::remainder(std::atan2(next.y(), next.x()) - std::atan2(leg.y(), leg.x()), 2 * kPi);
      const double tangent = std::abs(std::tan(yaw_change / 2));
      const double most = 0.45 * std::min(leg.norm(), next.norm());
      const double reach = std::min(radius * tangent, most);
      add(leg.norm() - cut - reach, 0);
      heights_.push_back({length_, points_[i].z()});
      if (reach > 1e-9) add(std::abs(yaw_change) * reach / tangent, std::copysign(tangent / reach, yaw_change));
      cut = reach;
    }
  }
  heights_.push_back({length_, points_.back().z()});
}

void Route::add(double length, double curvature) {
  const Piece& last = pieces_.back();
  pieces_.push_back({length_, length, along(last.from, last.heading, last.curvature, last.length),
                     last.heading + last.curvature * last.length, curvature});
  length_ += length;
}

double Route::curvature_at(double s) const {
  auto piece =
      std::upper_bound(pieces_.begin(), pieces_.end(), s, [](double v, const Piece& p) { return v < p.start; });
  return piece == pieces_.begin() ? 0.0 : (piece - 1)->curvature;
}

void Route::set_heights(const std::vector<double>& up_m) {
  heights_.clear();
  for (const double up : up_m) heights_.push_back({static_cast<double>(heights_.size()), up});
  std::vector<double> nearest(points_.size(), 1e300);
  for (const Height& h : heights_) {
    const Eigen::Vector2d here = at(h.s).north_east;
    for (size_t i = 0; i < points_.size(); ++i)
      if (const double d = (points_[i].head<2>() - here).norm(); d < nearest[i]) nearest[i] = d, points_[i].z() = h.up;
  }
}

Route::Place Route::at(double s) const {
  auto piece =
      std::upper_bound(pieces_.begin(), pieces_.end(), s, [](double v, const Piece& p) { return v < p.start; });
  if (piece != pieces_.begin()) --piece;
  const double d = s - piece->start;
  Place place;
  place.north_east = along(piece->from, piece->heading, piece->curvature, d);
  place.heading = piece->heading + piece->curvature * d;
  auto after = std::upper_bound(heights_.begin(), heights_.end(), s, [](double v, const Height& h) { return v < h.s; });
  if (after == heights_.end()) {
    place.up = heights_.back().up;
  } else if (after == heights_.begin()) {
    place.up = heights_.front().up;
  } else {
    const Height& before = *(after - 1);
    const double run = std::max(after->s - before.s, 1e-9);
    place.slope = (after->up - before.up) / run;
    place.up = before.up + place.slope * (s - before.s);
  }
  return place;
}

}  // namespace odograph
