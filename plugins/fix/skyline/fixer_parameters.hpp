// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <string>

namespace odograph::skyline {

/// Configuration of the fixer; the parameter table in plugin.cpp describes each value.
struct FixerConfig {
  std::string model, skylines;
  std::array<double, 3> model_origin = {0, 0, 0}, geodetic_origin = {0, 0, 0};
  bool geodetic = false;
  double geoid_height = 0;
  std::string sky = "robust", inclination = "pose", matching = "robust";
  double interval = 0.5, min_agreement = 0.75, tilt_sigma = 0.6 * std::numbers::pi / 180, min_sigma = 0.2, radius = 40;
  double height_sigma = 1.0;
  bool start_known = true, join = false, survey = true, photographs = false;
};

/// Parameters of the fixer that are not in the config. Unless a source is named, chosen empirically on drives and walks
/// through a model of Delft (`odograph city bench`); no sweep is recorded.
struct FixerParameters {
  static constexpr double kDegree = std::numbers::pi / 180;

  // The prior.
  double unplaced_sigma_m = 1000;  ///< sigma of a pose without an initial position
  double unscaled_sigma_m = 2.5;   ///< min sigma without metric scale: a car's displacement between its first fixes
  double min_yaw_rad = 1 * kDegree, max_yaw_rad = 60 * kDegree;  ///< sigma; three times the latter means any heading
  double max_tilt_rad = 3 * kDegree;                             ///< sigma
  double no_heading_rad = 20 * kDegree;  ///< sigma above which the heading is treated as unknown
  double max_off = 2;  ///< of the path since the last fix: the error of motion opposite to the estimated heading
  double max_scale_sigma = 0.2;  ///< max relative sigma of the scale: beyond, a path of 20 m fits no place

  // Before the first fix: the ring around the start.
  double slack_m = 6, slack_of_path = 0.05;  ///< its width: a constant, and a fraction of the path
  double farthest_from_start_m = 150;        ///< no ring is searched beyond: the work grows with its length

  // Failures in a row.
  int failures_until_lost = 4;          ///< then the offset on which several pictures agree is searched
  int failures_until_search = 20;       ///< then the whole database is searched
  double failed_yaw_rad = 1 * kDegree;  ///< added to the heading's sigma per failure, with joined pictures
  double farthest_survey_m = 15;        ///< max three sigmas of the pose's position for a survey, which searches 12 m
  double min_survey_sigma_m = 0.5;      ///< of its prior: the pose's own sigma excludes errors of the map
  // A place found in a database.
  double found_sigma_m = 1.5, found_sigma_rad = 2 * kDegree;  ///< sigmas, from several pictures
  double found_apart_m = 3;  ///< max distance of the newest picture's own match from it

  // The height above n's origin.
  double road_height_m = 0.05;      ///< sigma added from fix to fix
  double min_height_sigma_m = 0.1;  ///< lower bound

  // Pictures that are joined.
  size_t min_of_view = 40;          ///< directions with a roof's edge: 20 degrees
  double drift = 0.02;              ///< error of the odometry, as a fraction of the path between pictures or since one
  int64_t late_ns = 2'500'000'000;  ///< estimators keep a history for steps, which come up to 3 s late

  // Work, in units of an edge or a direction compared (README, "Worker thread").
  double work_per_second = 48e6;                        ///< per second of sensor time: a quarter of a core
  uint64_t min_slice = 400'000, max_slice = 3'200'000;  ///< per frame: 2 and 16 ms
  uint64_t sky_work = 10;                               ///< per pixel

  double min_integrity = 0.01;  ///< lower bound of the risk that a fix is wrong
};

}  // namespace odograph::skyline
