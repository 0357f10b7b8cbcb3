// SPDX-License-Identifier: Apache-2.0
//
// odograph-tools: the commands of developers, vendors and cities, which `odograph` runs from here.
#include "sdk/tools/benchmarks/benchmarks.hpp"
#include "sdk/tools/command_line/commands.hpp"

int main(int argc, char** argv) {
  using namespace odograph;
  return run_command(argc, argv, {add_plugin, add_calibrate, add_bench, add_city});
}
