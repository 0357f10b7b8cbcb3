// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "sdk/tools/recording/read_table.hpp"
#include "sdk/tools/recording/recording.hpp"
#include "sdk/tools/recording/video.hpp"

namespace odograph::phone {

/// The files of a phone recording, by name relative to its folder, with '/' as separator.
struct Files {
  std::filesystem::path folder;
  std::shared_ptr<const void> keep;  ///< the folder that they were unpacked into
  std::vector<std::string> names;

  /// The first file that matches a pattern (its alternatives in order); empty if none does.
  std::string find(const std::string& pattern) const;
  std::vector<std::string> find_all(const std::string& pattern) const;
  /// A path that keeps the unpacked folder alive.
  std::shared_ptr<const std::filesystem::path> path(const std::string& name) const;
};

/// The files of a folder, two levels deep, without links and hidden files.
Files files_of(const std::filesystem::path& folder, std::shared_ptr<const void> keep);
/// The first format with a matching mark; null if none.
const Format* format_of(const Files& files);
/// Names and values of Sensor Logger's Metadata.csv, as far as readable.
std::map<std::string, std::string> metadata_of(const std::filesystem::path& file);

/// Lens and phone as stated by an app.
struct CameraFacts {
  std::string device;  ///< "iPhone14,5", "SM-S721B", or empty
  bool apple = false;
  bool has_lens = false, has_mount = false;
  bool frames_have_lens = true;  ///< focal lengths of single frames are as accurate as the lens
  odo_calibration calibration{};
  std::string lens_from;  ///< for messages: "calibration.json"
};

/// Camera to body from p_camera = T p_imu, row-major; false if its rotation is invalid or its translation exceeds 10 m.
bool set_mount(odo_calibration& camera, const double (&T)[12]);

/// Reads the app's own files beside the tables: camera.yaml, Kalibr's camchain, calibration.json, camera_matrix.csv,
/// video_meta.pb3.
Result<CameraFacts> camera_facts(const Files& files, std::vector<std::string>& warnings);

/// Lens and mount for pictures of a size, stated or guessed; each guess is a warning. `times` may contain focal
/// lengths, or be null.
Result<odo_calibration> calibration_of(CameraFacts facts, const Rows* times, uint32_t width, uint32_t height,
                                       Recording& recording);

/// Adds the calibration and all frames; guesses and skipped frames are added to the recording's warnings. `times`: of
/// Stream::frame, or null. A recording without video and pictures is not a failure, but a warning.
Result<bool> add_camera(Recording& recording, const Format& format, const Files& files, const Rows* times,
                        CameraFacts facts);

}  // namespace odograph::phone
