// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sdk/tools/evaluation/evaluation.hpp"
#include "sdk/tools/replay/runner.hpp"

namespace odograph {

/// A run of one recording under a name that a legend can show. Its poses are collected (RunOptions::collect_poses).
struct NamedRun {
  std::string name;
  const RunResult* result;
};

/// How a run's track is laid over the truth: turned about the vertical and shifted so that it fits best, with a scale
/// where the track is not metric; without a truth, turned and shifted onto the first 10 m of the waypoints.
struct LaidRun {
  StampedPose to_truth;  ///< of places in the run's n; its time has no meaning
  double scale = 1;
  bool metric = true;
  /// Distance from the truth over the seconds since the run's first pose, m; at the waypoints where there is no truth.
  /// Empty where a recording has neither.
  std::vector<std::pair<double, double>> error_m;
  double rms_m() const;
};
LaidRun lay_over_truth(const Recording& recording, const RunResult& result, std::optional<Alignment> alignment = {});

struct PageOptions {
  std::string command;      ///< that made the runs, for the reader
  size_t pictures = 90;     ///< of the camera, at most, evenly over the recording
  int picture_width = 400;  ///< px
  bool served = false;      ///< by a server that gives pictures by their number, all of them
  bool live = false;        ///< the run goes on, and the page asks again
  /// Of one run against any truth: how it is laid over it, its figures in place of a run's own, and its relative error
  /// over time (s since the first pose, m). With them the page has coordinates and angles over time.
  struct Evaluation {
    Alignment alignment = Alignment::none;
    std::string alignment_text;
    std::vector<std::pair<std::string, std::string>> figures;
    std::vector<std::pair<double, double>> relative_m;
  };
  std::optional<Evaluation> evaluation{};
};

/// One self-contained page about the runs of a recording, each laid over its truth by itself: the track, the camera's
/// pictures, charts over one time, tables, configs. It asks for nothing from elsewhere, unless it is served.
std::string run_page(const Recording& recording, const std::vector<NamedRun>& runs, const PageOptions& options);
/// What the page shows, as JSON.
std::string run_page_data(const Recording& recording, const std::vector<NamedRun>& runs, const PageOptions& options);
/// A picture of the main camera as JPEG, by its number among its frames; empty where there is none.
std::vector<unsigned char> picture_of(const Recording& recording, size_t number, int width);

}  // namespace odograph
