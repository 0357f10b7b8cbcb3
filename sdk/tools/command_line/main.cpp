// SPDX-License-Identifier: Apache-2.0
#include <cerrno>
#include <cstdio>
#include <cstring>

#include <unistd.h>

#include "sdk/host/platform/library.hpp"
#include "sdk/tools/command_line/commands.hpp"

namespace odograph {
namespace {

/// The commands of odograph-tools, a program of its own, so that who runs and evaluates need not build it.
constexpr const char* kOfTools[][2] = {
    {"plugin", "For vendors: check a plugin library, write its manifest"},
    {"calibrate", "Calibrate a camera from pictures of a board, and camera-IMU extrinsics from a recording"},
    {"bench", "Run configs over many recordings and print a table"},
    {"city", "3D city models: contents, skylines, routes through their streets"}};

/// Does not return if the program is there.
int run_tools(char** argv) {
  const auto program = own_file().parent_path() / "odograph-tools";
  execv(program.c_str(), argv);
  std::fprintf(stderr, "odograph %s: this needs the program %s: %s\n", argv[1], program.c_str(), std::strerror(errno));
  return kBadUsage;
}

void add_tools(CLI::App& app, int&) {
  for (const auto& [name, help] : kOfTools) app.add_subcommand(name, help);
}

}  // namespace
}  // namespace odograph

int main(int argc, char** argv) {
  using namespace odograph;
  for (const auto& command : kOfTools)
    if (argc > 1 && std::strcmp(argv[1], command[0]) == 0) return run_tools(argv);
  return run_command(argc, argv,
                     {add_run, add_eval, add_sim, add_view, add_steps, add_compare, add_config, add_plugins,
                      add_convert, add_map, add_tools});
}
