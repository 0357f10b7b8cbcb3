// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include "sdk/base/nearest.hpp"
#include "sdk/cli/commands.hpp"
#include "sdk/plugin_host/check.hpp"
#include "sdk/plugin_host/registry.hpp"
#include "sdk/plugin_host/write_manifest.hpp"

namespace odograph {
namespace {

void describe(const Manifest& m) {
  std::printf("%s %s\n  %s\n  serves %s, ABI %u.%u, library %s\n", m.id.c_str(), m.version.c_str(), m.summary.c_str(),
              join(m.interfaces).c_str(), m.abi_major, m.abi_minor, m.library.c_str());
  for (const Spec& p : m.parameters)
    std::printf("  %-20s %s; %s; default %s\n", p.name.c_str(), p.help.c_str(), expectation(p).c_str(),
                p.fallback.c_str());
}

int plugins(const std::string& id, const std::string& folder) {
  std::vector<std::filesystem::path> first;
  if (!folder.empty()) first.emplace_back(folder);
  const PluginRegistry registry(plugin_directories(first));
  for (const auto& problem : registry.problems()) std::fprintf(stderr, "passed over: %s\n", problem.c_str());
  std::vector<std::string> ids;
  for (const Manifest& m : registry.manifests()) {
    ids.push_back(m.id);
    if (id.empty()) std::printf("%-22s %-8s %s\n", m.id.c_str(), m.version.c_str(), m.summary.c_str());
    if (m.id == id) {
      describe(m);
      return kDone;
    }
  }
  if (id.empty()) return kDone;
  std::fprintf(stderr, "no plugin '%s'; expected one of %s%s\n", id.c_str(), join(ids).c_str(),
               did_you_mean(id, ids).c_str());
  return kBadUsage;
}

int check(const std::string& file, const std::vector<std::string>& set) {
  std::vector<std::pair<std::string, std::string>> settings;
  for (const std::string& one : set) {
    const auto equals = one.find('=');
    if (equals == std::string::npos) return complain({ODO_E_ARGUMENT, "--set " + one + ": expected NAME=VALUE"});
    settings.emplace_back(one.substr(0, equals), one.substr(equals + 1));
  }
  bool good = true;
  for (const PluginCheck& check : check_plugin(file, settings)) {
    std::printf("%-4s %s%s%s\n", check.passed ? "ok" : "FAIL", check.what.c_str(), check.detail.empty() ? "" : ": ",
                check.detail.c_str());
    good = good && check.passed;
  }
  return good ? kDone : kPluginFailure;
}

}  // namespace

void add_plugins(CLI::App& app, int& status) {
  auto* list = app.add_subcommand("plugins", "List the plugins that lie on the search path, or explain one");
  auto id = std::make_shared<std::string>();
  auto folder = std::make_shared<std::string>();
  list->add_option("id", *id, "plugin to explain, with its parameters");
  list->add_option("--plugins", *folder, "folder to look in first");
  list->callback([=, &status] { status = plugins(*id, *folder); });

  auto* command = app.add_subcommand("plugin", "For vendors: check a plugin library, write its manifest");
  command->require_subcommand(1);
  auto file = std::make_shared<std::string>();
  auto* check_command =
      command->add_subcommand("check", "Put a plugin library to the test, each test in a process of its own");
  check_command->add_option("file", *file, "plugin library")->required();
  auto set = std::make_shared<std::vector<std::string>>();
  check_command->add_option("--set", *set, "a parameter that has no good default, as NAME=VALUE");
  check_command->callback([=, &status] { status = check(*file, *set); });
  auto* manifest = command->add_subcommand("manifest", "Write NAME.odoplugin.json beside a plugin library");
  manifest->add_option("file", *file, "plugin library")->required();
  manifest->callback([=, &status] {
    const auto written = write_manifest_beside(*file);
    status = written ? kDone : (std::fprintf(stderr, "%s\n", written.failure().text.c_str()), kPluginFailure);
    if (written) std::printf("%s\n", written->c_str());
  });
}

}  // namespace odograph
