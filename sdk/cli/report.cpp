// SPDX-License-Identifier: Apache-2.0
//
// report.html with pictures by gnuplot (a packaged plotter; without it the report says so and has the tables alone).
#include <cstdio>
#include <fstream>
#include <functional>
#include <sstream>

#include "sdk/cli/plot.hpp"
#include "sdk/cli/runner.hpp"

namespace odograph {
namespace {

std::string escape(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '&' ? "&amp;" : std::string(1, c);
  return out;
}

std::string row(const std::string& name, const std::string& value) {
  return "<tr><th>" + name + "</th><td>" + escape(value) + "</td></tr>\n";
}

std::string fixed(double value, int digits) {
  char text[32];
  std::snprintf(text, sizeof text, "%.*f", digits, value);
  return text;
}

Plot track_plot(const Recording& recording, const RunResult& result) {
  Plot plot{.title = "Track seen from above", .x_label = "east (m)", .y_label = "north (m)", .equal_axes = true};
  PlotSeries track{.name = "Odograph", .style = "lines lw 2"};
  for (const auto& x : result.track) track.points.emplace_back(x.p.y(), x.p.x());
  plot.series.push_back(track);
  if (!recording.truth.empty() && !result.track.empty()) {
    const Pairs pairs = associate(recording.truth, result.track, 0.05);
    if (pairs.reference.size() > 2) {
      const bool metric = !result.scales.empty() || !recording.has(ODO_TYPE_FRAME);
      PlotSeries truth{.name = metric ? "truth (turned to fit)" : "truth (Sim(3) to fit)", .style = "lines lw 1 dt 2"};
      const Trajectory aligned =
          align({pairs.estimate, pairs.reference}, metric ? Alignment::yaw : Alignment::sim3, nullptr);
      for (const auto& x : aligned) truth.points.emplace_back(x.p.y(), x.p.x());
      plot.series.push_back(truth);
    }
  }
  PlotSeries waypoints{.name = "waypoints", .style = "points pt 7"};
  for (const auto& w : recording.waypoints()) waypoints.points.emplace_back(w.p_n.y(), w.p_n.x());
  if (!waypoints.points.empty()) plot.series.push_back(waypoints);
  PlotSeries fixes{.name = "fixes", .style = "points pt 2"};
  for (const auto& f : result.fixes) fixes.points.emplace_back(f.fix.p_n[1], f.fix.p_n[0]);
  if (!fixes.points.empty()) plot.series.push_back(fixes);
  return plot;
}

}  // namespace

Result<bool> write_report(const std::filesystem::path& folder, const Recording& recording, const RunResult& result) {
  const int64_t t0 = result.track.empty() ? 0 : result.track.front().t_ns;
  const auto seconds = [t0](int64_t t_ns) { return static_cast<double>(t_ns - t0) * 1e-9; };
  std::vector<Plot> plots = {track_plot(recording, result)};
  if (!result.steps.empty()) {
    Plot plot{.title = "Step lengths", .x_label = "time (s)", .y_label = "step length (m)"};
    PlotSeries steps{.name = "steps", .style = "points pt 7 ps 0.4"};
    for (const auto& s : result.steps) steps.points.emplace_back(seconds(s.t_end_ns), s.length_m);
    plot.series.push_back(steps);
    plots.push_back(plot);
  }
  if (!result.scales.empty()) {
    Plot plot{.title = "Scale", .x_label = "time (s)", .y_label = "metres per VO unit"};
    PlotSeries scales{.name = "scale", .style = "points pt 7 ps 0.3"};
    for (const auto& s : result.scales) scales.points.emplace_back(seconds(s.header.t_ns), s.metres_per_unit);
    plot.series.push_back(scales);
    plots.push_back(plot);
  }
  const odo_statistics& s = result.statistics;
  std::ostringstream html;
  html << "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\"><title>Odograph run</title>\n<style>body{font:16px "
          "sans-serif;"
          "max-width:60em;margin:2em auto;padding:0 "
          "1em}th{text-align:left;padding-right:2em}svg{max-width:100%;height:auto}"
          "pre{background:#f4f4f4;padding:1em;overflow:auto}</style>\n<h1>Odograph run</h1>\n<table>\n";
  html << row("Recording", recording.path.string() + " (" + recording.format + ")")
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
  for (const Plot& plot : plots) {
    const auto svg = draw_svg(plot);
    html << "<h2>" << escape(plot.title) << "</h2>\n" << (svg ? *svg : "<p>" + escape(svg.failure().text) + "</p>\n");
  }
  for (const auto& report : result.reports) html << "<p>" << escape(report) << "</p>\n";
  html << "<h2>Config</h2>\n<pre>" << escape(result.config_text) << "</pre>\n</html>\n";
  std::ofstream file(folder / "report.html");
  file << html.str();
  if (!file.flush()) return Failure{ODO_E_NOT_FOUND, (folder / "report.html").string() + ": cannot be written"};
  return true;
}

}  // namespace odograph
