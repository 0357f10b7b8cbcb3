// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <fstream>
#include <functional>
#include <optional>

#include "sdk/host/base/printable.hpp"
#include "sdk/host/config/manifest.hpp"
#include "sdk/tools/command_line/commands.hpp"
#include "sdk/tools/command_line/plugin_skeleton.hpp"
#include "sdk/tools/recording/recording.hpp"
#include "sdk/tools/validator/check.hpp"
#include "sdk/tools/validator/statement.hpp"
#include "sdk/tools/validator/write_manifest.hpp"

namespace odograph {
namespace {

struct CheckWish {
  std::string file, format = "text", output, recording, statement, signer;
  std::vector<std::string> set, only;
  bool list = false, times = false;
};

/// Passes the messages of a recording on; skips frames whose pictures are unreadable.
void for_each_message(const Recording& recording, const std::function<void(const odo_header&)>& give) {
  for (const RecordedMessage& message : recording.messages) {
    if (message.message.header().type != ODO_TYPE_FRAME) {
      give(message.message.header());
    } else if (const auto frame = load_frame(message)) {
      give(frame->header);
      frame->loan.release(frame->loan.owner);
    }
  }
}

/// Writes conformance.md and conformance.svg.
Result<bool> write_statement(const CheckWish& wish, const std::vector<PluginCheck>& checks) {
  const auto manifest = read_manifest(std::filesystem::path(wish.file).replace_extension(".odoplugin.json"));
  if (!manifest) return manifest.failure();
  for (const auto& [name, text] :
       {std::pair<const char*, std::string>{"conformance.md", conformance_statement(*manifest, checks)},
        {"conformance.svg", conformance_badge(*manifest, checks)}}) {
    const std::filesystem::path file = std::filesystem::path(wish.statement) / name;
    std::ofstream out(file, std::ios::binary);
    out << text;
    if (!out.flush()) return Failure{ODO_E_IO, file.string() + ": cannot be written"};
  }
  return true;
}

int check(const CheckWish& wish) {
  if (wish.list) {
    for (const auto& [id, what] : plugin_check_cases()) std::printf("%-26s %s\n", id.c_str(), what.c_str());
    return kDone;
  }
  if (wish.file.empty())
    return print_failure({ODO_E_ARGUMENT, "which plugin library? (odograph plugin check FILE.so)"});
  std::error_code error;
  if (!std::filesystem::is_regular_file(wish.file, error))
    return print_failure({ODO_E_NOT_FOUND, wish.file + (std::filesystem::exists(wish.file, error)
                                                            ? ": is not a regular file; expected a plugin library"
                                                            : ": does not exist; expected a plugin library")});
  if (!wish.statement.empty() && !wish.only.empty())
    return print_failure({ODO_E_ARGUMENT, "--statement covers all cases; omit --only"});
  CheckOptions options;
  options.only = wish.only;
  options.signer = wish.signer;
  for (const std::string& one : wish.set) {
    const auto equals = one.find('=');
    if (equals == std::string::npos) return print_failure({ODO_E_ARGUMENT, "--set " + one + ": expected NAME=VALUE"});
    options.settings.emplace_back(one.substr(0, equals), one.substr(equals + 1));
  }
  std::optional<Result<Recording>> recording;
  if (!wish.recording.empty()) {
    recording.emplace(read_recording(wish.recording, {.events = true}));
    if (!*recording) return print_failure(recording->failure());
    options.recording = [&](const auto& give) { for_each_message(**recording, give); };
  }
  const bool as_it_goes = wish.format == "text" && wish.output.empty();
  std::string text;
  options.ended = [&](const std::vector<PluginCheck>& checks) {
    if (wish.format != "text") return;
    const std::string line = last_as_text(checks, wish.times);
    text += line;
    if (!as_it_goes) return;
    std::fputs(line.c_str(), stdout);
    std::fflush(stdout);
  };
  const auto checks = check_plugin(wish.file, options);
  if (checks.empty())
    return print_failure(
        {ODO_E_ARGUMENT, "--only: no case has this prefix; `odograph plugin check --list` names them"});
  text += wish.format == "json"    ? check_as_json(wish.file, checks)
          : wish.format == "junit" ? check_as_junit(wish.file, checks)
                                   : counts_as_text(checks);
  if (as_it_goes) {
    std::fputs(counts_as_text(checks).c_str(), stdout);
  } else if (wish.output.empty()) {
    std::fputs(text.c_str(), stdout);
  } else {
    std::ofstream out(wish.output, std::ios::binary);
    out << text;
    if (!out.flush()) return print_failure({ODO_E_IO, wish.output + ": cannot be written"});
  }
  if (!wish.statement.empty())
    if (const auto written = write_statement(wish, checks); !written) return print_failure(written.failure());
  for (const PluginCheck& one : checks)
    if (one.outcome == PluginCheck::Outcome::failed) return kPluginFailure;
  return kDone;
}

struct NewWish {
  std::string kind, id, folder, language = "c++";
  bool repository = false;
};

int write_new(const NewWish& wish) {
  if (wish.repository && wish.language == "python") {
    std::fprintf(stderr, "--repository is for plugins in C++, C or Rust; those in Python are for research\n");
    return kBadUsage;
  }
  const std::filesystem::path where = wish.folder.empty() ? wish.id.substr(wish.id.find('/') + 1) : wish.folder;
  const auto written = write_plugin_skeleton(wish.kind, wish.id, where, wish.language, wish.repository);
  if (!written) return print_failure(written.failure());
  std::printf("%s: see README.md there\n", where.c_str());
  return kDone;
}

void add_new(CLI::App& plugin, int& status) {
  auto wish = std::make_shared<NewWish>();
  auto* command = plugin.add_subcommand("new", "Write the source of a new plugin, ready to be built and run");
  command
      ->add_option("kind", wish->kind,
                   "attitude, step_estimator, vo_frontend, scale_source, absolute_fixer or surface_finder")
      ->required();
  command->add_option("id", wish->id, "group/name")->required();
  command->add_option("folder", wish->folder, "target folder; default: named after the plugin");
  command->add_option("--language", wish->language, "c++ (C++17), c (C99), rust or python")
      ->check(CLI::IsMember({"c++", "c", "rust", "python"}));
  command->add_flag_callback(
      "--c", [wish] { wish->language = "c"; }, "the same as --language c");
  command->add_flag(
      "--repository", wish->repository,
      "with CI files for GitHub and GitLab that build, check and write the conformance statement; C++, C or Rust");
  command->callback([=, &status] { status = write_new(*wish); });
}

}  // namespace

void add_plugin(CLI::App& app, int& status) {
  auto* command = app.add_subcommand("plugin", "For vendors: check a plugin library, write its manifest");
  command->require_subcommand(1);
  auto file = std::make_shared<std::string>();
  auto wish = std::make_shared<CheckWish>();
  auto* check_command = command->add_subcommand("check", "Test a plugin library, each case in its own process");
  check_command->add_option("file", wish->file, "plugin library");
  check_command->add_option("--set", wish->set, "NAME=VALUE of a parameter without a usable default");
  check_command->add_option("--only", wish->only, "only cases whose id begins with this, such as events or step.late");
  check_command->add_option("--format", wish->format, "text, json or junit")
      ->check(CLI::IsMember({"text", "json", "junit"}));
  check_command->add_option("-o,--output", wish->output, "output file; default: the terminal");
  check_command->add_option("--statement", wish->statement,
                            "folder for the conformance statement, conformance.md, and its badge conformance.svg");
  check_command->add_option("--recording", wish->recording,
                            "also run the plugin on this recording; its events are counted and checked");
  check_command
      ->add_option("--signer", wish->signer,
                   "public key that must have signed the manifest, as in plugins.signers of a config")
      ->check(
          [](const std::string& key) {
            return key.size() == 64 && key.find_first_not_of("0123456789abcdefABCDEF") == std::string::npos
                       ? ""
                       : "expected an Ed25519 public key, 64 hexadecimal digits";
          },
          "KEY");
  check_command->add_flag("--times", wish->times, "print the time of each case");
  check_command->add_flag("--list", wish->list, "list the cases");
  check_command->callback([=, &status] { status = check(*wish); });
  add_new(*command, status);
  auto* manifest = command->add_subcommand("manifest", "Write NAME.odoplugin.json beside a plugin library");
  manifest->add_option("file", *file, "plugin library")->required();
  manifest->callback([=, &status] {
    const auto written = write_manifest_beside(*file);
    status =
        written ? kDone : (std::fprintf(stderr, "%s\n", printable(written.failure().text).c_str()), kPluginFailure);
    if (written) std::printf("%s\n", written->c_str());
  });
}

}  // namespace odograph
