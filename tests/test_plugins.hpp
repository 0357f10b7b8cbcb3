// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <initializer_list>
#include <string>

#include <doctest/doctest.h>

#include "sdk/validator/write_manifest.hpp"
#include "tests/support.hpp"

namespace odograph {

/// The tests' own plugins with manifests, in a folder of their own.
class TestPlugins {
 public:
  explicit TestPlugins(std::initializer_list<const char*> names) {
    for (const std::string name : names) {
      const auto library = folder_ / (name + ".so");
      std::filesystem::copy_file(std::filesystem::path(ODOGRAPH_BUILD) / "tests/hostile" / (name + ".so"), library);
      const auto written = write_manifest_beside(library);
      REQUIRE_MESSAGE(written.ok(), (written.ok() ? "" : written.failure().text));
    }
  }
  std::string path() const { return folder_.path().string(); }

 private:
  TemporaryFolder folder_;
};

}  // namespace odograph
