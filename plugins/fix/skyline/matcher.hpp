// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "plugins/fix/skyline/horizon.hpp"
#include "plugins/fix/skyline/match_parameters.hpp"
#include "plugins/fix/skyline/offset_map.hpp"
#include "plugins/fix/skyline/seen_path.hpp"
#include "plugins/fix/skyline/sky_finder.hpp"

namespace odograph::skyline {

/// Number of directions of a picture with a roof's edge.
size_t closed_edges(const std::vector<SkyEdge>& edges);

/// Prior of a match.
struct Prior {
  Eigen::Vector3d p_n;  ///< of the camera
  Eigen::Quaterniond q_n_c;
  double position_sigma_m, yaw_sigma_rad, tilt_sigma_rad, farthest_m;
  /// Previous pictures gave no place: several must agree on the offset from the prior.
  bool lost = false;
  double height_sigma_m = 0.05;  ///< of the down component of p_n
  /// Last known position, where the heading is unknown: the distance from there to p_n is known to slack_m, so the
  /// place lies on a circle, and its bearing determines the heading.
  std::optional<Eigen::Vector3d> pivot_n = std::nullopt;
  double slack_m = 0;
};

/// Height of an object's roofs above the model's, as a picture shows it.
struct RoofHeight {
  int object;  ///< Edge::object
  double height_m;
  double directions;  ///< number of those that agree with it, by weight
};

struct Match {
  Eigen::Vector3d p_n;
  Eigen::Quaterniond q_n_c;
  Eigen::Matrix2d covariance;  ///< of north and east, m^2
  double yaw_sigma_rad;
  double height_sigma_m;
  double agreement;          ///< fraction of the directions with a roof's edge in which picture and model agree
  double second_best_ratio;  ///< likelihood ratio of the second-best place to this one
  /// The highest point of the skyline: eq. (2) and (4) of Gakne & O'Keefe 2018.
  Eigen::Vector3d landmark_n;
  double slant_distance_m;
  double tilt_sigma_rad = 0;           ///< of pitch and roll each, where they are estimated
  std::vector<RoofHeight> roofs = {};  ///< in view, the model's (height 0) or estimated
};

/// Reason for no match.
enum class Refusal {
  none,
  few_edges,        ///< too few directions have a roof's edge in the picture
  gathering,        ///< lost: several pictures must agree first
  ambiguous,        ///< several places fit, or the pictures' best place differs from this picture's
  nothing_in_view,  ///< the model has no roof there
  beyond,           ///< the best place lies outside the searched area, or far above or below the prior's height
};

/// Finds the position and the orientation whose skyline matches that of the picture: by the elevation of the sky's edge
/// in each direction against the model's, with a bounded loss, because models lack trees and new houses; or by the
/// binary images of eq. (3), as the paper does. The model's skylines are computed on demand.
class Matcher {
 public:
  using Parameters = MatcherParameters;
  explicit Matcher(City city, const Parameters& parameters = {}) : p_(parameters), city_(std::move(city)) {}
  /// `spend` is called with the amount of work before it is done, and may wait or throw. `older` pictures of the path
  /// to the prior's place are matched jointly with this one; not with a prior that is lost or has a pivot.
  std::optional<Match> match(const std::vector<SkyEdge>& edges, const Prior& prior, const Spend& spend = nullptr,
                             const std::vector<View>& older = {});
  /// Whether enough directions of the pictures have a roof's edge.
  static bool has_enough_edges(const std::vector<SkyEdge>& edges, const std::vector<View>& older = {},
                               const Parameters& parameters = {});
  const City& city() const { return city_; }
  City& city() { return city_; }
  /// Reason why the latest match() returned no match.
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
  double correlation_loss(const Guess& guess) const;
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
  void sample_neighbours(const Place& best);
  struct Spread {
    Eigen::Matrix2d position;  // m^2
    double yaw_variance;       // rad^2
  };
  Spread spread_around(const Place& best, double scale) const;
  /// The best place, and the cost of the second-best.
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
  std::vector<Place> places_, ends_;  // of the lattice; refined from it
  std::vector<Place> around_;         // neighbours of the best place
  std::vector<SeenSkyline::Residual> residuals_;
  OffsetMap offsets_;
  Refusal refusal_ = Refusal::none;
};

}  // namespace odograph::skyline
