// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "sdk/tools/benchmarks/bench_table.hpp"
#include "sdk/tools/plot/plot.hpp"
#include "sdk/tools/replay/runner.hpp"
#include "sdk/tools/simulation/scenario.hpp"

namespace odograph {

using ShowProgress = std::function<void(size_t done, size_t all)>;

/// One run of a benchmark.
struct BenchCase {
  Json labels;                               ///< what it is, the row's first keys
  std::vector<std::filesystem::path> files;  ///< what it reads: recordings, models
  RunOptions run{};                          ///< its config, if it has one, and what is set in it
  uint64_t seed = 0;
  size_t variant = 0;  ///< of the benchmark's `variants`, or whatever it numbers
};

/// What each benchmark has in common; which of the options it offers it says by `Offers`.
struct BenchOptions {
  std::vector<std::string> configs, set, recordings, scenarios;
  std::string keep = "out/bench", plot;
  uint64_t seeds = 1, first_seed = 1;
  size_t jobs = 1;
  bool json = false, quick = false, fresh = false;
};
enum Offers : unsigned { kConfigs = 1, kSeeds = 2, kQuick = 4, kPlot = 8, kSimulated = 16, kRecordings = 32 };

/// What is printed and drawn of the rows. Without `json` that is all rows.
struct BenchReport {
  std::string text;
  Json json{};
  Plot plot{};
};

/// A benchmark as a description: what it runs, what it measures, and what its rows come to (docs/benchmarks.md).
struct Benchmark {
  Benchmark(std::string its_name, std::string its_about, unsigned its_offers)
      : name(std::move(its_name)), about(std::move(its_about)), offers(its_offers) {}
  virtual ~Benchmark() = default;

  /// Options of its own. A row depends on all but those of the groups kCases and kOutput.
  virtual void add_options(CLI::App&) {}
  /// Each recording, or each seed where there are none, with each variant and each config.
  virtual Result<std::vector<BenchCase>> cases();
  /// A row's other keys; in a process of its own.
  virtual Result<Json> measure(const BenchCase& one, const ShowProgress& progress) const = 0;
  virtual BenchReport report(const Rows& rows) const = 0;

  std::string name, about;
  unsigned offers;
  BenchOptions options;
  std::vector<std::string> variants{""};  ///< such as sensors made worse; a label unless empty
  double quick_m = 0;                     ///< what --quick leaves of a simulated recording
  Json depends;                           ///< own options as given

 protected:
  /// A config of the command line, FILE or FILE?PATH=VALUE&PATH=VALUE, with what --set says.
  Result<RunOptions> run_of(const std::string& config) const;
  /// Simulated now, unless it is kept from an earlier run.
  Result<std::filesystem::path> kept(const std::filesystem::path& scenario, uint64_t seed) const;
  Result<std::vector<std::filesystem::path>> recordings() const;
};
constexpr const char *kCases = "Cases", *kOutput = "Output";

/// Adds the benchmark as a subcommand; its callback writes the exit status.
void add_benchmark(CLI::App& parent, std::shared_ptr<Benchmark> benchmark, int& status);

/// Rows of the cases, in their order, whatever --jobs says. Those of an earlier run in the keep folder are taken where
/// recording, config, plugins, options and program are the same. What one fails of is the failure of all.
Result<Rows> rows_of(const Benchmark& benchmark, const std::vector<BenchCase>& cases);

/// What a call returns that runs in a process of its own: its threads and what it holds end there.
Result<Json> in_child(const std::function<Result<Json>()>& call);

/// A replay of the case's first file, and what `score` makes of it.
using Score = std::function<Result<Json>(const Recording& recording, const RunResult& result)>;
Result<Json> replayed(const BenchCase& one, const ShowProgress& progress, const Score& score);

/// What a simulator without a camera makes of a scenario; nothing of it is kept.
Result<Recording> simulated(const Scenario& scenario, uint64_t seed);

/// A path's last part, without extension where it is a file's.
std::string stem_of(const std::filesystem::path& path);

}  // namespace odograph
