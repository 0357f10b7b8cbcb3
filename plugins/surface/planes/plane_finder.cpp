// SPDX-License-Identifier: Apache-2.0
#include "plugins/surface/planes/plane_finder.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Eigenvalues>

#include "plugins/surface/planes/outline.hpp"
#include "sdk/math/time.hpp"

namespace odograph::planes {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kSmaller = 0.8;  // of sigmas: less is not clearly better

bool is_horizontal(const Vector3d& normal) { return std::abs(normal.z()) > 0.7; }

/// Two axes in a plane: for a horizontal one along m's x and y, for a vertical one along it and upwards.
Matrix3d axes_of(const Vector3d& normal) {
  const Vector3d along = is_horizontal(normal) ? Vector3d(1, 0, 0) : Vector3d(-normal.y(), normal.x(), 0);
  Matrix3d axes;
  axes.col(2) = normal;
  axes.col(0) = (along - along.dot(normal) * normal).normalized();
  axes.col(1) = normal.cross(axes.col(0));
  return axes;
}

}  // namespace

/// How far a patch in so many connected cells is explained by chance, with which `by_chance` landmarks are expected in
/// as many cells anywhere. Each of these has one at least, else it would not be connected; but chance connects no cells
/// where hardly one in twelve has a landmark.
void PlaneFinder::weigh(Patch& patch, double by_chance, double cells) const {
  const auto on = static_cast<double>(patch.on.size());
  patch.contrast = on > 0 ? 1 - by_chance / on : 0;
  const double in_each = by_chance / cells, expected = by_chance / -std::expm1(-in_each);
  patch.significance =
      in_each < p_.sparse ? std::numeric_limits<double>::infinity() : (on - expected) / std::sqrt(expected);
}

double PlaneFinder::tolerance(const Landmark& landmark, const Vector3d& normal) const {
  const double variance = normal.dot(landmark.covariance * normal) + squared(p_.roughness_m);
  return p_.tolerance * std::sqrt(variance);
}

void PlaneFinder::gather(int64_t t_ns, const Vector3d& phone) {
  landmarks_.clear(), free_.clear();
  map_.visit([&](const MapPoint& point) {
    if (seconds(t_ns - point.t_ns) > p_.memory_s || (point.p - phone).squaredNorm() > squared(p_.reach_m)) return;
    const auto then = static_cast<double>(point.scale_sigma);
    if (!scale_is_current(then, scale_sigma_)) return;
    const Vector3d stretch = metre_change_sigma(then, scale_sigma_) * (point.p - point.eye.cast<double>());
    landmarks_.push_back({point.p, point.covariance.cast<double>() + stretch * stretch.transpose(), then, false});
  });
}

/// Number of free landmarks near the seed that agree with the plane through it.
size_t PlaneFinder::agreeing(size_t seed, const Vector3d& normal) const {
  const Vector3d& through = landmarks_[seed].p;
  size_t count = 0;
  for (const size_t i : free_) {
    const Vector3d to = landmarks_[i].p - through;
    const double off = std::abs(normal.dot(to));
    if (off > p_.max_tolerance_m || to.squaredNorm() > squared(p_.near_m)) continue;
    if (off < tolerance(landmarks_[i], normal)) ++count;
  }
  return count;
}

constexpr double kBeside = 4;  // tolerances: three times as much room as on the plane

/// Sorts the landmarks on and beside a plane into cells; of a known plane only those at its outline.
void PlaneFinder::sort_into_cells(const Vector3d& normal, const Vector3d& through, const Plane* known) {
  const Matrix3d axes = axes_of(normal);
  cells_.clear();
  for (size_t i = 0; i < landmarks_.size(); ++i) {
    const Landmark& landmark = landmarks_[i];
    if (landmark.taken && !known) continue;
    const double off = std::abs(normal.dot(landmark.p - through)), within = tolerance(landmark, normal);
    if (within > p_.max_tolerance_m || off > kBeside * within) continue;
    if (known && outside(known->outline, known->project(landmark.p)) > p_.cell_m) continue;
    const Vector2d there = (axes.transpose() * (landmark.p - through)).head<2>();
    cells_.add(Cells::index_of(there, p_.cell_m), i, off < within);
  }
}

void PlaneFinder::connect(Cells::Cell& from, Patch& patch) {
  patch.on.clear();
  const Cells::Count count = cells_.connect(from, patch.on);
  weigh(patch, static_cast<double>(count.beside) / (kBeside - 1), static_cast<double>(count.cells));
}

/// Puts the connected patch of landmarks on a plane into patch_: that of the seed, of the known plane, or the largest.
/// False if there is none.
bool PlaneFinder::find_patch(const Vector3d& normal, const Vector3d& through, const Vector3d* seed,
                             const Plane* known) {
  sort_into_cells(normal, through, known);
  auto& cells = cells_.sort();
  patch_.on.clear();
  if (seed) {
    const Vector2d there = (axes_of(normal).transpose() * (*seed - through)).head<2>();
    if (Cells::Cell* cell = cells_.find(Cells::index_of(there, p_.cell_m))) connect(*cell, patch_);
  } else {
    for (Cells::Cell& cell : cells) {
      if (cell.reached || cell.on == 0) continue;
      connect(cell, other_patch_);
      if (other_patch_.on.size() > patch_.on.size()) std::swap(patch_, other_patch_);
    }
  }
  patch_.normal = normal, patch_.middle = through;
  return !patch_.on.empty();
}

/// Weighted least squares: the height, or direction and offset of a vertical plane.
void PlaneFinder::fit(Patch& patch) {
  constexpr int kIterations = 3;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    double weights = 0, chi2 = 0;
    Vector3d middle = Vector3d::Zero();
    std::vector<double>& weight = weights_;
    weight.resize(patch.on.size());
    for (size_t k = 0; k < patch.on.size(); ++k) {
      const Landmark& landmark = landmarks_[patch.on[k]];
      weight[k] = squared(p_.tolerance / tolerance(landmark, patch.normal));
      weights += weight[k], middle += weight[k] * landmark.p;
    }
    patch.middle = middle / weights;
    Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
    for (size_t k = 0; k < patch.on.size(); ++k) {
      const Vector2d off = (landmarks_[patch.on[k]].p - patch.middle).head<2>();
      spread += weight[k] * off * off.transpose();
    }
    double along = 0;  // weighted spread along a wall
    if (!is_horizontal(patch.normal)) {
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver;
      solver.computeDirect(spread);
      const Vector2d across = solver.eigenvectors().col(0);
      const Vector3d normal(across.x(), across.y(), 0);
      patch.normal = normal.dot(patch.normal) < 0 ? Vector3d(-normal) : normal;
      along = solver.eigenvalues()[1];
    }
    for (size_t k = 0; k < patch.on.size(); ++k)
      chi2 += weight[k] * squared(patch.normal.dot(landmarks_[patch.on[k]].p - patch.middle));
    const double inflation = std::max(1.0, chi2 / static_cast<double>(std::max<size_t>(1, patch.on.size() - 2)));
    // Landmarks of the same frames have errors in common: as many are independent as there are cells.
    constexpr double kCommon = 4;
    patch.sigma_m = std::sqrt(kCommon * inflation / weights + squared(0.5 * p_.roughness_m));
    patch.tilt_sigma_rad = std::hypot(p_.gravity_sigma_rad, along > 0 ? std::sqrt(kCommon * inflation / along) : 0.0);
  }
}

bool PlaneFinder::is_wide_enough(const Patch& patch) {
  const Matrix3d axes = axes_of(patch.normal);
  vertices_.clear();
  for (const size_t i : patch.on) vertices_.push_back((axes.transpose() * (landmarks_[i].p - patch.middle)).head<2>());
  make_hull(vertices_);
  double variance = 0;
  for (const size_t i : patch.on) variance += landmarks_[i].covariance.trace() / static_cast<double>(patch.on.size());
  const double min_m = is_horizontal(patch.normal) ? p_.min_extent_m : p_.min_wall_m;
  return vertices_.size() >= 3 && width_of(vertices_) >= std::max(min_m, p_.min_extent * std::sqrt(variance));
}

/// Puts the patch of the best hypothesis into patch_.
bool PlaneFinder::find_best() {
  size_t best = 0, best_seed = 0;
  Vector3d best_normal = Vector3d::UnitZ();
  for (int k = 0; k < p_.hypotheses; ++k) {
    const size_t seed = free_[random() % free_.size()];
    Vector3d normal = Vector3d::UnitZ();
    if (k % 2 == 1) {
      const Vector3d to = landmarks_[free_[random() % free_.size()]].p - landmarks_[seed].p;
      const double apart_m = to.head<2>().norm();
      if (apart_m < p_.min_extent_m || apart_m > p_.near_m) continue;
      normal = Vector3d(-to.y(), to.x(), 0) / apart_m;
    }
    if (tolerance(landmarks_[seed], normal) > p_.max_tolerance_m) continue;
    if (const size_t count = agreeing(seed, normal); count > best) best = count, best_seed = seed, best_normal = normal;
  }
  if (best < p_.min_points) return false;
  const Vector3d seed = landmarks_[best_seed].p;
  find_patch(best_normal, seed, &seed, nullptr);
  for (int again = 0; again < 2 && patch_.on.size() >= p_.min_points; ++again) {
    fit(patch_);
    find_patch(Vector3d(patch_.normal), Vector3d(patch_.middle), nullptr, nullptr);
  }
  if (patch_.on.size() < p_.min_points) return false;
  fit(patch_);
  return true;
}

/// The plane follows its landmarks, its axes turn as little as possible; the outline grows.
void PlaneFinder::take_patch(Plane& plane, const Patch& patch) {
  const Vector3d normal = plane.normal_m().dot(patch.normal) < 0 ? Vector3d(-patch.normal) : patch.normal;
  plane.q_m_s = (Eigen::Quaterniond::FromTwoVectors(plane.normal_m(), normal) * plane.q_m_s).normalized();
  plane.p_m += normal * normal.dot(patch.middle - plane.p_m);
  plane.sigma_m = patch.sigma_m, plane.tilt_sigma_rad = patch.tilt_sigma_rad;
  plane.support = patch.on.size(), plane.eye = phone_;
  double scale_variance = 0;
  for (const size_t i : patch.on) scale_variance += squared(landmarks_[i].scale_sigma);
  plane.scale_sigma = std::sqrt(scale_variance / static_cast<double>(patch.on.size()));
  vertices_.assign(plane.outline.begin(), plane.outline.end());
  const Vector2d middle = plane.project(patch.middle);
  for (const size_t i : patch.on) {
    const Vector2d off = plane.project(landmarks_[i].p) - middle;
    const double off_m = std::max(off.norm(), 1e-9);
    const Vector3d outwards = plane.q_m_s * Vector3d(off.x(), off.y(), 0) / off_m;
    const double sigma_m = std::sqrt(outwards.dot(landmarks_[i].covariance * outwards));
    vertices_.push_back(middle + std::max(0.0, 1 - p_.inside * sigma_m / off_m) * off);
  }
  make_hull(vertices_);
  plane.outline.assign(vertices_.begin(), vertices_.end());
}

/// Fits a known plane to its landmarks again. False if it is withdrawn.
bool PlaneFinder::refine(Plane& plane) {
  if (!find_patch(plane.normal_m(), plane.p_m, nullptr, &plane) ||
      patch_.on.size() < p_.min_points / 2)  // out of view, or forgotten
    return scale_is_current(plane.scale_sigma, scale_sigma_);
  for (const size_t i : patch_.on) landmarks_[i].taken = true;
  plane.doubts = patch_.contrast < p_.doubtful ? plane.doubts + 1 : 0;
  constexpr int kDoubts = 3;
  if (plane.doubts >= kDoubts) return false;
  if (plane.doubts > 0 || patch_.on.size() < std::max(p_.min_points, plane.support / 2)) return true;
  fit(patch_);
  take_patch(plane, patch_);
  return true;
}

void PlaneFinder::find_new(const Vector3d& phone) {
  for (size_t i = 0; i < landmarks_.size(); ++i)
    if (!landmarks_[i].taken) free_.push_back(i);
  while (free_.size() >= p_.min_points && planes_.size() < p_.max_planes) {
    if (!find_best()) break;
    for (const size_t i : patch_.on) landmarks_[i].taken = true;
    std::erase_if(free_, [&](size_t i) { return landmarks_[i].taken; });
    if (patch_.contrast < p_.min_contrast || patch_.significance < p_.min_significance || !is_wide_enough(patch_))
      continue;
    Plane plane;
    plane.id = ++last_id_;
    plane.kind = is_horizontal(patch_.normal) ? Kind::horizontal : Kind::vertical;
    const Vector3d normal = patch_.normal.dot(phone - patch_.middle) < 0 ? Vector3d(-patch_.normal) : patch_.normal;
    plane.q_m_s = Eigen::Quaterniond(axes_of(normal)).normalized();
    plane.p_m = patch_.middle;
    take_patch(plane, patch_);
    planes_.push_back(plane);
  }
}

/// Two planes that turn out to be one: the older one remains, where the one with the better known scale is. A plane
/// that was measured with two scales appears twice.
void PlaneFinder::merge(std::vector<Change>& changes) {
  const auto apart_m = [](const Plane& a, const Plane& b) {  // how far b's nearest vertex lies outside of a
    double nearest = 1e300;
    for (const Vector2d& vertex : b.outline)
      nearest = std::min(nearest, outside(a.outline, a.project(b.p_m + b.q_m_s * Vector3d(vertex.x(), vertex.y(), 0))));
    return nearest;
  };
  for (size_t i = 0; i < planes_.size(); ++i)
    for (size_t k = i + 1; k < planes_.size();) {
      Plane &older = planes_[i], &younger = planes_[k];
      Vector2d middle = Vector2d::Zero();
      for (const Vector2d& vertex : younger.outline) middle += vertex / static_cast<double>(younger.outline.size());
      const Vector3d there = younger.p_m + younger.q_m_s * Vector3d(middle.x(), middle.y(), 0);
      const double rescaled = std::max(metre_change_sigma(older.scale_sigma, younger.scale_sigma),
                                       metre_change_sigma(younger.scale_sigma, older.scale_sigma));
      const double sigma_m = std::hypot(older.sigma_m, younger.sigma_m, rescaled * (there - phone_).norm());
      const double off_m = std::max(3 * sigma_m, 2 * p_.roughness_m);
      const bool same = older.normal_m().dot(younger.normal_m()) > std::cos(p_.same_rad) &&
                        std::abs(older.distance(there)) < off_m &&
                        std::min(apart_m(older, younger), apart_m(younger, older)) < p_.cell_m;
      if (!same) {
        ++k;
        continue;
      }
      vertices_.assign(older.outline.begin(), older.outline.end());
      for (const Vector2d& vertex : younger.outline)
        vertices_.push_back(older.project(younger.p_m + younger.q_m_s * Vector3d(vertex.x(), vertex.y(), 0)));
      make_hull(vertices_);
      older.outline.assign(vertices_.begin(), vertices_.end());
      if (younger.scale_sigma < kSmaller * older.scale_sigma) {
        older.p_m += older.normal_m() * older.distance(there);
        older.sigma_m = younger.sigma_m, older.scale_sigma = younger.scale_sigma, older.eye = younger.eye;
      }
      if (younger.told) changes.push_back({Change::What::merged, younger, older.id});
      planes_.erase(planes_.begin() + static_cast<ptrdiff_t>(k));
    }
}

/// The floor: the largest horizontal plane around the phone's foot, as far below it as a hand is held.
void PlaneFinder::name_floor(const Vector3d& phone) {
  Plane* floor = nullptr;
  for (Plane& plane : planes_) {
    if (plane.kind == Kind::vertical || plane.normal_m().z() > 0) continue;  // z points down: it is seen from above
    const double below_m = plane.p_m.z() - phone.z();
    if (below_m < p_.min_floor_m || below_m > p_.max_floor_m) continue;
    if (outside(plane.outline, plane.project(phone)) > p_.near_m) continue;
    if (!floor || area_of(plane.outline) > area_of(floor->outline)) floor = &plane;
  }
  if (!floor) return;
  for (Plane& plane : planes_)
    if (plane.kind != Kind::vertical) plane.kind = &plane == floor ? Kind::floor : Kind::horizontal;
}

/// Whether a plane differs from what was last told of it by more than is worth an event.
bool PlaneFinder::is_news(const Plane& plane) const {
  constexpr double kSigmas = 0.5, kLarger = 1.25, kGrown = 1.05;
  if (!plane.told || plane.told->kind != plane.kind) return true;
  const Plane::Told& told = *plane.told;
  return std::abs(plane.distance(told.p_m)) > kSigmas * plane.sigma_m ||
         plane.normal_m().dot(told.normal_m) < std::cos(kSigmas * plane.tilt_sigma_rad) ||
         plane.sigma_m < kSmaller * told.sigma_m || plane.sigma_m > kLarger * told.sigma_m ||
         plane.scale_sigma < kSmaller * told.scale_sigma || area_of(plane.outline) > kGrown * told.area_m2 ||
         (plane.eye - told.eye).norm() > p_.seen_again_m;
}

std::vector<Change> PlaneFinder::search(int64_t t_ns, const Vector3d& phone, double scale_sigma) {
  std::vector<Change> changes;
  if (searched_ns_ && seconds(t_ns - *searched_ns_) < p_.interval_s) return changes;
  searched_ns_ = t_ns, scale_sigma_ = scale_sigma, phone_ = phone;
  gather(t_ns, phone);
  std::erase_if(planes_, [&](Plane& plane) {
    if (refine(plane)) return false;
    changes.push_back({Change::What::withdrawn, plane});
    return true;
  });
  find_new(phone);
  merge(changes);
  name_floor(phone);
  for (Plane& plane : planes_) {
    if (!is_news(plane)) continue;
    plane.told = {plane.kind,    plane.p_m,         plane.normal_m(),      plane.eye,
                  plane.sigma_m, plane.scale_sigma, area_of(plane.outline)};
    changes.push_back({Change::What::present, plane});
  }
  return changes;
}

}  // namespace odograph::planes
