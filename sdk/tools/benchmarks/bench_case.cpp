// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/benchmarks/bench_case.hpp"

#include <algorithm>
#include <cstdio>

#include "sdk/host/base/printable.hpp"
#include "sdk/host/platform/library.hpp"
#include "sdk/tools/console/console.hpp"
#include "sdk/tools/replay/outcome.hpp"
#include "sdk/tools/replay/recording_cache.hpp"
#include "sdk/tools/replay/replayed.hpp"

namespace odograph {

namespace fs = std::filesystem;

namespace {

void add_common(CLI::App& command, Benchmark& b) {
  BenchOptions& o = b.options;
  const auto offers = [&](unsigned what) { return (b.offers & what) == what; };
  if (offers(kRecordings)) command.add_option("recordings", o.recordings, "recordings")->required(!offers(kSimulated));
  if (offers(kFolder))
    command
        .add_option("data", o.folder, "folder of Indoor Location Competition traces (*.txt) or of recordings (*.odo)")
        ->required();
  if (offers(kSimulated)) command.add_option("--scenario", o.scenarios, "scenarios to simulate instead of recordings");
  if (offers(kSensors))
    command.add_flag("--sensors", o.sensors, "each recording unchanged and with each sensor fault in turn");
  if (offers(kConfigs)) {
    command
        .add_option("-c,--config", o.configs,
                    "pipeline configs to compare, each FILE or FILE?PATH=VALUE&PATH=VALUE with overrides")
        ->required(o.configs.empty());
    command.add_option("--set", o.set, "PATH=VALUE in every config, such as walker.height=1.8m");
  }
  if (offers(kSeeds)) {
    command.add_option("--seeds", o.seeds, "number of seeds")->check(CLI::Range(1, 1000));
    command.add_option("--first-seed", o.first_seed, "the first seed");
  }
  if (offers(kQuick)) command.add_flag("--quick", o.quick, "only the beginning of each simulation");
  if (!command.get_option_no_throw("--keep"))
    command.add_option("--keep", o.keep, "folder in which simulated recordings and rows are kept");
  command.add_option("--jobs", o.jobs, "number of parallel runs")->check(CLI::Range(1, 256));
  command.add_flag("--fresh", o.fresh, "repeat measurements kept from an earlier run");
  command.add_flag("--json", o.json, "print the rows as JSON");
}

/// Why a run is no measurement; empty if it is one. A run that ends lost is one.
std::string fault_of(const RunResult& result) {
  if (const uint64_t faults = result.statistics.plugin_faults; faults > 0)
    return text("plugins failed %llu times", static_cast<unsigned long long>(faults));
  if (!result.nothing.empty()) return "the run came to nothing: " + result.nothing;
  return result.loss.any() ? "a part of the recording is lost" : "";
}

int run(Benchmark& b) {
  if (b.options.sensors) b.qualities = sensor_qualities();
  const auto cases = b.cases();
  if (!cases) return print_failure(cases.failure());
  const auto rows = rows_of(b, *cases);
  if (!rows) return print_failure(rows.failure());
  const BenchReport report = b.report(*rows);
  int status = kDone;
  for (const Json& row : *rows) {
    if (!row.contains("_fault")) continue;
    std::fprintf(stderr, "%s\n", printable(row["_fault"]["text"].get<std::string>()).c_str());
    status = std::max(status, row["_fault"]["status"].get<int>());
  }
  const std::string json =
      b.options.json ? (report.json.is_null() ? visible_rows(*rows) : report.json).dump(2) + '\n' : "";
  std::fputs((b.options.json ? json : report.text).c_str(), stdout);
  return status;
}

}  // namespace

std::string sample_file(const std::string& name) {
  const std::string here = "samples/" + name;
  const fs::path installed = own_file().parent_path().parent_path() / "share/odograph" / here;
  std::error_code error;
  return !fs::exists(here, error) && fs::exists(installed, error) ? installed.string() : here;
}

Benchmark::Benchmark(std::string its_name, std::string its_about, unsigned its_offers,
                     const std::vector<std::string>& configs)
    : name(std::move(its_name)), about(std::move(its_about)), offers(its_offers) {
  for (const std::string& config : configs) options.configs.push_back(sample_file("configs/" + config + ".yaml"));
}

Result<fs::path> Benchmark::simulated_recording(const fs::path& scenario, uint64_t seed) const {
  const auto path =
      in_child([&]() -> Result<Json> {  // rendering starts threads, and a process with threads cannot fork safely
        const auto file = cached_recording(scenario, seed, options.keep, options.quick ? quick_m : 0.0);
        return file ? Result<Json>(file->string()) : file.failure();
      });
  return path ? Result<fs::path>(path->get<std::string>()) : path.failure();
}

Result<std::vector<BenchCase>> Benchmark::recordings() {
  const bool folder = (offers & kFolder) != 0, simulated = (offers & kSimulated) == kSimulated;
  const auto files = folder ? files_in(options.folder, "", {".txt", ".odo"}) : options.recordings;
  if (folder && files.empty())
    return Failure{ODO_E_NOT_FOUND, options.folder + ": no walks (*.txt, *.odo) in this folder"};
  std::vector<BenchCase> all;
  for (const std::string& file : files) all.push_back({{{"recording", stem_of(file)}}, {file}});
  if (!all.empty()) return all;
  for (const std::string& scenario : simulated ? options.scenarios : std::vector<std::string>{""})
    for (uint64_t seed = options.first_seed; seed < options.first_seed + options.seeds; ++seed) {
      all.push_back({{{"seed", seed}}, {}, {}, seed, 0, scenario});
      if (!simulated) continue;
      const auto file = simulated_recording(scenario, seed);
      if (!file) return file.failure();
      all.back().labels = {{"recording", stem_of(*file)}}, all.back().files = {*file};
      all.back().run.asset_path = assets_of(*file).string();
    }
  return all;
}

Result<std::vector<BenchCase>> Benchmark::cases() {
  if (offers & kSensors) variants = names_of(qualities);
  const auto things = recordings();
  if (!things) return things.failure();
  std::vector<BenchCase> all;
  for (const BenchCase& thing : *things)
    for (size_t v = 0; v < variants.size(); ++v)
      for (const std::string& config : (offers & kConfigs) ? options.configs : std::vector<std::string>{""}) {
        BenchCase one = thing;
        if (const auto chosen = choose_config(one.run, config, options.set); !chosen) return chosen.failure();
        one.variant = v;
        if (!variants[v].empty()) one.labels[variant_label] = variants[v];
        if (!config.empty()) one.labels["config"] = config;
        if (const auto done = complete(one); !done) return done.failure();
        all.push_back(std::move(one));
      }
  return all;
}

Result<Json> Benchmark::measure(const BenchCase& one) const {
  const auto recording = recording_of(one);
  return recording ? measure_recording(one, *recording) : recording.failure();
}

Result<Recording> Benchmark::recording_of(const BenchCase& one) const {
  auto recording = read_recording(one.files.front(), read);
  return recording && (offers & kSensors) ? degraded(*recording, qualities[one.variant], sensor_seed) : recording;
}

Result<Json> Benchmark::measure_recording(const BenchCase& one, const Recording& recording) const {
  RunOptions run = one.run;
  run.collect_attitudes = true;
  const auto result = replay(recording, run);
  if (!result) return result.failure();
  auto row = measure_replay(one, recording, *result);
  if (const std::string text = fault_of(*result); row && !text.empty())
    (*row)["_fault"] = {{"status", exit_status(*result)},
                        {"text", recording.path.string() + ", " + run.config + ": " + text}};
  return row;
}

Result<Json> Benchmark::measure_replay(const BenchCase&, const Recording&, const RunResult&) const { return Json(); }

BenchReport Benchmark::report(const Rows& rows) const {
  if (!(offers & kByConfig)) return {heading(rows) + cases_text(rows, "figures", "", below) + notes(rows)};
  const auto columns = columns_of(rows);
  const Rows summaries = summaries_of(rows, "config", columns);
  return {heading(rows) + table_text({"", {{"config", "config"}}, columns}, summaries) + notes(rows),
          visible_rows(summaries)};
}

std::string cases_text(const Rows& rows, const std::string& table, const std::string& title, const std::string& below) {
  Table shown{title, {}, columns_of(rows, table)};
  for (const Json& row : rows)
    if (const Json labels = row.value("_labels", Json::array()); shown.labels.empty())
      for (const std::string key : labels) shown.labels.push_back({key, key, key == "config"});
  Rows lines = rows, summaries;
  for (const auto& [config, own] : groups_of(below.empty() ? Rows() : rows, "config"))
    for (Json& summary : summaries_of(own, "sensors", shown.columns)) {
      summary["config"] = config, summary["recording"] = below;
      summaries.push_back(std::move(summary));
    }
  if (summaries.size() < rows.size()) lines.insert(lines.end(), summaries.begin(), summaries.end());
  return table_text(shown, lines);
}

std::vector<std::string> files_in(const fs::path& folder, const std::string& begin, const std::set<fs::path>& endings) {
  std::vector<std::string> files;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error))
    if (entry.path().filename().string().starts_with(begin) && endings.count(entry.path().extension()) > 0)
      files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
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
