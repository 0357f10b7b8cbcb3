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
#include "plugins/fix/skyline/implicit_geometry.hpp"
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

namespace {

/// The documents of a text: one CityJSON, or a CityJSONSeq's first line and its features.
std::vector<Json> documents_of(const std::string& text, const std::string& name) {
  std::vector<Json> documents;
  documents.push_back(Json::parse(text, nullptr, false));
  const auto is = [](const Json& root, const char* type) {
    return root.is_object() && root.value("type", Json()) == type;
  };
  if (is(documents[0], "CityJSON")) return documents;
  std::istringstream lines(documents[0].is_discarded() ? text : "");
  documents.clear();
  std::string line;
  for (size_t number = 1; std::getline(lines, line); ++number) {
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    documents.push_back(Json::parse(line, nullptr, false));
    if (documents.size() == 1 && !is(documents[0], "CityJSON")) break;
    if (documents.size() > 1 && !is(documents.back(), "CityJSONFeature"))
      throw std::runtime_error(name + ": line " + std::to_string(number) + " is not a CityJSONFeature");
  }
  if (documents.empty() || !is(documents[0], "CityJSON"))
    throw std::runtime_error(name + ": not CityJSON: expected an object with \"type\": \"CityJSON\"");
  return documents;
}

/// Reader of CityJSON documents. The first has the transform, the reference system and the templates of all.
class CityJsonReader {
 public:
  CityJsonReader(const std::string& name, const Json& first) : name_(name) {
    if (const auto t = first.find("transform"); t != first.end()) {
      if (!t->is_object() || !is_point(t->value("scale", Json())) || !is_point(t->value("translate", Json())))
        throw std::runtime_error(name_ + ": \"transform\" wants \"scale\" and \"translate\", three numbers each");
      scale_ = point((*t)["scale"]), shift_ = point((*t)["translate"]);
    }
    const auto metadata = first.find("metadata");
    if (metadata != first.end() && metadata->is_object())
      if (const Json system = metadata->value("referenceSystem", Json()); system.is_string())
        system_ = system.get<std::string>();
    const auto all = first.find("geometry-templates");
    if (all == first.end() || !all->is_object()) return;
    templates_ = all->value("templates", Json());
    for (const Json& v : all->value("vertices-templates", Json::array()))
      template_points_.push_back(checked(v, "template vertex ", template_points_.size()));
  }

  const std::string& system() const { return system_; }

  /// A document's vertices in the model's coordinates.
  std::vector<Vector3d> vertices(const Json& document) const {
    const auto found = document.find("vertices"), objects = document.find("CityObjects");
    if (found == document.end() || !found->is_array() || objects == document.end() || !objects->is_object())
      throw std::runtime_error(name_ + ": no \"vertices\" or no \"CityObjects\" in it");
    std::vector<Vector3d> points;
    for (const Json& v : *found)
      points.push_back(far_checked(scale_.cwiseProduct(checked(v, "vertex ", points.size())) + shift_, points.size()));
    return points;
  }

  void read(const Json& document, const std::vector<Vector3d>& model_points, const ModelToNavigation& to_navigation) {
    std::vector<Vector3d> points;
    for (const Vector3d& at : model_points) points.push_back(far_checked(to_navigation(at), points.size()));
    for (const auto& [id, object] : document["CityObjects"].items()) {
      const Json type = object.is_object() ? object.value("type", Json()) : Json();
      if (!type.is_string()) throw std::runtime_error(name_ + ": " + id + ": no \"type\"");
      const auto geometry = object.find("geometry");
      if (geometry == object.end() || !geometry->is_array()) continue;
      const Json* finest = nullptr;
      for (const Json& g : *geometry)
        if (g.is_object() && g.contains("boundaries") &&
            (!finest || level_of_detail(shape(g)) > level_of_detail(shape(*finest))))
          finest = &g;
      if (!finest) continue;
      const std::string where = name_ + ": " + id + ": ";
      if (is_instance(*finest))
        place(*finest, model_points, to_navigation, where);
      else
        collect((*finest)["boundaries"], points, where, rings);
      owners.resize(rings.size(), is_ground(type.get<std::string>()) ? Edge::kGround : building_++);
    }
  }

  std::vector<std::vector<Vector3d>> rings;
  std::vector<int> owners;

 private:
  static bool is_instance(const Json& geometry) { return geometry.value("type", Json()) == "GeometryInstance"; }
  /// A geometry, or the template of an instance.
  const Json& shape(const Json& geometry) const {
    const auto index = geometry.find("template");
    return is_instance(geometry) && index != geometry.end() && index->is_number_unsigned() && templates_.is_array() &&
                   index->get<uint64_t>() < templates_.size()
               ? templates_[index->get<size_t>()]
               : geometry;
  }

  /// Places an instance of a template by its reference point and its matrix.
  void place(const Json& instance, const std::vector<Vector3d>& model_points, const ModelToNavigation& to_navigation,
             const std::string& where) {
    const Json &form = shape(instance), &boundaries = instance["boundaries"];
    const Json matrix = instance.value("transformationMatrix", Json());
    const bool right = &form != &instance && form.is_object() && form.contains("boundaries") && boundaries.is_array() &&
                       boundaries.size() == 1 && boundaries[0].is_number_unsigned() &&
                       boundaries[0].get<uint64_t>() < model_points.size() && matrix.is_array() &&
                       matrix.size() == 16 &&
                       std::all_of(matrix.begin(), matrix.end(), [](const Json& v) { return v.is_number(); });
    if (!right)
      throw std::runtime_error(where +
                               "a GeometryInstance wants a template, one vertex and a matrix of sixteen numbers");
    const Vector3d& reference_point = model_points[boundaries[0].get<size_t>()];
    ImplicitMatrix m{};
    std::transform(matrix.begin(), matrix.end(), m.begin(), [](const Json& v) { return v.get<double>(); });
    const size_t first = rings.size();
    collect(form["boundaries"], template_points_, where, rings);
    for (size_t k = first; k < rings.size(); ++k) {
      placed_ += rings[k].size();
      if (placed_ > kMaxPlacedCorners) throw std::runtime_error(where + "more than 20 million corners of templates");
      for (Vector3d& p : rings[k]) p = far_checked(to_navigation(reference_point, transformed(m, p)), k);
    }
  }

  Vector3d checked(const Json& v, const char* what, size_t index) const {
    if (!is_point(v)) throw std::runtime_error(name_ + ": " + what + std::to_string(index) + " is not three numbers");
    return point(v);
  }
  Vector3d far_checked(const Vector3d& p, size_t index) const {
    if (!(p.cwiseAbs().maxCoeff() < kFarthest_m))
      throw std::runtime_error(name_ + ": vertex " + std::to_string(index) +
                               " is farther than any reference system's zero");
    return p;
  }

  const std::string& name_;
  Vector3d scale_ = Vector3d::Ones(), shift_ = Vector3d::Zero();
  std::string system_;
  Json templates_;
  std::vector<Vector3d> template_points_;
  size_t placed_ = 0;
  int building_ = 0;
};

}  // namespace

std::vector<Edge> parse_city_outline(const std::string& text, const std::string& name, const CityPlacement& placement,
                                     Georeference* georeference) {
  if (is_xml(text)) return parse_city_gml(text, name, placement, georeference);
  const std::vector<Json> documents = documents_of(text, name);
  CityJsonReader reader(name, documents[0]);
  std::vector<std::vector<Vector3d>> points;
  std::vector<Vector3d> all;
  for (const Json& document : documents) {
    points.push_back(reader.vertices(document));
    all.insert(all.end(), points.back().begin(), points.back().end());
  }
  const ModelToNavigation to_navigation(placement, reader.system(), all, name);
  for (size_t k = 0; k < documents.size(); ++k) reader.read(documents[k], points[k], to_navigation);
  auto edges = edges_of(reader.rings, reader.owners);
  if (edges.empty()) throw std::runtime_error(name + ": no building with surfaces in it");
  if (georeference) *georeference = to_navigation.georeference();
  return edges;
}

std::vector<Edge> read_city_outline(const std::string& file, const CityPlacement& placement,
                                    Georeference* georeference) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw std::runtime_error(file + ": no such file");
  std::stringstream text;
  text << in.rdbuf();
  return parse_city_outline(text.str(), file, placement, georeference);
}

}  // namespace odograph::skyline
