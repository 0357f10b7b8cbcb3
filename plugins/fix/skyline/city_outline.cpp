// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/skyline/city_outline.hpp"

#include <cstdlib>
#include <fstream>
#include <map>
#include <optional>
#include <sstream>
#include <stdexcept>

#include <GeographicLib/LocalCartesian.hpp>
#include <nlohmann/json.hpp>

#include "plugins/shared/projection.hpp"

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

/// From a model's easting, northing and height to n.
class ModelToNavigation {
 public:
  ModelToNavigation(const CityPlacement& placement, const Json& root, const std::string& name) : p_(placement) {
    if (!p_.geodetic) return;
    const Json metadata = root.value("metadata", Json());
    const Json system = metadata.is_object() ? metadata.value("referenceSystem", Json()) : Json();
    const int epsg = system.is_string() ? epsg_of(system.get<std::string>()) : 0;
    projection_ = Projection::of(epsg);
    if (!projection_)
      throw std::runtime_error(name + ": geodetic_origin: the model's reference system (EPSG " + std::to_string(epsg) +
                               ") is not known; give model_origin in its coordinates");
    local_.Reset(p_.geodetic_origin[0], p_.geodetic_origin[1], p_.geodetic_origin[2]);
  }

  Vector3d operator()(const Vector3d& at) const {
    if (!projection_) {
      const Vector3d d = at - Vector3d(p_.model_origin.data());
      return {d.y(), d.x(), -d.z()};
    }
    const Geodetic g = projection_->geodetic({at.x(), at.y()});
    double east = 0, north = 0, up = 0;
    local_.Forward(g.latitude_deg, g.longitude_deg, at.z() + p_.geoid_height_m, east, north, up);
    return {north, east, -up};
  }

 private:
  CityPlacement p_;
  std::optional<Projection> projection_;
  GeographicLib::LocalCartesian local_;
};

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

std::vector<Edge> parse_city_outline(const std::string& text, const std::string& name, const CityPlacement& placement) {
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
  const ModelToNavigation to_navigation(placement, root, name);
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

std::vector<Edge> read_city_outline(const std::string& file, const CityPlacement& placement) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw std::runtime_error(file + ": no such file");
  std::stringstream text;
  text << in.rdbuf();
  return parse_city_outline(text.str(), file, placement);
}

}  // namespace odograph::skyline
