// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include <Eigen/Geometry>
#include <opencv2/core.hpp>

#include "sdk/host/base/result.hpp"
#include "sdk/tools/simulation/city_model.hpp"

namespace odograph {

/// What the world of simulated photographs has that its model does not, and how they are taken.
struct PhotographSceneParameters {
  double roof_sigma_m = 1.5;                   ///< by which each building's roofs are higher or lower than in the model
  double min_height_m = 2.5;                   ///< that a building keeps
  double trees_per_ha = 10, cars_per_ha = 15;  ///< beside walls; no tree nearer than 5 m to the photographer
  double nearest_wall_m = 2.5, farthest_wall_m = 12;  ///< of the photographer, from the next building
  double view_m = 12;                                 ///< free of buildings where the camera looks: nobody takes a wall
  double built_part = 0.7, built_m = 60;  ///< of the picture's width has a building so near: nobody takes a field
  double roofs_from_m = 8;                ///< what stands against the sky is farther away, and
  double below_top_rad = 0.035, roofs_part = 0.6;    ///< so far below the upper edge in this part of the width
  double narrowest_rad = 1.047, widest_rad = 1.309;  ///< angle of the long side: 60 to 75 degrees
  double lowest_pitch_rad = 0.05, highest_pitch_rad = 0.35, roll_sigma_rad = 0.035;
  int width = 1024, height = 768;
};

struct SimulatedPhotograph {
  cv::Mat bgr;  ///< before it is compressed
  double focal_px;
  Eigen::Vector3d p_n;
  Eigen::Quaterniond q_n_c;
};

/// Takes photographs in a city model whose roofs are wrong, with trees and parked cars, through what a phone makes of
/// the light: exposure, tone curve, white balance, sharpening, noise. A world for each seed of sun, clouds and facades.
class PhotographScene {
 public:
  PhotographScene(const CityModel& city, uint64_t seed, const PhotographSceneParameters& parameters = {});
  ~PhotographScene();
  Result<SimulatedPhotograph> take(uint64_t number);

 private:
  bool sees_roofs(const Eigen::Vector3d& eye_n, double heading, double pitch, double angle) const;
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace odograph
