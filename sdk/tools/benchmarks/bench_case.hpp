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
#include "sdk/tools/replay/runner.hpp"
#include "sdk/tools/simulation/scenario.hpp"
#include "sdk/tools/table/table.hpp"
#include "sdk/tools/text/text.hpp"

namespace odograph {

/// One run of a benchmark.
struct BenchCase {
  Json labels;                               ///< the first keys of its row
  std::vector<std::filesystem::path> files;  ///< inputs: recordings, models
  RunOptions run{};                          ///< its config, if any, overrides, and the progress callback
  uint64_t seed = 0;
  size_t variant = 0;      ///< index into the benchmark's `variants`, or a number of the benchmark's own
  std::string scenario{};  ///< from which its recording is simulated
};

/// Path of a file of samples/: in the current folder, otherwise as installed beside the program's folder.
std::string sample_file(const std::string& name);

/// Options common to all benchmarks; `Offers` selects those that a benchmark has.
struct BenchOptions {
  std::vector<std::string> configs, set, recordings, scenarios{sample_file("scenarios/street_short.yaml")};
  std::string folder, keep = "out/bench";
  uint64_t seeds = 1, first_seed = 1;
  size_t jobs = 1;
  bool json = false, quick = false, fresh = false, sensors = false;
};
enum Offers : unsigned {
  kConfigs = 1,
  kSeeds = 2,
  kQuick = 4,
  kRecordings = 8,
  kFolder = 16,    ///< of walks, instead of recordings
  kSensors = 32,   ///< each recording also with degraded sensors
  kByConfig = 64,  ///< no option: one table line per config, over all rows
  kSimulated = 128 | kSeeds
};

/// Printed report of the rows. With `json` unset, all rows are printed as JSON.
struct BenchReport {
  std::string text;
  Json json{};
};

/// Description of a benchmark: its runs, measurements and report (docs/benchmarks.md).
struct Benchmark {
  /// `configs`: names in samples/configs.
  Benchmark(std::string its_name, std::string its_about, unsigned its_offers,
            const std::vector<std::string>& configs = {});
  virtual ~Benchmark() = default;

  /// Adds the benchmark's own options. A row depends on all of them except the groups kCases and kOutput.
  virtual void add_options(CLI::App&) {}
  /// The product of its recordings(), variants and configs.
  Result<std::vector<BenchCase>> cases();
  /// By default, the given recordings, those of the folder, the simulated ones, or only seeds.
  virtual Result<std::vector<BenchCase>> recordings();
  /// Adds the further inputs of a case; by default none.
  virtual Result<bool> complete(BenchCase&) const { return true; }

  /// Measures the other keys of a row, in a process of its own. By default measure_recording() of recording_of().
  virtual Result<Json> measure(const BenchCase& one) const;
  /// By default the case's first file, with the variant's sensor degradation.
  virtual Result<Recording> recording_of(const BenchCase& one) const;
  /// By default measure_replay() of a replay with the case's config, attitudes collected.
  virtual Result<Json> measure_recording(const BenchCase& one, const Recording& recording) const;
  virtual Result<Json> measure_replay(const BenchCase& one, const Recording& recording, const RunResult& result) const;

  /// By default heading, a table of the figures of each case (with kByConfig: of each config), and notes.
  virtual BenchReport report(const Rows& rows) const;
  virtual std::string heading(const Rows&) const { return ""; }
  virtual std::string notes(const Rows&) const { return ""; }

  std::string name, about;
  unsigned offers;
  BenchOptions options;
  std::vector<std::string> variants{""};  ///< each adds a label of that name unless empty
  std::string variant_label = "sensors";
  std::vector<Degradation> qualities{{}};  ///< with kSensors, the variants
  uint64_t sensor_seed = 1;                ///< seed of their random numbers
  ReadOptions read{};
  double quick_m = 0;  ///< length to which --quick shortens a simulated recording
  std::string below;   ///< title of the summaries below the table, if any
  Json depends;        ///< the benchmark's own options as given

 protected:
  /// Simulates the recording unless it is kept from an earlier run.
  Result<std::filesystem::path> simulated_recording(const std::filesystem::path& scenario, uint64_t seed) const;
};
/// One line per row: the labels of its case (`_labels`) and the figures of a row_of() table. `below`: title of the
/// summaries over all recordings of a config and sensors, appended if there are several recordings.
std::string cases_text(const Rows& rows, const std::string& table = "figures", const std::string& title = "",
                       const std::string& below = "");

constexpr const char *kCases = "Cases", *kOutput = "Output";

/// Adds the benchmark as a subcommand; its callback writes the exit status.
void add_benchmark(CLI::App& parent, std::shared_ptr<Benchmark> benchmark, int& status);

/// Measures the cases; rows are in the order of the cases, whatever --jobs is. Reuses rows of the keep folder whose
/// recording, config, plugins, options and program are the same. One failure fails all.
Result<Rows> rows_of(const Benchmark& benchmark, const std::vector<BenchCase>& cases);

/// Runs the call in a child process, so that its threads and memory are released, and returns its result.
Result<Json> in_child(const std::function<Result<Json>()>& call);

/// Files of a folder whose names have this beginning and end, sorted.
std::vector<std::string> files_in(const std::filesystem::path& folder, const std::string& begin,
                                  const std::set<std::filesystem::path>& endings);

/// A path's last part, without a file's extension.
std::string stem_of(const std::filesystem::path& path);

}  // namespace odograph
