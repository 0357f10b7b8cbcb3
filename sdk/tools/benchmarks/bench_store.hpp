// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>

#include "sdk/tools/benchmarks/bench_case.hpp"

namespace odograph {

/// Rows that were measured before, each in a file of its own with what it depends on: recording, config, plugins,
/// program. Where the folder cannot be written there are none.
class RowStore {
 public:
  explicit RowStore(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// What a row depends on. Failures are those of its config.
  Result<Json> key_of(const Benchmark& benchmark, const BenchCase& one);
  std::optional<Json> find(const Json& key) const;
  void keep(const Json& key, const Json& row) const;

 private:
  std::filesystem::path file_of(const Json& key) const;
  const Json& identity_of(const std::filesystem::path& file);

  std::filesystem::path folder_;
  std::map<std::string, Json> identities_;  // of files, by path
};

}  // namespace odograph
