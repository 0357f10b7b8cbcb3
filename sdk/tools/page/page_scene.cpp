// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/page/page_scene.hpp"

#include <cmath>

namespace odograph {
namespace {

using Json = nlohmann::ordered_json;

void append(Json& coordinates, const double* p_n) {
  for (int k = 0; k < 3; ++k) coordinates.push_back(std::round(1e3 * p_n[k]) / 1e3);  // mm
}

}  // namespace

Json page_scene(const RunResult& result) {
  Json points = Json::array(), surfaces = Json::array();
  for (const odo_map_point& point : result.points) append(points, point.p_n);
  for (const RunResult::Patch& patch : result.patches) {
    Json outline = Json::array();
    for (const Eigen::Vector3d& p : patch.outline_n) append(outline, p.data());
    surfaces.push_back({{"kind", patch.kind}, {"sigma_m", patch.sigma_m}, {"outline", outline}});
  }
  return {{"points", points}, {"surfaces", surfaces}};
}

}  // namespace odograph
