// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/known_object/read_objects.hpp"

#include <cmath>
#include <fstream>
#include <numbers>
#include <set>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "plugins/fix/known_object/text_tree.hpp"

namespace odograph::known_object {
namespace {

using Eigen::Vector3d;
using nlohmann::json;
using Corners = std::array<Vector3d, 4>;

constexpr size_t kMaxBytes = 1 << 20, kMaxObjects = 1000;
constexpr double kDegree = std::numbers::pi / 180;

[[noreturn]] void fail(const std::string& what) { throw std::runtime_error(what); }

double number(const json& map, const char* key, double fallback) {
  const auto found = map.find(key);
  if (found == map.end()) return fallback;
  if (!found->is_number() || !std::isfinite(found->get<double>())) fail(std::string(key) + ": expected a number");
  return found->get<double>();
}

std::string text(const json& map, const char* key, const std::string& fallback) {
  const auto found = map.find(key);
  if (found == map.end()) return fallback;
  if (found->is_number_integer()) return std::to_string(found->get<int64_t>());
  if (found->is_number()) return std::to_string(std::llround(found->get<double>()));
  if (!found->is_string()) fail(std::string(key) + ": expected a text");
  return found->get<std::string>();
}

Vector3d triple(const json& list, const char* what) {
  if (!list.is_array() || list.size() != 3) fail(std::string(what) + ": expected three numbers");
  Vector3d v;
  for (size_t k = 0; k < 3; ++k) {
    if (!list[k].is_number() || !std::isfinite(list[k].get<double>()))
      fail(std::string(what) + ": expected three numbers");
    v[static_cast<Eigen::Index>(k)] = list[k].get<double>();
  }
  return v;
}

/// Latitude and longitude in degrees, height in m of four corners.
void place_on_earth(const Corners& corners, PlaneObject& object) {
  Place& place = object.place;
  place.geodetic = true;
  Vector3d middle = 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
  if (std::abs(middle.x()) > 89.9 || std::abs(middle.y()) > 360) fail("latitude or longitude out of range (degrees)");
  place.latitude_rad = middle.x() * kDegree, place.longitude_rad = middle.y() * kDegree, place.height_m = middle.z();
  const RadianLengths metres(place.latitude_rad);
  Corners local;
  for (size_t k = 0; k < 4; ++k)
    local[k] = {(corners[k].x() - middle.x()) * kDegree * metres.north_m,
                (corners[k].y() - middle.y()) * kDegree * metres.east_m, middle.z() - corners[k].z()};
  place_by_corners(local, object);
}

/// An upright board: its centre, size, and the direction it faces (degrees, from north to east: a board on the outside
/// of a north wall faces 0).
void place_upright(const json& properties, const Vector3d& latitude_longitude_height, PlaneObject& object) {
  if (!properties.contains("facing_deg") || !properties.contains("width") || !properties.contains("height"))
    fail("a point needs facing_deg, width and height");
  Place& place = object.place;
  place.geodetic = true;
  place.latitude_rad = latitude_longitude_height.x() * kDegree;
  place.longitude_rad = latitude_longitude_height.y() * kDegree;
  place.height_m = latitude_longitude_height.z();
  const double facing = number(properties, "facing_deg", 0) * kDegree;
  const Vector3d right(std::sin(facing), -std::cos(facing), 0), down(0, 0, 1);
  const Vector3d x = 0.5 * number(properties, "width", 0) * right, y = 0.5 * number(properties, "height", 0) * down;
  place_by_corners({y - x, y + x, x - y, -x - y}, object);
}

/// The properties common to both formats.
PlaneObject named(const json& map, const std::filesystem::path& folder) {
  PlaneObject object;
  object.id = text(map, "id", "");
  if (object.id.empty()) fail("id: expected a name");
  object.sigma_m = number(map, "sigma", 0.01);
  if (object.sigma_m < 1e-4 || object.sigma_m > 10) fail("sigma: expected 0.0001 to 10 m");
  const bool picture = map.contains("picture"), tag = map.contains("tag");
  if (picture == tag) fail("expected either picture or tag");
  if (picture) {
    object.picture = read_png(folder / text(map, "picture", ""));
  } else {
    object.tag = static_cast<int>(number(map, "tag", -1));
    object.family = text(map, "family", "36h11");
    object.picture = tag_picture(object.family, object.tag);
  }
  return object;
}

PlaneObject of_feature(const json& feature, const std::filesystem::path& folder) {
  const auto properties = feature.find("properties"), geometry = feature.find("geometry");
  if (properties == feature.end() || !properties->is_object()) fail("expected properties");
  if (geometry == feature.end() || !geometry->is_object()) fail("expected a geometry");
  PlaneObject object = named(*properties, folder);
  const std::string type = text(*geometry, "type", "");
  const json& coordinates = geometry->contains("coordinates") ? (*geometry)["coordinates"] : json();
  const auto turned = [](const Vector3d& p) { return Vector3d(p.y(), p.x(), p.z()); };  // longitude comes first
  if (type == "Point") {
    place_upright(*properties, turned(triple(coordinates, "coordinates")), object);
  } else if (type == "Polygon") {
    const bool ring = coordinates.is_array() && coordinates.size() == 1 && coordinates[0].is_array() &&
                      coordinates[0].size() == 5 && coordinates[0][0] == coordinates[0][4];
    if (!ring) fail("coordinates: expected one ring of four corners with the first repeated at the end");
    Corners corners;
    for (size_t k = 0; k < 4; ++k) corners[k] = turned(triple(coordinates[0][k], "coordinates"));
    place_on_earth(corners, object);
  } else {
    fail("geometry: expected a Polygon or a Point");
  }
  return object;
}

PlaneObject of_map(const json& map, const std::filesystem::path& folder) {
  PlaneObject object = named(map, folder);
  const bool local = map.contains("corners_n");
  if (local == map.contains("corners")) fail("expected either corners or corners_n");
  const json& list = map[local ? "corners_n" : "corners"];
  if (!list.is_array() || list.size() != 4) fail("corners: expected four");
  Corners corners;
  for (size_t k = 0; k < 4; ++k) corners[k] = triple(list[k], "corners");
  if (local)
    place_by_corners(corners, object);
  else
    place_on_earth(corners, object);
  return object;
}

}  // namespace

std::vector<PlaneObject> read_objects(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::string content(kMaxBytes + 1, '\0');
  stream.read(content.data(), static_cast<std::streamsize>(content.size()));
  content.resize(static_cast<size_t>(stream.gcount()));
  if (content.empty()) fail(file.string() + ": empty or unreadable");
  if (content.size() > kMaxBytes) fail(file.string() + ": larger than 1 MiB");
  const bool geojson = file.extension() == ".json" || file.extension() == ".geojson";
  std::string where = file.string() + ": ";
  try {
    const json root = geojson ? json::parse(content) : parse_yaml(content);
    if (!root.is_object()) fail("expected a map");
    if (!geojson && number(root, "odograph_objects", 0) != 1) fail("expected 'odograph_objects: 1'");
    if (geojson && text(root, "type", "") != "FeatureCollection") fail("expected a FeatureCollection");
    const auto list = root.find(geojson ? "features" : "objects");
    if (list == root.end() || !list->is_array() || list->empty() || list->size() > kMaxObjects)
      fail("expected 1 to 1000 objects");
    std::vector<PlaneObject> objects;
    std::set<std::string> names;
    for (size_t k = 0; k < list->size(); ++k) {
      where = file.string() + ": object " + std::to_string(k + 1) + ": ";
      const json& entry = (*list)[k];
      if (!entry.is_object()) fail("expected a map");
      objects.push_back(geojson ? of_feature(entry, file.parent_path()) : of_map(entry, file.parent_path()));
      if (!names.insert(objects.back().id).second) fail("the id '" + objects.back().id + "' occurs twice");
    }
    return objects;
  } catch (const std::exception& error) {
    throw std::runtime_error(where + error.what());
  }
}

}  // namespace odograph::known_object
