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

/// Finds where a camera is that was never placed: all places of a database, all headings. One picture is not enough,
/// since many streets look alike: a hypothesis must explain every picture of the path, which the odometry tells but for
/// place and heading, and better than all others do; of several all but the worst.
class PlaceFinder {
 public:
  struct Parameters {
    double apart_m = 3.0;                    ///< between two pictures at least: nearer ones err together
    size_t pictures = 6;                     ///< that count, the newest ones: for so long the odometry must hold
    size_t min_pictures = 4;                 ///< before one is believed
    double min_path_m = 15;                  ///< between the first and the last of them, in a straight line
    double sector_max_rad = 0.14;            ///< most that a sector of a signature counts: eight degrees
    double max_rad = 0.07;                   ///< most that a direction counts in the searches: four degrees
    size_t coarse = 2000;                    ///< places of the signatures' search that are looked at closely
    size_t kept = 40;                        ///< hypotheses that are followed
    double high_m = 2.5, high_step_m = 2.5;  ///< the eye's height against that of the database's places: the ground's
    double same_m = 4, same_rad = 0.17;      ///< nearer to each other than this two hypotheses are one
    double correlated = 2;                   ///< pictures whose errors are alike count as one
    double max_second_best_ratio = 1e-4;     ///< likelihood of the best other hypothesis over that of the best
    double agrees_rad = 0.026;               ///< of a direction in which picture and model agree: 1.5 degrees
    double min_agreement = 0.7;              ///< of the directions with a roof's edge, in the mean of the pictures
    double scale_sigma = 0.05;               ///< relative, of the odometry's metre
    int headings = 8;                        ///< degrees to each side of a signature's heading that are tried
    double noise_rad = 0.4 * std::numbers::pi / 180;  ///< least mean loss believed; the matcher's is for one place
    double correlated_directions = 12;                ///< neighbouring directions that err together: six degrees
    double reach = 1.6;  ///< spacings to a place of the database: farther is within a building
    size_t refined = 8;  ///< hypotheses, after each picture
    int steady = 2;      ///< pictures in a row for which the same hypothesis must be the only one
  };

  /// `offset_n`: from the database's n to the one that is used. The database outlives it.
  PlaceFinder(const Parameters& parameters, const SkylineDatabase& database, const Eigen::Vector3d& offset_n)
      : p_(parameters), database_(database), offset_n_(offset_n) {}

  /// A place and what turns the odometry's directions into n's.
  struct Found {
    Eigen::Vector3d p_n;
    double yaw_rad;
    double agreement, second_best_ratio;
  };
  /// Adds a picture: its sky's edge in c, its orientation with the right inclination and any heading, its place by the
  /// odometry in metres. Tells the place once one hypothesis stands alone.
  std::optional<Found> add(const std::vector<SkyEdge>& edges, const Eigen::Quaterniond& q_n_c,
                           const Eigen::Vector3d& p_odometry, const Spend& spend);
  /// Whether a picture from here would be far enough from the one before.
  bool wants(const Eigen::Vector3d& p_odometry) const;
  /// Forgets all pictures: the odometry has lost its thread.
  void clear();
  size_t pictures() const { return pictures_.size(); }
  /// Likelihood of the second-best hypothesis over that of the best, after the latest picture.
  double second_best_ratio() const { return second_best_ratio_; }

 private:
  struct Picture {
    SeenSkyline seen;
    Eigen::Vector3d p;
  };
  /// Of the newest picture's place, in the database's n, and of what turns and stretches the odometry's path.
  struct Hypothesis {
    Eigen::Vector3d p;
    double yaw = 0, scale = 1, cost = 0;
  };

  void search(std::vector<Hypothesis>& found, const Spend& spend);
  std::vector<Hypothesis> coarse(const SeenSkyline& seen, const Spend& spend) const;
  Hypothesis look_closely(const SeenSkyline& seen, const Hypothesis& at) const;
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
  int alone_ = 0;
};

}  // namespace odograph::skyline
