// SPDX-License-Identifier: Apache-2.0
//
// Databases of skylines: `odograph city build` and `query`. The plugin does the work through its extension
// odo.skylines.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <numbers>
#include <sstream>

#include <nlohmann/json.hpp>
#include <odograph/skylines.h>

#include "sdk/host/plugin_host/instance.hpp"
#include "sdk/tools/city/street_places.hpp"
#include "sdk/tools/command_line/commands.hpp"
#include "sdk/tools/text/text.hpp"

namespace odograph {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector2d;
using Eigen::Vector3d;
constexpr size_t kN = ODO_SKYLINE_DIRECTIONS;

/// Access to fix/skyline's extension odo.skylines.
class Skylines {
 public:
  /// Loads a model with n's origin in it, or a database.
  static Result<std::unique_ptr<Skylines>> make(const std::string& key, const std::string& file,
                                                const Vector3d& origin = Vector3d::Zero()) {
    const std::string yaml = text(
        "odograph: 1\nabsolute_fixers:\n  - plugin: fix/skyline\n    parameters:\n      %s: %s\n"
        "      model_origin: [%.6f m, %.6f m, %.6f m]\n",
        key.c_str(), nlohmann::json(fs::path(file).filename().string()).dump().c_str(), origin.x(), origin.y(),
        origin.z());
    auto config = read_pipeline_config(yaml, "fix/skyline", {});
    if (!config) return config.failure();
    std::unique_ptr<Skylines> made(new Skylines(fs::absolute(file).parent_path()));
    auto plugin = PluginInstance::make(config->fixers.front(), config->library_check, 1, made->host_);
    if (!plugin) return Failure{ODO_E_DATA, made->error_.empty() ? file + ": " + plugin.failure().text : made->error_};
    made->plugin_ = std::move(*plugin);
    made->table_ = static_cast<const odo_skylines*>(made->plugin_->extension(ODO_EXTENSION_SKYLINES));
    if (!made->table_) return Failure{ODO_E_UNSUPPORTED, "this fix/skyline does not provide " ODO_EXTENSION_SKYLINES};
    return made;
  }

  Result<bool> build(const std::string& file, const std::vector<Vector3d>& places, double spacing_m) {
    Progress progress("skylines");
    const odo_string name{file.data(), file.size()};
    const auto show = [](void* context, uint64_t done, uint64_t all) -> int32_t {
      static_cast<Progress*>(context)->show(done, all);
      return 1;
    };
    return result_of(
        table_->build(table_->user, &name, places.front().data(), places.size(), spacing_m, show, &progress), file);
  }
  Result<odo_skyline_database> open(const std::string& file) {
    odo_skyline_database what{};
    what.struct_size = sizeof what;
    const odo_string name{file.data(), file.size()};
    const auto done = result_of(table_->open(table_->user, &name, &what), file);
    if (!done) return done.failure();
    return what;
  }

  struct Skyline {
    Vector3d p_n;
    std::vector<float> elevation_rad, height_m, distance_m;
  };
  Result<Skyline> nearest(const Vector3d& p_n) const {
    uint64_t place = 0;
    Skyline s{p_n, std::vector<float>(kN), std::vector<float>(kN), std::vector<float>(kN)};
    int32_t status = table_->nearest(table_->user, p_n.x(), p_n.y(), &place);
    if (status == ODO_OK)
      status = table_->skyline(table_->user, place, s.p_n.data(), s.elevation_rad.data(), s.height_m.data(),
                               s.distance_m.data());
    const auto done = result_of(status, "place " + std::to_string(place));
    if (!done) return done.failure();
    return s;
  }

  /// Eq. (3) of two skylines.
  double correlation(const Skyline& seen, const Skyline& place) const {
    double correlation = 0;
    table_->correlate(table_->user, seen.elevation_rad.data(), place.elevation_rad.data(), &correlation);
    return correlation;
  }

 private:
  explicit Skylines(const fs::path& folder)
      : host_(0, {folder}, [this](const Report& report) {
          if (report.severity >= ODO_SEVERITY_ERROR) error_ = report.text;
        }) {}
  Result<bool> result_of(int32_t status, const std::string& what) const {
    if (status == ODO_OK) return true;
    return Failure{status, error_.empty() ? what + ": status " + std::to_string(status) : error_};
  }

  std::string error_;
  HostServices host_;
  std::unique_ptr<PluginInstance> plugin_;
  const odo_skylines* table_ = nullptr;
};

struct SkylineArguments {
  std::string model, database, output, along;
  std::vector<double> at, to, seen_from;  // easting, northing
  StreetPlaceParameters places;
  double step_m = 1;
  bool json = false;
};

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Reads a line from rows of easting and northing.
Result<std::vector<Vector2d>> read_line(const std::string& file, const Vector3d& origin) {
  std::ifstream in(file);
  if (!in) return Failure{ODO_E_NOT_FOUND, file + ": no such file"};
  std::vector<Vector2d> line;
  std::string row;
  for (int number = 1; std::getline(in, row); ++number) {
    std::replace(row.begin(), row.end(), ',', ' ');
    if (row.find_first_not_of(" \t\r") == std::string::npos || row[0] == '#') continue;
    std::istringstream numbers(row);
    double easting = 0, northing = 0;
    if (!(numbers >> easting >> northing))
      return Failure{ODO_E_DATA, file + ":" + std::to_string(number) + ": expected easting, northing"};
    line.emplace_back(northing - origin.y(), easting - origin.x());
  }
  if (line.size() < 2) return Failure{ODO_E_DATA, file + ": a line needs at least two points"};
  return line;
}

int build(const SkylineArguments& a) {
  const auto city = read_city_model(a.model);
  if (!city) return print_failure(city.failure());
  auto skylines = Skylines::make("model", a.model, city->origin);
  if (!skylines) return print_failure(skylines.failure());
  Result<std::vector<Vector3d>> places = Failure{};
  if (a.along.empty()) {
    places = places_of_grid(*city, a.places);
  } else {
    const auto line = read_line(a.along, city->origin);
    if (!line) return print_failure(line.failure());
    places = places_along(*city, *line, a.places);
  }
  if (!places) return print_failure(places.failure());
  if (places->empty()) return print_failure({ODO_E_DATA, a.model + ": no place outside buildings"});
  const auto start = std::chrono::steady_clock::now();
  if (const auto done = (*skylines)->build(a.output, *places, a.places.spacing_m); !done)
    return print_failure(done.failure());
  const double took_s = seconds_since(start), n = static_cast<double>(places->size());
  const auto what = (*skylines)->open(a.output);
  if (!what) return print_failure(what.failure());
  std::printf("%s: %zu places %.1f m apart, %.1f MB, %.0f bytes a place; %.1f s, %.0f skylines a second\n",
              a.output.c_str(), places->size(), a.places.spacing_m, static_cast<double>(what->bytes) / 1e6,
              static_cast<double>(what->bytes) / n, took_s, n / took_s);
  return kDone;
}

/// A point of the model's reference system in the database's n.
Vector3d in_n(const odo_skyline_database& what, const std::vector<double>& at) {
  return {at[1] - what.origin[1], at[0] - what.origin[0], 0};
}

/// Figure 7: the correlation of each place along a road with the skyline seen from one place, which is at its peak.
void print_correlation(const Skylines& skylines, const std::vector<Skylines::Skyline>& road,
                       const Skylines::Skyline& seen, double step_m) {
  constexpr double kBar = 60;
  std::printf("# distance_m correlation\n");
  for (size_t k = 0; k < road.size(); ++k) {
    const double correlation = skylines.correlation(seen, road[k]);
    const auto bar = static_cast<size_t>(std::max(0.0, kBar * correlation));
    std::printf("%8.2f %7.4f %s%s\n", static_cast<double>(k) * step_m, correlation, std::string(bar, '#').c_str(),
                road[k].p_n == seen.p_n ? " <" : "");
  }
}

int query(const SkylineArguments& a) {
  auto skylines = Skylines::make("skylines", a.database);
  if (!skylines) return print_failure(skylines.failure());
  const auto what = (*skylines)->open(a.database);
  if (!what) return print_failure(what.failure());
  if (a.at.empty()) {
    std::printf("%s: %llu places, %.1f m apart, %.1f MB; n's origin is at easting %.3f, northing %.3f, height %.3f\n",
                a.database.c_str(), static_cast<unsigned long long>(what->places), what->spacing_m,
                static_cast<double>(what->bytes) / 1e6, what->origin[0], what->origin[1], what->origin[2]);
    return kDone;
  }
  const Vector3d from = in_n(*what, a.at), to = a.to.empty() ? from : in_n(*what, a.to);
  const auto steps = static_cast<size_t>(std::ceil((to - from).norm() / a.step_m));
  std::vector<Skylines::Skyline> found;
  const auto start = std::chrono::steady_clock::now();
  for (size_t k = 0; k <= steps; ++k) {
    const double part = steps ? static_cast<double>(k) / static_cast<double>(steps) : 0.0;
    auto skyline = (*skylines)->nearest(from + part * (to - from));
    if (!skyline) return print_failure(skyline.failure());
    found.push_back(std::move(*skyline));
  }
  const double took_ms = 1e3 * seconds_since(start);
  if (!a.seen_from.empty()) {
    const auto seen = (*skylines)->nearest(in_n(*what, a.seen_from));
    if (!seen) return print_failure(seen.failure());
    print_correlation(**skylines, found, *seen, a.step_m);
    return kDone;
  }
  const auto easting = [&](const Vector3d& p) { return what->origin[0] + p.y(); };
  const auto northing = [&](const Vector3d& p) { return what->origin[1] + p.x(); };
  if (a.json) {
    nlohmann::ordered_json rows = nlohmann::json::array();
    for (const auto& s : found)
      rows.push_back({{"easting_m", easting(s.p_n)},
                      {"northing_m", northing(s.p_n)},
                      {"height_m", what->origin[2] - s.p_n.z()},
                      {"elevation_rad", s.elevation_rad},
                      {"roof_height_m", s.height_m},
                      {"distance_m", s.distance_m}});
    std::printf("%s\n", rows.dump().c_str());
    return kDone;
  }
  if (found.size() == 1) {
    std::printf("# easting %.3f, northing %.3f, height %.3f\n# azimuth_deg elevation_deg height_m distance_m\n",
                easting(found[0].p_n), northing(found[0].p_n), what->origin[2] - found[0].p_n.z());
    for (size_t j = 0; j < kN; ++j)
      std::printf("%7.2f %8.3f %8.3f %9.3f\n", (static_cast<double>(j) + 0.5) * 0.5,
                  static_cast<double>(found[0].elevation_rad[j]) * 180 / std::numbers::pi,
                  static_cast<double>(found[0].height_m[j]), static_cast<double>(found[0].distance_m[j]));
    return kDone;
  }
  std::printf("%zu skylines in %.1f ms\n", found.size(), took_ms);
  return kDone;
}

}  // namespace

void add_city_skylines(CLI::App& city, int& status) {
  auto a = std::make_shared<SkylineArguments>();
  auto* built = city.add_subcommand("build", "Compute the skylines of a model's streets and write them as a database");
  built->add_option("model", a->model, "city model: CityJSON or OBJ, not CityGML")->required();
  built->add_option("-o,--output", a->output, "database to write")->required();
  built->add_option("--spacing", a->places.spacing_m, "distance between places, m")
      ->capture_default_str()
      ->check(CLI::Range(0.1, 1000.0));
  built->add_option("--eye", a->places.eye_m, "height of the camera above the ground, m")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 100.0));
  built->add_option("--along", a->along, "only along a road: file with rows of easting and northing, m");
  built->callback([a, &status] { status = build(*a); });
  auto* asked =
      city.add_subcommand("query", "Print skylines of a database: elevation, height and distance in 720 directions");
  asked->add_option("database", a->database, "database written by `city build`")->required();
  asked->add_option("--at", a->at, "easting and northing in the model's reference system, m")->expected(2);
  asked->add_option("--to", a->to, "end of a road that starts at --at: easting and northing, m")->expected(2);
  asked
      ->add_option("--seen-from", a->seen_from,
                   "easting and northing, m: print the correlation of the skyline there with each along the road, eq. "
                   "(3) and Figure 7 of Gakne & O'Keefe 2018")
      ->expected(2);
  asked->add_option("--step", a->step_m, "distance between places along the road, m")
      ->capture_default_str()
      ->check(CLI::Range(0.01, 1000.0));
  asked->add_flag("--json", a->json, "print one JSON array");
  asked->callback([a, &status] { status = query(*a); });
}

}  // namespace odograph
