// SPDX-License-Identifier: Apache-2.0
//
// Runs fix/known_object alone on rendered scenes.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "sdk/host/platform/temporary_folder.hpp"
#include "sdk/host/config/pipeline_config.hpp"
#include "sdk/host/messages/messages.hpp"
#include "sdk/host/plugin_host/instance.hpp"
#include "sdk/tools/simulation/known_object_scene.hpp"

namespace odograph::known_object_scene {

/// The plugin alone, with its own objects file.
class Fixer {
 public:
  /// The pipeline config that contains it.
  static Result<PipelineConfig> config();
  static Result<std::unique_ptr<Fixer>> make(const std::vector<Target>& targets, uint64_t seed);

  void begin(const odo_calibration& lens) {
    instance_->reset();
    instance_->process(lens.header);
  }
  std::vector<odo_fix> process_frame(const odo_pose& prior, const cv::Mat& grey, int64_t line_time_ns);
  uint64_t faults() const { return instance_->faults(); }

 private:
  Fixer() = default;
  void take(const odo_header& message, std::vector<odo_fix>& fixes) {
    for (const AnyMessage& event : instance_->process(message))
      if (event.header().type == ODO_TYPE_FIX) fixes.push_back(as<odo_fix>(event.header()));
  }
  TemporaryFolder folder_;
  std::unique_ptr<HostServices> host_;
  std::unique_ptr<PluginInstance> instance_;
};

/// Result of one scene: all fixes, with the truth at their times.
struct TimedFix {
  odo_fix fix;
  Viewpoint truth;
};
std::vector<TimedFix> run_scene(Fixer& fixer, const std::vector<WallPicture>& hung, const Viewpoint& start, int frames,
                                uint64_t scene, Random& random, double position_sigma_m, const std::string& keep);

/// A combination of distance, obliqueness, and walking past or standing.
struct Cell {
  double from_m, to_m, from_deg, to_deg;
  bool standing;
};
constexpr Cell kCells[] = {{2, 5, -20, 20, true},  {2, 5, 0, 30, false},   {2, 5, 30, 60, false},
                           {5, 10, 0, 30, false},  {5, 10, 30, 60, false}, {10, 15, 0, 30, false},
                           {10, 15, 30, 60, false}};

/// Accuracy for a target in the scenes of a cell, from the last fix of each scene.
struct CellFigures {
  size_t scenes = 0;                               ///< that could be set up
  std::vector<double> error_m, rotation_deg, nis;  ///< of the fixes; horizontal
};
/// Scene numbers run through all cells of a target. The first two of each cell save a picture to the folder, if given.
Result<CellFigures> scenes_of(const Target& target, size_t cell, uint64_t scenes, uint64_t seed,
                              const std::string& keep, const std::function<void(size_t done, size_t all)>& progress);

/// Fixes on look-alikes of one kind.
struct LookAlikeFigures {
  uint64_t frames = 0, fixes = 0, wrong = 0;  ///< wrong: off by more than a metre, or not a known object
  double worst_m = 0;
};
/// Runs scenes of all kinds in turn for the given number of frames; `only`: one kind, negative: all. The last kind
/// follows the others, a seventh as often. Results by kind.
Result<std::vector<LookAlikeFigures>> look_alikes(uint64_t frames, int only, uint64_t seed, const std::string& keep,
                                                  const std::function<void(size_t done, size_t all)>& progress);

}  // namespace odograph::known_object_scene
