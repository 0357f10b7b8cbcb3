// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/command_line/commands.hpp"

#include <cstdio>

#include <odograph/odograph.h>

#include "sdk/host/base/printable.hpp"

namespace odograph {

int run_command(int argc, char** argv, std::initializer_list<void (*)(CLI::App&, int&)> commands) {
  CLI::App app{"Odograph: a metric 6-DoF pose from a hand-held phone's sensors", "odograph"};
  app.require_subcommand(1);
  app.set_version_flag("--version", odo_version());
  app.footer(
      "Exit status: 0 done, 1 ran but lost tracking, came to nothing or placed no photograph, 2 bad usage or config, 3 "
      "bad data, or "
      "some of the input was lost (what could be read was used), 4 plugin failure.");
  int status = kDone;
  for (const auto add : commands) add(app, status);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kDone : kBadUsage;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "odograph: %s\n", printable(error.what()).c_str());
    return kBadData;
  }
  return status;
}

}  // namespace odograph
