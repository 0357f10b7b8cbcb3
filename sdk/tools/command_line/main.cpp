// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include <odograph/odograph.h>

#include "sdk/host/base/printable.hpp"
#include "sdk/tools/benchmarks/benchmarks.hpp"
#include "sdk/tools/command_line/commands.hpp"

int main(int argc, char** argv) {
  CLI::App app{"Odograph: a metric 6-DoF pose from a hand-held phone's sensors"};
  app.require_subcommand(1);
  app.set_version_flag("--version", odo_version());
  app.footer(
      "Exit status: 0 done, 1 ran but lost tracking or placed no photograph, 2 bad usage or config, 3 bad data, or "
      "some of the input was lost (what could be read was used), 4 plugin failure.");
  int status = odograph::kDone;
  odograph::add_run(app, status);
  odograph::add_eval(app, status);
  odograph::add_sim(app, status);
  odograph::add_view(app, status);
  odograph::add_steps(app, status);
  odograph::add_compare(app, status);
  odograph::add_config(app, status);
  odograph::add_plugins(app, status);
  odograph::add_convert(app, status);
  odograph::add_calibrate(app, status);
  odograph::add_bench(app, status);
  odograph::add_city(app, status);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? odograph::kDone : odograph::kBadUsage;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "odograph: %s\n", odograph::printable(error.what()).c_str());
    return odograph::kBadData;
  }
  return status;
}
