// SPDX-License-Identifier: Apache-2.0
//
// A visual odometry started at many times of a recording.
#include <algorithm>
#include <cmath>

#include "sdk/math/time.hpp"
#include "sdk/tools/benchmarks/benchmarks.hpp"
#include "sdk/tools/evaluation/start_windows.hpp"

namespace odograph {
namespace {

struct Windows : Benchmark {
  Windows()
      : Benchmark("windows", "A visual-inertial odometry started at every second of recordings with a truth",
                  kConfigs | kSimulated | kRecordings | kSensors, {"inertial_odograph"}) {
    read.true_states = false;
    below = "median";
  }
  void add_options(CLI::App& command) override {
    command.add_option("--from", from_s, "start of the first window after the first frame, s");
    command.add_option("--every", every_s, "time between the starts of two windows, s")->check(CLI::PositiveNumber);
    command.add_option("--length", length_s, "length of a window, s; 0: to the recording's end");
    command.add_option("--only", only, "faults of --sensors by name, instead of all");
  }

  Result<std::vector<BenchCase>> recordings() override {
    if (!only.empty()) {
      std::vector<Degradation> chosen;
      for (const Degradation& d : sensor_qualities())
        if (std::find(only.begin(), only.end(), d.name) != only.end()) chosen.push_back(d);
      if (chosen.size() != only.size())
        return Failure{ODO_E_ARGUMENT, "--only: the table of --sensors has no such row"};
      qualities = chosen, variants = names_of(chosen);
    }
    return Benchmark::recordings();
  }

  Result<Json> measure_recording(const BenchCase& one, const Recording& recording) const override {
    int64_t first_ns = 0, last_ns = 0;
    for (const RecordedMessage& m : recording.messages) {
      if (m.message.header().type != ODO_TYPE_FRAME) continue;
      last_ns = m.message.header().t_ns;
      if (first_ns == 0) first_ns = last_ns;
    }
    const double all_s = seconds(last_ns - first_ns);
    std::vector<StartWindow> windows;
    Json listed = Json::array();
    for (double from = from_s; from + std::max(1.0, length_s) <= all_s + 1e-3; from += every_s) {
      Degradation window;
      window.cut_s = from, window.length_s = length_s;
      const Recording part = degraded(recording, window, sensor_seed);
      const auto result = replay(part, one.run);
      if (!result) return result.failure();
      windows.push_back(start_window(recording.truth, result->motions, first_ns + nanoseconds(from)));
      listed.push_back(line_of(from, windows.back()));
    }
    Json row = row_of(figures_of(windows));
    row["windows_each"] = listed;
    return row;
  }

  static Json line_of(double from_s, const StartWindow& w) {
    Json scales = Json::array();
    for (const StatedScale& c : w.scales)
      scales.push_back(
          {{"after_s", c.after_s}, {"scale_percent", 100 * std::expm1(c.log_scale)}, {"sigma_percent", 100 * c.sigma}});
    return {{"from_s", from_s},
            {"start_s", w.start_s},
            {"groups", w.groups},
            {"path_m", w.path_m},
            {"scale_percent", 100 * std::expm1(w.log_scale)},
            {"sigma_percent", 100 * w.sigma},
            {"worst_sigmas", w.worst_sigmas},
            {"se3_m", w.se3_rmse_m},
            {"sim3_m", w.sim3_rmse_m},
            {"rotation_nees", w.rotation_nees},
            {"displacement_nees", w.displacement_nees},
            {"claims", scales}};
  }

  static std::vector<Figure> figures_of(const std::vector<StartWindow>& windows) {
    std::vector<double> start, scale, sigma, nees, se3, sim3, rotation, displacement;
    size_t beyond = 0, again = 0;
    const auto add = [](std::vector<double>& to, double value) {
      if (std::isfinite(value)) to.push_back(value);
    };
    for (const StartWindow& w : windows) {
      add(start, w.start_s), add(scale, 100 * std::abs(std::expm1(w.log_scale))), add(sigma, 100 * w.sigma);
      for (const StatedScale& c : w.scales) add(nees, std::pow(c.log_scale / c.sigma, 2));
      add(se3, w.se3_rmse_m), add(sim3, w.sim3_rmse_m);
      add(rotation, w.rotation_nees), add(displacement, w.displacement_nees);
      beyond += w.worst_sigmas > StartWindowParameters{}.confident_sigmas, again += w.groups > 1;
    }
    const auto mean = [](const std::vector<double>& x) { return x.empty() ? std::nan("") : statistics_of(x).mean; };
    return {{"windows", "", "windows", 0, windows.size(), kSum},
            {"started", "", "started", 0, start.size(), kSum},
            {"again", "", "again", 0, again, kSum},
            {"start", "s", "start_s", 2, percentile_or_nan(start, 0.5)},
            {"worst", "s", "start_worst_s", 2, percentile_or_nan(start, 1), kWorst},
            {"scale", "err %", "scale_error_percent", 2, percentile_or_nan(scale, 0.5)},
            {"worst", "%", "scale_error_worst_percent", 2, percentile_or_nan(scale, 1), kWorst},
            {"sigma", "%", "sigma_percent", 2, percentile_or_nan(sigma, 0.5)},
            {"beyond", "3 sigma", "beyond", 0, beyond, kSum},
            {"NEES", "scale", "scale_nees", 2, mean(nees)},
            {"NEES", "rot.", "rotation_nees", 2, mean(rotation)},
            {"NEES", "disp.", "displacement_nees", 2, mean(displacement)},
            {"SE3", "m", "se3_m", 3, percentile_or_nan(se3, 0.5)},
            {"Sim3", "m", "sim3_m", 3, percentile_or_nan(sim3, 0.5)}};
  }

  BenchReport report(const Rows& rows) const override {
    std::string out =
        cases_text(rows, "figures", "", "median, sums") +
        "\nEach window is a separate run. start: from its first frame to the first metric motion. scale, sigma, SE3, "
        "Sim3: of the longest\nscale group at its end. beyond: windows in which the scale was off by more than 3 of "
        "the sigmas stated 1, 2, 4 s after a start or\nat the end. again: more than one metric scale group. NEES: "
        "normalised error squared by degree of freedom; 1 is consistent.\n";
    for (const Json& row : rows)
      for (const Json& w : row["windows_each"])
        if (number_at(w, "worst_sigmas") > StartWindowParameters{}.confident_sigmas || number_at(w, "start_s") > 3 ||
            !std::isfinite(number_at(w, "start_s"))) {
          out += row["recording"].get<std::string>() + text(" from %.1f s: ", number_at(w, "from_s"));
          out += std::isfinite(number_at(w, "start_s"))
                     ? text("start %.2f s, %zu group(s)", number_at(w, "start_s"), w["groups"].get<size_t>())
                     : std::string("no motion in metres");
          if (std::isfinite(number_at(w, "scale_percent")))
            out += text(", scale %+.1f %% (sigma %.1f %%), worst %.1f sigmas; ", number_at(w, "scale_percent"),
                        number_at(w, "sigma_percent"), number_at(w, "worst_sigmas"));
          for (const Json& c : w["claims"])
            out += text(" [%.1f s: %+.1f, %.1f]", number_at(c, "after_s"), number_at(c, "scale_percent"),
                        number_at(c, "sigma_percent"));
          out += '\n';
        }
    return BenchReport{.text = out};
  }

  double from_s = 0, every_s = 1, length_s = 8;
  std::vector<std::string> only;
};

}  // namespace

Benchmarks windows_benchmarks() { return {std::make_shared<Windows>()}; }

}  // namespace odograph
