// SPDX-License-Identifier: Apache-2.0
//
// `odograph bench allan`: the simulated IMU at rest, its Allan deviation beside what the scenario asks for.
#include <cmath>

#include "sdk/tools/benchmarks/benchmarks.hpp"
#include "sdk/tools/evaluation/evaluation.hpp"
#include "sdk/tools/simulation/sensors.hpp"

namespace odograph {
namespace {

struct Allan : Benchmark {
  Allan() : Benchmark("allan", "The simulated IMU at rest: its Allan deviation beside the scenario's", kPlot) {}
  void add_options(CLI::App& command) override {
    command.add_option("--scenario", scenario, "whose IMU");
    command.add_option("--seed", seed, "another bias and other noise");
    command.add_option("--hours", hours, "how long")->check(CLI::Range(0.1, 24.0));
  }

  Result<std::vector<BenchCase>> cases() override {
    return std::vector<BenchCase>{{{{"sensor", "gyroscope"}}, {scenario}}, {{{"sensor", "accelerometer"}}, {scenario}}};
  }

  Result<Json> measure(const BenchCase& one, const ShowProgress&) const override {
    const auto read = read_scenario(scenario);
    if (!read) return read.failure();
    const auto& imu = read->imu;
    const auto errors =
        one.labels["sensor"] == "gyroscope"
            ? SimTriad::Errors{imu.gyro_bias, imu.gyro_walk, imu.gyro_noise, 0, 0, imu.gyro_range, imu.gyro_step}
            : SimTriad::Errors{imu.accel_bias, imu.accel_walk, imu.accel_noise, 0, 0, imu.accel_range, imu.accel_step};
    SimTriad triad(Random(seed, 2), errors, imu.rate_hz);
    std::vector<double> axis[3];
    for (auto n = static_cast<size_t>(hours * 3600 * imu.rate_hz); n > 0; --n) {
      const Eigen::Vector3d m = triad.measure(Eigen::Vector3d::Zero());
      for (int k = 0; k < 3; ++k) axis[k].push_back(m[k]);
    }
    Json points = Json::array();
    for (double tau = 0.02; tau < hours * 3600 / 20; tau *= std::sqrt(10)) {
      double sum = 0;
      for (const auto& x : axis) sum += allan_deviation(x, imu.rate_hz, tau) / 3;
      const double step = errors.step;  // rounding adds white noise of variance step^2 / 12 to each sample
      const double white = errors.noise * errors.noise + step * step / 12 / imu.rate_hz;
      const double want = std::sqrt(white / tau + errors.walk * errors.walk * tau / 3);
      points.push_back({{"averaging_s", tau}, {"simulated", sum}, {"asked_for", want}, {"ratio", sum / want}});
    }
    return Json{{"rate_hz", imu.rate_hz}, {"points", points}};
  }

  BenchReport report(const Rows& rows) const override {
    BenchReport report{text("%.1f hours at rest, %.0f Hz, mean of three axes; quantisation included.\n\n", hours,
                            number_at(rows[0], "rate_hz")),
                       {},
                       {.title = "Allan deviation at rest", .x_label = "log10 s", .y_label = "log10 (rad/s or m/s^2)"}};
    Rows lines;
    for (const Json& row : rows)
      for (const char* key : {"asked_for", "simulated"}) {
        const bool made = std::string(key) == "simulated";
        PlotSeries series{.name = row["sensor"].get<std::string>() + (made ? ", simulated" : ", asked for"),
                          .style = made ? "points" : "lines"};
        for (const Json& point : row["points"]) {
          series.points.emplace_back(std::log10(number_at(point, "averaging_s")), std::log10(number_at(point, key)));
          if (!made) continue;
          lines.push_back({{"sensor", row["sensor"]}, {"point", point}});
          for (const char* figure : {"simulated", "asked_for"})
            lines.back()[figure] = text("%.3e", number_at(point, figure));
        }
        report.plot.series.push_back(std::move(series));
      }
    report.text += table_text({"",
                               {{"sensor", "sensor"}},
                               {{"averaging", "s", "point/averaging_s"},
                                {"", "simulated", "simulated"},
                                {"", "asked for", "asked_for"},
                                {"", "ratio", "point/ratio", 3}}},
                              lines);
    return report;
  }

  std::string scenario = "samples/scenarios/street_short.yaml";
  uint64_t seed = 1;
  double hours = 3;
};

}  // namespace

std::shared_ptr<Benchmark> bench_allan() { return std::make_shared<Allan>(); }

}  // namespace odograph
