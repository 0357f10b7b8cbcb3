// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/city/city_scenario.hpp"

#include <fstream>
#include <sstream>

#include "sdk/tools/city/street_route.hpp"
#include "sdk/tools/text/text.hpp"

namespace odograph {
namespace {

/// The benchmark's cameras: a fisheye or a phone's wide camera that faces up, or one that faces ahead.
const char* camera_of(const std::string& lens) {
  if (lens == "wide") return "{model: kannala_brandt, focal: 200 px, exposure: 3 ms}";
  if (lens == "narrow") return "{focal: 400 px, exposure: 3 ms}";
  return "{focal: 520 px, exposure: 3 ms, pitch: 0.2}";
}

}  // namespace

Result<Eigen::Vector3d> write_city_scenario(const CityScenario& a) {
  const auto city = read_city_model(a.model);
  if (!city) return city.failure();
  StreetRouteParameters p;
  p.length_m = a.length_m;
  const auto points = draw_street_route(*city, a.seed, p);
  if (!points) return points.failure();
  const Eigen::Vector3d start = points->front();
  const Eigen::Vector3d origin =
      city->origin + Eigen::Vector3d(start.y(), start.x(), ground_up_m(*city, start.head<2>()));
  std::ostringstream text;
  text.precision(10);
  text << "odograph_scenario: 1\ncarrier: " << a.carrier
       << "\nvehicle: {speed: 30 km/h}\nworld:\n  type: city\n  model: " << std::filesystem::absolute(a.model).string()
       << "\n  model_origin: [" << origin.x() << " m, " << origin.y() << " m, " << origin.z()
       << " m]\nwalker: {stand: 3 s}\nroute:\n  corner: 5 m\n  points:\n";
  for (const auto& p_n : *points) text << "    - [" << p_n.x() - start.x() << ", " << p_n.y() - start.y() << ", 0]\n";
  text << "camera: " << camera_of(a.lens) << '\n';
  std::ofstream out(a.output);
  out << text.str();
  if (!out.flush()) return Failure{ODO_E_IO, a.output + ": cannot be written"};
  return origin;
}

std::vector<Override> skyline_overrides(const std::filesystem::path& model, const Eigen::Vector3d& origin,
                                        const std::string& skylines) {
  const std::string of = "absolute_fixers.fix/skyline.parameters.";
  const std::string at = text("[%.4f m, %.4f m, %.4f m]", origin.x(), origin.y(), origin.z());
  std::vector<Override> all = {{of + "model", model.filename().string()}, {of + "model_origin", at}};
  if (!skylines.empty()) all.push_back({of + "skylines", std::filesystem::absolute(skylines).string()});
  return all;
}

}  // namespace odograph
