// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "sdk/tools/evaluation/degrade.hpp"
#include "sdk/tools/plot/plot.hpp"
#include "sdk/tools/replay/runner.hpp"
#include "sdk/tools/simulation/scenario.hpp"
#include "sdk/tools/table/table.hpp"
#include "sdk/tools/text/text.hpp"

namespace odograph {

/// One run of a benchmark.
struct BenchCase {
  Json labels;                               ///< what it is, the row's first keys
  std::vector<std::filesystem::path> files;  ///< what it reads: recordings, models
  RunOptions run{};  ///< its config, if it has one, what is set in it, and whom to tell how far it has come
  uint64_t seed = 0;
  size_t variant = 0;      ///< of the benchmark's `variants`, or whatever it numbers
  std::string scenario{};  ///< that its recording is simulated from
};

/// What each benchmark has in common; which of the options it offers it says by `Offers`.
struct BenchOptions {
  std::vector<std::string> configs, set, recordings, scenarios{"samples/scenarios/street_short.yaml"};
  std::string folder, keep = "out/bench", plot;
  uint64_t seeds = 1, first_seed = 1;
  size_t jobs = 1;
  bool json = false, quick = false, fresh = false, sensors = false;
};
enum Offers : unsigned {
  kConfigs = 1,
  kSeeds = 2,
  kQuick = 4,
  kPlot = 8,
  kRecordings = 16,
  kFolder = 32,     ///< of walks, instead of recordings
  kSensors = 64,    ///< each recording with its sensors made worse too
  kByConfig = 128,  ///< no option: its table has a line for each config, over all rows
  kSimulated = 256 | kSeeds
};

/// What is printed of the rows. Without `json` that is all rows.
struct BenchReport {
  std::string text;
  Json json{};
};

/// A benchmark as a description: what it runs, what it measures, and what its rows come to (docs/benchmarks.md).
struct Benchmark {
  /// `configs`: names in samples/configs.
  Benchmark(std::string its_name, std::string its_about, unsigned its_offers,
            const std::vector<std::string>& configs = {});
  virtual ~Benchmark() = default;

  /// Options of its own. A row depends on all but those of the groups kCases and kOutput.
  virtual void add_options(CLI::App&) {}
  /// Each of its recordings() with each variant and each config.
  Result<std::vector<BenchCase>> cases();
  /// By default the given ones, those of the folder, those that are simulated, or seeds alone.
  virtual Result<std::vector<BenchCase>> recordings();
  /// What one of these cases needs besides; by default nothing.
  virtual Result<bool> complete(BenchCase&) const { return true; }

  /// A row's other keys; in a process of its own. By default what measure_recording() says of recording_of().
  virtual Result<Json> measure(const BenchCase& one) const;
  /// By default the case's first file, its sensors as the variant has them.
  virtual Result<Recording> recording_of(const BenchCase& one) const;
  /// By default what measure_replay() says of a replay with the case's config, attitudes collected.
  virtual Result<Json> measure_recording(const BenchCase& one, const Recording& recording) const;
  virtual Result<Json> measure_replay(const BenchCase& one, const Recording& recording, const RunResult& result) const;

  /// By default heading, a table of the figures of each case (or with kByConfig of each config), and notes.
  virtual BenchReport report(const Rows& rows) const;
  virtual std::string heading(const Rows&) const { return ""; }
  virtual std::string notes(const Rows&) const { return ""; }
  /// With kPlot: the lines of the plot. By default each row's `_lines` and `_points`, pairs of numbers by name.
  virtual void draw(const Rows& rows, Plot& into) const;

  std::string name, about;
  unsigned offers;
  BenchOptions options;
  std::vector<std::string> variants{""};  ///< a label of that name unless empty
  std::string variant_label = "sensors";
  std::vector<Degradation> qualities{{}};  ///< with kSensors, the variants
  uint64_t sensor_seed = 1;                ///< of their random numbers
  ReadOptions read{};
  double quick_m = 0;  ///< what --quick leaves of a simulated recording
  std::string below;   ///< what the summaries below the table are called, if there are any
  Json depends;        ///< own options as given
  Plot plot;           ///< with kPlot: its title and axes

 protected:
  /// Simulated now, unless it is kept from an earlier run.
  Result<std::filesystem::path> kept(const std::filesystem::path& scenario, uint64_t seed) const;
};
/// A line for each row: the labels of its case (`_labels`) and the figures of a row_of() table. `below`: what summaries
/// over the recordings of a config and sensors are called, which come last where there are several.
std::string cases_text(const Rows& rows, const std::string& table = "figures", const std::string& title = "",
                       const std::string& below = "");

constexpr const char *kCases = "Cases", *kOutput = "Output";

/// Adds the benchmark as a subcommand; its callback writes the exit status.
void add_benchmark(CLI::App& parent, std::shared_ptr<Benchmark> benchmark, int& status);

/// Rows of the cases, in their order, whatever --jobs says. Those of an earlier run in the keep folder are taken where
/// recording, config, plugins, options and program are the same. What one fails of is the failure of all.
Result<Rows> rows_of(const Benchmark& benchmark, const std::vector<BenchCase>& cases);

/// What a call returns that runs in a process of its own: its threads and what it holds end there.
Result<Json> in_child(const std::function<Result<Json>()>& call);

/// A line of a plot through pairs of numbers, if there are any.
void add_line(Plot& plot, const std::string& name, const Json& pairs, const std::string& style = "lines");

/// Files of a folder whose names begin and end like that, in order.
std::vector<std::string> files_in(const std::filesystem::path& folder, const std::string& begin,
                                  const std::set<std::filesystem::path>& endings);

/// A path's last part, without extension where it is a file's.
std::string stem_of(const std::filesystem::path& path);

}  // namespace odograph
