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

/// Where a phone recording's files lie: by name relative to its folder, '/' between parts.
struct Files {
  std::filesystem::path folder;
  std::shared_ptr<const void> keep;  ///< what they were unpacked into
  std::vector<std::string> names;

  /// The first that matches a pattern (its alternatives in order); empty where none does.
  std::string find(const std::string& pattern) const;
  std::vector<std::string> find_all(const std::string& pattern) const;
  /// A path that keeps the unpacked folder for as long as it is.
  std::shared_ptr<const std::filesystem::path> path(const std::string& name) const;
};

/// The files of a folder, two levels deep, links and hidden ones left aside.
Files files_of(const std::filesystem::path& folder, std::shared_ptr<const void> keep);
/// The first format of which a mark is there; null where none is.
const Format* format_of(const Files& files);
/// Sensor Logger's Metadata.csv: names and values, as far as it can be read.
std::map<std::string, std::string> metadata_of(const std::filesystem::path& file);

/// What an app says of its lens and phone, as far as it does.
struct CameraFacts {
  std::string device;  ///< "iPhone14,5", "SM-S721B", or empty
  bool apple = false;
  bool has_lens = false, has_mount = false;
  bool frames_have_lens = true;  ///< focal lengths of single frames are as good as the lens
  odo_calibration calibration{};
  std::string lens_from;  ///< for the words: "calibration.json"
};

/// Camera to body out of p_camera = T p_imu, row by row; false where its rotation is none or its shift more than 10 m.
bool set_mount(odo_calibration& camera, const double (&T)[12]);

/// What the app's own files beside the tables say: camera.yaml, Kalibr's camchain, calibration.json, camera_matrix.csv,
/// video_meta.pb3.
Result<CameraFacts> camera_facts(const Files& files, std::vector<std::string>& warnings);

/// Lens and mount for pictures of a size, given or guessed; each guess is a warning. `times` may have focal lengths, or
/// be null.
Result<odo_calibration> calibration_of(CameraFacts facts, const Rows* times, uint32_t width, uint32_t height,
                                       Recording& recording);

/// Adds the calibration and all frames; what is guessed or left out goes into the recording's warnings. `times` is of
/// Stream::frame, or null. No video and no pictures is no failure, but said.
Result<bool> add_camera(Recording& recording, const Format& format, const Files& files, const Rows* times,
                        CameraFacts facts);

}  // namespace odograph::phone
