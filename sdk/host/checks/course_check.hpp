// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <odograph/samples.h>

#include "sdk/host/checks/input_fault.hpp"

namespace odograph {

/// Compares the bends of the path by positions with those by the gyroscope: they bend to the other side where latitude
/// and longitude are exchanged, or one has lost its sign. No allocation. Not thread-safe.
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
  };

  void add(const odo_gnss& gnss, const FaultFound& found);
  /// `yaw_rad`: to the right about the vertical, since the sample before.
  void turn(double yaw_rad) { turned_rad_ += yaw_rad, sum_rad_ += turned_rad_, ++samples_; }
  void reset() { *this = CourseCheck(); }

 private:
  Parameters p_;
  double latitude_rad_ = 0, longitude_rad_ = 0;  // where the leg begins
  int legs_ = -1;                                // -1: no position yet
  double turned_rad_ = 0, sum_rad_ = 0;          // since the beginning; summed over the samples of this leg
  int samples_ = 0;
  double course_rad_ = 0, mean_turned_rad_ = 0;  // of the leg before
  int opposed_ = 0;
};

}  // namespace odograph
