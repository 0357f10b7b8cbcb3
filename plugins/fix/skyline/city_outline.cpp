// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/skyline/city_outline.hpp"

#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>

#include <nlohmann/json.hpp>

namespace odograph::skyline {
namespace {

using Eigen::Vector3d;
using Json = nlohmann::json;

constexpr double kFarthest_m = 1e8;

bool is_point(const Json& v) {
  return v.is_array() && v.size() == 3 && v[0].is_number() && v[1].is_number() && v[2].is_number();
}
Vector3d point(const Json& v) { return {v[0].get<double>(), v[1].get<double>(), v[2].get<double>()}; }

double level_of_detail(const Json& geometry) {
  const auto lod = geometry.find("lod");
  if (lod == geometry.end()) return 0;
  return lod->is_string() ? std::atof(lod->get<std::string>().c_str()) : lod->is_number() ? lod->get<double>() : 0;
}

/// Rings of vertices, however deeply the geometry's type nests them.
void collect(const Json& part, const std::vector<Vector3d>& points, const std::string& where,
             std::vector<std::vector<Vector3d>>& rings) {
  if (!part.is_array()) throw std::runtime_error(where + "\"boundaries\" is not a list");
  if (part.empty()) return;
  if (part[0].is_array()) {
    for (const Json& inner : part) collect(inner, points, where, rings);
    return;
  }
  auto& ring = rings.emplace_back();
  for (const Json& index : part) {
    if (!index.is_number_unsigned() || index.get<uint64_t>() >= points.size())
      throw std::runtime_error(where + "no vertex " + index.dump() + "; there are " + std::to_string(points.size()));
    ring.push_back(points[index.get<size_t>()]);
  }
}

}  // namespace

std::vector<Edge> edges_of(const std::vector<std::vector<Vector3d>>& rings) {
  std::map<std::array<double, 6>, bool> seen;  // walls share their edges: each once
  std::vector<Edge> edges;
  for (const auto& ring : rings)
    for (size_t i = 0; i < ring.size(); ++i) {
      Vector3d a = ring[i], b = ring[(i + 1) % ring.size()];
      if (std::lexicographical_compare(b.data(), b.data() + 3, a.data(), a.data() + 3)) std::swap(a, b);
      if (seen.try_emplace({a.x(), a.y(), a.z(), b.x(), b.y(), b.z()}, true).second) edges.push_back({a, b});
    }
  return edges;
}

std::vector<Edge> parse_city_outline(const std::string& text, const std::string& name,
                                     const std::array<double, 3>& origin) {
  const Json root = Json::parse(text, nullptr, false);
  if (!root.is_object() || root.value("type", Json()) != "CityJSON")
    throw std::runtime_error(name + ": not CityJSON: expected an object with \"type\": \"CityJSON\"");
  Vector3d scale = Vector3d::Ones(), shift = Vector3d::Zero();
  if (const auto t = root.find("transform"); t != root.end()) {
    if (!t->is_object() || !is_point(t->value("scale", Json())) || !is_point(t->value("translate", Json())))
      throw std::runtime_error(name + ": \"transform\" wants \"scale\" and \"translate\", three numbers each");
    scale = point((*t)["scale"]), shift = point((*t)["translate"]);
  }
  const Json vertices = root.value("vertices", Json()), objects = root.value("CityObjects", Json());
  if (!vertices.is_array() || !objects.is_object())
    throw std::runtime_error(name + ": no \"vertices\" or no \"CityObjects\" in it");
  std::vector<Vector3d> points;
  for (const Json& v : vertices) {
    if (!is_point(v))
      throw std::runtime_error(name + ": vertex " + std::to_string(points.size()) + " is not three numbers");
    const Vector3d p = scale.cwiseProduct(point(v)) + shift - Vector3d(origin.data());
    if (!(p.cwiseAbs().maxCoeff() < kFarthest_m))
      throw std::runtime_error(name + ": vertex " + std::to_string(points.size()) +
                               " is farther than any reference system's zero");
    points.emplace_back(p.y(), p.x(), -p.z());
  }
  std::vector<std::vector<Vector3d>> rings;
  for (const auto& [id, object] : objects.items()) {
    const Json type = object.is_object() ? object.value("type", Json()) : Json();
    if (!type.is_string()) throw std::runtime_error(name + ": " + id + ": no \"type\"");
    const auto geometry = object.find("geometry");
    if (geometry == object.end() || !geometry->is_array()) continue;
    const Json* finest = nullptr;
    for (const Json& g : *geometry)
      if (g.is_object() && g.contains("boundaries") && (!finest || level_of_detail(g) > level_of_detail(*finest)))
        finest = &g;
    if (finest) collect((*finest)["boundaries"], points, name + ": " + id + ": ", rings);
  }
  auto edges = edges_of(rings);
  if (edges.empty()) throw std::runtime_error(name + ": no building with surfaces in it");
  return edges;
}

std::vector<Edge> read_city_outline(const std::string& file, const std::array<double, 3>& origin) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw std::runtime_error(file + ": no such file");
  std::stringstream text;
  text << in.rdbuf();
  return parse_city_outline(text.str(), file, origin);
}

}  // namespace odograph::skyline
