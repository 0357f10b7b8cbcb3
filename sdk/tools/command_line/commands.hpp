// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <initializer_list>

#include <CLI/CLI.hpp>

#include "sdk/tools/console/console.hpp"

namespace odograph {

/// The main function of a program with these subcommands: returns the exit status.
int run_command(int argc, char** argv, std::initializer_list<void (*)(CLI::App&, int&)> commands);

/// Each adds its subcommand, whose callback writes the exit status.
void add_run(CLI::App& app, int& status);
void add_eval(CLI::App& app, int& status);
void add_sim(CLI::App& app, int& status);
void add_config(CLI::App& app, int& status);
void add_plugins(CLI::App& app, int& status);
void add_plugin(CLI::App& app, int& status);
void add_convert(CLI::App& app, int& status);
void add_calibrate(CLI::App& app, int& status);
void add_view(CLI::App& app, int& status);
void add_steps(CLI::App& app, int& status);
void add_compare(CLI::App& app, int& status);
/// `odograph map ...`: files of maps of places.
void add_map(CLI::App& app, int& status);
/// `odograph city ...`: city models, their skylines, routes through their streets.
void add_city(CLI::App& app, int& status);
/// `odograph city build` and `query`.
void add_city_skylines(CLI::App& city, int& status);
/// `odograph city locate`.
void add_city_locate(CLI::App& city, int& status);

}  // namespace odograph
