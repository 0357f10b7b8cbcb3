// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "sdk/host/base/result.hpp"

namespace odograph {

struct PlotSeries {
  std::string name;
  std::string style;                              // gnuplot's "with": lines, points, steps ...
  std::vector<std::pair<double, double>> points;  // NaN breaks a line
};

struct Plot {
  std::string title, x_label, y_label;
  bool equal_axes = false, y_down = false, log_y = false;
  std::vector<PlotSeries> series;
};

/// Renders the plot as an SVG element with the installed gnuplot. ODO_E_UNSUPPORTED if there is none.
Result<std::string> draw_svg(const Plot& plot);
/// Writes the same to a file.
Result<bool> write_svg(const Plot& plot, const std::string& file);

/// A self-contained HTML page: figures, warnings, the written file, and the plots (or why there are none).
std::string plots_page(const std::string& title, const std::string& figures, const std::vector<std::string>& warnings,
                       const std::string& written, const std::vector<Plot>& plots);

}  // namespace odograph
