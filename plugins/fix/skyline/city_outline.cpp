// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/skyline/city_outline.hpp"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <numeric>
#include <sstream>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "plugins/fix/skyline/city_gml.hpp"
#include "plugins/fix/skyline/model_to_navigation.hpp"

namespace odograph::skyline {
namespace {

using Eigen::Vector3d;
using Json = nlohmann::json;

constexpr double kFarthest_m = 1e8;

bool is_point(const Json& v) {
  return v.is_array() && v.size() == 3 && v[0].is_number() && v[1].is_number() && v[2].is_number();
}
Vector3d point(const Json& v) { return {v[0].get<double>(), v[1].get<double>(), v[2].get<double>()}; }

bool is_ground(const std::string& type) {
  return type == "TINRelief" || type == "Road" || type == "Railway" || type == "TransportSquare" || type == "LandUse" ||
         type == "WaterBody" || type == "PlantCover" || type == "Waterway";
}

double level_of_detail(const Json& geometry) {
  const auto lod = geometry.find("lod");
  if (lod == geometry.end()) return 0;
  return lod->is_string() ? std::atof(lod->get<std::string>().c_str()) : lod->is_number() ? lod->get<double>() : 0;
}

/// Rings of vertices at any depth of the geometry's nesting.
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

std::vector<Edge> edges_of(const std::vector<std::vector<Vector3d>>& rings, const std::vector<int>& objects) {
  std::vector<Edge> edges;
  for (size_t k = 0; k < rings.size(); ++k)
    for (size_t i = 0; i < rings[k].size(); ++i) {
      Vector3d a = rings[k][i], b = rings[k][(i + 1) % rings[k].size()];
      if (std::lexicographical_compare(b.data(), b.data() + 3, a.data(), a.data() + 3)) std::swap(a, b);
      edges.push_back({a, b, k < objects.size() ? objects[k] : Edge::kUnknown});
    }
  // Walls share edges: keep each once, at its first occurrence.
  const auto ends = [](const Edge& e) {
    return std::array<double, 6>{e.from.x(), e.from.y(), e.from.z(), e.to.x(), e.to.y(), e.to.z()};
  };
  std::vector<uint32_t> order(edges.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
    const auto x = ends(edges[a]), y = ends(edges[b]);
    return x != y ? x < y : a < b;
  });
  std::vector<char> twice(edges.size(), 0);
  for (size_t i = 1, first = 0; i < order.size(); ++i) {
    Edge& met = edges[order[first]];
    const Edge& again = edges[order[i]];
    twice[order[i]] = ends(again) == ends(met);
    if (!twice[order[i]])
      first = i;
    else if (again.object != met.object && met.also == Edge::kUnknown)
      met.also = again.object;
  }
  size_t kept = 0;
  for (size_t i = 0; i < edges.size(); ++i)
    if (!twice[i]) edges[kept++] = edges[i];
  edges.resize(kept);
  edges.shrink_to_fit();
  return edges;
}

std::vector<Edge> parse_city_outline(const std::string& text, const std::string& name, const CityPlacement& placement) {
  if (is_xml(text)) return parse_city_gml(text, name, placement);
  const Json root = Json::parse(text, nullptr, false);
  if (!root.is_object() || root.value("type", Json()) != "CityJSON")
    throw std::runtime_error(name + ": not CityJSON: expected an object with \"type\": \"CityJSON\"");
  Vector3d scale = Vector3d::Ones(), shift = Vector3d::Zero();
  if (const auto t = root.find("transform"); t != root.end()) {
    if (!t->is_object() || !is_point(t->value("scale", Json())) || !is_point(t->value("translate", Json())))
      throw std::runtime_error(name + ": \"transform\" wants \"scale\" and \"translate\", three numbers each");
    scale = point((*t)["scale"]), shift = point((*t)["translate"]);
  }
  const auto found_vertices = root.find("vertices"), found_objects = root.find("CityObjects");
  if (found_vertices == root.end() || !found_vertices->is_array() || found_objects == root.end() ||
      !found_objects->is_object())
    throw std::runtime_error(name + ": no \"vertices\" or no \"CityObjects\" in it");
  const Json &vertices = *found_vertices, &objects = *found_objects;
  const auto metadata = root.find("metadata");
  const Json system =
      metadata != root.end() && metadata->is_object() ? metadata->value("referenceSystem", Json()) : Json();
  const ModelToNavigation to_navigation(placement, system.is_string() ? epsg_of(system.get<std::string>()) : 0, name);
  std::vector<Vector3d> points;
  for (const Json& v : vertices) {
    if (!is_point(v))
      throw std::runtime_error(name + ": vertex " + std::to_string(points.size()) + " is not three numbers");
    const Vector3d at = scale.cwiseProduct(point(v)) + shift;
    const bool near = at.cwiseAbs().maxCoeff() < kFarthest_m;
    const Vector3d p = near ? to_navigation(at) : at;
    if (!(p.cwiseAbs().maxCoeff() < kFarthest_m))
      throw std::runtime_error(name + ": vertex " + std::to_string(points.size()) +
                               " is farther than any reference system's zero");
    points.push_back(p);
  }
  std::vector<std::vector<Vector3d>> rings;
  std::vector<int> owners;
  int building = 0;
  for (const auto& [id, object] : objects.items()) {
    const Json type = object.is_object() ? object.value("type", Json()) : Json();
    if (!type.is_string()) throw std::runtime_error(name + ": " + id + ": no \"type\"");
    const auto geometry = object.find("geometry");
    if (geometry == object.end() || !geometry->is_array()) continue;
    const Json* finest = nullptr;
    for (const Json& g : *geometry)
      if (g.is_object() && g.contains("boundaries") && (!finest || level_of_detail(g) > level_of_detail(*finest)))
        finest = &g;
    if (!finest) continue;
    collect((*finest)["boundaries"], points, name + ": " + id + ": ", rings);
    owners.resize(rings.size(), is_ground(type.get<std::string>()) ? Edge::kGround : building++);
  }
  auto edges = edges_of(rings, owners);
  if (edges.empty()) throw std::runtime_error(name + ": no building with surfaces in it");
  return edges;
}

std::vector<Edge> read_city_outline(const std::string& file, const CityPlacement& placement) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw std::runtime_error(file + ": no such file");
  std::stringstream text;
  text << in.rdbuf();
  return parse_city_outline(text.str(), file, placement);
}

}  // namespace odograph::skyline
