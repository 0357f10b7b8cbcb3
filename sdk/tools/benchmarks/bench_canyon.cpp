// SPDX-License-Identifier: Apache-2.0
//
// `odograph bench canyon`: what satellite positions between houses do to a walk, with errors that stay alike and jump.
#include "sdk/tools/benchmarks/benchmarks.hpp"
#include "sdk/tools/evaluation/degrade.hpp"
#include "sdk/tools/evaluation/fix_figures.hpp"
#include "sdk/tools/simulation/walk_scenarios.hpp"

namespace odograph {
namespace {

struct Canyon : Benchmark {
  Canyon()
      : Benchmark("canyon", "Simulated walks with satellite positions whose errors stay alike and jump",
                  kConfigs | kSeeds) {
    options.seeds = 10;
  }
  void add_options(CLI::App& command) override {
    command.add_option("--sigma", sigma_m, "standard deviation of each component, m");
    command.add_option("--reflection", reflection_m, "how far off for a minute, m");
    command.add_option("--velocity-sigma", velocity_sigma_mps,
                       "the receiver tells velocities, off by that in each component, m/s; 0: it tells none");
  }

  Result<Json> measure(const BenchCase& one, const ShowProgress&) const override {
    auto recording = simulated(canyon_walk(sigma_m), one.seed);
    if (!recording) return recording.failure();
    const CanyonParameters p;
    shift_gnss(*recording, p.reflection_from_s, p.reflection_to_s, reflection_m);
    if (velocity_sigma_mps > 0) add_gnss_velocities(*recording, velocity_sigma_mps, one.seed);
    const auto result = replay(*recording, one.run);
    if (!result) return result.failure();
    const CanyonFigures f = canyon_figures(recording->true_states, result->track, p);
    return Json{{"heading_after_100_m_deg", f.yaw_deg},
                {"position_m", f.median_m},
                {"largest_m", f.largest_m},
                {"largest_in_reflection_m", f.in_reflection_m}};
  }

  BenchReport report(const Rows& rows) const override {
    std::vector<Column> columns;
    for (const auto& [head, key] : {std::pair{"heading, 100 m", "heading_after_100_m_deg"},
                                    {"position", "position_m"},
                                    {"largest error", "largest_m"},
                                    {"in reflection", "largest_in_reflection_m"}})
      for (const auto& [which, part] : {std::pair{"median", 0.5}, {"worst", 1.0}})
        columns.push_back({head,
                           std::string(key).ends_with("deg") ? std::string("deg ") + which : std::string("m ") + which,
                           std::string(key) + '/' + which, 1, false, key, Over::percentile, part});
    const Rows summaries = summaries_of(rows, "config", columns);
    return {text("%llu walks of 200 m, a position each second with an error of %g m that is alike for 20 s, and off by "
                 "%g m from 60 to 120 s.\n\n",
                 static_cast<unsigned long long>(options.seeds), sigma_m, reflection_m) +
                table_text({"", {{"config", "config"}}, columns}, summaries),
            summaries,
            {}};
  }

  double sigma_m = 12, reflection_m = 40, velocity_sigma_mps = 0;
};

}  // namespace

std::shared_ptr<Benchmark> bench_canyon() { return std::make_shared<Canyon>(); }

}  // namespace odograph
