// SPDX-License-Identifier: Apache-2.0
//
// Survey of a scenario's objects.
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include <opencv2/imgcodecs.hpp>

#include "sdk/host/base/geodesy.hpp"
#include "sdk/math/scalar.hpp"
#include "sdk/tools/simulation/simulate.hpp"
#include "sdk/tools/simulation/world.hpp"
#include "sdk/tools/text/text.hpp"

namespace odograph {
namespace {

constexpr double kSurvey_m = 0.01;  // stated standard deviation of each corner; the corners are exact

/// The ground as a mesh with x east, y north, z up from n's origin, as fix/terrain reads it: each leg of the route
/// reaches 200 m aside and, at its ends' heights, 100 m beyond.
std::string ground_of(const std::vector<Eigen::Vector3d>& route) {
  constexpr double kAside_m = 200, kBeyond_m = 100;
  std::string obj = "# the ground of a simulated route\n";
  size_t vertices = 0;
  for (size_t i = 0; i + 1 < route.size(); ++i) {
    const Eigen::Vector3d &from = route[i], &to = route[i + 1];
    const Eigen::Vector2d along = (to - from).head<2>().normalized(), right(-along.y(), along.x());
    const Eigen::Vector3d beyond(kBeyond_m * along.x(), kBeyond_m * along.y(), 0);
    for (const Eigen::Vector3d& p : {Eigen::Vector3d(from - beyond), from, to, Eigen::Vector3d(to + beyond)})
      for (const double side : {-kAside_m, kAside_m})
        obj += text("v %.3f %.3f %.3f\n", p.y() + side * right.y(), p.x() + side * right.x(), p.z());
    for (size_t k = vertices + 1; k < vertices + 7; k += 2) obj += text("f %zu %zu %zu %zu\n", k, k + 1, k + 3, k + 2);
    vertices += 8;
  }
  return obj;
}

}  // namespace

Result<bool> write_known_objects(const Scenario& scenario, uint64_t seed, const std::filesystem::path& folder) {
  std::optional<CityModel> city;
  if (scenario.world.type == "city") {
    auto model = read_city_model(scenario.world.model, scenario.world.model_origin);
    if (!model) return model.failure();
    city = std::move(*model);
  }
  const World world(scenario, seed, city ? &*city : nullptr);
  if (world.known_objects().empty())
    return Failure{ODO_E_CONFIG, "the scenario has no `route: {objects: ...}` that could be surveyed"};
  Geodesy geodesy;
  geodesy.set_origin(kSimulatedOrigin);
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  std::string yaml = "odograph_objects: 1\nobjects:\n";
  for (const KnownObject& object : world.known_objects()) {
    const bool tag = object.poster.empty();
    yaml += text("  - id: %s %u\n    sigma: %g\n", tag ? "tag" : "poster", object.tag, kSurvey_m);
    if (tag) {
      yaml += text("    tag: %u\n", object.tag);
    } else {
      const std::string picture = "poster" + std::to_string(object.tag) + ".png";
      if (!cv::imwrite((folder / picture).string(), object.poster))
        return Failure{ODO_E_IO, (folder / picture).string() + ": cannot be written"};
      yaml += text("    picture: %s\n", picture.c_str());
    }
    yaml += "    corners:\n";
    for (const Eigen::Vector3d& p : object.corners) {
      const auto at = geodesy.to_geodetic({p.x(), p.y(), p.z()});
      yaml += text("      - [%.10f, %.10f, %.4f]\n", at[0] / kRad_per_deg, at[1] / kRad_per_deg, at[2]);
    }
  }
  for (const auto& [name, content] : {std::pair{"objects.yaml", yaml}, {"ground.obj", ground_of(scenario.route)}}) {
    std::ofstream out(folder / name);
    out << content;
    if (!out.flush()) return Failure{ODO_E_IO, (folder / name).string() + ": cannot be written"};
  }
  return true;
}

}  // namespace odograph
