// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>

#include <Eigen/Geometry>
#include <opencv2/core.hpp>

namespace odograph::known_object {

/// Position and orientation of an object, in n or geodetic.
struct Place {
  bool geodetic = false;                                ///< latitude etc. are valid and p_n is not
  double latitude_rad = 0, longitude_rad = 0;           ///< WGS 84
  double height_m = 0;                                  ///< above the ellipsoid
  Eigen::Vector3d p_n = Eigen::Vector3d::Zero();        ///< m; valid if not geodetic
  Eigen::Matrix3d R_n_o = Eigen::Matrix3d::Identity();  ///< o: x right, y down, z into the board, for a reader
};

/// A planar rectangle of known picture, size and position. The origin of its frame o is its centre.
struct PlaneObject {
  std::string id;
  cv::Mat picture;  ///< 8-bit grey, the whole rectangle, upright
  double width_m = 0, height_m = 0;
  Place place;
  double sigma_m = 0.01;  ///< standard deviation of each surveyed corner, in each direction
  int tag = -1;           ///< number within the family; negative: found by its picture
  std::string family;     ///< 36h11, 25h9 or 16h5

  /// Lower left, lower right, upper right, upper left in o, m.
  std::array<Eigen::Vector3d, 4> corners_o() const {
    const double x = 0.5 * width_m, y = 0.5 * height_m;
    return {{{-x, y, 0}, {x, y, 0}, {x, -y, 0}, {-x, -y, 0}}};
  }
};

/// Length of a radian of latitude and longitude, m (WGS 84).
struct RadianLengths {
  explicit RadianLengths(double latitude_rad);
  double north_m, east_m;
};

/// Sets size and position from four corners in n (lower left, lower right, upper right, upper left for a reader), or in
/// north, east, down about any point for a geodetic position, whose centre remains unchanged. Throws std::runtime_error
/// if they deviate from a rectangle by more than five sigma and a hundredth of its size.
void place_by_corners(const std::array<Eigen::Vector3d, 4>& corners, PlaneObject& object);

/// Picture of a tag up to the outside of its black border. Throws std::runtime_error for an unknown tag.
cv::Mat tag_picture(const std::string& family, int tag);

}  // namespace odograph::known_object
