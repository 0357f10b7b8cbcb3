// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "plugins/fix/known_object/finder.hpp"

namespace odograph::known_object {

/// Knowledge of the camera at a frame's time without the object.
struct Prior {
  Eigen::Quaterniond q_n_c = Eigen::Quaterniond::Identity();
  Eigen::Vector3d p_n = Eigen::Vector3d::Zero();
  double tilt_sigma_rad = 0, yaw_sigma_rad = 0, horizontal_sigma_m = 0, vertical_sigma_m = 0;
  double path_m = 0;          ///< length of the path so far
  bool placed = false;        ///< position and heading are in the objects' frame
  double coarse_error_m = 0;  ///< if not placed: accuracy of the position (GNSS); 0: unknown
};

/// The camera's pose from an object.
struct Estimate {
  size_t object = 0;
  int64_t t_ns = 0;
  Eigen::Vector3d from_object_n;  ///< position of the camera minus the object's centre, in n, m
  Eigen::Vector3d p_n;            ///< the same plus the object's position, m
  Eigen::Quaterniond q_n_c;
  Eigen::Matrix3d covariance_n;              ///< of the position, m^2
  Eigen::Matrix3d orientation_covariance_n;  ///< of the small rotation in n, rad^2
  double correlation = 0, oblique_rad = 0;
  bool standing = false;  ///< the walker stood in front of the object
};

/// Decides on a sighting: which pose of the plane is upright, whether the position is plausible, whether it is
/// confirmed, and when it is emitted. Not thread-safe.
class SightingValidator {
 public:
  struct Parameters {
    double interval_s = 0.5;              ///< min time between two fixes by the same object
    double stand_s = 3;                   ///< Antigny et al. 2019, section 3.5: "since a few seconds"
    double hold_s = 10;                   ///< after a fix in front of the object: no fix by it while walking
    int confirmations = 3;                ///< consecutive agreeing sightings, twice as many without a prior
    double gravity_sigma_rad = 0.017;     ///< lower bound, of the prior's inclination
    double pixel_sigma = 0.15;            ///< px, of each corner, common to the frame: interpolation, lens; bench
    double focal_sigma = 0.003;           ///< relative, of the focal length: autofocus, calibration
    double correlation_s = 5;             ///< correlation time of the errors of fixes by one object
    double drift = 0.05;                  ///< of the path since the last fix: error of the prior beyond its sigma
    double max_horizontal_sigma_m = 1.0;  ///< fixes with a larger sigma are not emitted
    double unobserved_copy = 4;           ///< chi-square by which the prior must exclude a copy on an unseen side
    double gate_sigmas = 3.5;             ///< for gravity, and for a position known from GNSS only
    double max_prior_cost = 16.25;        ///< chi-square of position, height and heading: rejects 0.3 % of true ones
    /// In addition to the prior's: errors of surveys and priors change in steps; empirical.
    double step_sigma_m = 0.3, step_sigma_rad = 0.03;
    double max_speed_mps = 2.5;      ///< of a walker, between two sightings
    double sway_m = 0.15;            ///< of a standing walker; empirical
    int64_t gap_ns = 1'500'000'000;  ///< after which a new encounter with the object begins; empirical
    size_t min_standing = 5;         ///< min sightings while standing; empirical
    double ambiguous = 9;            ///< min difference of the costs of two poses (chi-square) to decide between them
  };
  explicit SightingValidator(const Parameters& parameters) : p_(parameters) {}

  /// Nothing if the sighting is rejected, not confirmed yet, or not due.
  std::optional<Estimate> validate(const Sighting& sighting, const PlaneObject& object, const RollingLens& lens,
                                   const Prior& prior);
  void clear();
  /// Counts of the reasons for rejection, for tests and reports.
  struct Rejections {
    uint64_t not_upright = 0, ambiguous = 0, implausible_position = 0, large_sigma = 0, possible_copy = 0;
  };
  const Rejections& rejections() const { return rejections_; }

 private:
  struct Observation {
    int64_t t_ns;
    Eigen::Vector3d p_n;
    double sigma_m;
  };
  struct Encounter {
    std::deque<Observation> seen;
    std::array<bool, kSides> clear{};  ///< sides without a copy, from all sightings
    int64_t last_fix_ns = INT64_MIN, standing_fix_ns = INT64_MIN;
  };
  struct Candidate {
    Estimate estimate;
    double cost;  ///< of picture and gravity
    bool upright, is_plausible;
  };
  Candidate candidate(const Alignment& alignment, const PlaneObject& object, const RollingLens& lens,
                      const Prior& prior) const;
  bool is_plausible(const Estimate& estimate, const Prior& prior) const;
  bool excludes_copies(const Estimate& estimate, const PlaneObject& object, const Prior& prior,
                       const Encounter& encounter) const;
  bool is_stationary(const Encounter& encounter, int64_t t_ns) const;

  Parameters p_;
  std::map<size_t, Encounter> encounters_;
  double path_at_fix_m_ = 0;
  Rejections rejections_;
};

}  // namespace odograph::known_object
