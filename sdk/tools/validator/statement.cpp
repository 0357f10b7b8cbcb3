// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/validator/statement.hpp"

#include <algorithm>
#include <fstream>
#include <map>

#include <odograph/odograph.h>

#include "sdk/host/base/nearest.hpp"

namespace odograph {
namespace {

using Outcome = PluginCheck::Outcome;

std::string count(const std::vector<PluginCheck>& checks, Outcome outcome) {
  return std::to_string(
      std::count_if(checks.begin(), checks.end(), [&](const auto& c) { return c.outcome == outcome; }));
}

/// "x86-64, Debian GNU/Linux 12 (bookworm)": the library's target, from its ELF header, and the system of the test.
std::string machine(const std::filesystem::path& library) {
  constexpr size_t kMachineAt = 18;  // offset of a 16-bit little-endian number in the header
  const std::map<int, std::string> names = {{3, "x86"}, {40, "ARM"}, {62, "x86-64"}, {183, "AArch64"}};
  std::string head(kMachineAt + 2, '\0');
  std::ifstream(library, std::ios::binary).read(head.data(), static_cast<std::streamsize>(head.size()));
  const auto name = names.find(static_cast<unsigned char>(head[kMachineAt]));
  std::string text = name == names.end() ? "another processor" : name->second;
  std::ifstream release("/etc/os-release");
  const std::string key = "PRETTY_NAME=\"";
  for (std::string line; std::getline(release, line);)
    if (line.rfind(key, 0) == 0) text += ", " + line.substr(key.size(), line.size() - key.size() - 1);
  return text;
}

std::string table_row(const std::string& name, const std::string& value) {
  return "| " + name + " | " + value + " |\n";
}

/// A line with the number and names of all of them but the first; empty if there is one.
std::string further_cases(const std::vector<std::string>& same) {
  if (same.size() < 2) return "";
  constexpr size_t kNamed = 6;  // fits on a line
  const size_t more = same.size() - 1, named = std::min(more, kNamed);
  return "  the same fault in " + std::to_string(more) + (more == 1 ? " further case: " : " further cases: ") +
         join({same.begin() + 1, same.begin() + 1 + static_cast<std::ptrdiff_t>(named)}) +
         (more > named ? ", ... (--format json lists them)" : "") + "\n";
}

std::string listed(const std::vector<PluginCheck>& checks, Outcome outcome, const std::string& title) {
  std::string text;
  for (const PluginCheck& check : checks) {
    if (check.outcome != outcome) continue;
    const auto same = cases_with_fault_of(checks, check);
    if (same.front() != check.id) continue;
    text += "* `" + check.id + "` " + check.what + (check.detail.empty() ? "" : ": " + check.detail) + "\n" +
            further_cases(same);
  }
  return text.empty() ? "" : "\n## " + title + "\n\n" + text;
}

/// Verdana's advance at 11 px is about 7 px per character.
constexpr int kCharacter_px = 7;
constexpr int kMargin_px = 10;

}  // namespace

std::string conformance_statement(const Manifest& manifest, const std::vector<PluginCheck>& checks) {
  const bool good = count(checks, Outcome::failed) == "0";
  return "# " + manifest.id + " " + manifest.version + (good ? " conforms to " : " does not conform to ") +
         join(manifest.interfaces) + "\n\n" + manifest.summary + ".\n\n| | |\n|---|---|\n" +
         table_row("contract", join(manifest.interfaces) + ", ABI " + std::to_string(manifest.abi_major) + "." +
                                   std::to_string(manifest.abi_minor)) +
         table_row("cases", count(checks, Outcome::passed) + " passed, " + count(checks, Outcome::failed) +
                                " failed, " + count(checks, Outcome::not_applicable) + " do not apply, " +
                                count(checks, Outcome::not_run) + " not run") +
         table_row("library", "`" + manifest.library.filename().string() + "`, SHA-256 `" + manifest.sha256 + "`") +
         table_row("checked by", std::string("odograph ") + odo_version() + ", `odograph plugin check`") +
         table_row("machine", machine(manifest.library)) + listed(checks, Outcome::failed, "Failed") +
         listed(checks, Outcome::not_applicable, "Does not apply") + listed(checks, Outcome::not_run, "Not run");
}

std::string conformance_badge(const Manifest& manifest, const std::vector<PluginCheck>& checks) {
  const bool good = count(checks, Outcome::failed) == "0";
  const std::string left = join(manifest.interfaces);
  const std::string right =
      good ? count(checks, Outcome::passed) + " cases passed" : count(checks, Outcome::failed) + " cases failed";
  const int split = static_cast<int>(left.size()) * kCharacter_px + kMargin_px;
  const int width = split + static_cast<int>(right.size()) * kCharacter_px + kMargin_px;
  const auto text = [](int x, const std::string& words) {
    return "<text x=\"" + std::to_string(x) + "\" y=\"14\">" + words + "</text>";
  };
  return "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + std::to_string(width) +
         "\" height=\"20\" role=\"img\" aria-label=\"" + left + ": " + right + "\"><rect width=\"" +
         std::to_string(width) + "\" height=\"20\" rx=\"3\" fill=\"#444\"/><path d=\"M" + std::to_string(split) +
         " 0h" + std::to_string(width - split - 3) + "a3 3 0 0 1 3 3v14a3 3 0 0 1-3 3H" + std::to_string(split) +
         "z\" fill=\"" + (good ? "#2a7d2a" : "#b02a2a") +
         "\"/><g fill=\"#fff\" font-family=\"Verdana,sans-serif\" font-size=\"11\" text-anchor=\"middle\">" +
         text(split / 2, left) + text((split + width) / 2, right) + "</g></svg>\n";
}

}  // namespace odograph
