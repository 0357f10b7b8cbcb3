// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <odograph/types.h>

#include "sdk/host/config/registry.hpp"
#include "sdk/host/config/spec.hpp"

namespace odograph {

/// Where a plugin runs, and its resource limits.
struct Isolation {
  enum class Kind { none, process };
  Kind kind = Kind::none;
  double time_s = 2;                          ///< longest call; longer than any shipped plugin takes on a slow phone
  double start_s = 30;                        ///< longest load, create, configure, activate: models, on a slow disk
  uint64_t memory_bytes = uint64_t(2) << 30;  ///< address space of a plugin process; OpenCV and its threads take 0.5 GB
  std::filesystem::path program;              ///< odograph-plugin-host; empty: the default next to the library
};

/// A plugin selected by the config.
struct PluginChoice {
  Manifest manifest;
  std::string interface_id;
  std::string place;                               // of its entry: "file:line:column: "; empty if it is from no file
  std::vector<std::pair<Spec, Value>> parameters;  // the plugin's whole table, with defaults filled in
  Isolation isolation;
  std::shared_ptr<const PluginChoice> fallback;  // replaces the plugin if it is given up; may be null
};

/// Start pose in n.
struct StartPose {
  std::array<double, 3> position_m{0, 0, 0};
  double heading_rad = 0.0;
  bool given = false, heading_given = false;
};

enum class Orientation { vo, gyroscope, attitude };
enum class Vertical { ignore, scaled };
enum class Compass { always, start };

enum class CouplingType { paper, localizer };

struct CouplingConfig {
  Orientation orientation = Orientation::vo;
  Vertical vertical = Vertical::ignore;
  Compass compass = Compass::always;
  double fix_gate_sigma = 5.0;
  double bridge_s = 2.0;
  double fastest_mps = 2.0;
  double odometry_covariance = 1.0;
  CouplingType type = CouplingType::paper;
};

struct OrderingConfig {
  double max_wait_s = 0.2;
  double max_gap_s = 1.0;
  size_t queue = 4096;
  size_t frames = 8;
};

/// Alignment of a recording's map frame with n in a replay; `odograph run` applies it to its output.
struct ReplayConfig {
  bool start_at_first_waypoint = false;
  double align_heading_over_m = 0.0;
};

/// A validated pipeline config.
struct PipelineConfig {
  std::string name;  // for messages: the file's path, or "<text>"
  std::string text;  // as read, so that a run can be repeated
  LibraryCheck library_check = LibraryCheck::hash;
  std::optional<std::array<double, 3>> origin;  // latitude rad, longitude rad, height m
  std::optional<double> declination_rad;        // magnetic north from true north, positive to the east
  StartPose start;
  std::optional<odo_calibration> camera;  // mount and time offset are valid only if their flags are set
  OrderingConfig ordering;
  CouplingConfig coupling;
  ReplayConfig replay;
  std::optional<double> walker_height_m;  // if given, or if there is a step estimator
  // any number of each, numbered in this order
  std::vector<PluginChoice> attitudes, step_estimators, vo_frontends, scale_sources, fixers, surface_finders;

  /// All plugins, in the order of their numbers.
  template <class Visit>
  void visit_plugins(Visit&& each) const {
    for (const auto* kind : {&attitudes, &step_estimators, &vo_frontends, &scale_sources, &fixers, &surface_finders})
      for (const PluginChoice& plugin : *kind) each(plugin);
  }
};

/// Schema of the whole file; the source of the JSON Schema and the help.
const Spec& pipeline_spec();

/// Validates a config and finds its plugins' manifests. Runs no plugin code. `directories` precede the config's own
/// search path. Relative names in the config are searched in the folder of its file, then in `folders`. The failure's
/// text lists all mistakes, one per line.
Result<PipelineConfig> read_pipeline_config(const std::string& text, const std::string& name,
                                            const std::vector<std::filesystem::path>& directories,
                                            const std::vector<std::filesystem::path>& folders = {});
Result<PipelineConfig> read_pipeline_config_file(const std::string& path,
                                                 const std::vector<std::filesystem::path>& directories,
                                                 std::vector<std::filesystem::path> folders = {});

/// JSON Schema (draft 07) of a spec. It accepts any plugin parameters.
std::string json_schema(const Spec& spec, const std::string& title);

}  // namespace odograph
