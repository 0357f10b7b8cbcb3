// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include "sdk/host/base/nearest.hpp"
#include "sdk/host/base/printable.hpp"
#include "sdk/host/config/registry.hpp"
#include "sdk/tools/command_line/commands.hpp"

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
  for (const auto& problem : registry.problems()) std::fprintf(stderr, "skipped: %s\n", printable(problem).c_str());
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

}  // namespace

void add_plugins(CLI::App& app, int& status) {
  auto* list = app.add_subcommand("plugins", "List the plugins on the search path, or explain one");
  auto id = std::make_shared<std::string>();
  auto folder = std::make_shared<std::string>();
  list->add_option("id", *id, "plugin to explain, with its parameters");
  list->add_option("--plugins", *folder, "folder to look in first");
  list->callback([=, &status] { status = plugins(*id, *folder); });
}

}  // namespace odograph
