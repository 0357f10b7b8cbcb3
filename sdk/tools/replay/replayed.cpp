// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/replay/replayed.hpp"

#include <algorithm>

#include "sdk/host/base/nearest.hpp"
#include "sdk/host/base/output_file.hpp"
#include "sdk/host/platform/temporary_folder.hpp"

namespace odograph {
namespace {

/// The options with a temporary config that includes the overrides. Relative paths still refer to the original file's
/// folder.
Result<RunOptions> overridden(RunOptions options, const TemporaryFolder& folder) {
  if (options.overrides.empty()) return options;
  const auto text = effective_config(options.config, options.overrides);
  if (!text) return text.failure();
  const std::filesystem::path file(options.config);
  options.asset_path = std::filesystem::absolute(file).parent_path().string() + ':' + options.asset_path;
  options.config = (folder / file.filename().string()).string();
  if (const auto written = write_whole_file(options.config, *text); !written) return written.failure();
  return options;
}

/// Replaces the temporary config's name in a failure by the original file's.
Failure named_as(const std::string& name, const std::string& own, Failure failure) {
  const std::string shown = name + " with overrides";
  for (size_t at = 0; own != name && (at = failure.text.find(own, at)) != std::string::npos; at += shown.size())
    failure.text.replace(at, own.size(), shown);
  return failure;
}

}  // namespace

Result<bool> choose_config(RunOptions& options, const std::string& choice, const std::vector<std::string>& set) {
  const size_t query = std::min(choice.find('?'), choice.size());
  std::vector<std::string> texts = set;
  if (query < choice.size())
    for (std::string& value : split(choice.substr(query + 1), '&')) texts.push_back(std::move(value));
  std::vector<Override> overrides;
  for (const std::string& text : texts) {
    const auto value = parse_override(text);
    if (!value) return value.failure();
    overrides.push_back(*value);
  }
  options.config = choice.substr(0, query);
  options.overrides.insert(options.overrides.begin(), overrides.begin(), overrides.end());
  return true;
}

Result<PipelineConfig> config_of(const RunOptions& options) {
  const TemporaryFolder folder;
  const auto own = overridden(options, folder);
  if (!own) return own.failure();
  std::vector<std::filesystem::path> directories;
  if (!options.plugin_path.empty()) directories.emplace_back(options.plugin_path);
  auto config = read_pipeline_config_file(own->config, directories, path_list(own->asset_path));
  if (!config) return named_as(options.config, own->config, config.failure());
  return config;
}

Result<SessionHandle> replay_session(const RunOptions& options) {
  const TemporaryFolder folder;
  const auto own = overridden(options, folder);
  if (!own) return own.failure();
  odo_session_options o{};
  o.struct_size = sizeof o;
  o.run = ODO_RUN_REPLAY;
  o.flags = ODO_SESSION_CRASH_NOTES;
  o.config_path = {own->config.data(), own->config.size()};
  o.plugin_path = {own->plugin_path.data(), own->plugin_path.size()};
  o.seed = own->seed;
  o.asset_path = {own->asset_path.data(), own->asset_path.size()};
  odo_error error{sizeof error, ODO_OK, {}};
  odo_session* session = nullptr;
  if (const int32_t status = odo_session_create(&o, &session, &error); status != ODO_OK)
    return named_as(options.config, own->config, {status, error.message});
  return SessionHandle(session, odo_session_destroy);
}

std::optional<Failure> push(odo_session* session, const RecordedMessage& message) {
  const odo_header& header = message.message.header();
  if (header.type != ODO_TYPE_FRAME) {
    odo_session_push(session, &header);
    return std::nullopt;
  }
  const auto picture = load_frame(message);
  if (!picture) return picture.failure();
  odo_session_push(session, &picture->header);
  picture->loan.release(picture->loan.owner);
  return std::nullopt;
}

}  // namespace odograph
