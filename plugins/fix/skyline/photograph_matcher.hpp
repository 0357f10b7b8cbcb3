// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "plugins/fix/skyline/facades.hpp"
#include "plugins/fix/skyline/ground.hpp"
#include "plugins/fix/skyline/photograph_decision.hpp"
#include "plugins/fix/skyline/photograph_prior.hpp"
#include "plugins/fix/skyline/roof_line.hpp"

namespace odograph::skyline {

/// Refinement of the likeliest places of the lattice, first with a wide sigma of the line, which has a wide basin of
/// attraction. Chosen empirically on rendered pictures of Delft and Linz.
struct PhotographRefinementParameters {
  static constexpr double kDegree = std::numbers::pi / 180;
  double wide_rad = 0.3 * kDegree;  ///< the wide sigma
  size_t starts = 500;              ///< max number of places fitted
  double start_m = 2;               ///< min distance of two with the same heading
  double mode_m = 0.75;             ///< max distance of two results that are the same place
  // Levenberg-Marquardt.
  bool fits_wide = false;                           ///< first with the wide sigma, not only with the line's own
  int steps = 12;                                   ///< max number of steps of a fit
  double step_m = 1.5, rotation_rad = 4 * kDegree;  ///< max length of a step
  double moved_m = 4, aligned_rad = 15 * kDegree;   ///< max distance from the start,
  double beyond_m = 2;                              ///< and of a place beyond the radius of the search
  double min_decrease = 0.05;                       ///< of the cost, for another step
  double damping = 1e-3, retry_damping = 1e-2,
         max_damping = 1e3;  ///< first; min after a step that fails; last
  // Pattern search, which gets past the optima between which a house's corner separates.
  size_t polished = 15;                             ///< number of the likeliest places,
  size_t near_best = 8;                             ///< and of the likeliest around the best one,
  double near_m = 10;                               ///< within this distance: they decide its covariance
  double align_deg = 0.03;                          ///< smallest step of the heading
  double move_m = 0.8, moved_to_m = 0.2;            ///< first and last step of the position with the wide sigma,
  double sharp_move_m = 0.4, sharp_moved_m = 0.05;  ///< and with the line's own
  // The covariance of the position by the likelihood at a distance.
  double measured_gain = 6;      ///< of the places whose log-likelihood is at most this below the best
  double max_increase = 2;       ///< of the cost: beyond, which are two sigmas, the distance is halved
  double min_measured_m = 0.25;  ///< smallest distance
};

/// Parameters of matching one photograph. Unless a source is named, chosen empirically on rendered pictures of Delft
/// and Linz (docs/accuracy/city.md).
struct PhotographParameters {
  static constexpr double kDegree = std::numbers::pi / 180;
  RoofErrorParameters roofs;
  // The search.
  double sigmas = 3;    ///< range of the search in sigmas of the prior's place and heading
  double min_m = 8;     ///< min and
  double max_m = 60;    ///< max radius of the search
  double step_m = 1.5;  ///< of its lattice; 2 m where the radius exceeds 30 m
  double wide_m = 30, wide_step_m = 2;
  double yaw_step_rad = 1.5 * kDegree;
  double pitch_step_rad = 1.2 * kDegree;                    ///< step of the pitches,
  double pitch_sigmas = 1.5, max_pitch_rad = 12 * kDegree;  ///< searched within so many of the prior's sigmas, at most
  size_t stride = 3;                                        ///< the search uses every third direction
  size_t headings = 3;                                      ///< number of headings kept for a place
  double turned_rad = 5 * kDegree;                          ///< and their min distance
  double max_up_sigmas = 2;           ///< max deviation of the camera's height from eye_m, in its sigmas
  double feet_sigma_m = 1.0;          ///< of the ground without terrain, from the feet of the buildings around
  double ground_step_m = 2;           ///< of the lattice between whose heights the ground is interpolated
  double tile_m = 12;                 ///< half the side of a tile, for which visible edges are selected together
  double coarse_rad = 0.6 * kDegree;  ///< sigma of a direction of the line on the lattice, which is too coarse for
                                      ///< the line's own: its optimum lies between two places
  double spread_sigmas = 2;           ///< range of the buildings' heights in sigmas, for which roofs are visible
  double min_tan = 0.03;              ///< tangent of the elevation of a roof in a picture: two degrees
  double lower_m = 4;                 ///< max height of a place of a tile below its middle
  uint64_t direction_work = 12;       ///< of a Spend, for the cost of a direction
  uint64_t ground_work = 1000;        ///< the same, for the height of the ground at a place
  PhotographRefinementParameters refinement;
  size_t min_edges = 40;  ///< directions with a roof's edge that a search requires: 20 degrees
  PhotographDecisionParameters decision;
};

/// Estimates the position of one photograph. A search on a lattice of places and headings around the prior gives the
/// starts of fits in place, heading, inclination, camera height and the heights of the buildings. All their optima
/// compete, so that the covariance covers several likely places, and so do those of all hypotheses where the
/// photograph's sky or inclination is ambiguous.
class PhotographMatcher {
 public:
  PhotographMatcher(City& city, const Ground& ground, const PhotographParameters& parameters = {})
      : p_(parameters), city_(city), ground_(ground), fit_(parameters.roofs) {}

  /// Starts a photograph.
  void clear();
  /// Searches the places by one hypothesis: a sky's edge, and the inclination of `prior`. The priors of a photograph
  /// differ in the inclination only. `spend` is as that of Matcher::match().
  void add(const std::vector<SkyEdge>& edges, const PhotographPrior& prior, const Spend& spend = nullptr,
           Facades* facades = nullptr);
  /// No match where the picture does not determine the place; why() gives the reason.
  std::optional<Match> match();
  /// The same for a photograph with one hypothesis.
  std::optional<Match> match(const std::vector<SkyEdge>& edges, const PhotographPrior& prior) {
    clear(), add(edges, prior);
    return match();
  }
  const std::string& why() const { return decision_.why; }
  Reason reason() const { return decision_.reason; }
  /// Log-likelihood of the best place over that of a place where nothing fits. Low where there is no place.
  double gain() const { return decision_.gain; }
  /// The best place, accepted or rejected.
  const std::optional<Match>& tried() const { return decision_.tried; }
  /// Probability that the camera is beyond three sigmas of the best place.
  double other() const { return decision_.other; }
  /// The places by each hypothesis.
  const std::vector<PhotographAttempt>& attempts() const { return attempts_; }
  /// Radius of the search.
  double reach_m() const { return std::clamp(p_.sigmas * prior_.sigma_m, p_.min_m, p_.max_m); }

 private:
  struct Candidate {
    Guess guess;
    double cost = 0;
    size_t tile = 0;
    Eigen::Matrix<double, 6, 6> information = {};  // as in normal_equations()
  };
  static bool is_likelier(const Candidate& x, const Candidate& y) { return x.cost < y.cost; }
  Eigen::Vector3d place_of(const Guess& g) const {
    return {prior_.p_n.x() + g.north, prior_.p_n.y() + g.east, heights_.down_m(g.north, g.east)};
  }
  /// Places inside buildings are excluded.
  bool is_built(const Guess& guess) const {
    return ground_.is_built(prior_.p_n.head<2>() + Eigen::Vector2d(guess.north, guess.east));
  }
  double up_reach() const { return p_.max_up_sigmas * prior_.height_sigma_m; }
  double yaw_reach() const { return std::min(p_.sigmas * prior_.yaw_sigma_rad, std::numbers::pi); }
  std::vector<int> roofs_around(const Guess& guess, double radius_m);
  void select_roofs(const Candidate& at, double radius_m);
  void render_skyline(const Guess& guess, double reach_rad);
  double cost_of_facades(const Guess& guess) const { return facades_ ? facades_->cost(place_of(guess), guess.yaw) : 0; }
  double cost_of(const Guess& guess, size_t stride = 1) {
    if (spend_) spend_(p_.direction_work * fit_.directions() / stride);
    return fit_.cost(line_, guess, stride) + prior_.cost(guess) + cost_of_facades(guess);
  }
  void search();
  void search_place(const Candidate& at, double reach_rad);
  void fit(Candidate& at);
  void align(Candidate& at);
  void move(Candidate& at, double from_m, double to_m);
  void polish(Candidate& at);
  std::vector<Candidate> distinct(std::vector<Candidate> all, size_t most, double apart_m) const;
  std::vector<Candidate> refined();
  Eigen::Matrix<double, 6, 6> covariance_of(const Candidate& at) const;
  PhotographPlace place_at(const Candidate& at) const;
  void measure_position(const Candidate& at, PhotographPlace& place);
  bool describe(const Candidate& best, Match& match);

  PhotographParameters p_;
  City& city_;
  const Ground& ground_;
  RoofLineFit fit_;
  Facades* facades_ = nullptr;
  Spend spend_;
  RoofLine line_;                        // of the latest place
  std::vector<std::vector<int>> roofs_;  // of the tiles
  CameraHeights heights_;
  RoofTops tops_;
  PhotographPrior prior_{};
  double pitch_azimuth_ = 0;  // azimuth of the camera's axis
  std::vector<Candidate> candidates_;
  std::vector<PhotographAttempt> attempts_;
  PhotographDecision decision_;
};

}  // namespace odograph::skyline
