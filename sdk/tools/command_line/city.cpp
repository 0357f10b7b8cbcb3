// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <fstream>

#include "sdk/tools/benchmarks/benchmarks.hpp"
#include "sdk/tools/city/city_scenario.hpp"
#include "sdk/tools/city/georeferenced_city.hpp"
#include "sdk/tools/command_line/commands.hpp"
#include "sdk/tools/simulation/city_model.hpp"

namespace odograph {
namespace {

constexpr uintmax_t kLargest_bytes = 64u << 20;  // parsing takes 20 times as much memory

/// Prints what is in a model, for the simulator (CityJSON, OBJ) and for `city locate` (CityGML, CityJSON).
Result<bool> print_model(const std::filesystem::path& file) {
  std::error_code error;
  std::string head(64, '\0');
  if (std::filesystem::is_regular_file(file, error)) std::ifstream(file, std::ios::binary).read(head.data(), 64);
  if (const auto size = std::filesystem::file_size(file, error); !error && size > kLargest_bytes)
    return Failure{ODO_E_DATA, file.string() + ": " + std::to_string(size >> 20) + " MB; at most " +
                                   std::to_string(kLargest_bytes >> 20) + " MB are read: cut the model into tiles"};
  const bool gml = is_xml(head);
  if (!gml) {
    const auto model = read_city_model(file);
    if (!model) return model.failure();
    std::printf("%s: %zu objects, %zu triangles\n", file.c_str(), model->objects.size(), model->faces.size());
    if (file.extension() == ".obj") return true;
  }
  const auto city = GeoreferencedCity::geodetic(file);
  if (gml && (city || city.failure().status == ODO_E_UNSUPPORTED)) std::printf("%s: CityGML\n", file.c_str());
  if (city)
    std::printf("  %zu edges of buildings; they span %s\n", city->edges(), city->span().c_str());
  else if (city.failure().status == ODO_E_UNSUPPORTED)
    std::printf("  `city locate` needs --model-at or --at: %s\n", city.failure().text.c_str());
  else if (gml)
    return city.failure();
  else
    std::printf("  warning: fix/skyline rejects it: %s\n", city.failure().text.c_str());
  return true;
}

int check(const std::vector<std::string>& files) {
  int status = kDone;
  for (const std::string& file : files)
    if (const auto done = print_model(file); !done) status = print_failure(done.failure());
  return status;
}

}  // namespace

void add_city(CLI::App& app, int& status) {
  auto* city = app.add_subcommand("city", "3D city models: contents, skylines, routes through their streets");
  city->require_subcommand(1);
  auto files = std::make_shared<std::vector<std::string>>();
  auto* checked =
      city->add_subcommand("check", "Print the contents of city models, or why they are rejected; writes no file");
  checked->add_option("model", *files, "city models: CityJSON, CityGML or OBJ")->required();
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
