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

Json page_places(const RunResult& result, int64_t t0_ns) {
  Json key_frames = Json::array(), loops = Json::array(), map_poses = Json::array();
  const auto used = [](const odo_header& header) { return (header.flags & ODO_FLAG_ACCEPTED) != 0; };
  const auto time = [&](int64_t t_ns) { return std::round(1e-6 * static_cast<double>(t_ns - t0_ns)) / 1e3; };
  for (const odo_key_frame& frame : result.key_frames) key_frames.push_back(time(frame.header.t_ns));
  for (const odo_relative_pose& loop : result.loops)
    loops.push_back({time(loop.t_from_ns), time(loop.header.t_ns), used(loop.header)});
  for (const odo_map_pose& place : result.map_poses) map_poses.push_back({time(place.header.t_ns), used(place.header)});
  return {{"key_frames", key_frames}, {"loops", loops}, {"map_poses", map_poses}};
}

}  // namespace odograph
