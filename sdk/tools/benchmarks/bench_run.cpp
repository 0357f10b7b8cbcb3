// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <optional>

#include "sdk/host/base/output_file.hpp"
#include "sdk/host/base/version.hpp"
#include "sdk/host/config/manifest.hpp"
#include "sdk/tools/benchmarks/bench_case.hpp"
#include "sdk/tools/console/console.hpp"
#include "sdk/tools/replay/replayed.hpp"
#include "sdk/tools/validator/child.hpp"

namespace odograph {
namespace {

namespace fs = std::filesystem;

/// Cache of measured rows, one file each, keyed by what a row depends on: recording, config, plugins, program. Without
/// a writable folder, nothing is cached.
class RowStore {
 public:
  explicit RowStore(fs::path folder) : folder_(std::move(folder)) {}

  /// The key of a row. Fails if the config does.
  Result<Json> key_of(const Benchmark& benchmark, const BenchCase& one) {
    Json key = {{"benchmark", benchmark.name},     {"labels", one.labels}, {"options", benchmark.depends},
                {"case", {one.seed, one.variant}}, {"version", kVersion},  {"program", identity_of("/proc/self/exe")}};
    for (const fs::path& file : one.files) key["files"].push_back(identity_of(file));
    if (one.run.config.empty()) return key;
    const auto config = config_of(one.run);
    if (!config) return config.failure();
    key["config"] = config->text, key["beside"] = fs::absolute(one.run.config).parent_path().string();
    key["assets"] = one.run.asset_path;
    config->visit_plugins([&](const PluginChoice& plugin) {
      key["plugins"].push_back({plugin.manifest.id, plugin.manifest.sha256});
    });
    return key;
  }

  std::optional<Json> find(const Json& key) const {
    std::ifstream file(file_of(key));
    const Json kept = file ? Json::parse(file, nullptr, false) : Json();
    if (!kept.is_object() || !kept.contains("row") || kept["key"] != key) return std::nullopt;
    return kept["row"];
  }

  void keep(const Json& key, const Json& row) const {
    std::error_code error;
    fs::create_directories(folder_, error);
    (void)write_whole_file(file_of(key),
                           Json{{"key", key}, {"row", row}}.dump());  // on failure the row is measured again
  }

 private:
  fs::path file_of(const Json& key) const {
    uint64_t hash = 14695981039346656037u;  // FNV-1a; the file holds the whole key
    for (const char c : key.dump()) hash = (hash ^ static_cast<uint8_t>(c)) * 1099511628211u;
    return folder_ /
           (key["benchmark"].get<std::string>() + text("-%016llx.json", static_cast<unsigned long long>(hash)));
  }

  /// Identity of an input: a file's bytes; for a folder, names, sizes and times of its files.
  const Json& identity_of(const fs::path& file) {
    Json& identity = identities_[file.string()];
    if (!identity.is_null()) return identity;
    std::error_code error;
    identity = Json::array();
    if (!fs::is_directory(file, error)) {
      const auto hash = sha256_of(file);
      identity.push_back(hash ? *hash : hash.failure().text);
      return identity;
    }
    for (fs::recursive_directory_iterator at(file, error), end; !error && at != end; at.increment(error))
      if (at->is_regular_file(error))
        identity.push_back({at->path().lexically_relative(file).string(), at->file_size(error),
                            at->last_write_time(error).time_since_epoch().count()});
    std::sort(identity.begin(), identity.end());
    return identity;
  }

  fs::path folder_;
  std::map<std::string, Json> identities_;  // of files, by path
};

/// Text that the process of a run sends, and its inverse.
std::string serialised(const Result<Json>& row) {
  const Json words = row ? Json{{"row", *row}} : Json{{"status", row.failure().status}, {"text", row.failure().text}};
  return words.dump(-1, ' ', false, Json::error_handler_t::replace);
}
Result<Json> parsed(const ChildResult& child) {
  const Json words = child.finished ? Json::parse(child.text, nullptr, false) : Json();
  if (!words.is_object()) return Failure{ODO_E_ERROR, "the process of a run: " + child.text};
  if (words.contains("row")) return words["row"];
  return Failure{words["status"], words["text"]};
}

std::string name_of(const BenchCase& one) {
  std::string name;
  for (const auto& label : one.labels)
    name += (name.empty() ? "" : " ") + (label.is_string() ? stem_of(label.get<std::string>()) : label.dump());
  return name;
}

/// A row's labels, followed by the measurements.
Json labelled(const BenchCase& one, const Json& figures) {
  Json row = one.labels;
  for (const auto& label : one.labels.items()) row["_labels"].push_back(label.key());
  row.update(figures);
  return row;
}

}  // namespace

std::string stem_of(const fs::path& path) {
  return (path.has_filename() ? path : path.parent_path()).stem().string();  // FOLDER/
}

Result<Json> in_child(const std::function<Result<Json>()>& call) {
  return parsed(run_in_child(INFINITY, [&] { return serialised(call()); }));
}

Result<Rows> rows_of(const Benchmark& benchmark, const std::vector<BenchCase>& cases) {
  const BenchOptions& options = benchmark.options;
  RowStore store(fs::path(options.keep) / "rows");
  Rows rows(cases.size()), keys(cases.size());
  std::vector<size_t> missing;
  for (size_t i = 0; i < cases.size(); ++i) {
    auto key = store.key_of(benchmark, cases[i]);
    if (!key) return key.failure();
    keys[i] = std::move(*key);
    const auto kept = options.fresh ? std::nullopt : store.find(keys[i]);
    if (kept)
      rows[i] = labelled(cases[i], *kept);
    else
      missing.push_back(i);
  }
  if (missing.size() < cases.size())
    std::fprintf(stderr, "%zu of %zu rows are from an earlier run (%s/rows; --fresh measures them again)\n",
                 cases.size() - missing.size(), cases.size(), options.keep.c_str());
  const size_t jobs = std::min(options.jobs, missing.size());
  Progress progress("bench " + benchmark.name);
  std::map<size_t, Failure> failures;
  run_in_children(
      missing.size(), jobs,
      [&](size_t i) {
        BenchCase one = cases[missing[i]];
        Progress bar(name_of(one));
        if (jobs == 1) one.run.progress = [&](size_t k, size_t n) { bar.show(k, n); };
        return serialised(benchmark.measure(one));
      },
      [&, done = size_t{0}](size_t i, const ChildResult& child) mutable {
        const size_t number = missing[i];
        const auto row = parsed(child);
        if (row)
          store.keep(keys[number], *row), rows[number] = labelled(cases[number], *row);
        else
          failures.emplace(number, row.failure());
        if (jobs > 1) progress.show(++done, missing.size());
        return failures.empty();
      });
  if (!failures.empty()) return failures.begin()->second;
  return rows;
}

}  // namespace odograph
