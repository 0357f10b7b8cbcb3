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

/// How one photograph is placed by itself. By hand on rendered pictures of Delft where no source is named.
struct PhotographParameters {
  static constexpr double kDegree = std::numbers::pi / 180;
  RoofErrorParameters roofs;
  // The search.
  double sigmas = 3;    ///< of the prior's place and heading that are searched
  double min_m = 8;     ///< at least, and
  double max_m = 60;    ///< at most
  double step_m = 1.5;  ///< of its lattice, 2 m where that is more than 30 m wide
  double wide_m = 30, wide_step_m = 2;
  double yaw_step_rad = 1.5 * kDegree;
  double pitch_step_rad = 1.2 * kDegree;  ///< of as many pitches as lie within a sigma and a half
  size_t stride = 3;                      ///< directions from one that is looked at in the search to the next
  size_t headings = 3;                    ///< of a place that are kept,
  double turned_rad = 5 * kDegree;        ///< so far apart
  double max_up_m = 1.2;                  ///< by which the camera is higher or lower than eye_m over the ground
  double tile_m = 12;                     ///< half the side of what is looked around at once
  size_t refined = 500,
         modes = 20;   ///< places whose heading, pitch, roll and height are looked for; whose place is too
  double apart_m = 4;  ///< farther from each other than this two places are two
  double fine_m = 3.5, fine_step_m = 0.5;  ///< of the lattice around the best place, for its covariance
  // What is wanted of a picture that is placed.
  size_t min_edges = 40;     ///< directions with a roof's edge: 20 degrees
  double max_sigma_m = 3;    ///< of the place along its worst axis
  double min_sigma_m = 0.5;  ///< of north and of east: no model's corners are better (CityGML 2.0, LOD3: 0.5 m)
  double max_other = 0.1;    ///< probability of all other places, and of none, together
  double doubt_over_m = 10;  ///< the place's doubt over this is the heading's: a roof is about so near (K7's drives)
};

struct PhotographPrior {
  Eigen::Vector3d p_n;  ///< of the camera
  Eigen::Quaterniond q_n_c;
  double sigma_m = 10;  ///< of north and east each
  double height_sigma_m = 0.6;
  double yaw_sigma_rad = 0.35, tilt_sigma_rad = 0.01;
  double eye_m = 1.6;  ///< over the model's ground, where it has some; then p_n's down does not count
};

/// Places one photograph: the likelihood of places and headings on a lattice around the prior, each with the height of
/// each building, the inclination and the camera's height that fit best. What all of the lattice says is the
/// covariance, so that a place which is one of several says so.
class PhotographMatcher {
 public:
  PhotographMatcher(City& city, const Ground& ground, const PhotographParameters& parameters = {})
      : p_(parameters), city_(city), ground_(ground), fit_(parameters.roofs) {}

  /// Nothing where the picture does not tell the place; why() says so in words.
  std::optional<Match> match(const std::vector<SkyEdge>& edges, const PhotographPrior& prior);
  const std::string& why() const { return why_; }
  /// How much likelier the best place makes the picture than one that fits nothing, as a logarithm: to compare
  /// inclinations and skies by. Low where there is none.
  double gain() const { return gain_; }
  /// The best place, refused or not.
  const std::optional<Match>& tried() const { return tried_; }
  /// Probability of all places but the best one's surroundings.
  double other() const { return other_; }
  /// False where the model has no ground of its own there.
  bool on_terrain() const { return terrain_; }

 private:
  struct Candidate {
    Guess guess;
    double cost = 0;
    double area_m2 = 0;  // that it stands for
    size_t line = 0;     // in lines_
  };
  Eigen::Vector3d place_of(const Guess& guess) const;
  /// Nobody stands in a building.
  bool is_built(const Guess& guess) const {
    return ground_.is_built(prior_.p_n.head<2>() + Eigen::Vector2d(guess.north, guess.east));
  }
  void look(const Guess& guess);
  double cost_of_prior(const Guess& guess) const;
  double cost_of(const Guess& guess) { return fit_.cost(line_, guess) + cost_of_prior(guess); }
  void search();
  void search_place(const Candidate& at);
  void align(Candidate& at);
  void move(Candidate& at);
  std::vector<Candidate> surroundings_of(const Candidate& best);
  bool judge(const Candidate& best, Match& match);
  bool describe(const Candidate& best, Match& match);

  PhotographParameters p_;
  City& city_;
  const Ground& ground_;
  RoofLineFit fit_;
  RoofLine line_;                // of the place that was looked at last
  std::vector<RoofLine> lines_;  // of the lattice
  Horizon horizon_;
  City::Winners winners_{};
  PhotographPrior prior_{};
  double pitch_azimuth_ = 0;  // of the camera's axis
  std::vector<Candidate> candidates_;
  std::string why_;
  std::optional<Match> tried_;
  double gain_ = -1e9, other_ = 0;
  bool terrain_ = false;
};

}  // namespace odograph::skyline
