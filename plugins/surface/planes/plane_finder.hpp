// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "plugins/surface/planes/cells.hpp"
#include "sdk/math/scalar.hpp"
#include "sdk/math/voxel_map.hpp"

namespace odograph::planes {

enum class Kind { floor, horizontal, vertical };

/// A plane patch. All coordinates are in m, a frame that moves with the track; its z axis points down.
struct Plane {
  uint64_t id = 0;
  Kind kind = Kind::horizontal;
  Eigen::Quaterniond q_m_s = Eigen::Quaterniond::Identity();  ///< z: the normal, on the side that was seen
  Eigen::Vector3d p_m = Eigen::Vector3d::Zero();              ///< origin of the axes
  double sigma_m = 0, tilt_sigma_rad = 0;
  double scale_sigma = 0;                         ///< relative, of the metre when it was fitted
  std::vector<Eigen::Vector2d> outline;           ///< convex, counterclockwise, in the surface's axes
  size_t support = 0;                             ///< points
  int doubts = 0;                                 ///< searches in a row that contradicted it
  Eigen::Vector3d eye = Eigen::Vector3d::Zero();  ///< where the phone was when it was fitted
  /// As it was in the newest change that told of it.
  struct Told {
    Kind kind;
    Eigen::Vector3d p_m, normal_m, eye;
    double sigma_m, scale_sigma, area_m2;
  };
  std::optional<Told> told;

  Eigen::Vector3d normal_m() const { return q_m_s * Eigen::Vector3d::UnitZ(); }
  double distance(const Eigen::Vector3d& p) const { return normal_m().dot(p - p_m); }
  Eigen::Vector2d project(const Eigen::Vector3d& p) const { return (q_m_s.conjugate() * (p - p_m)).head<2>(); }
};

/// What a search changed.
struct Change {
  enum class What { present, merged, withdrawn };
  What what;
  Plane plane;
  uint64_t into = 0;  ///< merged
};

/// Finds horizontal and vertical planes among landmarks. A hypothesis is a landmark's height, or the vertical plane
/// through two landmarks; landmarks agree with it within their own sigma, in one connected patch, and clearly more of
/// them than beside it: random sample consensus (Fischler & Bolles 1981) with gravity known, one plane after the other.
/// Memory is bounded. Not thread-safe.
class PlaneFinder {
 public:
  struct Parameters {
    double interval_s = 0.5;        ///< between two searches
    double memory_s = 20;           ///< landmarks that were seen longer ago have drifted away from newer ones
    double reach_m = 10;            ///< from the phone; beyond it a landmark is worse known than a table is high
    double cube_m = 0.1;            ///< one landmark in each
    double max_sigma_m = 0.10;      ///< of a landmark: of a worse one only the direction is known
    double roughness_m = 0.01;      ///< sigma of what lies on a plane: paving, plaster
    double tolerance = 2.5;         ///< sigmas from the plane
    double max_tolerance_m = 0.06;  ///< a third of a step: a less certain landmark cannot tell one from the next
    double cell_m = 0.4;            ///< landmarks of one patch are in touching cells
    double near_m = 1.5;            ///< radius around its first landmark in which a hypothesis is compared
    int hypotheses = 120;           ///< for each search
    size_t min_points = 12;         ///< of a plane
    double min_extent_m = 0.25;     ///< of a horizontal patch, along its narrower side
    double min_wall_m = 0.6;        ///< of a vertical patch, along its narrower side
    double min_extent = 6;          ///< the same in sigmas of its landmarks: a line of noisy ones is no plane
    double inside = 2;              ///< sigmas of its landmarks by which an outline stays inside: of many, some are off
    double min_contrast = 0.65;   ///< share of the landmarks on the plane that their number beside it does not explain
    double min_significance = 4;  ///< sigmas: one of some hundred hypotheses a second may have three by chance
    double sparse = 0.08;         ///< landmarks in a cell by chance, below which chance does not connect cells
    double doubtful = 0.35;       ///< the same, below which a plane is doubted; three times in a row: withdrawn
    double seen_again_m = 1;  ///< way of the phone after which a plane that is seen again is told of again: else its
                              ///< place would seem as old, and as far off, as the way since then
    double gravity_sigma_rad = 0.009;             ///< half a degree: the front-end's inclination
    double same_rad = 0.14;                       ///< 8 degrees, between planes that may be one
    double min_floor_m = 0.9, max_floor_m = 2.1;  ///< below the phone: 0.74 of a child of 1.2 m, a tall man's eyes
    size_t max_planes = 64;
  };

  PlaneFinder() : map_(512, p_.cube_m) {}
  explicit PlaneFinder(const Parameters& parameters) : p_(parameters), map_(512, p_.cube_m) {}

  void add(const MapPoint& landmark) {
    if (landmark.sigma_m() < p_.max_sigma_m) map_.add(landmark);
  }
  /// Searches if it is time to. `phone`: where it is now; `scale_sigma`: of the metre, relative.
  std::vector<Change> search(int64_t t_ns, const Eigen::Vector3d& phone, double scale_sigma);

  const std::vector<Plane>& planes() const { return planes_; }

 private:
  struct Landmark {
    Eigen::Vector3d p;
    Eigen::Matrix3d covariance;
    double scale_sigma;
    bool taken;
  };
  /// A plane as it fits a patch of landmarks.
  struct Patch {
    Eigen::Vector3d normal, middle;
    std::vector<size_t> on;  ///< indices of its landmarks
    double contrast = 0, significance = 0, sigma_m = 0, tilt_sigma_rad = 0;
  };

  void weigh(Patch& patch, double by_chance, double cells) const;
  double tolerance(const Landmark& landmark, const Eigen::Vector3d& normal) const;
  void gather(int64_t t_ns, const Eigen::Vector3d& phone);
  bool find_best();
  size_t agreeing(size_t seed, const Eigen::Vector3d& normal) const;
  void sort_into_cells(const Eigen::Vector3d& normal, const Eigen::Vector3d& through, const Plane* known);
  void connect(Cells::Cell& from, Patch& patch);
  bool find_patch(const Eigen::Vector3d& normal, const Eigen::Vector3d& through, const Eigen::Vector3d* seed,
                  const Plane* known);
  void fit(Patch& patch);
  bool is_wide_enough(const Patch& patch);
  bool refine(Plane& plane);
  void take_patch(Plane& plane, const Patch& patch);
  void find_new(const Eigen::Vector3d& phone);
  void merge(std::vector<Change>& changes);
  void name_floor(const Eigen::Vector3d& phone);
  bool is_news(const Plane& plane) const;
  uint64_t random() { return state_ = state_ * 6364136223846793005u + 1442695040888963407u, state_ >> 33; }

  Parameters p_;
  VoxelMap map_;
  std::vector<Landmark> landmarks_;  // of this search
  std::vector<size_t> free_;         // indices of those that belong to no plane
  std::vector<Plane> planes_;
  // Of one step of a search; kept, since a search allocates nothing but new planes.
  Patch patch_, other_patch_;
  Cells cells_;
  std::vector<double> weights_;
  std::vector<Eigen::Vector2d> vertices_;
  std::optional<int64_t> searched_ns_;
  double scale_sigma_ = 1;  // now
  Eigen::Vector3d phone_ = Eigen::Vector3d::Zero();
  uint64_t last_id_ = 0, state_ = 1;
};

}  // namespace odograph::planes
