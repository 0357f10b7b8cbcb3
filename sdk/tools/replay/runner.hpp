// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <odograph/odograph.h>

#include "sdk/host/config/overrides.hpp"
#include "sdk/tools/evaluation/evaluation.hpp"
#include "sdk/tools/recording/recording.hpp"

namespace odograph {

/// Everything that a replay gave, as the files of a run have it.
struct RunResult {
  struct Fix {
    odo_fix fix;
    bool accepted;
  };
  Trajectory track;                       // in n; of the camera where the recording has one, otherwise of the body
  Trajectory corrected;                   // the same as known at the end; empty where nothing was corrected
  std::vector<uint32_t> states, reasons;  // of each pose
  size_t first_metric = 0;                // poses before it have no scale yet; the track's size where none has
  std::optional<std::array<double, 3>> origin;  // of n: latitude, longitude (rad), height (m), where the run knew it
  std::vector<odo_step> steps;
  std::vector<odo_vo_motion> motions;
  std::vector<int64_t> motions_known_ns;  // for each motion the time of the newest input when it came out
  std::vector<odo_calibration> refined;   // what the front-end refined the camera to
  std::vector<odo_scale> scales;
  std::vector<Fix> fixes;
  std::vector<odo_fix> accepted() const {
    std::vector<odo_fix> all;
    for (const Fix& fix : fixes)
      if (fix.accepted) all.push_back(fix.fix);
    return all;
  }
  std::vector<odo_motion_mode> modes;   // each from its own time until the next one's
  std::vector<odo_attitude> attitudes;  // where RunOptions asks for them
  std::vector<odo_pose> poses;          // all that came out, with their covariance; where RunOptions asks for them
  odo_statistics statistics{};
  std::vector<double> frame_ms;         // work between one camera pose and the next
  std::vector<double> frame_thread_ms;  // the same as processor time of the thread that pushes
  std::vector<double> imu_us;           // work of each IMU sample alone
  uint32_t final_state = 0;
  uint32_t final_reason = 0;
  double heading_offset_rad = 0;  // applied by replay.align_heading_over
  std::vector<std::string> reports;
  std::string state_failure;      // why the state could not be saved; the results are there all the same
  RecordingLoss loss;             // of the recording, with the pictures that turned out to be unreadable
  std::shared_ptr<void> session;  // where RunOptions asks for it
  /// What plugins said beside errors, by plugin and key: the latest text, and how often.
  struct Notice {
    uint64_t count = 0;
    std::string text;
  };
  std::map<std::string, Notice> notices;
  /// A plugin of the config; events have its number in header.source.
  struct Plugin {
    uint32_t number = 0;  ///< from 1
    std::string kind;     ///< as in the config: "step_estimator"
    std::string id, version;
    std::string sha256;  ///< of the library, from the manifest
  };
  std::vector<Plugin> plugins;
  std::string config_text;
};

struct RunOptions {
  std::string config;               // a YAML file
  std::vector<Override> overrides;  // values that take the place of the file's
  std::string plugin_path;
  std::string asset_path;  // folders of files that the config names, where they are not beside it
  std::string state;       // a file with what the plugins have learnt; read where it exists, and written anew
  uint64_t seed = 0;
  bool collect_timing = true;
  bool collect_attitudes = false;
  bool collect_poses = false;
  bool keep_session = false;  // it ends with the result: a plugin that fails in its end takes no results with it
  std::function<void(size_t done, size_t all)> progress;
  std::function<void(const RunResult&)> so_far;  // after each frame, what there is
};

/// Replays a recording through a session of the C API, deterministically.
Result<RunResult> replay(const Recording& recording, const RunOptions& options);

/// trajectory.tum (from the first pose on whose scale is known; all where none is), corrected.tum, vo.csv, steps.csv,
/// scale.csv, fixes.csv, states.csv, summary.json: all anew, or none where one cannot be written. Files of an older run
/// that this one has not are removed.
Result<bool> write_run(const std::filesystem::path& folder, const Recording& recording, const RunResult& result,
                       const RunOptions& options);

/// Peak resident memory of this process, MB.
double peak_rss_mb();

}  // namespace odograph
