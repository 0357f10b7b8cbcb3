// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/benchmarks/bench_case.hpp"

#include <cstdio>

#include "sdk/host/base/nearest.hpp"
#include "sdk/host/base/temporary_folder.hpp"
#include "sdk/tools/console/console.hpp"
#include "sdk/tools/replay/kept_recordings.hpp"
#include "sdk/tools/simulation/simulate.hpp"

namespace odograph {

namespace fs = std::filesystem;

namespace {

void add_common(CLI::App& command, Benchmark& b) {
  BenchOptions& o = b.options;
  const auto offers = [&](unsigned what) { return (b.offers & what) != 0; };
  if (offers(kRecordings)) command.add_option("recordings", o.recordings, "recordings")->required(!offers(kSimulated));
  if (offers(kSimulated)) command.add_option("--scenario", o.scenarios, "what is simulated, without recordings");
  if (offers(kConfigs)) {
    command
        .add_option("-c,--config", o.configs,
                    "pipeline configs to compare, each FILE or FILE?PATH=VALUE&PATH=VALUE with values of its own")
        ->required(o.configs.empty());
    command.add_option("--set", o.set, "PATH=VALUE in every config, such as walker.height=1.8m");
  }
  if (offers(kSeeds)) {
    command.add_option("--seeds", o.seeds, "how many of each")->check(CLI::Range(1, 1000));
    command.add_option("--first-seed", o.first_seed, "the first of them");
  }
  if (offers(kQuick)) command.add_flag("--quick", o.quick, "the beginning of what is simulated alone");
  if (offers(kPlot)) command.add_option("--plot", o.plot, "write the plot as SVG");
  if (!command.get_option_no_throw("--keep"))
    command.add_option("--keep", o.keep, "simulated recordings and rows are kept here");
  command.add_option("--jobs", o.jobs, "so many runs at a time")->check(CLI::Range(1, 256));
  command.add_flag("--fresh", o.fresh, "measure again what is kept of an earlier run");
  command.add_flag("--json", o.json, "print the rows as JSON");
}

int run(Benchmark& b) {
  const auto cases = b.cases();
  if (!cases) return complain(cases.failure());
  const auto rows = rows_of(b, *cases);
  if (!rows) return complain(rows.failure());
  const BenchReport report = b.report(*rows);
  const std::string json = b.options.json ? (report.json.is_null() ? printed(*rows) : report.json).dump(2) + '\n' : "";
  std::fputs((b.options.json ? json : report.text).c_str(), stdout);
  if (b.options.plot.empty()) return kDone;
  if (report.plot.series.empty()) {
    std::fprintf(stderr, "%s: nothing to plot\n", b.options.plot.c_str());
    return kDone;
  }
  const auto written = write_svg(report.plot, b.options.plot);
  return written ? kDone : complain(written.failure());
}

}  // namespace

Result<RunOptions> Benchmark::run_of(const std::string& config) const {
  RunOptions run;
  const size_t query = config.find('?');
  run.config = config.substr(0, query);
  std::vector<std::string> set = options.set;
  if (query != std::string::npos)
    for (std::string& one : split(config.substr(query + 1), '&')) set.push_back(std::move(one));
  for (const std::string& one : set) {
    const auto value = parse_override(one);
    if (!value) return value.failure();
    run.overrides.push_back(*value);
  }
  return run;
}

Result<fs::path> Benchmark::kept(const fs::path& scenario, uint64_t seed) const {
  const auto path =
      in_child([&]() -> Result<Json> {  // rendering starts threads, and a process with threads cannot fork
        const auto file = kept_recording(scenario, seed, options.keep, options.quick ? quick_m : 0.0);
        return file ? Result<Json>(file->string()) : file.failure();
      });
  return path ? Result<fs::path>(path->get<std::string>()) : path.failure();
}

Result<std::vector<fs::path>> Benchmark::recordings() const {
  std::vector<fs::path> files(options.recordings.begin(), options.recordings.end());
  for (const std::string& scenario : files.empty() ? options.scenarios : std::vector<std::string>())
    for (uint64_t seed = options.first_seed; seed < options.first_seed + options.seeds; ++seed) {
      const auto file = kept(scenario, seed);
      if (!file) return file.failure();
      files.push_back(*file);
    }
  return files;
}

Result<std::vector<BenchCase>> Benchmark::cases() {
  const auto files = recordings();
  if (!files) return files.failure();
  std::vector<BenchCase> things, all;
  for (const fs::path& file : *files) things.push_back({{{"recording", stem_of(file)}}, {file}});
  for (uint64_t k = 0; files->empty() && k < options.seeds; ++k)
    things.push_back({{{"seed", options.first_seed + k}}, {}, {}, options.first_seed + k});
  for (const BenchCase& thing : things)
    for (size_t v = 0; v < variants.size(); ++v)
      for (const std::string& config : (offers & kConfigs) ? options.configs : std::vector<std::string>{""}) {
        BenchCase one = thing;
        const auto run = run_of(config);
        if (!run) return run.failure();
        one.run = *run, one.variant = v;
        if (!config.empty()) one.labels["config"] = config;
        if (!variants[v].empty()) one.labels["sensors"] = variants[v];
        all.push_back(std::move(one));
      }
  return all;
}

Result<Json> replayed(const BenchCase& one, const ShowProgress& progress, const Score& score) {
  const auto recording = read_recording(one.files.front());
  if (!recording) return recording.failure();
  RunOptions run = one.run;
  run.progress = progress;
  const auto result = replay(*recording, run);
  return result ? score(*recording, *result) : result.failure();
}

Result<Recording> simulated(const Scenario& scenario, uint64_t seed) {
  const TemporaryFolder folder;
  const fs::path file = folder / "walk.odo";
  const auto made = simulate(scenario, seed, file, {.threads = 1, .frames = false});
  return made ? read_recording(file) : made.failure();
}

void add_benchmark(CLI::App& parent, std::shared_ptr<Benchmark> benchmark, int& status) {
  auto* command = parent.add_subcommand(benchmark->name, benchmark->about);
  command->option_defaults()->always_capture_default();
  benchmark->add_options(*command);
  const auto own = command->get_options();
  add_common(*command, *benchmark);
  command->callback([benchmark, own, &status] {
    for (const CLI::Option* option : own)
      if (option->get_group() != kCases && option->get_group() != kOutput && option->count() > 0)
        benchmark->depends[option->get_name()] = option->results();
    status = run(*benchmark);
  });
}

}  // namespace odograph
