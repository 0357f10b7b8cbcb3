// SPDX-License-Identifier: Apache-2.0
//
// report.html with pictures by gnuplot (a packaged plotter; without it the report says so and has the tables alone).
#include <fstream>
#include <sstream>

#include "sdk/host/base/output_file.hpp"
#include "sdk/tools/replay/run_plots.hpp"

namespace odograph {
namespace {

using html::escape;
using html::fixed;

std::string row(const std::string& name, const std::string& value) {
  return "<tr><th>" + name + "</th><td>" + escape(value) + "</td></tr>\n";
}

}  // namespace

Result<bool> write_report(const std::filesystem::path& folder, const Recording& recording, const RunResult& result) {
  const odo_statistics& s = result.statistics;
  std::ostringstream page;
  page << html::head("Odograph run") << "<table>\n";
  page << row("Recording", recording.path.string() + " (" + recording.format + ")")
       << row("Distance", fixed(s.distance_m, 2) + " m") << row("Steps", std::to_string(s.steps))
       << row("Camera frames", std::to_string(s.frames))
       << row("Tracking / degraded / lost",
              fixed(s.tracking_s, 1) + " s / " + fixed(s.degraded_s, 1) + " s / " + fixed(s.lost_s, 1) + " s")
       << row("At the end", std::string(odo_state_text(result.final_state)) +
                                (result.final_reason ? std::string(": ") + odo_reason_text(result.final_reason) : ""))
       << row("Fixes accepted / rejected", std::to_string(s.fixes_accepted) + " / " + std::to_string(s.fixes_rejected))
       << row("Work a frame, median / 99 %", fixed(percentile(result.frame_ms, 0.5), 2) + " ms / " +
                                                 fixed(percentile(result.frame_ms, 0.99), 2) + " ms")
       << row("Dropped: late, duplicate, invalid, overflow",
              std::to_string(s.late) + ", " + std::to_string(s.duplicate) + ", " + std::to_string(s.invalid) + ", " +
                  std::to_string(s.overflow))
       << row("Plugin faults", std::to_string(s.plugin_faults)) << "</table>\n";
  page << html::figures(plots_of(recording, {{"Odograph", &result}}));
  for (const auto& [key, notice] : result.notices)
    page << "<p>" << escape(key) << ", " << notice.count << " times: " << escape(notice.text) << "</p>\n";
  for (const auto& report : result.reports) page << "<p>" << escape(report) << "</p>\n";
  page << "<h2>Config</h2>\n<pre>" << escape(result.config_text) << "</pre>\n</html>\n";
  return write_whole_file(folder / "report.html", page.str());
}

}  // namespace odograph
