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

/// Latitude, longitude (rad) and height (m) of a track's frame n.
using Origin = std::optional<std::array<double, 3>>;

/// What converters outwards take: a track with the recording that it is of, and what a run wrote beside it.
struct ExportedRun {
  Recording recording;
  Trajectory track;  ///< of the camera where the recording has one, in n; the recording's truth where it is no run's
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
};

/// A run's folder with the recording that its summary names, or another; or a recording with its truth. A run whose
/// recording is gone is a failure that says how to name it.
Result<ExportedRun> read_exported_run(const std::filesystem::path& input, const std::string& recording,
                                      const ReadOptions& options);

/// The origin in a run's summary.json; none where the run never knew it.
Origin origin_in_summary(const std::filesystem::path& summary);

struct Exported {
  size_t poses = 0, pictures = 0;
  uint64_t pictures_lost = 0;  ///< that could not be read
  size_t without_pose = 0;     ///< pictures at whose time there is no pose, left out
};
using ExportProgress = std::function<void(size_t done, size_t all)>;

/// MCAP with Foxglove's schemas as JSON: transforms, poses, the whole track, pictures, lens, fixes, IMU, and where it
/// is a run's its scale and states. The world has x to the east, y to the north, z up.
Result<Exported> write_foxglove(const ExportedRun& run, const std::filesystem::path& file,
                                const ExportProgress& progress);

/// A folder for COLMAP: images/ and in sparse/ a text model with lens and poses, without points.
Result<Exported> write_colmap(const ExportedRun& run, const std::filesystem::path& folder, double every_s,
                              const ExportProgress& progress);
/// transforms.json as nerfstudio reads it, with images/ beside it; z up, x to the east.
Result<Exported> write_transforms(const ExportedRun& run, const std::filesystem::path& file, double every_s,
                                  const ExportProgress& progress);

}  // namespace odograph
