// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Geometry>

#include "plugins/fix/skyline/matcher.hpp"

namespace odograph::skyline {

/// The latest pictures of the path, which are matched jointly where a single one sees too little.
class ViewWindow {
 public:
  struct Parameters {
    double apart_m = 2;       ///< pictures nearer than this have common errors,
    double turned_rad = 0.5;  ///< unless their directions differ: half a narrow picture's width
    size_t most = 10;       ///< max number of pictures: 20 m of a straight street, two houses and the gaps between them
    double longest_m = 40;  ///< max length of the path: an odometry without fixes drifts by a metre over it
    double doubt_over_m = 10;  ///< the position's sigma over this distance adds to the heading's: a typical distance of
                               ///< a roof, as in PhotographMatcherParameters
  };

  ViewWindow() : ViewWindow(Parameters{}) {}
  explicit ViewWindow(const Parameters& parameters) : p_(parameters) {}

  /// Whether a picture from here would add information to the newest one.
  bool adds_information(const Eigen::Vector3d& p_n, const Eigen::Quaterniond& q_n_c) const;
  /// Adds the newest picture, taken after `path_m` of the path; drops those that lie too far back.
  void add(View view, double path_m);
  /// A correction of n moves x to q x + p.
  void correct(const Eigen::Quaterniond& q, const Eigen::Vector3d& p);
  void clear() { views_.clear(), path_m_.clear(), fresh_ = 0; }
  /// Inflates a match's covariance by the odometry's error, `drift` times the path of the pictures, and limits its
  /// information to that of the new pictures: consecutive matches share most pictures and therefore errors. A position
  /// that is wrong turns the roofs, so the heading's variance contains the position's.
  void inflate_covariance(Match& match, double drift);
  const std::vector<View>& views() const { return views_; }

 private:
  Parameters p_;
  std::vector<View> views_;     // oldest first
  std::vector<double> path_m_;  // of each view
  size_t fresh_ = 0;            // number of new views
};

}  // namespace odograph::skyline
