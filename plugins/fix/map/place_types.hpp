// SPDX-License-Identifier: Apache-2.0
//
// What goes into a map of places and what comes out of it. Frames: c, the camera of a picture (x right, y down, z
// ahead); k, the camera of a key frame; m, the map's own. Lengths in metres, angles in radians, pixels with 0, 0 in the
// centre of the first one.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <opencv2/core.hpp>

#include "plugins/shared/camera/camera_model.hpp"

namespace odograph::place_map {

struct Rigid {
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
  Eigen::Vector3d p = Eigen::Vector3d::Zero();

  Eigen::Vector3d operator*(const Eigen::Vector3d& x) const { return q * x + p; }
  Rigid operator*(const Rigid& other) const { return {(q * other.q).normalized(), q * other.p + p}; }
  Rigid inverse() const { return {q.conjugate(), -(q.conjugate() * p)}; }
};

/// A landmark of a picture, from odo_points.
struct Landmark {
  uint64_t id = 0;                                       ///< of its track, unique within an epoch
  Eigen::Vector3d p_c = Eigen::Vector3d::Zero();         ///< metres
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< of p_c
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
};

struct Picture {
  int64_t t_ns = 0;
  cv::Mat grey;                                       ///< 8 bits
  CameraModel lens;                                   ///< in pixels of `grey`
  Eigen::Vector3d down_c = Eigen::Vector3d::UnitY();  ///< unit vector
  double tilt_sigma_rad = 0.01;                       ///< of down_c, about each axis across it
};

/// A binary descriptor, 256 comparisons of intensity.
using Descriptor = std::array<uint64_t, 4>;
/// Bits set in two words; without a processor's own instruction, which x86-64 does not guarantee.
inline int bits_of(uint64_t a, uint64_t b) {
  constexpr uint64_t k1 = 0x5555555555555555u, k2 = 0x3333333333333333u, k4 = 0x0f0f0f0f0f0f0f0fu;
  a -= a >> 1 & k1, b -= b >> 1 & k1;
  const uint64_t nibbles = (a & k2) + (a >> 2 & k2) + (b & k2) + (b >> 2 & k2);
  return static_cast<int>(((nibbles & k4) + (nibbles >> 4 & k4)) * 0x0101010101010101u >> 56);
}
inline int hamming(const Descriptor& a, const Descriptor& b) {
  return bits_of(a[0] ^ b[0], a[1] ^ b[1]) + bits_of(a[2] ^ b[2], a[3] ^ b[3]);
}
/// The same, or 257 where the first half alone shows that it is beyond the limit, or is very likely to.
inline int hamming_within(const Descriptor& a, const Descriptor& b, int limit) {
  const int half = bits_of(a[0] ^ b[0], a[1] ^ b[1]);
  return half > limit / 2 + 12 ? 257 : half + bits_of(a[2] ^ b[2], a[3] ^ b[3]);
}

/// A landmark of a key frame, as it is kept and stored.
struct KeptLandmark {
  uint64_t id = 0;
  std::array<float, 3> p_k{};               ///< metres
  float across_sigma = 0, along_sigma = 0;  ///< across and along the ray, metres
  std::array<Descriptor, 2> descriptors{};  ///< in two octaves
  std::array<int8_t, 2> levels{-1, -1};     ///< of the descriptors; -1: there is none
};

struct KeyFrame {
  uint64_t id = 0;
  uint32_t epoch = 0;  ///< landmark ids are unique within it
  int64_t t_ns = 0;
  Rigid T_m_k;
  Eigen::Vector3d down_k = Eigen::Vector3d::UnitY();
  double tilt_sigma_rad = 0.01;
  double scale_sigma = 0.02;  ///< of all landmarks in common, relative
  std::vector<KeptLandmark> landmarks;
};

/// A picture's pose in a key frame.
struct Recognition {
  uint64_t key_frame = 0;
  int64_t t_ns = 0;  ///< of the picture
  Rigid T_k_c;
  /// Of rotation (left perturbation, in k) and position (in k), rad^2, rad m, m^2.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Identity();
  int inliers = 0;
  int cells = 0;                                       ///< of the picture with inliers
  Eigen::Vector3d normal_k = Eigen::Vector3d::Zero();  ///< of the plane of most matches, or zero
  int off_plane = 0;                                   ///< cells with matches that are not on it
  double share = 0;      ///< of the landmarks that should be in the picture, those that are
  double covered = 0;    ///< share of the picture's cells with landmarks in which one is found
  double log_odds = 0;   ///< natural logarithm: of this place against chance
  double runner_up = 0;  ///< the same of the best other place of the map
};

}  // namespace odograph::place_map
