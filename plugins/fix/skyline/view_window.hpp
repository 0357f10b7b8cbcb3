// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Geometry>

#include "plugins/fix/skyline/matcher.hpp"

namespace odograph::skyline {

/// The pictures of the path's end that are matched together, where one alone sees too little.
class ViewWindow {
 public:
  struct Parameters {
    double apart_m = 2;       ///< two pictures nearer to each other than this err together,
    double turned_rad = 0.5;  ///< unless one looks elsewhere: half a narrow picture's width
    size_t most = 10;         ///< pictures: 20 m of a straight street, two houses and the gaps between them
    double longest_m = 40;    ///< of the path: an odometry without fixes errs by a metre over it
  };

  ViewWindow() : ViewWindow(Parameters{}) {}
  explicit ViewWindow(const Parameters& parameters) : p_(parameters) {}

  /// Whether a picture from here would tell more than the newest one.
  bool wants(const Eigen::Vector3d& p_n, const Eigen::Quaterniond& q_n_c) const;
  /// Adds the newest picture, taken after `path_m` of the path; drops those that lie too far back.
  void add(View view, double path_m);
  /// What was at x in the old n is at q x + p in the new one.
  void correct(const Eigen::Quaterniond& q, const Eigen::Vector3d& p);
  void clear() { views_.clear(), path_m_.clear(), fresh_ = 0; }
  /// What is told of these pictures: the odometry errs by `drift` of the path between them; and since the next match
  /// has most of them once more, and errs with this one, the information of each is that of the pictures which are new.
  void doubt(Match& match, double drift);
  const std::vector<View>& views() const { return views_; }

 private:
  Parameters p_;
  std::vector<View> views_;     // the oldest first
  std::vector<double> path_m_;  // of each
  size_t fresh_ = 0;            // of them, the newest
};

}  // namespace odograph::skyline
