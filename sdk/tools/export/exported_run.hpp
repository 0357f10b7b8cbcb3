// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "sdk/tools/recording/recording.hpp"

namespace odograph {

/// Latitude, longitude (rad) and height (m) of the origin of a track's frame n.
using Origin = std::optional<std::array<double, 3>>;

/// Input of the exporters: a track with its recording, and the run's other output.
struct ExportedRun {
  Recording recording;
  StampedPoses track;  ///< of the camera if the recording has one, in n; the truth if the input is a recording
  Origin origin;
  struct Scale {
    int64_t t_ns;
    double scale, sigma;
    std::string source;  ///< the plugin
    bool used;
  };
  std::vector<Scale> scales;
  struct State {
    int64_t t_ns;
    std::string state, reason;
  };
  std::vector<State> states;
  std::vector<Eigen::Vector3f> points;  ///< landmarks in n
};

/// Reads a run's folder with the recording that its summary names, or another one; or a recording with its truth. If
/// the run's recording is missing, the failure states how to name it.
Result<ExportedRun> read_exported_run(const std::filesystem::path& input, const std::string& recording,
                                      const ReadOptions& options);

/// The origin in a run's summary.json; none if the run had no origin.
Origin origin_in_summary(const std::filesystem::path& summary);

struct Exported {
  size_t poses = 0, pictures = 0;
  uint64_t pictures_lost = 0;  ///< unreadable
  size_t without_pose = 0;     ///< pictures without a pose at their time, skipped
};
using ExportProgress = std::function<void(size_t done, size_t all)>;

/// Writes MCAP with Foxglove's schemas as JSON: transforms, poses, the whole track, pictures, lens, fixes, IMU, and for
/// a run its scale, states and landmarks. The world frame has x east, y north, z up.
Result<Exported> write_foxglove(const ExportedRun& run, const std::filesystem::path& file,
                                const ExportProgress& progress);

/// Writes a folder for COLMAP: images/, and in sparse/ a text model with lens and poses, without points.
Result<Exported> write_colmap(const ExportedRun& run, const std::filesystem::path& folder, double every_s,
                              const ExportProgress& progress);
/// Writes transforms.json for nerfstudio, with images/ beside it; z up, x east.
Result<Exported> write_transforms(const ExportedRun& run, const std::filesystem::path& file, double every_s,
                                  const ExportProgress& progress);

}  // namespace odograph
