// SPDX-License-Identifier: Apache-2.0
//
// `odograph bench allan`: the simulated IMU at rest, its Allan deviation beside what the scenario asks for.
#include <cmath>
#include <cstdio>

#include "sdk/tools/benchmarks/benchmarks.hpp"
#include "sdk/tools/console/console.hpp"
#include "sdk/tools/evaluation/evaluation.hpp"
#include "sdk/tools/plot/plot.hpp"
#include "sdk/tools/simulation/scenario.hpp"
#include "sdk/tools/simulation/sensors.hpp"

namespace odograph {
namespace {

struct AllanArguments {
  std::string scenario = "samples/scenarios/street_short.yaml", plot;
  uint64_t seed = 1;
  double hours = 3;
};

int allan(const AllanArguments& a) {
  const auto scenario = read_scenario(a.scenario);
  if (!scenario) return complain(scenario.failure());
  const auto& imu = scenario->imu;
  struct Sensor {
    const char *name, *unit;
    SimTriad::Errors errors;
  };
  const Sensor sensors[] = {
      {"gyroscope", "rad/s", {imu.gyro_bias, imu.gyro_walk, imu.gyro_noise, 0, 0, imu.gyro_range, imu.gyro_step}},
      {"accelerometer",
       "m/s^2",
       {imu.accel_bias, imu.accel_walk, imu.accel_noise, 0, 0, imu.accel_range, imu.accel_step}}};
  Plot plot{.title = "Allan deviation at rest", .x_label = "log10 s", .y_label = "log10 (rad/s or m/s^2)"};
  std::printf("%.1f hours at rest, %.0f Hz, mean of three axes; quantisation included.\n", a.hours, imu.rate_hz);
  for (const Sensor& sensor : sensors) {
    SimTriad triad(Random(a.seed, 2), sensor.errors, imu.rate_hz);
    std::vector<double> axis[3];
    for (auto n = static_cast<size_t>(a.hours * 3600 * imu.rate_hz); n > 0; --n) {
      const Eigen::Vector3d m = triad.measure(Eigen::Vector3d::Zero());
      for (int k = 0; k < 3; ++k) axis[k].push_back(m[k]);
    }
    std::printf("\n%-14s %12s %14s %14s %8s\n", sensor.name, "averaging (s)", "simulated", "asked for", "ratio");
    PlotSeries made{.name = std::string(sensor.name) + ", simulated", .style = "points"};
    PlotSeries asked{.name = std::string(sensor.name) + ", asked for", .style = "lines"};
    for (double tau = 0.02; tau < a.hours * 3600 / 20; tau *= std::sqrt(10)) {
      double sum = 0;
      for (const auto& x : axis) sum += allan_deviation(x, imu.rate_hz, tau) / 3;
      const double step = sensor.errors.step;  // rounding adds white noise of variance step^2 / 12 to each sample
      const double white = sensor.errors.noise * sensor.errors.noise + step * step / 12 / imu.rate_hz;
      const double want = std::sqrt(white / tau + sensor.errors.walk * sensor.errors.walk * tau / 3);
      std::printf("%-14s %12.2f %14.3e %14.3e %8.3f\n", "", tau, sum, want, sum / want);
      made.points.emplace_back(std::log10(tau), std::log10(sum));
      asked.points.emplace_back(std::log10(tau), std::log10(want));
    }
    plot.series.push_back(std::move(asked)), plot.series.push_back(std::move(made));
  }
  if (a.plot.empty()) return kDone;
  const auto written = write_svg(plot, a.plot);
  return written ? kDone : complain(written.failure());
}

}  // namespace

void add_bench_allan(CLI::App& bench, int& status) {
  auto a = std::make_shared<AllanArguments>();
  auto* command = bench.add_subcommand("allan", "The simulated IMU at rest: its Allan deviation beside the scenario's");
  command->add_option("--scenario", a->scenario, "whose IMU")->capture_default_str();
  command->add_option("--seed", a->seed, "another bias and other noise")->capture_default_str();
  command->add_option("--hours", a->hours, "how long")->capture_default_str()->check(CLI::Range(0.1, 24.0));
  command->add_option("--plot", a->plot, "write the curves as SVG");
  command->callback([a, &status] { status = allan(*a); });
}

}  // namespace odograph
