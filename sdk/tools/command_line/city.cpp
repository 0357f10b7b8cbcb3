// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include "sdk/tools/benchmarks/benchmarks.hpp"
#include "sdk/tools/city/city_check.hpp"
#include "sdk/tools/city/city_scenario.hpp"
#include "sdk/tools/city/georeferenced_city.hpp"
#include "sdk/tools/command_line/commands.hpp"

namespace odograph {
namespace {

/// Prints what `city locate` reads of CityGML and CityJSON, and whether it supports the reference system.
Result<bool> print_buildings(const std::string& file) {
  const auto city = GeoreferencedCity::geodetic(file);
  if (city)
    std::printf("  %zu edges of buildings; they span %s\n  %s\n", city->edges(), city->span().c_str(),
                city->reference_system().c_str());
  else if (city.failure().status == ODO_E_UNSUPPORTED)
    std::printf("  `city locate` needs --model-at or --at: %s\n", city.failure().text.c_str());
  else
    return city.failure();
  return true;
}

int check(const std::vector<std::string>& files) {
  int status = kDone;
  for (const std::string& file : files) {
    const auto done = check_city_model(file);
    if (!done) {
      status = print_failure(done.failure());
      continue;
    }
    const CityCheck& c = *done;
    const bool gml = c.format == "CityGML";
    if (gml)
      std::printf("%s: CityGML\n", file.c_str());
    else
      std::printf("%s: %s%s%s, %zu objects, %zu vertices, %zu surfaces with %zu holes%s%s\n", file.c_str(),
                  c.format.c_str(), c.version.empty() ? "" : " ", c.version.c_str(), c.objects, c.vertices, c.surfaces,
                  c.holes, c.reference_system.empty() ? ", no reference system" : ", ", c.reference_system.c_str());
    if (!gml && c.surfaces == 0) std::printf("  nothing that could be seen in it\n");
    for (const auto& [type, count] : c.skipped)
      std::printf("  %zu geometries of the type %s are not used\n", count, type.c_str());
    for (const auto& warning : c.warnings) std::printf("  warning: %s\n", warning.c_str());
    if (!gml && (c.format == "OBJ" || c.surfaces == 0)) continue;
    const auto read = print_buildings(file);
    if (!read && gml) status = print_failure(read.failure());
    if (!read && !gml) std::printf("  warning: fix/skyline rejects it: %s\n", read.failure().text.c_str());
  }
  return status;
}

}  // namespace

void add_city(CLI::App& app, int& status) {
  auto* city = app.add_subcommand("city", "3D city models: contents, skylines, routes through their streets");
  city->require_subcommand(1);
  auto files = std::make_shared<std::vector<std::string>>();
  auto* checked =
      city->add_subcommand("check", "Print the contents of city models, or why they are rejected; writes no file");
  checked->add_option("model", *files, "city models: CityJSON, CityJSONSeq, CityGML or OBJ")->required();
  checked->callback([files, &status] { status = check(*files); });
  auto r = std::make_shared<CityScenario>();
  auto* draw =
      city->add_subcommand("route", "Write a random route through a model's streets as a scenario for `odograph sim`");
  draw->add_option("model", r->model, "city model: CityJSON or OBJ")->required();
  draw->add_option("-o,--output", r->output, "scenario file to write")->required();
  draw->add_option("--seed", r->seed, "seed of the random route")->capture_default_str();
  draw->add_option("--length", r->length_m, "length of the route, m")
      ->capture_default_str()
      ->check(CLI::Range(20.0, 5000.0));
  draw->add_option("--lens", r->lens, "wide and narrow look up, forward looks ahead")
      ->capture_default_str()
      ->check(CLI::IsMember({"wide", "narrow", "forward"}));
  draw->add_option("--carrier", r->carrier, "what carries the camera")
      ->capture_default_str()
      ->check(CLI::IsMember({"car", "walker"}));
  draw->callback([r, &status] {
    const auto done = write_city_scenario(*r);
    status = done ? kDone : print_failure(done.failure());
  });
  add_city_locate(*city, status);
  add_city_skylines(*city, status);
  add_bench_city(*city, status);
}

}  // namespace odograph
