// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <numbers>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "plugins/fix/skyline/seen_skyline.hpp"
#include "plugins/fix/skyline/skyline_database.hpp"

namespace odograph::skyline {

/// Finds a camera without an initial position: searches all places of a database and all headings. One picture is not
/// enough, since many streets look alike. The odometry provides the path up to position and heading; a hypothesis must
/// explain all of its pictures (of several, all but the worst) better than all others do.
class PlaceFinder {
 public:
  struct Parameters {
    double apart_m = 3.0;                    ///< min distance between two pictures: nearer ones have common errors
    size_t pictures = 6;                     ///< number of newest pictures in use: the odometry must be valid over them
    size_t min_pictures = 4;                 ///< before a hypothesis is accepted
    double min_path_m = 15;                  ///< min distance between the first and the last of them
    double sector_max_rad = 0.14;            ///< max loss of a sector of a signature: eight degrees
    double max_rad = 0.07;                   ///< max loss of a direction in the searches: four degrees
    size_t coarse = 2000;                    ///< places of the signature search that are compared closely
    size_t kept = 40;                        ///< number of hypotheses
    double high_m = 2.5, high_step_m = 2.5;  ///< of the camera's height relative to the database's places
    double same_m = 4, same_rad = 0.17;      ///< hypotheses nearer than this are the same
    double correlated = 2;                   ///< pictures with common errors, counted as one
    double max_second_best_ratio = 1e-4;     ///< max likelihood of the second-best hypothesis over that of the best
    double agrees_rad = 0.026;   ///< max difference of a direction in which picture and model agree: 1.5 degrees
    double min_agreement = 0.7;  ///< of the directions with a roof's edge, mean of the pictures
    double scale_sigma = 0.05;   ///< relative, of the odometry's scale
    int headings = 8;            ///< degrees to each side of a signature's heading that are searched
    double noise_rad = 0.4 * std::numbers::pi / 180;  ///< min mean loss; the matcher's is for one place
    double correlated_directions = 12;                ///< neighbouring directions with a common error: six degrees
    double reach = 1.6;  ///< max distance to a place of the database in spacings: farther is inside a building
    size_t refined = 8;  ///< number of hypotheses refined after each picture
    int steady = 2;      ///< consecutive pictures with the same single hypothesis
  };

  /// `offset_n`: from the database's n to the one in use. The database must outlive this object.
  PlaceFinder(const Parameters& parameters, const SkylineDatabase& database, const Eigen::Vector3d& offset_n)
      : p_(parameters), database_(database), offset_n_(offset_n) {}

  /// A place, and the yaw from the odometry's frame to n.
  struct Found {
    Eigen::Vector3d p_n;
    double yaw_rad;
    double agreement, second_best_ratio;
  };
  /// Adds a picture: its sky edge in c, its orientation with the correct inclination and any heading, its position by
  /// the odometry in metres. Returns the place once a single hypothesis remains.
  std::optional<Found> add(const std::vector<SkyEdge>& edges, const Eigen::Quaterniond& q_n_c,
                           const Eigen::Vector3d& p_odometry, const Spend& spend);
  /// Whether a picture from here is far enough from the previous one.
  bool is_far_enough(const Eigen::Vector3d& p_odometry) const;
  /// Removes all pictures, for a tracking loss of the odometry.
  void clear();
  size_t pictures() const { return pictures_.size(); }
  /// Likelihood ratio of the second-best hypothesis to the best, after the latest picture.
  double second_best_ratio() const { return second_best_ratio_; }

 private:
  struct Picture {
    SeenSkyline seen;
    Eigen::Vector3d p;
  };
  /// The newest picture's position, in the database's n, and the yaw and scale of the odometry's path.
  struct Hypothesis {
    Eigen::Vector3d p;
    double yaw = 0, scale = 1, cost = 0;
  };

  void search(std::vector<Hypothesis>& found, const Spend& spend);
  std::vector<Hypothesis> coarse(const SeenSkyline& seen, const Spend& spend) const;
  Hypothesis refine_coarse(const SeenSkyline& seen, const Hypothesis& at) const;
  bool horizon_at(const Eigen::Vector3d& p, Horizon& out) const;
  Eigen::Vector3d moved(const Hypothesis& h, const Eigen::Vector3d& odometry) const;
  Eigen::Vector3d place_of(const Hypothesis& h, const Picture& picture) const;
  double joint_cost(const Hypothesis& h, const Spend& spend) const;
  Hypothesis refine(Hypothesis h, const Spend& spend) const;
  double agreement(const Hypothesis& h) const;
  bool same(const Hypothesis& a, const Hypothesis& b) const;

  Parameters p_;
  const SkylineDatabase& database_;
  Eigen::Vector3d offset_n_;
  std::deque<Picture> pictures_;
  std::vector<Hypothesis> hypotheses_;  // the best first
  double second_best_ratio_ = 1;
  int single_count_ = 0;
};

}  // namespace odograph::skyline
