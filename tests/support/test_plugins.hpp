// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <initializer_list>

#include "sdk/host/config/manifest.hpp"
#include "sdk/tools/validator/write_manifest.hpp"
#include "tests/support/support.hpp"

namespace odograph {

// Address and thread sanitizers reserve terabytes: the sandbox then sets no memory limit.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kMemoryLimited = false;
#elif defined(__has_feature)
inline constexpr bool kMemoryLimited = !__has_feature(address_sanitizer) && !__has_feature(thread_sanitizer);
#else
inline constexpr bool kMemoryLimited = true;
#endif

/// One of the tests' own plugins.
inline std::filesystem::path hostile(const std::string& name) {
  return built("tests/hostile") / (name + ODOGRAPH_LIBRARY);
}

/// Copies a plugin and writes the manifest beside the copy; returns the manifest's path.
inline std::filesystem::path copy_plugin(const std::filesystem::path& library, const std::filesystem::path& copy) {
  std::filesystem::copy_file(library, copy, std::filesystem::copy_options::overwrite_existing);
  return *required(write_manifest_beside(copy));
}

/// The tests' own plugins with manifests, in a separate folder.
class TestPlugins {
 public:
  explicit TestPlugins(std::initializer_list<const char*> names) {
    for (const std::string name : names) copy_plugin(hostile(name), folder_ / (name + ODOGRAPH_LIBRARY));
  }
  std::string path() const { return folder_.path().string(); }

 private:
  TemporaryFolder folder_;
};

/// Copies a library into the folder as NAME.so, with a manifest that is not queried from it, which hostile ones would
/// not survive. Returns the folder's path.
inline std::string install_with_manifest(const TemporaryFolder& folder, const std::filesystem::path& library,
                                         const std::string& name, const std::string& id, const std::string& kind) {
  const auto copy = folder / (name + ODOGRAPH_LIBRARY);
  std::filesystem::copy_file(library, copy, std::filesystem::copy_options::overwrite_existing);
  write_text(folder / (name + ".odoplugin.json"),
             "{\"odoplugin\": 1, \"id\": \"" + id + "\", \"version\": \"1.0.0\", \"summary\": \"Bad.\", \"abi\": [" +
                 std::to_string(ODO_ABI_MAJOR) + ", " + std::to_string(ODO_ABI_MINOR) + "], \"interfaces\": [\"" +
                 kind + "\"], \"library\": \"" + name + ODOGRAPH_LIBRARY + "\", \"sha256\": \"" + *sha256_of(copy) +
                 "\", \"parameters\": []}");
  return folder.path().string();
}

}  // namespace odograph
