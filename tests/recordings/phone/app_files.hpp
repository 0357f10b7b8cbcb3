// SPDX-License-Identifier: Apache-2.0
//
// A walk in the format of each app, for tests: names, columns, units, signs and clocks.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "sdk/tools/recording/recording.hpp"

constexpr int64_t kEpoch_ns = 1'781'801'311'000'000'000;  // typical for Sensor Logger's times

/// Input of an app: the walk's sensor samples and pictures.
struct PhoneWalk {
  odograph::Recording recording;  ///< with the camera mount of phones and Unix times
  odo_calibration lens{};
  std::vector<cv::Mat> pictures;
  std::vector<int64_t> times_ns;
};

/// A recorded walk with a phone: the body axes become the phone's, with a phone's camera mount; upright: its pictures
/// are rotated to portrait.
PhoneWalk phone_walk(const odograph::Recording& walk, bool upright);

/// The start of a walk through a street, 12 m, with jitter of the inertial samples.
const PhoneWalk& street_walk(bool upright);

/// The walk's own recording with its own pictures: the reference for the apps'.
void write_direct(const PhoneWalk& walk, const std::filesystem::path& file);

struct App {
  std::string name;  ///< of the format, as reported by the reader
  std::function<void(const PhoneWalk&, const std::filesystem::path& folder)> write;
  bool has_lens = false;  ///< the app writes it; otherwise the test adds a camera.yaml
};
const std::vector<App>& apps();

/// The walk as recorded by ROS 2.
void write_ros2_mcap(const PhoneWalk& walk, const std::filesystem::path& folder);
/// Covariance from north, east, down to east, north, up.
void east_north_up(const double* n, double* e);

/// A camera.yaml with the lens alone.
void write_lens(const PhoneWalk& walk, const std::filesystem::path& folder);

/// A zip of a folder; with the given names where `names` has them.
void write_zip(const std::filesystem::path& folder, const std::filesystem::path& zip,
               const std::string& prefix = std::string());
