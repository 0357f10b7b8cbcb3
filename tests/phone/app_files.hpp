// SPDX-License-Identifier: Apache-2.0
//
// A walk as each of the apps writes it, for tests: their names, columns, units, signs and clocks.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "sdk/tools/recording/recording.hpp"

constexpr int64_t kEpoch_ns = 1'781'801'311'000'000'000;  // what Sensor Logger's times look like

/// What an app is given: the walk as sensors deliver it, and its pictures.
struct PhoneWalk {
  odograph::Recording recording;  ///< camera's mount is that of phones, times are Unix times
  odo_calibration lens{};
  std::vector<cv::Mat> pictures;
  std::vector<int64_t> times_ns;
};

/// A recorded walk carried by a phone: axes of the body become the phone's, so that the camera sits as phones have it;
/// upright: its pictures are rotated to stand upright in portrait.
PhoneWalk phone_walk(const odograph::Recording& walk, bool upright);

/// The begin of a walk through a street, 12 m, with jitter of the inertial samples.
const PhoneWalk& street_walk(bool upright);

/// The walk's own recording, with its own pictures: what the apps' are compared with.
void write_direct(const PhoneWalk& walk, const std::filesystem::path& file);

struct App {
  std::string name;  ///< of the format, as the reader says it
  std::function<void(const PhoneWalk&, const std::filesystem::path& folder)> write;
  bool has_lens = false;  ///< the app writes it; otherwise the test puts a camera.yaml beside
};
const std::vector<App>& apps();

/// The walk as ROS 2 records it.
void write_ros2_mcap(const PhoneWalk& walk, const std::filesystem::path& folder);
/// A covariance in north, east, down as one in east, north, up.
void east_north_up(const double* n, double* e);

/// A camera.yaml with the lens alone.
void write_lens(const PhoneWalk& walk, const std::filesystem::path& folder);

/// A zip of a folder; names as given where `names` has them.
void write_zip(const std::filesystem::path& folder, const std::filesystem::path& zip,
               const std::string& prefix = std::string());
