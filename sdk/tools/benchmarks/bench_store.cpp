// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/benchmarks/bench_store.hpp"

#include <algorithm>
#include <fstream>

#include "sdk/host/base/output_file.hpp"
#include "sdk/host/base/version.hpp"
#include "sdk/host/config/manifest.hpp"
#include "sdk/tools/replay/replayed.hpp"

namespace odograph {

namespace fs = std::filesystem;

/// A file's bytes; of a folder the names, sizes and times of what lies in it.
const Json& RowStore::identity_of(const fs::path& file) {
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

Result<Json> RowStore::key_of(const Benchmark& benchmark, const BenchCase& one) {
  Json key = {{"benchmark", benchmark.name},     {"labels", one.labels}, {"options", benchmark.depends},
              {"case", {one.seed, one.variant}}, {"version", kVersion},  {"program", identity_of("/proc/self/exe")}};
  for (const fs::path& file : one.files) key["files"].push_back(identity_of(file));
  if (one.run.config.empty()) return key;
  const auto config = config_of(one.run);
  if (!config) return config.failure();
  key["config"] = config->text, key["beside"] = fs::absolute(one.run.config).parent_path().string();
  key["assets"] = one.run.asset_path;
  for (const auto* kind :
       {&config->attitudes, &config->step_estimators, &config->vo_frontends, &config->scale_sources, &config->fixers})
    for (const PluginChoice& plugin : *kind) key["plugins"].push_back({plugin.manifest.id, plugin.manifest.sha256});
  return key;
}

fs::path RowStore::file_of(const Json& key) const {
  uint64_t hash = 14695981039346656037u;  // FNV-1a; the file holds the whole key
  for (const char c : key.dump()) hash = (hash ^ static_cast<uint8_t>(c)) * 1099511628211u;
  return folder_ / (key["benchmark"].get<std::string>() + text("-%016llx.json", static_cast<unsigned long long>(hash)));
}

std::optional<Json> RowStore::find(const Json& key) const {
  std::ifstream file(file_of(key));
  const Json kept = file ? Json::parse(file, nullptr, false) : Json();
  if (!kept.is_object() || !kept.contains("row") || kept["key"] != key) return std::nullopt;
  return kept["row"];
}

void RowStore::keep(const Json& key, const Json& row) const {
  std::error_code error;
  fs::create_directories(folder_, error);
  (void)write_whole_file(file_of(key), Json{{"key", key}, {"row", row}}.dump());  // without it the row is made anew
}

}  // namespace odograph
