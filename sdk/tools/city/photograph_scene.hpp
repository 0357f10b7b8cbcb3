// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include <Eigen/Geometry>
#include <opencv2/core.hpp>

#include "sdk/host/base/result.hpp"
#include "sdk/tools/simulation/city_model.hpp"

namespace odograph {

/// Differences between the simulated world and its model, and camera placement.
struct PhotographSceneParameters {
  double roof_sigma_m = 1.5;                   ///< sigma of the height error of each building's roofs in the model
  double min_height_m = 2.5;                   ///< min height of a building
  double trees_per_ha = 10, cars_per_ha = 15;  ///< beside walls; no tree nearer than 5 m to the camera
  double nearest_wall_m = 2.5, farthest_wall_m = 12;  ///< of the camera, from the next building
  double view_m = 12;                                 ///< min distance to buildings ahead: no photographs of walls
  double built_part = 0.7, built_m = 60;              ///< min fraction of the width with a building so near: no fields
  double roofs_from_m = 8;                            ///< min distance of the roofs against the sky, which are
  double below_top_rad = 0.035, roofs_part = 0.6;     ///< this far below the upper edge in this fraction of the width
  double narrowest_rad = 1.047, widest_rad = 1.309;   ///< angle of the long side: 60 to 75 degrees
  double lowest_pitch_rad = 0.05, highest_pitch_rad = 0.35, roll_sigma_rad = 0.035;
  int width = 1024, height = 768;
};

struct SimulatedPhotograph {
  cv::Mat bgr;  ///< before compression
  cv::Mat sky;  ///< 255 where it shows the sky
  double focal_px;
  Eigen::Vector3d p_n;
  Eigen::Quaterniond q_n_c;
};

/// Renders photographs in a city model with height errors, trees and parked cars, through a phone's image processing:
/// exposure, tone curve, white balance, sharpening, noise. The seed of a world determines sun, clouds and facades.
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
