// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdio>

#include "sdk/host/base/printable.hpp"
#include "sdk/host/config/camera_yaml.hpp"
#include "sdk/host/config/manifest.hpp"
#include "sdk/host/config/pipeline_config.hpp"
#include "sdk/host/plugin_host/sealed_copy.hpp"
#include "sdk/tools/command_line/commands.hpp"
#include "sdk/tools/evaluation/faults.hpp"
#include "sdk/tools/replay/replayed.hpp"
#include "sdk/tools/simulation/scenario.hpp"

namespace odograph {
namespace {

/// The plugins of a config, with their fallbacks.
std::vector<const PluginChoice*> plugins_of(const PipelineConfig& config) {
  std::vector<const PluginChoice*> all;
  config.visit_plugins([&](const PluginChoice& choice) {
    for (const PluginChoice* one = &choice; one; one = one->fallback.get()) all.push_back(one);
  });
  return all;
}

/// The first library that is not the one of its manifest, which a session refuses.
Result<bool> check_libraries(const PipelineConfig& config) {
  if (config.library_check == LibraryCheck::none) return true;
  for (const PluginChoice* choice : plugins_of(config)) {
    if (choice->manifest.entry) continue;  // linked in
    if (const auto same = has_hash_of(choice->manifest, choice->manifest.library); !same) return same.failure();
  }
  return true;
}

struct CheckArguments {
  std::vector<std::string> files;
  std::string plugins, assets;
  bool no_load = false;
};

int check(const std::string& file, const CheckArguments& a) {
  std::vector<std::filesystem::path> directories;
  if (!a.plugins.empty()) directories.emplace_back(a.plugins);
  const auto config = read_pipeline_config_file(file, directories);
  if (!config) {
    print_failure(config.failure());
    return kBadUsage;
  }
  if (const auto same = check_libraries(*config); !same)
    return print_failure({ODO_E_CONFIG, file + ": " + same.failure().text});
  if (!a.no_load) {
    RunOptions options;
    options.config = file, options.plugin_path = a.plugins, options.asset_path = a.assets;
    if (const auto session = replay_session(options); !session)
      return print_failure({ODO_E_CONFIG, session.failure().text});
  }
  std::printf("%s: good\n", file.c_str());
  return kDone;
}

void list(const std::vector<Spec>& specs, const std::string& indent) {
  for (const Spec& spec : specs) {
    std::string about = spec.help.empty() ? expectation(spec) : spec.help;
    if (spec.type != SpecType::map && spec.type != SpecType::plugins && spec.type != SpecType::list &&
        !spec.help.empty())
      about += "; " + expectation(spec);
    if (!spec.fallback.empty()) about += "; default " + spec.fallback;
    std::printf("%s%-*s %s\n", indent.c_str(), 28 - static_cast<int>(indent.size()), spec.name.c_str(), about.c_str());
    if (spec.type == SpecType::map) list(spec.children, indent + "  ");
  }
}

int schema(const std::string& which) {
  if (which == "pipeline")
    std::fputs(json_schema(pipeline_spec(), "Odograph pipeline config").c_str(), stdout);
  else if (which == "camera")
    std::fputs(json_schema(camera_spec(), "Odograph camera.yaml").c_str(), stdout);
  else if (which == "scenario")
    std::fputs(json_schema(scenario_spec(), "Odograph simulation scenario").c_str(), stdout);
  else if (which == "faults")
    std::fputs(json_schema(faults_spec(), "Odograph faults of sensors").c_str(), stdout);
  else
    std::fputs(json_schema(manifest_spec(), "Odograph plugin manifest").c_str(), stdout);
  return kDone;
}

}  // namespace

void add_config(CLI::App& app, int& status) {
  auto* command = app.add_subcommand("config", "Check a pipeline config, explain its keys, print its schema");
  command->require_subcommand(1);
  auto a = std::make_shared<CheckArguments>();
  auto* check_command = command->add_subcommand(
      "check", "Find every mistake in configs; creates and configures the plugins as a session does, without samples");
  check_command->add_option("files", a->files, "pipeline configs (YAML)")->required();
  check_command->add_option("--plugins", a->plugins, "folder to look for plugins in first");
  check_command->add_option("--assets", a->assets,
                            "folder of files named by the configs, such as a city model, if they are not beside them");
  check_command->add_flag("--no-load", a->no_load, "load no plugin: the text, the manifests and the libraries' hashes");
  check_command->callback([=, &status] {
    for (const std::string& file : a->files) status = std::max(status, check(file, *a));
  });
  command->add_subcommand("keys", "List all keys of a pipeline config")->callback([&status] {
    list(pipeline_spec().children, "");
    status = kDone;
  });
  auto which = std::make_shared<std::string>("pipeline");
  auto* schema_command = command->add_subcommand("schema", "Print a JSON Schema");
  schema_command->add_option("which", *which, "pipeline, camera, scenario, faults or odoplugin")
      ->check(CLI::IsMember({"pipeline", "camera", "scenario", "faults", "odoplugin"}))
      ->capture_default_str();
  schema_command->callback([=, &status] { status = schema(*which); });
}

}  // namespace odograph
