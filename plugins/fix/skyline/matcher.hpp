// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <Eigen/Geometry>

#include "plugins/fix/skyline/horizon.hpp"
#include "plugins/fix/skyline/match_parameters.hpp"
#include "plugins/fix/skyline/offset_map.hpp"
#include "plugins/fix/skyline/seen_path.hpp"
#include "plugins/fix/skyline/sky_finder.hpp"

namespace odograph::skyline {

/// The directions of a picture that have a roof's edge.
size_t closed_edges(const std::vector<SkyEdge>& edges);

/// What is known before looking.
struct Prior {
  Eigen::Vector3d p_n;  ///< of the camera
  Eigen::Quaterniond q_n_c;
  double position_sigma_m, yaw_sigma_rad, tilt_sigma_rad, farthest_m;
  /// The picture before did not tell the place: several must agree on where the prior is wrong.
  bool lost = false;
  double height_sigma_m = 0.05;  ///< of p_n's down
  /// Where the position was known last, when the heading is not known: the path from there to p_n is known but for its
  /// direction, to within slack_m, so the place lies on a circle, and where it lies on it says the heading.
  std::optional<Eigen::Vector3d> pivot_n = std::nullopt;
  double slack_m = 0;
};

struct Match {
  Eigen::Vector3d p_n;
  Eigen::Quaterniond q_n_c;
  Eigen::Matrix2d covariance;  ///< of north and east, m^2
  double yaw_sigma_rad;
  double height_sigma_m;
  double agreement;          ///< part of the directions with a roof's edge in which picture and model agree
  double second_best_ratio;  ///< likelihood of the best other place over that of this one
  /// The highest point of the skyline: eq. (2) and (4) of Gakne & O'Keefe 2018.
  Eigen::Vector3d landmark_n;
  double slant_distance_m;
};

/// Why a picture told no place.
enum class Refusal {
  none,
  few_edges,        ///< too few directions have a roof's edge in the picture
  gathering,        ///< lost: several pictures must agree first
  ambiguous,        ///< several places fit, or the pictures' best is not this picture's
  nothing_in_view,  ///< the model has no roof there
  beyond,           ///< the best place lies where nothing was searched, or far above or below the prior's height
};

/// Finds the place and the orientation whose skyline looks like the one in the picture. Where the paper correlates
/// binary images of a database of places, this compares the elevation at which the sky ends, direction by direction,
/// with the model's, computed where it is needed; the loss of a direction is bounded, because models miss trees and new
/// houses.
class Matcher {
 public:
  using Parameters = MatcherParameters;
  explicit Matcher(City city, const Parameters& parameters = {}) : p_(parameters), city_(std::move(city)) {}
  /// `spend` is told of the work before it is done, and may wait or throw. `older` pictures of the path to the prior's
  /// place are matched together with this one; a prior that is lost or has a pivot goes without.
  std::optional<Match> match(const std::vector<SkyEdge>& edges, const Prior& prior, const Spend& spend = nullptr,
                             const std::vector<View>& older = {});
  /// Whether enough directions of the pictures have a roof's edge.
  static bool tells_enough(const std::vector<SkyEdge>& edges, const std::vector<View>& older = {},
                           const Parameters& parameters = {});
  const City& city() const { return city_; }
  City& city() { return city_; }
  /// Why the latest match() gave nothing.
  Refusal refusal() const { return refusal_; }

 private:
  using Vector6d = Eigen::Matrix<double, 6, 1>;
  using Matrix6d = Eigen::Matrix<double, 6, 6>;

  Eigen::Vector3d place_of(const Guess& guess) const {
    return prior_.p_n + Eigen::Vector3d(guess.north, guess.east, -guess.up);
  }
  void spend(uint64_t work) const {
    if (spend_) spend_(work);
  }
  double cost(const Guess& guess, bool new_place);
  double cost_of_prior(const Guess& guess) const;
  void search(double radius_m, double step_m);
  void search_path(double radius_m, double step_m);
  void search_circle(const Eigen::Vector2d& displacement, double step_m);
  void look_at_place(Place place, int middle_deg, int yaw_steps, int stride);
  Place refine(Place from);
  void align_heading(Place& at);
  Place polish(Place from);
  bool linearise(const Guess& at, double soft_rad, Matrix6d& H, Vector6d& b);
  double add_view(const SeenPath::Seen& seen, const Guess& at, double soft_rad, Matrix6d& H, Vector6d& b);
  std::optional<Guess> step(const Guess& at, double soft_rad, double damping);
  void sound(const Place& best);
  struct Doubt {
    Eigen::Matrix2d position;  // m^2
    double yaw_variance;       // rad^2
  };
  Doubt doubt_around(const Place& best, double scale) const;
  /// Best place and best other one.
  std::optional<Place> choose(double step_m, double& second_best_cost);
  bool within_reach(const Place& best, double chord_m, double reach_m) const;
  bool estimate_covariance(const Place& best, double second_best_cost, Match& match);
  bool describe(const Place& best, Match& match);

  Parameters p_;
  City city_;
  Spend spend_;
  Prior prior_{};
  SeenPath seen_;
  SeenSkyline::Twice twice_{};
  std::vector<Place> places_, ends_;  // of the lattice, and where those of them led that were refined
  std::vector<Place> around_;         // the best place
  std::vector<SeenSkyline::Residual> residuals_;
  OffsetMap offsets_;
  Refusal refusal_ = Refusal::none;
};

}  // namespace odograph::skyline
