// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "plugins/fix/skyline/ground.hpp"
#include "plugins/fix/skyline/matcher.hpp"
#include "plugins/fix/skyline/roof_line.hpp"

namespace odograph::skyline {

/// Refinement of the likeliest places in heading, inclination and heights, then also in position, first with a wide
/// sigma of the line, which has a wide basin of attraction. Chosen empirically on rendered pictures of Delft and Linz.
struct PhotographRefinementParameters {
  static constexpr double kDegree = std::numbers::pi / 180;
  double aligned_rad = 15 * kDegree, align_deg = 0.03;  ///< max change and smallest step of the heading
  double medium_rad = 0.3 * kDegree;                    ///< the wide sigma
  size_t refined = 250;                                 ///< number of places refined in heading,
  size_t modes = 40;                                    ///< in position with the wide sigma,
  size_t sharp = 15;                                    ///< and with the line's own
  double mode_m = 2;                                    ///< min distance of places refined in position
  double move_m = 0.8, moved_m = 0.2;                   ///< first and last step of the position with the wide sigma,
  double sharp_move_m = 0.4, sharp_moved_m = 0.05;      ///< and with the line's own
  double gained_quantile = 0.1;                         ///< of the factors by which those gained, for all others
  double around_m = 8;                                  ///< radius for which roofs are selected together
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
  double pitch_step_rad = 1.2 * kDegree;  ///< step of the pitches within a sigma and a half
  size_t stride = 3;                      ///< the search uses every third direction
  size_t headings = 3;                    ///< number of headings kept for a place
  double turned_rad = 5 * kDegree;        ///< and their min distance
  double max_up_m = 3.5;                  ///< max deviation of the camera's height above the ground from eye_m
  double feet_sigma_m = 1.0;              ///< of the ground without terrain, from the feet of the buildings around
  double tile_m = 12;                     ///< half the side of a tile, for which visible edges are selected together
  double coarse_rad = 0.6 * kDegree;      ///< sigma of a direction of the line on the lattice, which is too coarse for
                                          ///< the line's own: its optimum lies between two places
  double spread_sigmas = 2;               ///< range of the buildings' heights in sigmas, for which roofs are visible
  PhotographRefinementParameters refinement;
  double fine_m = 3.5, fine_step_m = 0.5;  ///< of the lattice around the best place, for its covariance
  // Requirements for a match.
  size_t min_edges = 40;      ///< directions with a roof's edge: 20 degrees
  double max_sigma_m = 4;     ///< of the position along its worst axis
  double min_sigma_m = 0.5;   ///< of north and of east: no model's corners are more accurate (CityGML 2.0, LOD3: 0.5 m)
  double mode_radius_m = 6;   ///< of the places that form the covariance unless too many are left out
  double max_other = 0.05;    ///< total probability of places beyond three sigmas and of no place
  double unmodelled = 0.05;   ///< odds, before the picture is seen, that the model has nothing of it; judgement
  double power = 0.5;         ///< of the likelihoods, since the model's errors are not those assumed
  double sky_power = 0.3;     ///< the same between a photograph's hypotheses, in addition
  double modelled_power = 3;  ///< the fraction of a line that a model has is distributed as its power: mean 80 %
  double roof_distance_m = 10;  ///< the position's sigma over this distance adds to the heading's: a typical distance
                                ///< of a roof
};

struct PhotographPrior {
  Eigen::Vector3d p_n;  ///< of the camera
  Eigen::Quaterniond q_n_c;
  double sigma_m = 10;  ///< of north and east each
  double height_sigma_m = 0.6;
  double yaw_sigma_rad = 0.35, tilt_sigma_rad = 0.01;
  double eye_m = 1.6;  ///< above the model's ground where it has some; p_n's down is ignored then
};

/// Estimates the position of one photograph: the likelihood of places and headings on a lattice around the prior, each
/// with the best-fitting heights of the buildings, inclination and camera height. The covariance is that of the whole
/// lattice and therefore covers several likely places. Where the photograph's sky or inclination is ambiguous, the
/// places of all hypotheses compete.
class PhotographMatcher {
 public:
  PhotographMatcher(City& city, const Ground& ground, const PhotographParameters& parameters = {})
      : p_(parameters), city_(city), ground_(ground), fit_(parameters.roofs) {}

  /// Starts a photograph.
  void clear();
  /// Searches the places by one hypothesis: a sky's edge, and the inclination of `prior`. The priors of a photograph
  /// differ in the inclination only.
  void add(const std::vector<SkyEdge>& edges, const PhotographPrior& prior);
  /// No match where the picture does not determine the place; why() gives the reason.
  std::optional<Match> match();
  /// The same for a photograph with one hypothesis.
  std::optional<Match> match(const std::vector<SkyEdge>& edges, const PhotographPrior& prior) {
    clear(), add(edges, prior);
    return match();
  }
  const std::string& why() const { return why_; }
  /// Log-likelihood of the best place over that of a place where nothing fits. Low where there is no place.
  double gain() const { return gain_; }
  /// The best place, accepted or rejected.
  const std::optional<Match>& tried() const { return tried_; }
  /// Probability that the camera is beyond three sigmas of the best place.
  double other() const { return other_; }
  /// False where the model has no terrain there.
  bool on_terrain() const { return terrain_; }

 private:
  struct Candidate {
    Guess guess;
    double cost = 0;
    double area_m2 = 0;    // of its lattice cell
    size_t line = 0;       // index in lines_
    double unrefined = 0;  // cost before the place was refined
  };
  static bool is_likelier(const Candidate& x, const Candidate& y) { return x.cost < y.cost; }
  struct Place {
    double north, east, yaw, gain, area_m2;
  };
  /// The result of a hypothesis.
  struct Attempt {
    Match match;                // without covariance
    std::vector<Place> places;  // the best one first
    double own_yaw_variance = 0, possible_gain = 0;
  };
  Eigen::Vector3d place_of(const Guess& guess) const;
  /// Places inside buildings are excluded.
  bool is_built(const Guess& guess) const {
    return ground_.is_built(prior_.p_n.head<2>() + Eigen::Vector2d(guess.north, guess.east));
  }
  double yaw_reach() const { return std::min(p_.sigmas * prior_.yaw_sigma_rad, std::numbers::pi); }
  void select_roofs(const Eigen::Vector3d& p_n, double radius_m);
  void render_skyline(const Guess& guess, double reach_rad);
  double cost_of_prior(const Guess& guess) const;
  double cost_of(const Guess& guess) { return fit_.cost(line_, guess) + cost_of_prior(guess); }
  void search();
  void search_place(const Candidate& at);
  void align(Candidate& at);
  void move(Candidate& at, double from_m, double to_m);
  std::vector<Candidate> refined_modes();
  std::vector<Candidate> surroundings_of(const Candidate& best);
  double own_yaw_variance(const Candidate& best);
  bool describe(const Candidate& best, Match& match);
  void estimate_uncertainty(const Attempt& best, Match& match);

  PhotographParameters p_;
  City& city_;
  const Ground& ground_;
  RoofLineFit fit_;
  RoofLine line_;                // of the latest place
  std::vector<RoofLine> lines_;  // of the lattice
  RoofTops tops_;
  PhotographPrior prior_{};
  double pitch_azimuth_ = 0;  // azimuth of the camera's axis
  std::vector<Candidate> candidates_;
  std::vector<Attempt> attempts_;
  std::string why_;
  std::optional<Match> tried_;
  double gain_ = -1e9, other_ = 0;
  bool terrain_ = false, chance_ = false;
};

}  // namespace odograph::skyline
