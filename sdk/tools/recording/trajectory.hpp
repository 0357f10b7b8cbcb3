// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "sdk/host/base/result.hpp"

namespace odograph {

/// A stamped pose: q rotates vectors from the moving frame to the reference frame; p is in the reference frame, m.
struct StampedPose {
  int64_t t_ns = 0;
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
};
using StampedPoses = std::vector<StampedPose>;

/// A surveyed position and the time at which it was passed.
struct Waypoint {
  int64_t t_ns;
  Eigen::Vector3d p_n;
};

/// Converts decimal seconds to nanoseconds without loss of precision.
Result<int64_t> parse_seconds(std::string_view text);
/// "12.345678901", nine decimals.
std::string format_seconds(int64_t t_ns);

inline constexpr int64_t kKittiInterval_ns = 100'000'000;  // of poses without times

/// TUM: `seconds x y z qx qy qz qw`, or w first if a comment at the head names the columns so; times of more than 12
/// digits are nanoseconds (ORB-SLAM3). Lines with '#' are comments. Failures state file:line.
Result<StampedPoses> read_tum(const std::filesystem::path& path);
/// KITTI odometry: twelve numbers per line, the upper 3x4 of T_world_camera. Times from `times` (seconds, one per
/// line), or 10 Hz.
Result<StampedPoses> read_kitti_poses(const std::filesystem::path& path, const std::filesystem::path& times);
/// EuRoC state_groundtruth_estimate0/data.csv: t_ns, p, q (w x y z), ... A time with a decimal point is in seconds.
Result<StampedPoses> read_euroc_truth(const std::filesystem::path& path);

/// Whether a sensor clock's time must be Unix time: after 2001 and before 2096.
constexpr bool is_unix_time(int64_t t_ns) {
  return t_ns >= 1'000'000'000'000'000'000 && t_ns < 4'000'000'000'000'000'000;
}

/// Writes a track in TUM format, with 12 digits.
void write_tum(std::ostream& out, const StampedPoses& trajectory);
/// Writers by the file's extension: .tum/.txt, .kitti, .csv, and georeferenced .gpx, .kml, .geojson (`to_geodetic`
/// returns latitude and longitude in rad and height in m for a position; without it these formats are refused). The
/// latter have times if the clock is Unix time.
using ToGeodetic = std::function<std::array<double, 3>(const Eigen::Vector3d& p_n)>;
Result<bool> write_trajectory(const std::filesystem::path& path, const StampedPoses& trajectory,
                              const ToGeodetic& to_geodetic);

/// Length of the polyline through all positions, m.
double path_length(const StampedPoses& trajectory);

}  // namespace odograph
