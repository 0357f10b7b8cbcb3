// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/simulation/city_model.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include <nlohmann/json.hpp>
#define TINYOBJLOADER_USE_DOUBLE
#include <tiny_obj_loader.h>

namespace odograph {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;
using Json = nlohmann::json;
using Kind = CityModel::Kind;
using Ring = std::vector<Vector3d>;  // in the file's axes: east, north, up

constexpr size_t kMaxFaces = 20'000'000;
constexpr double kFarthestVertex_m = 1e8;

Kind ground_kind(const std::string& type) {
  if (type == "Road" || type == "Railway" || type == "TransportSquare" || type == "Bridge") return Kind::road;
  if (type == "PlantCover" || type == "SolitaryVegetationObject") return Kind::green;
  if (type == "WaterBody") return Kind::water;
  return Kind::paved;
}

bool is_built(const std::string& type) {
  return type.starts_with("Building") || type.starts_with("Tunnel") || type == "OtherConstruction";
}

/// Collects polygons of city objects and converts them to a model.
class ModelCollector {
 public:
  ModelCollector(const std::string& name, std::optional<Vector3d> origin) : name_(name), origin_(origin) {}

  void begin(const std::string& id, bool is_building) { model_.objects.push_back({id, is_building, -1e9}); }
  /// Adds a polygon of the current object. `ground` is ignored for buildings: their slope determines the kind.
  Result<bool> add(const std::vector<Ring>& rings, Kind ground) {
    if (!spend_crossings(rings, budget_))
      return Failure{ODO_E_DATA, name_ + ": " + model_.objects.back().id +
                                     ": too many edges of surfaces cross each other; at most " +
                                     std::to_string(CrossingBudget{}.crossings) + " in a file"};
    const auto object = static_cast<uint32_t>(model_.objects.size() - 1);
    const bool building = model_.objects.back().is_building;
    for (const auto& t : triangulate(rings)) {
      Vector3d normal = (t[1] - t[0]).cross(t[2] - t[0]);
      const double twice_area = normal.norm();
      if (twice_area < 1e-8) continue;
      normal /= twice_area;
      if (building && normal.z() < -0.7) continue;  // the floor is never visible
      if (!building && normal.z() < 0) normal = -normal;
      const Kind kind = !building ? ground : std::abs(normal.z()) < 0.5 ? Kind::wall : Kind::roof;
      model_.faces.push_back({t, normal, kind, object});
    }
    return true;
  }
  bool full() const { return model_.faces.size() > kMaxFaces; }

  Result<CityModel> finish() {
    if (model_.faces.empty()) return Failure{ODO_E_DATA, name_ + ": no surface in it that could be shown"};
    Vector3d low = Vector3d::Constant(1e300), high = -low;
    for (const auto& face : model_.faces)
      for (const Vector3d& p : face.corners) low = low.cwiseMin(p), high = high.cwiseMax(p);
    if (!((high - low).maxCoeff() < 1e5))
      return Failure{ODO_E_DATA, name_ + ": wider than 100 km; are its coordinates in metres?"};
    model_.origin = origin_.value_or(low);
    const auto to_n = [](const Vector3d& p) { return Vector3d(p.y(), p.x(), -p.z()); };
    model_.low = Vector3d::Constant(1e300), model_.high = -model_.low;
    for (auto& face : model_.faces) {
      for (Vector3d& p : face.corners) {
        p = to_n(p - model_.origin);
        model_.low = model_.low.cwiseMin(p), model_.high = model_.high.cwiseMax(p);
        auto& object = model_.objects[face.object];
        object.top_up_m = std::max(object.top_up_m, -p.z());
      }
      face.normal = to_n(face.normal);
    }
    return std::move(model_);
  }

 private:
  const std::string& name_;
  std::optional<Vector3d> origin_;
  CityModel model_;
  CrossingBudget budget_;
};

/// CityJSON's vertices, and conversion of its index arrays to polygons.
class CityJson {
 public:
  CityJson(const Json& root, const std::string& name, ModelCollector& to) : root_(root), name_(name), to_(to) {}

  Result<bool> read() {
    if (!root_.is_object() || root_.value("type", Json()) != "CityJSON")
      return wrong("expected an object with \"type\": \"CityJSON\"");
    if (const auto version = root_.value("version", Json(""));
        !version.is_string() ||
        !(version.get<std::string>().starts_with("1.") || version.get<std::string>().starts_with("2.")))
      return wrong("version " + version.dump() + "; this program reads CityJSON 1.0 to 2.0");
    if (const auto done = read_vertices(); !done) return done;
    const auto objects = root_.find("CityObjects");
    if (objects == root_.end() || !objects->is_object()) return wrong("no \"CityObjects\" in it");
    for (const auto& [id, object] : objects->items()) {
      if (!object.is_object() || !object.value("type", Json()).is_string()) return wrong(id + ": no \"type\"");
      const auto geometry = object.find("geometry");
      if (geometry == object.end() || !geometry->is_array()) continue;
      type_ = object["type"].get<std::string>(), id_ = id;
      to_.begin(id, is_built(type_));
      const Json* finest = nullptr;
      for (const Json& g : *geometry)
        if (depth_of(g) > 0 && (!finest || lod_of(g) > lod_of(*finest))) finest = &g;
      if (!finest) continue;
      if (const auto done = walk((*finest)["boundaries"], depth_of(*finest)); !done) return done;
      if (to_.full()) return wrong("more than 20 million triangles");
    }
    return true;
  }

 private:
  Failure wrong(const std::string& what) const { return {ODO_E_DATA, name_ + ": " + what}; }

  Result<bool> read_vertices() {
    Vector3d scale = Vector3d::Ones(), shift = Vector3d::Zero();
    if (const auto t = root_.find("transform"); t != root_.end()) {
      const auto three = [&](const char* key, Vector3d& to) {
        const Json v = t->is_object() ? t->value(key, Json()) : Json();
        if (!is_point(v)) return false;
        for (size_t i = 0; i < 3; ++i) to[static_cast<long>(i)] = v[i].get<double>();
        return true;
      };
      if (!three("scale", scale) || !three("translate", shift))
        return wrong("\"transform\" wants \"scale\" and \"translate\", three numbers each");
    }
    const auto vertices = root_.find("vertices");
    if (vertices == root_.end() || !vertices->is_array()) return wrong("no \"vertices\" in it");
    for (const Json& v : *vertices) {
      if (!is_point(v)) return wrong("vertex " + std::to_string(points_.size()) + " is not three numbers");
      points_.push_back(scale.cwiseProduct(Vector3d(v[0].get<double>(), v[1].get<double>(), v[2].get<double>())) +
                        shift);
      if (!(points_.back().cwiseAbs().maxCoeff() < kFarthestVertex_m))
        return wrong("vertex " + std::to_string(points_.size() - 1) + " is farther than any reference system's zero");
    }
    return true;
  }

  static bool is_point(const Json& v) {
    return v.is_array() && v.size() == 3 && v[0].is_number() && v[1].is_number() && v[2].is_number();
  }

  /// Levels of arrays above a surface; 0 for geometry without surfaces.
  static int depth_of(const Json& g) {
    if (!g.is_object() || !g.contains("boundaries") || !g.value("type", Json()).is_string()) return 0;
    const auto type = g["type"].get<std::string>();
    if (type == "MultiSurface" || type == "CompositeSurface") return 1;
    if (type == "Solid") return 2;
    return type == "MultiSolid" || type == "CompositeSolid" ? 3 : 0;
  }
  static double lod_of(const Json& g) {
    const auto lod = g.find("lod");
    if (lod == g.end()) return 0;
    return lod->is_number() ? lod->get<double>() : lod->is_string() ? std::atof(lod->get<std::string>().c_str()) : 0;
  }

  Result<bool> walk(const Json& boundaries, int depth) {
    if (!boundaries.is_array()) return wrong(id_ + ": \"boundaries\" are not nested as its geometry's type wants");
    for (const Json& part : boundaries) {
      if (const auto done = depth > 1 ? walk(part, depth - 1) : polygon(part); !done) return done;
    }
    return true;
  }

  Result<bool> polygon(const Json& surface) {
    std::vector<Ring> rings;
    if (!surface.is_array()) return wrong(id_ + ": a surface is not a list of rings");
    for (const Json& indices : surface) {
      if (!indices.is_array()) return wrong(id_ + ": a ring is not a list of vertices");
      Ring& ring = rings.emplace_back();
      for (const Json& index : indices) {
        if (!index.is_number_unsigned() || index.get<uint64_t>() >= points_.size())
          return wrong(id_ + ": no vertex " + index.dump() + "; there are " + std::to_string(points_.size()));
        ring.push_back(points_[index.get<size_t>()]);
      }
    }
    return to_.add(rings, ground_kind(type_));
  }

  const Json& root_;
  const std::string& name_;
  ModelCollector& to_;
  std::vector<Vector3d> points_;
  std::string type_, id_;
};

Result<CityModel> read_obj(const fs::path& file, std::optional<Vector3d> origin) {
  const std::string name = file.string();
  tinyobj::ObjReader reader;
  tinyobj::ObjReaderConfig config;
  config.triangulate = false;  // triangulate() supports holes and bent walls
  if (!reader.ParseFromFile(name, config)) {
    std::string why = reader.Error();
    while (!why.empty() && why.back() == '\n') why.pop_back();
    return Failure{ODO_E_DATA, name + ": " + (why.empty() ? "not an OBJ file" : why)};
  }
  ModelCollector to(name, origin);
  const auto& xyz = reader.GetAttrib().vertices;
  for (const auto& shape : reader.GetShapes()) {
    std::string lower = shape.name;
    for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    to.begin(shape.name, !lower.starts_with("terrain") && !lower.starts_with("ground"));
    size_t next = 0;
    for (const auto count : shape.mesh.num_face_vertices) {
      Ring ring;
      for (size_t k = 0; k < count; ++k, ++next) {
        const auto i = static_cast<size_t>(3 * static_cast<int64_t>(shape.mesh.indices[next].vertex_index));
        if (i + 2 >= xyz.size()) return Failure{ODO_E_DATA, name + ": " + shape.name + ": no such vertex"};
        ring.emplace_back(xyz[i], xyz[i + 1], xyz[i + 2]);
        if (!(ring.back().cwiseAbs().maxCoeff() < kFarthestVertex_m) || ring.back().hasNaN())
          return Failure{ODO_E_DATA, name + ": vertex " + std::to_string(i / 3 + 1) +
                                         " is no three numbers, or farther than any reference system's zero"};
      }
      if (const auto added = to.add({ring}, Kind::paved); !added) return added.failure();
    }
    if (to.full()) return Failure{ODO_E_DATA, name + ": more than 20 million triangles"};
  }
  return to.finish();
}

}  // namespace

bool is_xml(std::string_view text) {
  const auto first = text.substr(0, 64).find_first_not_of("\xEF\xBB\xBF \t\r\n");
  return first != std::string_view::npos && text[first] == '<';
}

Result<CityModel> parse_city_json(std::string_view text, const std::string& name, std::optional<Vector3d> origin) {
  if (is_xml(text))
    return Failure{ODO_E_DATA, name +
                                   ": CityGML; this command reads CityJSON and OBJ alone: convert it, for example with "
                                   "`citygml-tools to-cityjson`"};
  const Json root = Json::parse(text, nullptr, false);
  if (root.is_discarded()) return Failure{ODO_E_DATA, name + ": not JSON; `odograph city check` reports where"};
  ModelCollector to(name, origin);
  const auto done = CityJson(root, name, to).read();
  if (!done) return done.failure();
  return to.finish();
}

Result<CityModel> read_city_model(const fs::path& file, std::optional<Vector3d> origin) {
  std::ifstream in(file, std::ios::binary);
  if (!in) return Failure{ODO_E_NOT_FOUND, file.string() + ": no such file"};
  if (std::error_code error; !fs::is_regular_file(file, error))
    return Failure{ODO_E_DATA, file.string() + ": a folder or a device, not a file"};
  if (file.extension() == ".obj") return read_obj(file, origin);
  std::stringstream text;
  text << in.rdbuf();
  return parse_city_json(text.str(), file.string(), origin);
}

Result<bool> write_city_json(const fs::path& file, const std::vector<Building>& buildings,
                             const std::vector<KnownObject>& objects) {
  using List = nlohmann::ordered_json;
  List vertices = List::array(), all = List::object();
  const auto vertex = [&](const Vector3d& p) {  // millimetres
    vertices.push_back(List::array({std::llround(p.y() * 1e3), std::llround(p.x() * 1e3), std::llround(-p.z() * 1e3)}));
    return vertices.size() - 1;
  };
  const auto surface = [](const auto& corners) { return List::array({List(corners)}); };
  const auto object = [&](const std::string& id, const char* type, List attributes, const char* geometry,
                          List boundaries) {
    const List shape = {{"type", geometry}, {"lod", "1"}, {"boundaries", std::move(boundaries)}};
    all[id] = {{"type", type}, {"attributes", std::move(attributes)}, {"geometry", List::array({shape})}};
  };
  size_t number = 0;
  for (const Building& b : buildings) {
    ++number;
    if (!b.surveyed) continue;
    auto foot = b.foot;  // counter-clockwise from above, as CityJSON requires
    if ((foot[1] - foot[0]).cross(foot[2] - foot[1]).z() > 0) std::reverse(foot.begin(), foot.end());
    std::array<size_t, 4> low{}, high{};
    for (size_t i = 0; i < 4; ++i) low[i] = vertex(foot[i]), high[i] = vertex(foot[i] - Vector3d(0, 0, b.height_m));
    List shell = List::array({surface(std::array{low[3], low[2], low[1], low[0]}), surface(high)});
    for (size_t i = 0; i < 4; ++i) {
      const size_t j = (i + 1) % 4;
      shell.push_back(surface(std::array{low[i], low[j], high[j], high[i]}));
    }
    object("building-" + std::to_string(number), "Building", {{"measuredHeight", b.height_m}}, "Solid",
           List::array({shell}));
  }
  for (const KnownObject& o : objects) {
    if (!o.poster.empty()) continue;
    std::array<size_t, 4> corners{};
    for (size_t i = 0; i < 4; ++i) corners[i] = vertex(o.corners[i]);
    object("tag-" + std::to_string(o.tag), "CityFurniture", {{"tag36h11", o.tag}}, "MultiSurface",
           List::array({surface(corners)}));
  }
  const List root = {
      {"type", "CityJSON"},
      {"version", "2.0"},
      {"transform", {{"scale", List::array({0.001, 0.001, 0.001})}, {"translate", List::array({0, 0, 0})}}},
      {"CityObjects", all},
      {"vertices", vertices}};
  std::ofstream out(file);
  out << root.dump() << '\n';
  if (!out.flush()) return Failure{ODO_E_IO, file.string() + ": cannot be written"};
  return true;
}

}  // namespace odograph
