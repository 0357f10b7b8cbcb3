// SPDX-License-Identifier: Apache-2.0
//
// Survey of a scenario's objects.
#include <fstream>

#include <opencv2/imgcodecs.hpp>

#include "sdk/host/base/geodesy.hpp"
#include "sdk/math/scalar.hpp"
#include "sdk/tools/simulation/simulate.hpp"
#include "sdk/tools/simulation/world.hpp"
#include "sdk/tools/text/text.hpp"

namespace odograph {
namespace {

constexpr double kSurvey_m = 0.01;  // stated standard deviation of each corner; the corners are exact

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
  const std::filesystem::path file = folder / "objects.yaml";
  std::ofstream out(file);
  out << yaml;
  if (!out.flush()) return Failure{ODO_E_IO, file.string() + ": cannot be written"};
  return true;
}

}  // namespace odograph
