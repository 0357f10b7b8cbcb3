// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <opencv2/core.hpp>

#include "sdk/host/plugin_host/instance.hpp"

struct odo_skylines;

namespace odograph {

/// Origin of n: geodetic, or in the model's own coordinates.
struct PhotographOrigin {
  std::optional<std::array<double, 2>>
      geodetic_deg;  ///< latitude, longitude; needs a supported reference system of the model
  Eigen::Vector3d model = Eigen::Vector3d::Zero();  ///< otherwise easting, northing, height
};

/// Prior position and heading of a photograph.
struct PhotographGuess {
  double north_m = 0, east_m = 0, sigma_m = 10;  ///< in n; of each
  std::optional<double> heading_rad;             ///< none: any heading
  double heading_sigma_rad = 0.35;
};

struct PhotographPose {
  bool placed = false;
  std::string why;  ///< reason where it is not placed
  Eigen::Vector3d p_n = Eigen::Vector3d::Zero();
  Eigen::Quaterniond q_n_c = Eigen::Quaterniond::Identity();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();  ///< of north and east, m^2
  double heading_sigma_rad = 0, height_sigma_m = 0;
  double integrity = 1;  ///< probability that the camera is elsewhere
  double agreement = 0;  ///< fraction of the sky's edge that lies on the model's roofs

  double heading_rad() const;  ///< of the optical axis, from north to the east
  double pitch_rad() const;    ///< of the axis above the horizon
  double roll_rad() const;     ///< clockwise
  double sigma_m() const;      ///< along the worst axis
};

/// fix/skyline with `photographs: true`: computes a fix from a frame and a pose with its covariance, or reports the
/// reason why not.
class PhotographLocalizer {
 public:
  static Result<std::unique_ptr<PhotographLocalizer>> make(const std::filesystem::path& model,
                                                           const PhotographOrigin& origin);
  ~PhotographLocalizer();

  /// `photograph`: 8-bit BGR, upright, square pixels, with the optical axis at its centre.
  Result<PhotographPose> estimate_pose(const cv::Mat& photograph, double focal_px, const PhotographGuess& guess);
  /// The model's reference system and its transformation, in words; empty without a geodetic origin.
  const std::string& reference_system() const;
  /// The model's skyline from a place: elevation (rad) of 720 directions from north to the east.
  std::vector<float> skyline(const Eigen::Vector3d& p_n) const;
  struct Ground {
    double down_m;
    bool terrain;  ///< from the model's terrain; false: from the buildings around
  };
  std::optional<Ground> ground(const Eigen::Vector2d& north_east) const;
  /// Edges of buildings within `radius_m` of a place, pairs of points.
  std::vector<std::array<Eigen::Vector3d, 2>> edges_near(const Eigen::Vector2d& north_east, double radius_m) const;

 private:
  class Host;
  PhotographLocalizer();
  const odo_skylines* table() const;

  std::unique_ptr<Host> host_;
  std::unique_ptr<PluginInstance> plugin_;
  int64_t t_ns_ = 0;
};

}  // namespace odograph
