// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/city/model_errors.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "sdk/tools/simulation/random.hpp"

namespace odograph {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kFoot_m = 2;  // above a building's lowest corner: its foot on a slope

std::string type_of(const Json& object) { return object.is_object() ? object.value("type", std::string()) : ""; }

/// A building's part belongs to its first parent, all else to itself.
std::string building_of(const std::string& id, const Json& object) {
  const bool part = type_of(object) == "BuildingPart" && object.contains("parents") && !object["parents"].empty();
  return part && object["parents"][0].is_string() ? object["parents"][0].get<std::string>() : id;
}

/// Calls `with` for each vertex index of a geometry's boundaries.
template <class With>
void for_each_index(Json& boundaries, const With& with) {
  if (boundaries.is_number_integer()) return with(boundaries);
  if (boundaries.is_array())
    for (Json& inner : boundaries) for_each_index(inner, with);
}
template <class With>
void for_each_index_of(Json& object, const With& with) {
  if (!object.contains("geometry")) return;
  for (Json& geometry : object["geometry"])
    if (geometry.contains("boundaries")) for_each_index(geometry["boundaries"], with);
}

/// Moves the corners of a building's roofs up by `up` (in the file's numbers) to vertices of their own: neighbours
/// share vertices.
class RoofMover {
 public:
  explicit RoofMover(Json& root)
      : vertices_(root["vertices"]),
        metre_(root.contains("transform") ? 1 / root["transform"]["scale"][2].get<double>() : 1),
        whole_(root.contains("transform")) {}

  void move(const std::vector<Json*>& parts, double up_m) {
    double lowest = 1e300;
    const auto known = [&](const Json& index) { return index.get<int64_t>() >= 0 && index.get<size_t>() < original_; };
    const auto height = [&](const Json& index) { return vertices_[index.get<size_t>()][2].get<double>(); };
    for (Json* part : parts)
      for_each_index_of(*part, [&](Json& i) { lowest = known(i) ? std::min(lowest, height(i)) : lowest; });
    std::map<size_t, size_t> moved;
    for (Json* part : parts)
      for_each_index_of(*part, [&](Json& i) {
        if (!known(i) || height(i) < lowest + kFoot_m * metre_) return;
        const auto [at, fresh] = moved.emplace(i.get<size_t>(), vertices_.size());
        if (fresh) {
          Json corner = vertices_[at->first];
          const double z = std::max(lowest + kFoot_m * metre_, height(i) + up_m * metre_);
          corner[2] = whole_ ? Json(std::llround(z)) : Json(z);
          vertices_.push_back(std::move(corner));
        }
        i = at->second;
      });
  }

 private:
  Json& vertices_;
  double metre_;
  bool whole_;
  size_t original_ = vertices_.size();
};

}  // namespace

Result<size_t> write_model_with_errors(const std::filesystem::path& model, const std::filesystem::path& output,
                                       const ModelErrors& errors) {
  std::ifstream in(model, std::ios::binary);
  if (!in) return Failure{ODO_E_NOT_FOUND, model.string() + ": no such file"};
  auto root = Json::parse(in, nullptr, false);
  if (!root.is_object() || !root.contains("CityObjects") || !root["CityObjects"].is_object() ||
      !root.contains("vertices"))
    return Failure{ODO_E_DATA, model.string() + ": not CityJSON"};
  auto& objects = root["CityObjects"];
  Random random(errors.seed, 181), roofs(errors.seed, 182);
  std::map<std::string, double> up_m;  // of the buildings that stay
  std::set<std::string> gone;
  for (const auto& [id, object] : objects.items()) {
    if (type_of(object) != "Building") continue;
    const double up = errors.roof_sigma_m * roofs.normal();
    if (random.uniform() < errors.missing)
      gone.insert(id);
    else
      up_m[id] = up;
  }
  for (const auto& [id, object] : objects.items())
    if (gone.count(building_of(id, object))) gone.insert(id);
  for (const std::string& id : gone) objects.erase(id);
  if (errors.roof_sigma_m > 0) {
    std::map<std::string, std::vector<Json*>> parts;
    for (auto& [id, object] : objects.items())
      if (const auto building = building_of(id, object); up_m.count(building)) parts[building].push_back(&object);
    RoofMover mover(root);
    for (const auto& [building, own] : parts) mover.move(own, up_m[building]);
  }
  std::ofstream out(output, std::ios::binary);
  out << root.dump();
  if (!out.flush()) return Failure{ODO_E_IO, output.string() + ": cannot be written"};
  return up_m.size();
}

}  // namespace odograph
