// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/command_line/plugin_repository.hpp"

#include <fstream>
#include <string>
#include <utility>

#include <odograph/base.h>

namespace odograph {
namespace {

/// Build and test commands of a language, and the Debian 12 packages that they need beside Odograph.
struct Toolchain {
  const char *packages, *build, *ignored;
};

constexpr Toolchain kCMake = {"cmake g++ libodograph-dev ninja-build openssl", R"(cmake -B build "$@"
cmake --build build
ctest --test-dir build --output-on-failure
)",
                              "/build/\n"};

constexpr Toolchain kCargo = {"cargo openssl", R"(program=$(command -v odograph)
[ -e odograph ] || ln -s "${program%/bin/odograph}/share/odograph/bindings/rust" odograph
cargo build --release
mkdir -p build
cp "${CARGO_TARGET_DIR:-target}/release/lib@FILE@.so" build/@FILE@.so
odograph plugin manifest build/@FILE@.so
odograph plugin check build/@FILE@.so --format junit -o build/check.xml --statement build
odograph config check pipeline.yaml
)",
                              "/build/\n/target/\n/odograph\n"};

constexpr char kCheck[] = R"(#!/bin/sh
# Builds and tests the plugin on Debian 12, and writes its conformance statement: build/conformance.md, build/conformance.svg.
# ODOGRAPH_KEY: the Ed25519 key, as a PEM file, that signs the manifest (openssl genpkey -algorithm ed25519); without it, it is unsigned.
# If Odograph is not installed, ODOGRAPH_REPOSITORY must be the address of an apt repository with it and odograph.asc.
set -eu
if ! command -v odograph > /dev/null; then
  : "${ODOGRAPH_REPOSITORY:?the address of an apt repository of Odograph}"
  apt-get update -qq
  apt-get install -y -qq ca-certificates curl > /dev/null
  curl -fsSL "$ODOGRAPH_REPOSITORY/odograph.asc" -o /usr/share/keyrings/odograph.asc
  echo "deb [signed-by=/usr/share/keyrings/odograph.asc] $ODOGRAPH_REPOSITORY bookworm main" > /etc/apt/sources.list.d/odograph.list
  apt-get update -qq
  apt-get install -y -qq odograph @PACKAGES@ > /dev/null
fi
@BUILD@if [ -n "${ODOGRAPH_KEY:-}" ]; then
  openssl pkeyutl -sign -rawin -inkey "$ODOGRAPH_KEY" -in build/@FILE@.odoplugin.json -out build/@FILE@.odoplugin.sig
  key=$(openssl pkey -in "$ODOGRAPH_KEY" -pubout -outform DER | tail -c 32 | od -An -v -tx1 | tr -d ' \n')
  odograph plugin check build/@FILE@.so --only file --signer "$key"
  echo "for a user's config: plugins: {signers: [{ids: @ID@, key: $key}]}"
fi
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
      - run: |  # the secret ODOGRAPH_KEY, if there is one, is the PEM text of the key that signs
          if [ -n "$KEY" ]; then
            (umask 077; printf '%s\n' "$KEY" > "$RUNNER_TEMP/key.pem")
            export ODOGRAPH_KEY="$RUNNER_TEMP/key.pem"
          fi
          sh ci/check
        env:
          KEY: ${{ secrets.ODOGRAPH_KEY }}
      - run: cat build/conformance.md >> "$GITHUB_STEP_SUMMARY"
      - uses: actions/upload-artifact@v4
        if: always()
        with:
          name: conformance
          path: |
            build/*.so
            build/*.odoplugin.*
            build/conformance.*
            build/check.xml
)";

constexpr char kGitLab[] =
    R"(# ODOGRAPH_REPOSITORY: set it as a variable of the project (Settings, CI/CD); ODOGRAPH_KEY, to sign, as one of type File, protected.
check:
  image: debian:12
  script: sh ci/check
  artifacts:
    when: always
    paths: [build/*.so, build/*.odoplugin.*, build/conformance.md, build/conformance.svg]
    reports:
      junit: build/check.xml
)";

std::string with(std::string text, const std::string& mark, const std::string& value) {
  for (size_t at = 0; (at = text.find(mark, at)) != std::string::npos; at += value.size())
    text.replace(at, mark.size(), value);
  return text;
}

}  // namespace

Result<bool> write_plugin_repository(const std::string& id, const std::filesystem::path& folder,
                                     const std::string& language) {
  namespace fs = std::filesystem;
  std::error_code error;
  const Toolchain& tools = language == "rust" ? kCargo : kCMake;
  std::string check = with(with(kCheck, "@BUILD@", tools.build), "@PACKAGES@", tools.packages);
  check = with(with(check, "@FILE@", id.substr(id.find('/') + 1)), "@ID@", id);
  for (const auto& [name, text] : {std::pair<const char*, std::string>{"ci/check", check},
                                   {".github/workflows/check.yml", kGitHub},
                                   {".gitlab-ci.yml", kGitLab},
                                   {".gitignore", tools.ignored}}) {
    const fs::path file = folder / name;
    if (fs::exists(file, error)) return Failure{ODO_E_ARGUMENT, file.string() + " already exists"};
    fs::create_directories(file.parent_path(), error);
    std::ofstream out(file, std::ios::binary);
    out << text;
    if (!out.flush()) return Failure{ODO_E_IO, file.string() + ": cannot be written"};
  }
  fs::permissions(folder / "ci/check", fs::perms::owner_exec | fs::perms::group_exec | fs::perms::others_exec,
                  fs::perm_options::add, error);
  std::ofstream readme(folder / "README.md", std::ios::binary | std::ios::app);
  readme
      << "\n`ci/check` builds and tests " << id
      << " and writes its conformance statement, `build/conformance.md`, with the badge `build/conformance.svg`. "
         "GitHub and GitLab run it "
         "(`.github`, `.gitlab-ci.yml`);\n"
         "set `ODOGRAPH_REPOSITORY` there to the address of an apt repository of Odograph, and `ODOGRAPH_KEY` to the "
         "key that signs the plugin, if it is to be signed.\n";
  if (!readme.flush()) return Failure{ODO_E_IO, (folder / "README.md").string() + ": cannot be written"};
  return true;
}

}  // namespace odograph
