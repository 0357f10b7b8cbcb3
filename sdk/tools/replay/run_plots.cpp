// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/replay/run_plots.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "sdk/math/time.hpp"

namespace odograph {
namespace {

constexpr double kTogether_s = 0.05;  // poses of truth and track that far apart are taken as one
constexpr double kFit_m = 10;         // of the waypoints, to which a track is turned

bool is_metric(const Recording& recording, const RunResult& result) {
  const auto knows = [](const odo_vo_motion& motion) { return (motion.header.flags & ODO_VO_METRIC) != 0; };
  return !result.scales.empty() || !result.steps.empty() || !recording.has(ODO_TYPE_FRAME) ||
         std::any_of(result.motions.begin(), result.motions.end(), knows);
}

Pairs pairs_of(const Recording& recording, const RunResult& result) {
  return associate(recording.truth, result.track, kTogether_s);
}

/// Whatever holds until the next entry, as a line of steps.
template <class Entries, class Time, class Value>
PlotSeries steps_of(const std::string& name, const Entries& entries, Time time, Value value, double end) {
  PlotSeries series{.name = name, .style = "lines lw 2"};
  for (size_t k = 0; k < entries.size(); ++k) {
    const double next = k + 1 < entries.size() ? time(k + 1) : end;
    series.points.emplace_back(time(k), value(k));
    series.points.emplace_back(std::max(time(k), next), value(k));
  }
  return series;
}

void keep(std::vector<Plot>& plots, Plot plot) {
  std::erase_if(plot.series, [](const PlotSeries& series) { return series.points.empty(); });
  if (!plot.series.empty()) plots.push_back(std::move(plot));
}

/// Everything is laid over the first run's frame, which is what its fixes and files have.
Plot track_plot(const Recording& recording, const std::vector<NamedRun>& runs) {
  Plot plot{.title = "Track seen from above", .x_label = "east (m)", .y_label = "north (m)", .equal_axes = true};
  const auto series_of = [](const std::string& name, const char* style, const Trajectory& track) {
    PlotSeries series{.name = name, .style = style};
    for (const auto& x : track) series.points.emplace_back(x.p.y(), x.p.x());
    return series;
  };
  for (const NamedRun& run : runs) plot.series.push_back(series_of(run.name, "lines lw 2", run.result->track));
  if (!recording.truth.empty() && !runs.empty() && !runs[0].result->track.empty()) {
    const Pairs pairs = pairs_of(recording, *runs[0].result);
    if (pairs.reference.size() > 2) {
      const bool metric = is_metric(recording, *runs[0].result);
      const Trajectory aligned =
          align({pairs.estimate, pairs.reference}, metric ? Alignment::yaw : Alignment::sim3, nullptr);
      plot.series.push_back(
          series_of(metric ? "truth (turned to fit)" : "truth (Sim(3) to fit)", "lines lw 1 dt 2", aligned));
    }
  }
  PlotSeries waypoints{.name = "waypoints", .style = "points pt 7"};
  for (const auto& w : recording.waypoints()) waypoints.points.emplace_back(w.p_n.y(), w.p_n.x());
  plot.series.push_back(waypoints);
  for (const bool accepted : {true, false}) {
    PlotSeries fixes{.name = accepted ? "fixes" : "fixes, not used", .style = accepted ? "points pt 2" : "points pt 1"};
    constexpr uint32_t horizontal = ODO_FIX_NORTH | ODO_FIX_EAST;
    if (!runs.empty())
      for (const auto& f : runs[0].result->fixes)
        if (f.accepted == accepted && (f.fix.header.flags & horizontal) == horizontal)
          fixes.points.emplace_back(f.fix.p_n[1], f.fix.p_n[0]);
    plot.series.push_back(fixes);
  }
  return plot;
}

}  // namespace

std::vector<std::pair<double, double>> error_over_time(const Recording& recording, const RunResult& result) {
  std::vector<std::pair<double, double>> errors;
  if (result.track.empty()) return errors;
  const auto seconds = [&](int64_t t_ns) { return odograph::seconds(t_ns - result.track.front().t_ns); };
  if (!recording.truth.empty()) {
    const Pairs pairs = pairs_of(recording, result);
    if (pairs.reference.size() < 3) return errors;
    const Trajectory aligned = align(pairs, is_metric(recording, result) ? Alignment::yaw : Alignment::sim3, nullptr);
    for (size_t k = 0; k < aligned.size(); ++k)
      errors.emplace_back(seconds(aligned[k].t_ns), (aligned[k].p - pairs.reference[k].p).norm());
    return errors;
  }
  const auto waypoints = recording.waypoints();
  if (waypoints.size() < 2) return errors;
  const Trajectory laid = lay_over(result.track, waypoints, heading_offset(result.track, waypoints, kFit_m));
  for (const Waypoint& w : waypoints)
    errors.emplace_back(seconds(w.t_ns), (position_at(laid, w.t_ns) - w.p_n).head<2>().norm());
  return errors;
}

std::vector<Plot> plots_of(const Recording& recording, const std::vector<NamedRun>& runs) {
  std::vector<Plot> plots;
  keep(plots, track_plot(recording, runs));
  Plot error{.title = "Error over time", .x_label = "time (s)", .y_label = "distance from the truth (m)"};
  Plot parts{.title = "Distribution of the error", .x_label = "error (m)", .y_label = "part of the poses"};
  Plot lengths{.title = "Step lengths", .x_label = "time (s)", .y_label = "step length (m)"};
  Plot scale{.title = "Scale, with one sigma", .x_label = "time (s)", .y_label = "scale"};
  Plot modes{.title = "Motion", .x_label = "time (s)", .y_label = "ODO_MODE number"};
  Plot states{.title = "State (1 tracking, 2 degraded, 3 lost)", .x_label = "time (s)", .y_label = "state"};
  Plot residuals{.title = "Fixes less the track", .x_label = "time (s)", .y_label = "m"};
  for (const auto& [name, result] : runs) {
    const Trajectory& track = result->track;
    if (track.empty()) continue;
    const auto seconds = [t0 = track.front().t_ns](int64_t t_ns) { return odograph::seconds(t_ns - t0); };
    const double end = seconds(track.back().t_ns);
    PlotSeries over_time{.name = name, .style = "lines lw 2"}, part{.name = name, .style = "lines lw 2"};
    over_time.points = error_over_time(recording, *result);
    std::vector<double> sorted;
    for (const auto& [t, e] : over_time.points) sorted.push_back(e);
    std::sort(sorted.begin(), sorted.end());
    for (size_t k = 0; k < sorted.size(); ++k)
      part.points.emplace_back(sorted[k], static_cast<double>(k + 1) / static_cast<double>(sorted.size()));
    error.series.push_back(over_time), parts.series.push_back(part);
    PlotSeries steps{.name = name, .style = "points pt 7 ps 0.4"};
    for (const auto& s : result->steps) steps.points.emplace_back(seconds(s.t_end_ns), s.length_m);
    lengths.series.push_back(steps);
    PlotSeries factor{.name = name, .style = "points pt 7 ps 0.3"},
        band{.name = name + ", sigma", .style = "lines lw 1"};
    for (const auto& s : result->scales) {
      const double t = seconds(s.header.t_ns);
      factor.points.emplace_back(t, s.scale);
      band.points.emplace_back(t, s.scale - s.sigma);
      band.points.emplace_back(t, s.scale + s.sigma);
      band.points.emplace_back(t, std::numeric_limits<double>::quiet_NaN());
    }
    scale.series.push_back(factor), scale.series.push_back(band);
    const auto& m = result->modes;
    modes.series.push_back(steps_of(
        name, m, [&](size_t k) { return seconds(m[k].header.t_ns); },
        [&](size_t k) { return static_cast<double>(m[k].mode); }, end));
    states.series.push_back(steps_of(
        name, result->states, [&](size_t k) { return seconds(track[std::min(k, track.size() - 1)].t_ns); },
        [&](size_t k) { return static_cast<double>(result->states[k]); }, end));
    const char* axes[] = {"north", "east", "down"};
    for (int axis = 0; axis < 3; ++axis) {
      PlotSeries off{.name = name + ", " + axes[axis], .style = "points pt 7 ps 0.4"};
      for (const auto& f : result->fixes)
        if (f.fix.header.flags & (ODO_FIX_NORTH << axis))
          off.points.emplace_back(seconds(f.fix.header.t_ns),
                                  f.fix.p_n[axis] - position_at(track, f.fix.header.t_ns)[axis]);
      residuals.series.push_back(off);
    }
  }
  for (Plot* plot : {&error, &parts, &lengths, &scale, &modes, &states, &residuals}) keep(plots, std::move(*plot));
  return plots;
}

namespace html {

std::string escape(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '&' ? "&amp;" : std::string(1, c);
  return out;
}

std::string fixed(double value, int digits) {
  char text[32];
  std::snprintf(text, sizeof text, "%.*f", digits, value);
  return text;
}

std::string head(const std::string& title) {
  return "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\"><title>" + escape(title) +
         "</title>\n<style>body{font:16px sans-serif;max-width:60em;margin:2em auto;padding:0 1em}"
         "th,td{text-align:left;padding-right:1.5em;vertical-align:top}svg{max-width:100%;height:auto}"
         "pre{background:#f4f4f4;padding:1em;overflow:auto;white-space:pre-wrap}"
         "@media print{body{max-width:none;margin:0}h2,svg{break-inside:avoid}h2{break-after:avoid}}</style>\n<h1>" +
         escape(title) + "</h1>\n";
}

std::string figures(const std::vector<Plot>& plots) {
  std::string page;
  for (const Plot& plot : plots) {
    const auto svg = draw_svg(plot);
    page += "<h2>" + escape(plot.title) + "</h2>\n" + (svg ? *svg : "<p>" + escape(svg.failure().text) + "</p>") + "\n";
  }
  return page;
}

}  // namespace html
}  // namespace odograph
