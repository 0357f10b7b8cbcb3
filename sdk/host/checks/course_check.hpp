// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include <Eigen/Core>
#include <odograph/samples.h>

#include "sdk/host/checks/input_fault.hpp"
#include "sdk/math/ring.hpp"

namespace odograph {

/// Compares the path by positions with what else is said of it, leg by leg. Its bends go to the other side than those
/// by the gyroscope where latitude and longitude are exchanged, or one has lost its sign; the velocities of the same
/// messages lead elsewhere where they are in another unit or in other axes. No allocation. Not thread-safe.
class CourseCheck {
 public:
  struct Parameters {
    double min_leg_m = 8,
           sigmas = 4;  ///< of a leg, also in standard deviations of a position: its direction to 0.25 rad
    double bend_rad = 0.6,
           max_bend_rad = 2.4;  ///< of a bend that tells: more than legs are off, less than a turning back
    double same_rad = 0.6;      ///< by which both may differ; exchanged axes distort a right angle by 0.4
    int opposed = 4;            ///< with no leg between them that contradicts: a phone that is turned in the hand or
                                ///< positions that are reflected by buildings give two or three by chance
    double max_gap_s = 3;       ///< s between velocities that are integrated
    double differs = 0.2;       ///< mean square by which the velocities' path is off, of a leg of 1; judgement
    double explained = 0.25;    ///< share of the velocities' path that another unit or other axes do not explain, ...
    double better = 0.5;        ///< ... and of what the right unit and axes do not: a straight path fits many axes
    double other_unit = 1.5;    ///< factor, or its inverse: a knot is 0.51 m/s; positions with errors make it 0.8
    double wandering = 0.2;     ///< factor below which positions wander and nobody moves; a km/h is 0.28 m/s
  };

  void add(const odo_gnss& gnss, const FaultFound& found);
  /// `yaw_rad`: to the right about the vertical, since the sample before.
  void turn(double yaw_rad) { turned_rad_ += yaw_rad, sum_rad_ += turned_rad_, ++samples_; }
  void reset() { *this = CourseCheck(); }

 private:
  /// Of a leg, north and east, over its length: by positions and by the velocities meanwhile.
  struct Paths {
    Eigen::Vector2d positions, velocities;
  };
  void integrate(const odo_gnss& gnss, const FaultFound& found);
  void compare_paths(const FaultFound& found) const;
  double product(const SignedAxes& axes) const;
  void compare_bends(double course_rad, const FaultFound& found);

  Parameters p_;
  std::optional<odo_gnss> last_;            // with a velocity
  std::optional<Eigen::Vector2d> moved_m_;  // by velocities in this leg; nothing: there is a gap
  Ring<Paths, 8> paths_;
  double latitude_rad_ = 0, longitude_rad_ = 0;  // where the leg begins
  int legs_ = -1;                                // -1: no position yet
  double turned_rad_ = 0, sum_rad_ = 0;          // since the beginning; summed over the samples of this leg
  int samples_ = 0;
  double course_rad_ = 0, mean_turned_rad_ = 0;  // of the leg before
  int opposed_ = 0;
};

}  // namespace odograph
