// SPDX-License-Identifier: Apache-2.0
//
// How simulated walkers compare with real ones: `odograph bench gait`.
#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdio>

#include "sdk/tools/benchmarks/benchmarks.hpp"
#include "sdk/tools/console/console.hpp"
#include "sdk/tools/plot/plot.hpp"
#include "sdk/tools/replay/runner.hpp"
#include "sdk/tools/simulation/random.hpp"
#include "sdk/tools/simulation/walker.hpp"

namespace odograph {
namespace {

namespace fs = std::filesystem;

constexpr double kRate_hz = 50;  // of phones' recordings
constexpr double kPi = 3.14159265358979323846;

struct GaitArguments {
  std::string data, scenario = "samples/scenarios/walk700_M1.yaml", plot;
  uint64_t seeds = 40;
};

/// Samples of a walk at kRate_hz: norms of acceleration and of rotation rate, and the horizontal acceleration.
struct Series {
  std::vector<double> acceleration, rotation, level;
};

struct GaitFigures {
  double frequency_hz;      ///< of the steps: the spectrum's peak between 1.2 and 3 Hz
  double acceleration_std;  ///< of the norm, m/s^2
  double acceleration_p95;  ///< of the norm's deviation from its mean, m/s^2
  double rotation_rms;      ///< rad/s
  double horizontal_rms;    ///< of the horizontal acceleration, m/s^2, by the phone's own orientation or the true one
  double stride_part;       ///< power around half the step frequency over that around it
  double shock_part;        ///< power above 8 Hz over all power
  std::vector<double> spectrum;  ///< of the acceleration's norm, (m/s^2)^2/Hz at 0.1 Hz steps
};

Series resampled(const Recording& recording) {
  Series series;
  int64_t next = 0;
  Eigen::Vector3d a = Eigen::Vector3d::Zero();
  size_t at = 0;
  const auto& attitudes = recording.phone_attitudes;
  for (const auto& m : recording.messages) {
    if (m.message.header().type != ODO_TYPE_IMU) continue;
    const auto& imu = as<odo_imu>(m.message.header());
    if (imu.header.flags & ODO_IMU_ACCEL) a = Eigen::Vector3d::Map(imu.accel_b);
    if (!(imu.header.flags & ODO_IMU_GYRO) || a.norm() == 0) continue;
    if (next == 0) next = imu.header.t_ns;
    for (; next <= imu.header.t_ns; next += static_cast<int64_t>(1e9 / kRate_hz)) {
      series.acceleration.push_back(a.norm());
      series.rotation.push_back(Eigen::Vector3d::Map(imu.gyro_b).norm());
      while (at + 1 < attitudes.size() && attitudes[at + 1].t_ns <= imu.header.t_ns) ++at;
      if (!attitudes.empty()) series.level.push_back((attitudes[at].q * a).head<2>().norm());
    }
  }
  return series;
}

Series simulated(const Scenario& scenario, uint64_t seed) {
  const Journey walk = make_walk(scenario, seed);
  Random random(seed, 5);
  Series series;
  for (double t = walk.steps.front().t_start_s; t < walk.phone.duration_s(); t += 1 / kRate_hz) {
    const auto s = walk.phone.at(t);
    const auto noise = [&](double sigma) {
      return Eigen::Vector3d(sigma * random.normal(), sigma * random.normal(), sigma * random.normal());
    };
    series.acceleration.push_back(
        (s.specific_force_b() + noise(scenario.imu.accel_noise * std::sqrt(kRate_hz))).norm());
    series.level.push_back((s.T_n_b.linear() * s.specific_force_b()).head<2>().norm());
    series.rotation.push_back((s.angular_velocity_b + noise(scenario.imu.gyro_noise * std::sqrt(kRate_hz))).norm());
  }
  return series;
}

/// Welch's mean periodogram: Hann windows of ten seconds, half overlapping.
std::vector<double> spectrum_of(const std::vector<double>& signal) {
  const size_t n = static_cast<size_t>(10 * kRate_hz), bins = n / 2;
  std::vector<double> power(bins, 0.0);
  size_t windows = 0;
  for (size_t from = 0; from + n <= signal.size(); from += n / 2, ++windows) {
    double mean = 0;
    for (size_t i = 0; i < n; ++i) mean += signal[from + i] / static_cast<double>(n);
    for (size_t k = 0; k < bins; ++k) {
      std::complex<double> sum = 0;
      const std::complex<double> rotation = std::polar(1.0, -2 * kPi * static_cast<double>(k) / static_cast<double>(n));
      std::complex<double> phase = 1;
      for (size_t i = 0; i < n; ++i, phase *= rotation) {
        const double hann = 0.5 - 0.5 * std::cos(2 * kPi * static_cast<double>(i) / static_cast<double>(n));
        sum += hann * (signal[from + i] - mean) * phase;
      }
      power[k] += 2 * std::norm(sum) / (kRate_hz * 0.375 * static_cast<double>(n));
    }
  }
  for (double& p : power) p /= static_cast<double>(std::max<size_t>(1, windows));
  return power;
}

GaitFigures figures_of(const Series& s) {
  GaitFigures f{};
  f.spectrum = spectrum_of(s.acceleration);
  const auto bin = [](double hz) { return static_cast<size_t>(std::lround(10 * hz)); };
  const auto peak = std::max_element(f.spectrum.begin() + static_cast<long>(bin(1.2)),
                                     f.spectrum.begin() + static_cast<long>(bin(3.0)));
  const auto at = static_cast<size_t>(peak - f.spectrum.begin());
  f.frequency_hz = 0.1 * static_cast<double>(at);
  const auto power = [&](size_t from, size_t to) {
    double sum = 0;
    for (size_t k = from; k < std::min(to, f.spectrum.size()); ++k) sum += f.spectrum[k];
    return sum;
  };
  f.stride_part = power(at / 2 - 1, at / 2 + 2) / power(at - 1, at + 2);
  f.shock_part = power(bin(8), f.spectrum.size()) / power(bin(0.3), f.spectrum.size());
  const Statistics a = statistics_of(s.acceleration);
  std::vector<double> deviation;
  for (double x : s.acceleration) deviation.push_back(std::abs(x - a.mean));
  f.acceleration_std = a.std;
  f.acceleration_p95 = percentile(deviation, 0.95);
  f.rotation_rms = statistics_of(s.rotation).rmse;
  f.horizontal_rms = statistics_of(s.level).rmse;
  return f;
}

struct Figure {
  const char* name;
  double GaitFigures::*value;
};
constexpr Figure kFigures[] = {
    {"step frequency (Hz)", &GaitFigures::frequency_hz},
    {"acceleration, std of the norm (m/s^2)", &GaitFigures::acceleration_std},
    {"acceleration, 95 % of |norm - mean| (m/s^2)", &GaitFigures::acceleration_p95},
    {"rotation rate, rms (rad/s)", &GaitFigures::rotation_rms},
    {"horizontal acceleration, rms (m/s^2)", &GaitFigures::horizontal_rms},
    {"stride's power over step's", &GaitFigures::stride_part},
    {"power above 8 Hz over all", &GaitFigures::shock_part},
};

std::vector<double> column(const std::vector<GaitFigures>& all, double GaitFigures::*value) {
  std::vector<double> v;
  for (const GaitFigures& f : all) v.push_back(f.*value);
  return v;
}

Result<bool> plot_spectra(const std::string& file, const std::vector<GaitFigures>& real,
                          const std::vector<GaitFigures>& made) {
  Plot plot{.title = "Acceleration's norm", .x_label = "Hz", .y_label = "log10 (m/s^2)^2/Hz"};
  for (const auto* group : {&real, &made})
    for (const double p : {0.25, 0.5, 0.75}) {
      PlotSeries series{
          .name = std::string(group == &real ? "real" : "simulated") + (p == 0.5 ? ", median" : ", quartile"),
          .style = group == &real ? "lines lc rgb '#1f77b4'" : "lines lc rgb '#d62728'"};
      for (size_t k = 3; k < 240; ++k) {
        std::vector<double> values;
        for (const GaitFigures& f : *group) values.push_back(f.spectrum[k]);
        series.points.emplace_back(0.1 * static_cast<double>(k), std::log10(percentile(values, p) + 1e-9));
      }
      plot.series.push_back(std::move(series));
    }
  return write_svg(plot, file);
}

int gait(const GaitArguments& a) {
  const auto scenario = read_scenario(a.scenario);
  if (!scenario) return complain(scenario.failure());
  std::vector<GaitFigures> real, made;
  std::error_code error;
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(a.data, error))
    if (entry.path().extension() == ".txt") files.push_back(entry.path());
  if (files.empty()) return complain({ODO_E_NOT_FOUND, a.data + ": no walks (*.txt) in this folder"});
  std::sort(files.begin(), files.end());
  for (const auto& file : files) {
    const auto recording = open_recording(file);
    if (!recording) return complain(recording.failure());
    if (const Series s = resampled(*recording); s.acceleration.size() >= static_cast<size_t>(10 * kRate_hz))
      real.push_back(figures_of(s));
  }
  for (uint64_t seed = 1; seed <= a.seeds; ++seed) {
    // Walkers of all sizes and paces, on a piece of the route that has no long stop.
    Scenario one = *scenario;
    Random random(seed, 6);
    one.events.clear();
    one.walk_m = 80;
    one.walker.height_m = random.uniform(1.55, 1.90);
    one.walker.speed_mps = random.uniform(1.05, 1.45);
    made.push_back(figures_of(simulated(one, seed)));
  }
  std::printf(
      "%zu real walks, %zu simulated walkers; samples at %.0f Hz\n\n%-46s %-32s %s\n%-46s %7s %7s %7s %7s %9s %7s "
      "%7s\n",
      real.size(), made.size(), kRate_hz, "", "real", "simulated", "", "min", "25 %", "75 %", "max", "25 %", "50 %",
      "75 %");
  bool inside = true;
  for (const Figure& f : kFigures) {
    const auto r = column(real, f.value), m = column(made, f.value);
    const bool here = percentile(m, 0.25) >= percentile(r, 0) && percentile(m, 0.75) <= percentile(r, 1);
    inside = inside && here;
    std::printf("%-46s %7.4f %7.4f %7.4f %7.4f %9.4f %7.4f %7.4f %s\n", f.name, percentile(r, 0), percentile(r, 0.25),
                percentile(r, 0.75), percentile(r, 1), percentile(m, 0.25), percentile(m, 0.5), percentile(m, 0.75),
                here ? "" : "  outside");
  }
  std::printf("\nEvery quartile of the simulation lies inside the real range: %s\n", inside ? "yes" : "no");
  if (!a.plot.empty())
    if (const auto done = plot_spectra(a.plot, real, made); !done) return complain(done.failure());
  return kDone;
}

}  // namespace

void add_bench_gait(CLI::App& bench, int& status) {
  auto a = std::make_shared<GaitArguments>();
  auto* command = bench.add_subcommand("gait", "How simulated walkers compare with a folder of real walks");
  command->add_option("data", a->data, "folder of Indoor Location Competition traces")->required();
  command->add_option("--scenario", a->scenario, "where the walkers walk")->capture_default_str();
  command->add_option("--seeds", a->seeds, "how many walkers")->capture_default_str()->check(CLI::Range(4, 1000));
  command->add_option("--plot", a->plot, "write the spectra as SVG");
  command->callback([a, &status] { status = gait(*a); });
}

}  // namespace odograph
