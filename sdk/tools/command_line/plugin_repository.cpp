// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/command_line/plugin_repository.hpp"

#include <fstream>
#include <utility>

#include <odograph/base.h>

namespace odograph {
namespace {

constexpr char kCheck[] = R"(#!/bin/sh
# Builds the plugin on Debian 12, tests it, and states what it conforms to: build/conformance.md, build/conformance.svg.
# Where Odograph is not installed: ODOGRAPH_REPOSITORY is the address of an apt repository of it, with odograph.asc in it.
set -eu
if ! command -v odograph > /dev/null; then
  : "${ODOGRAPH_REPOSITORY:?the address of an apt repository of Odograph}"
  apt-get update -qq
  apt-get install -y -qq ca-certificates cmake curl g++ ninja-build > /dev/null
  curl -fsSL "$ODOGRAPH_REPOSITORY/odograph.asc" -o /usr/share/keyrings/odograph.asc
  echo "deb [signed-by=/usr/share/keyrings/odograph.asc] $ODOGRAPH_REPOSITORY bookworm main" > /etc/apt/sources.list.d/odograph.list
  apt-get update -qq
  apt-get install -y -qq libodograph-dev odograph > /dev/null
fi
cmake -B build "$@"
cmake --build build
ctest --test-dir build --output-on-failure
cat build/conformance.md
)";

constexpr char kGitHub[] = R"(name: check
on: [push, pull_request]
jobs:
  check:
    runs-on: ubuntu-latest
    container: debian:12
    env:
      ODOGRAPH_REPOSITORY: ${{ vars.ODOGRAPH_REPOSITORY }}
    steps:
      - uses: actions/checkout@v4
      - run: sh ci/check
      - run: cat build/conformance.md >> "$GITHUB_STEP_SUMMARY"
      - uses: actions/upload-artifact@v4
        if: always()
        with:
          name: conformance
          path: |
            build/conformance.*
            build/check.xml
)";

constexpr char kGitLab[] = R"(# ODOGRAPH_REPOSITORY: a variable of the project (Settings, CI/CD).
check:
  image: debian:12
  script: sh ci/check
  artifacts:
    when: always
    paths: [build/conformance.md, build/conformance.svg]
    reports:
      junit: build/check.xml
)";

}  // namespace

Result<bool> write_plugin_repository(const std::string& id, const std::filesystem::path& folder) {
  namespace fs = std::filesystem;
  std::error_code error;
  for (const auto& [name, text] : {std::pair<const char*, std::string>{"ci/check", kCheck},
                                   {".github/workflows/check.yml", kGitHub},
                                   {".gitlab-ci.yml", kGitLab},
                                   {".gitignore", "/build/\n"}}) {
    const fs::path file = folder / name;
    if (fs::exists(file, error)) return Failure{ODO_E_ARGUMENT, file.string() + " is there already"};
    fs::create_directories(file.parent_path(), error);
    std::ofstream out(file, std::ios::binary);
    out << text;
    if (!out.flush()) return Failure{ODO_E_NOT_FOUND, file.string() + ": cannot be written"};
  }
  fs::permissions(folder / "ci/check", fs::perms::owner_exec | fs::perms::group_exec | fs::perms::others_exec,
                  fs::perm_options::add, error);
  std::ofstream readme(folder / "README.md", std::ios::binary | std::ios::app);
  readme << "\n`ci/check` builds, tests and states what " << id
         << " conforms to: `build/conformance.md`, and `build/conformance.svg` as a badge. GitHub and GitLab run it "
            "(`.github`, `.gitlab-ci.yml`);\n"
            "set `ODOGRAPH_REPOSITORY` there to the address of an apt repository of Odograph.\n";
  if (!readme.flush()) return Failure{ODO_E_NOT_FOUND, (folder / "README.md").string() + ": cannot be written"};
  return true;
}

}  // namespace odograph
