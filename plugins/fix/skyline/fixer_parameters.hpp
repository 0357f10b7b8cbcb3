// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <numbers>

namespace odograph::skyline {

/// When the fixer looks, how far, and what it tells: what a config does not say. Unless a source is named, chosen by
/// hand on drives and walks through a model of Delft (`odograph city bench`); no sweep of it is recorded.
struct FixerParameters {
  static constexpr double kDegree = std::numbers::pi / 180;

  // The prior.
  double nowhere_m = 1000;  ///< sigma of a pose that nobody has placed yet
  double unscaled_m = 2.5;  ///< least sigma without a metre: what a car drives from fix to fix at first
  double min_yaw_rad = 1 * kDegree, max_yaw_rad = 60 * kDegree;  ///< sigma; three times the latter is any heading
  double max_tilt_rad = 3 * kDegree;                             ///< sigma
  double no_heading_rad = 20 * kDegree;  ///< sigma, from where on the heading is taken as unknown
  double max_off = 2;       ///< of the path since the last fix: one who goes the opposite direction to what was thought
  double path_metre = 0.2;  ///< relative sigma of the metre: a path of 20 m is so long or short that no place fits it

  // Before the first fix: the ring around the start.
  double slack_m = 6, slack_of_path = 0.05;  ///< its width: of itself, and of the path
  double farthest_from_start_m = 150;        ///< beyond, no ring is searched: the work grows with its length

  // Failures in a row.
  int doubtful = 4;                     ///< then the offset is looked for that several pictures agree on
  int hopeless = 20;                    ///< then a whole database is searched
  double failed_yaw_rad = 1 * kDegree;  ///< of doubt about the heading, for each of them, of joined pictures

  // A place found in a database.
  double found_sigma_m = 1.5, found_sigma_rad = 2 * kDegree;  ///< by several pictures
  double found_apart_m = 3;                                   ///< the newest picture's own match lies so near it

  // The height over n's origin.
  double road_height_m = 0.05;      ///< sigma that it gains from fix to fix
  double min_height_sigma_m = 0.1;  ///< at least

  // Pictures that are joined.
  size_t min_of_view = 40;          ///< directions with a roof's edge: 20 degrees
  double drift = 0.02;              ///< of the path between pictures, or since one: what the odometry errs by
  int64_t late_ns = 2'500'000'000;  ///< an estimator keeps the past for steps, which come up to 3 s late

  // Work, in units of an edge or a direction compared (README, "On a thread of its own").
  double work_per_second = 48e6;                        ///< of sensor time: a quarter of a core
  uint64_t min_slice = 400'000, max_slice = 3'200'000;  ///< of a frame: 2 and 16 ms
  uint64_t sky_work = 10;                               ///< of a pixel

  double elsewhere = 0.1;  ///< probability of other places, from where on they are what speaks against a photograph
  double min_integrity = 0.01;  ///< risk that a fix is wrong, at least
};

}  // namespace odograph::skyline
