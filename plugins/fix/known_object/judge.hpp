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

/// What is known of the camera at a frame's time without the object.
struct Prior {
  Eigen::Quaterniond q_n_c = Eigen::Quaterniond::Identity();
  Eigen::Vector3d p_n = Eigen::Vector3d::Zero();
  double tilt_sigma_rad = 0, yaw_sigma_rad = 0, horizontal_sigma_m = 0, vertical_sigma_m = 0;
  double path_m = 0;    ///< walked so far
  bool placed = false;  ///< position and heading are in the objects' frame
  double loose_m = 0;   ///< where not placed: the position is good to this at best (satellites); 0: not at all
};

/// The camera's pose by an object.
struct Estimate {
  size_t object = 0;
  int64_t t_ns = 0;
  Eigen::Vector3d from_object_n;  ///< the camera's position less the object's middle, in n, m
  Eigen::Vector3d p_n;            ///< the same with the object's place added, m
  Eigen::Quaterniond q_n_c;
  Eigen::Matrix3d covariance_n;              ///< of the position, m^2
  Eigen::Matrix3d orientation_covariance_n;  ///< of the small rotation in n, rad^2
  double correlation = 0, oblique_rad = 0;
  bool standing = false;  ///< the walker has stood before it
};

/// Decides what a sighting is worth: which pose of the plane is upright, whether the place can be, whether it is seen
/// steadily, and when it is told. One thread at a time.
class Judge {
 public:
  struct Parameters {
    double interval_s = 0.5;           ///< between two fixes by the same object
    double stand_s = 3;                ///< Antigny et al. 2019, section 3.5: "since a few seconds"
    double hold_s = 10;                ///< after a fix in front: none by this object from walking
    int confirmations = 3;             ///< sightings in a row that agree, twice as many without a prior
    double gravity_sigma_rad = 0.017;  ///< least, of the prior's inclination
    double pixel_sigma = 0.15;         ///< px, of each corner, common to a frame: interpolation, lens; bench
    double focal_sigma = 0.003;        ///< relative, of the focal length: autofocus, calibration
    double alike_s = 5;                ///< for so long fixes by one object err alike
    double drift = 0.05;               ///< of the path since the last fix, that the prior may be off beyond its sigma
    double max_horizontal_sigma_m = 1.0;  ///< worse ones are not told
    double unseen_copy = 4;               ///< chi-square by which the prior must exclude a copy where nobody looked
    double gate_sigmas = 3.5;             ///< of gravity, and of a place that is known to satellites alone
    double max_prior_cost = 16.25;        ///< chi-square of place, height and heading: 0.3 % of true ones are refused
    double step_sigma_m = 0.3,
           step_sigma_rad = 0.03;    ///< beside the prior's: surveys and priors err in steps; judgement
    double max_speed_mps = 2.5;      ///< of a walker, between two sightings
    double sway_m = 0.15;            ///< of whoever stands; judgement
    int64_t gap_ns = 1'500'000'000;  ///< after which an object is met anew; judgement
    size_t min_standing = 5;         ///< sightings of who stands; judgement
    double ambiguous = 9;            ///< difference of the costs below which two poses are alike (chi-square)
  };
  explicit Judge(const Parameters& parameters) : p_(parameters) {}

  /// Nothing where the sighting is refused, not confirmed yet, or not due.
  std::optional<Estimate> judge(const Sighting& sighting, const PlaneObject& object, const RollingLens& lens,
                                const Prior& prior);
  void forget();
  /// Why sightings were refused, for tests and reports.
  struct Refusals {
    uint64_t not_upright = 0, ambiguous = 0, elsewhere = 0, unsure = 0, beside = 0;
  };
  const Refusals& refusals() const { return refusals_; }

 private:
  struct Seen {
    int64_t t_ns;
    Eigen::Vector3d p_n;
    double sigma_m;
  };
  struct Encounter {
    std::deque<Seen> seen;
    std::array<bool, kSides> clear{};  ///< sides on which no copy hangs, by all that was seen
    int64_t told_ns = INT64_MIN, told_standing_ns = INT64_MIN;
  };
  struct Candidate {
    Estimate estimate;
    double cost;  ///< of picture and gravity
    bool upright, can_be;
  };
  Candidate candidate(const Alignment& alignment, const PlaneObject& object, const RollingLens& lens,
                      const Prior& prior) const;
  bool can_be(const Estimate& estimate, const Prior& prior) const;
  bool is_alone(const Estimate& estimate, const PlaneObject& object, const Prior& prior,
                const Encounter& encounter) const;
  bool is_steady(const Encounter& encounter, int64_t t_ns) const;

  Parameters p_;
  std::map<size_t, Encounter> encounters_;
  double told_path_m_ = 0;
  Refusals refusals_;
};

}  // namespace odograph::known_object
