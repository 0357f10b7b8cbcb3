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
#include <odograph/scene.h>

#include "sdk/host/config/overrides.hpp"
#include "sdk/tools/evaluation/evaluation.hpp"
#include "sdk/tools/recording/recording.hpp"

namespace odograph {

/// The results of a replay, as written to the files of a run.
struct RunResult {
  struct Fix {
    odo_fix fix;
    bool accepted;
  };
  StampedPoses track;                     // in n; of the camera if the recording has one, otherwise of the body
  StampedPoses corrected;                 // the same with later corrections; empty without corrections
  std::vector<uint32_t> states, reasons;  // of each pose
  size_t first_metric = 0;  // number of poses before the first metric one; the track's size if there is none
  std::optional<std::array<double, 3>> origin;  // of n: latitude, longitude (rad), height (m), if known
  std::vector<odo_step> steps;
  std::vector<odo_vo_motion> motions;
  std::vector<int64_t> motions_emitted_ns;  // for each motion, the time of the newest input when it was emitted
  std::vector<odo_calibration> refined;     // camera parameters as refined by the front-end
  std::vector<odo_scale> scales;
  std::vector<Fix> fixes;
  std::vector<odo_fix> accepted() const {
    std::vector<odo_fix> all;
    for (const Fix& fix : fixes)
      if (fix.accepted) all.push_back(fix.fix);
    return all;
  }
  std::vector<odo_motion_mode> modes;   // each valid until the next one
  std::vector<odo_attitude> attitudes;  // if requested by RunOptions
  std::vector<odo_pose> poses;          // all published poses with covariance; if requested by RunOptions
  odo_statistics statistics{};
  std::vector<odo_key_frame> key_frames;  // as last published
  std::vector<odo_relative_pose> loops;   // accepted ones have ODO_FLAG_ACCEPTED
  std::vector<odo_map_pose> map_poses;    // likewise
  std::vector<odo_surface> surfaces;      // as published, without outlines
  std::vector<odo_map_point> points;      // landmarks that the session has at the end, in the n of `corrected`
  /// A surface that the session has at the end, likewise.
  struct Patch {
    uint64_t id = 0;
    std::string kind;  ///< "floor", "horizontal", "vertical" or "other"
    double sigma_m = 0;
    std::vector<Eigen::Vector3d> outline_n;
  };
  std::vector<Patch> patches;
  std::vector<double> frame_ms;         // work between consecutive camera poses
  std::vector<double> frame_thread_ms;  // the same as processor time of the pushing thread
  std::vector<double> imu_us;           // work of each IMU sample alone
  uint32_t final_state = 0;
  uint32_t final_reason = 0;
  double heading_offset_rad = 0;  // applied by replay.align_heading_over
  std::vector<std::string> reports;
  std::string nothing;  // why the run came to nothing (outcome.hpp), which is also a report; empty if it did not
  std::vector<std::string> save_failures;  // why state or map could not be saved; the results remain valid
  RecordingLoss loss;                      // of the recording, including unreadable pictures
  std::shared_ptr<void> session;           // if requested by RunOptions
  /// Reports of plugins other than errors, by plugin and key: the latest text, and the count.
  struct Notice {
    uint64_t count = 0;
    std::string text;
  };
  std::map<std::string, Notice> notices;
  /// A plugin of the config; events carry its number in header.source.
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
  std::vector<Override> overrides;  // replace values of the file
  std::string plugin_path;
  std::string asset_path;  // folders of files named by the config, if not beside it
  std::string state;       // file of the plugins' saved state; read if it exists, and rewritten
  std::string map;         // file of the map of places; likewise
  uint64_t seed = 0;
  bool collect_timing = true;
  bool collect_attitudes = false;
  bool collect_poses = false;
  bool keep_session = false;  // keep it with the result: a plugin that crashes in destruction then loses no results
  std::function<void(size_t done, size_t all)> progress;
  std::function<void(const RunResult&)> so_far;                  // called after each frame with the results so far
  std::function<void(odo_session*, const RunResult&)> at_frame;  // the same, to query the session
};

/// Replays a recording through a session of the C API, deterministically.
Result<RunResult> replay(const Recording& recording, const RunOptions& options);

/// Writes trajectory.tum (from the first metric pose on; all poses if there is none), corrected.tum, vo.csv, steps.csv,
/// scale.csv, fixes.csv, states.csv, points.ply and surfaces.json (what remains at the end), summary.json: all of them,
/// or none if one cannot be written. Removes files of an older run that this one does not have.
Result<bool> write_run(const std::filesystem::path& folder, const Recording& recording, const RunResult& result,
                       const RunOptions& options);

/// Peak resident memory of this process, MB.
double peak_rss_mb();

}  // namespace odograph
