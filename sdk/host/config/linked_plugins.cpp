// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/config/linked_plugins.hpp"

#include <mutex>

namespace odograph {
namespace {

struct Table {
  std::mutex mutex;
  std::vector<Manifest> manifests;
};

/// Never destroyed: sessions may be created during program exit.
Table& table() {
  static auto* mine = new Table;
  return *mine;
}

}  // namespace

Result<bool> add_linked_plugin(const Manifest& manifest) {
  const std::lock_guard lock(table().mutex);
  for (const Manifest& known : table().manifests) {
    if (known.entry == manifest.entry) return true;
    if (known.id == manifest.id)
      return Failure{ODO_E_CONFIG, "another registered plugin has the id '" + manifest.id + "'"};
  }
  table().manifests.push_back(manifest);
  return true;
}

std::vector<Manifest> linked_plugins() {
  const std::lock_guard lock(table().mutex);
  return table().manifests;
}

}  // namespace odograph
