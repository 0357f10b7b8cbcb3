// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sdk/tools/evaluation/evaluation.hpp"
#include "sdk/tools/replay/runner.hpp"

namespace odograph {

/// A run of one recording with a name for the legend. Its poses are collected (RunOptions::collect_poses).
struct NamedRun {
  std::string name;
  const RunResult* result;
};

/// Alignment of a run's track with the truth: best rotation about the vertical and translation, plus scale if the track
/// is not metric; without a truth, onto the first 10 m of the waypoints.
struct AlignedRun {
  StampedPose to_truth;  ///< of positions in the run's n; its time is unused
  double scale = 1;
  bool metric = true;
  /// Distance from the truth over the seconds since the run's first pose, m; at the waypoints if there is no truth.
  /// Empty if the recording has neither.
  std::vector<std::pair<double, double>> error_m;
  double rms_m() const;
  std::optional<ScalePart> scale_part;  ///< of a metric run against a truth, aligned by yaw
};
AlignedRun align_to_truth(const Recording& recording, const RunResult& result, std::optional<Alignment> alignment = {});

struct PageOptions {
  std::string command;      ///< command line of the runs, shown to the reader
  size_t pictures = 90;     ///< maximum number of camera pictures, evenly spaced
  int picture_width = 400;  ///< px
  bool served = false;      ///< served by a server that provides all pictures by number
  bool live = false;        ///< the run continues, and the page polls for updates
  /// For one run against any truth: its alignment, figures that replace a run's own, and its relative error over time
  /// (s since the first pose, m). They enable coordinates and angles over time.
  struct Evaluation {
    Alignment alignment = Alignment::none;
    std::string alignment_text;
    std::vector<std::pair<std::string, std::string>> figures;
    std::vector<std::pair<double, double>> relative_m;
  };
  std::optional<Evaluation> evaluation{};
};

/// One self-contained page of the runs of a recording, each aligned with its truth: track, camera pictures, charts over
/// a common time, tables, configs. Loads nothing from elsewhere unless served.
std::string run_page(const Recording& recording, const std::vector<NamedRun>& runs, const PageOptions& options);
/// The page's data as JSON.
std::string run_page_data(const Recording& recording, const std::vector<NamedRun>& runs, const PageOptions& options);
/// A JPEG picture of the main camera, by frame index; empty if there is none.
std::vector<unsigned char> picture_of(const Recording& recording, size_t number, int width);

}  // namespace odograph
