// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/city/city_check.hpp"

#include <array>
#include <cmath>
#include <fstream>
#include <iterator>
#include <optional>
#include <sstream>

#include <nlohmann/json.hpp>

namespace odograph {
namespace {

using SortedJson = nlohmann::json;

/// Levels of arrays from a geometry's boundaries to its rings or points; nothing for unknown types.
std::optional<int> depth_of(const std::string& type) {
  if (type == "MultiPoint") return 0;
  if (type == "MultiLineString") return 1;
  if (type == "MultiSurface" || type == "CompositeSurface") return 2;
  if (type == "Solid") return 3;
  if (type == "MultiSolid" || type == "CompositeSolid") return 4;
  return {};
}

std::string where_of(const std::string& text, size_t byte) {
  size_t line = 1, column = 1;
  for (size_t i = 0; i < std::min(byte, text.size()); ++i) text[i] == '\n' ? (++line, column = 1) : ++column;
  return std::to_string(line) + ":" + std::to_string(column);
}

/// Checks the documents of one file.
class Checker {
 public:
  Checker(const std::string& name, const CityCheckLimits& limits) : name_(name), limits_(limits) {}

  Result<bool> document(const SortedJson& root) {
    if (!root.is_object()) return wrong("expected an object with \"type\": \"CityJSON\"");
    const auto type = root.find("type");
    if (type == root.end()) return wrong("no \"type\"; expected CityJSON or CityJSONFeature");
    const bool feature = *type == "CityJSONFeature";
    if (!feature && *type != "CityJSON")
      return wrong("\"type\" is " + type->dump() + "; expected CityJSON or CityJSONFeature");
    if (!feature) {
      const auto version = root.find("version");
      if (version == root.end() || !version->is_string())
        return wrong("no \"version\"; this program reads CityJSON 1.0 to 2.0");
      check_.version = version->get<std::string>();
      if (!check_.version.starts_with("1.") && !check_.version.starts_with("2."))
        return wrong("version " + version->dump() + "; this program reads CityJSON 1.0 to 2.0");
      if (const auto done = transform(root); !done) return done;
      reference_system(root);
    } else if (root.contains("transform")) {
      if (const auto done = transform(root); !done) return done;
    }
    if (check_.format.empty()) check_.format = feature ? "CityJSONFeature" : "CityJSON";
    if (const auto done = vertices(root); !done) return done;
    const auto objects = root.find("CityObjects");
    if (objects == root.end() || !objects->is_object()) return wrong("no \"CityObjects\" in it");
    if (feature) {
      const auto id = root.find("id");
      if (id == root.end() || !id->is_string()) return wrong("a CityJSONFeature has no \"id\"");
      if (!objects->contains(id->get<std::string>()))
        return wrong("the CityJSONFeature " + id->dump() + " has no city object of that id");
    }
    for (const auto& [id, object] : objects->items())
      if (const auto done = city_object(id, object); !done) return done;
    extent(root);
    return true;
  }

  CityCheck take() { return std::move(check_); }
  void set_format(const std::string& format) { check_.format = format; }
  Failure wrong(const std::string& what) const { return {ODO_E_DATA, name_ + ": " + what}; }

 private:
  static bool is_point(const SortedJson& v) {
    return v.is_array() && v.size() == 3 && v[0].is_number() && v[1].is_number() && v[2].is_number();
  }
  static std::array<double, 3> point(const SortedJson& v) {
    return {v[0].get<double>(), v[1].get<double>(), v[2].get<double>()};
  }

  Result<bool> transform(const SortedJson& root) {
    scale_ = {1, 1, 1}, shift_ = {0, 0, 0};
    const auto t = root.find("transform");
    if (t == root.end()) return true;
    if (!t->is_object() || !is_point(t->value("scale", SortedJson())) || !is_point(t->value("translate", SortedJson())))
      return wrong("\"transform\" requires \"scale\" and \"translate\", three numbers each");
    scale_ = point((*t)["scale"]), shift_ = point((*t)["translate"]);
    for (size_t i = 0; i < 3; ++i) {
      if (!(std::abs(scale_[i]) > 0 && std::abs(scale_[i]) < 1e6))
        return wrong("\"scale\" is " + (*t)["scale"].dump() + "; expected numbers between 0 and a million");
      if (!(std::abs(shift_[i]) <= limits_.farthest_m))
        return wrong("\"translate\" is " + (*t)["translate"].dump() + ": farther than any reference system's zero");
    }
    return true;
  }

  void reference_system(const SortedJson& root) {
    const auto metadata = root.find("metadata");
    if (metadata == root.end() || !metadata->is_object()) return;
    const SortedJson crs = metadata->value("referenceSystem", SortedJson());
    if (crs.is_string()) check_.reference_system = crs.get<std::string>();
  }

  Result<bool> vertices(const SortedJson& root) {
    const auto list = root.find("vertices");
    if (list == root.end() || !list->is_array()) return wrong("no \"vertices\" in it");
    points_.clear(), low_.fill(1e300), high_.fill(-1e300);
    size_t k = 0;
    for (const SortedJson& v : *list) {
      const std::string at = "vertex " + std::to_string(k++);
      if (!is_point(v)) return wrong(at + " is not three numbers");
      const auto p = point(v);
      Eigen::Vector3d& to = points_.emplace_back();
      for (size_t i = 0; i < 3; ++i) {
        const double x = scale_[i] * p[i] + shift_[i];
        to[static_cast<Eigen::Index>(i)] = x;
        if (!(std::abs(x) <= limits_.farthest_m))
          return wrong(at + " is " + v.dump() + ": farther than any reference system's zero");
        low_[i] = std::min(low_[i], x), high_[i] = std::max(high_[i], x);
      }
    }
    check_.vertices += points_.size();
    return true;
  }

  Result<bool> city_object(const std::string& id, const SortedJson& object) {
    id_ = id;
    if (!object.is_object() || !object.value("type", SortedJson()).is_string()) return wrong(id + ": no \"type\"");
    ++check_.objects;
    const auto list = object.find("geometry");
    if (list == object.end()) return true;
    if (!list->is_array()) return wrong(id + ": \"geometry\" is not a list");
    for (const SortedJson& g : *list) {
      if (!g.is_object() || !g.value("type", SortedJson()).is_string())
        return wrong(id + ": a geometry without \"type\"");
      const auto type = g["type"].get<std::string>();
      const auto depth = depth_of(type);
      if (!depth && type != "GeometryInstance") {
        ++check_.skipped[type];
        check_.warnings.push_back(id + ": geometry of the type \"" + type + "\" is not CityJSON's");
        continue;
      }
      if (!g.contains("boundaries")) return wrong(id + ": a geometry without \"boundaries\"");
      if (depth.value_or(0) < 2) ++check_.skipped[type];
      if (const auto done = walk(g["boundaries"], depth.value_or(0), depth.value_or(0) >= 2); !done) return done;
    }
    return true;
  }

  /// `depth` levels of lists above the indices of vertices.
  Result<bool> walk(const SortedJson& part, int depth, bool surfaces) {
    if (!part.is_array()) return wrong(id_ + ": \"boundaries\" are not nested as the geometry's type requires");
    if (depth == 0) {
      for (const SortedJson& index : part)
        if (!index.is_number_unsigned() || index.get<uint64_t>() >= points_.size())
          return wrong(id_ + ": no vertex " + index.dump() + "; there are " + std::to_string(points_.size()));
      return true;
    }
    for (const SortedJson& inner : part)
      if (const auto done = walk(inner, depth - 1, surfaces); !done) return done;
    if (depth == 1 && surfaces) {
      ++check_.surfaces;
      if (part.size() > 1) check_.holes += part.size() - 1;
      std::vector<std::vector<Eigen::Vector3d>> rings;
      for (const SortedJson& ring : part) {
        auto& to = rings.emplace_back();
        for (const SortedJson& index : ring) to.push_back(points_[index.get<size_t>()]);
      }
      if (!spend_crossings(rings, crossings_))
        return wrong(id_ + ": too many edges of surfaces cross each other; at most " +
                     std::to_string(limits_.crossings.crossings) + " in a file");
    }
    return true;
  }

  void extent(const SortedJson& root) {
    const auto metadata = root.find("metadata");
    if (metadata == root.end() || !metadata->is_object() || points_.empty()) return;
    const SortedJson box = metadata->value("geographicalExtent", SortedJson());
    if (!box.is_array() || box.size() != 6) return;
    for (size_t i = 0; i < 3; ++i) {
      if (!box[i].is_number() || !box[i + 3].is_number()) return;
      const double slack = std::max(0.01, 2 * std::abs(scale_[i]));
      if (low_[i] >= box[i].get<double>() - slack && high_[i] <= box[i + 3].get<double>() + slack) continue;
      check_.warnings.push_back("vertices lie outside \"geographicalExtent\"");
      return;
    }
  }

  const std::string& name_;
  const CityCheckLimits& limits_;
  CityCheck check_;
  std::array<double, 3> scale_{1, 1, 1}, shift_{0, 0, 0}, low_{}, high_{};
  std::vector<Eigen::Vector3d> points_;
  CrossingBudget crossings_ = limits_.crossings;
  std::string id_;
};

Result<CityCheck> check_obj(const std::string& text, const std::string& name, const CityCheckLimits& limits) {
  CityCheck check{.format = "OBJ"};
  std::istringstream lines(text);
  std::string line;
  size_t number = 0;
  const auto wrong = [&](const std::string& what) {
    return Failure{ODO_E_DATA, name + ":" + std::to_string(number) + ": " + what};
  };
  while (std::getline(lines, line)) {
    ++number;
    std::istringstream words(line);
    std::string key;
    if (!(words >> key)) continue;
    if (key == "v") {
      double x = 0;
      for (int i = 0; i < 3; ++i)
        if (!(words >> x) || !(std::abs(x) <= limits.farthest_m))
          return wrong("a vertex requires three numbers of at most 1e8 m");
      ++check.vertices;
    } else if (key == "o" || key == "g") {
      ++check.objects;
    } else if (key == "f") {
      ++check.surfaces;
      std::string corner;
      while (words >> corner) {
        char* end = nullptr;
        const long long index = std::strtoll(corner.c_str(), &end, 10);
        const auto known = static_cast<long long>(check.vertices);
        if (end == corner.c_str() || index == 0 || index > known || index < -known)
          return wrong("no vertex " + corner + "; there are " + std::to_string(known));
      }
    }
  }
  if (check.vertices == 0) return wrong("no vertices; is it an OBJ file?");
  return check;
}

}  // namespace

Result<CityCheck> check_city_text(const std::string& text, const std::string& name, const CityCheckLimits& limits) {
  Checker checker(name, limits);
  const auto parse = [](std::string_view part, SortedJson& to, size_t& byte) {
    try {
      to = SortedJson::parse(part);
      return true;
    } catch (const SortedJson::parse_error& error) {
      byte = error.byte;
    } catch (const SortedJson::exception&) {
      byte = 0;  // a number beyond the range of double
    }
    return false;
  };
  SortedJson root;
  size_t byte = 0;
  if (parse(text, root, byte)) {
    if (const auto done = checker.document(root); !done) return done.failure();
    return checker.take();
  }
  // CityJSONSeq: one document per line.
  std::istringstream lines(text);
  std::string line;
  size_t number = 0, documents = 0;
  while (std::getline(lines, line)) {
    ++number;
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    size_t in_line = 0;
    if (!parse(line, root, in_line)) {
      if (documents == 0)
        return checker.wrong(byte ? "not JSON at " + where_of(text, byte - 1)
                                  : std::string("a number in it is beyond all measure"));
      return checker.wrong("line " + std::to_string(number) + " is not JSON at column " + std::to_string(in_line));
    }
    const bool feature = root.is_object() && root.value("type", SortedJson()) == "CityJSONFeature";
    if (documents == 0 && feature) return checker.wrong("the first line of a CityJSONSeq must be of the type CityJSON");
    if (documents > 0 && !feature) return checker.wrong("line " + std::to_string(number) + " is not a CityJSONFeature");
    checker.set_format("CityJSONSeq");
    if (const auto done = checker.document(root); !done) return done.failure();
    ++documents;
  }
  if (documents == 0) return checker.wrong("it is empty");
  return checker.take();
}

Result<CityCheck> check_city_model(const std::filesystem::path& file, const CityCheckLimits& limits) {
  std::error_code error;
  const auto status = std::filesystem::status(file, error);
  if (!std::filesystem::exists(status)) return Failure{ODO_E_NOT_FOUND, file.string() + ": no such file"};
  if (!std::filesystem::is_regular_file(status))
    return Failure{ODO_E_DATA, file.string() + ": a folder or a device, not a file"};
  const uintmax_t size = std::filesystem::file_size(file, error);
  if (error || size > limits.file_bytes)
    return Failure{ODO_E_DATA, file.string() + ": " + std::to_string(size >> 20) + " MB; at most " +
                                   std::to_string(limits.file_bytes >> 20) + " MB are read: cut the model into tiles"};
  std::ifstream in(file, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  if (file.extension() == ".obj") return check_obj(text, file.string(), limits);
  if (is_xml(text)) return CityCheck{.format = "CityGML"};
  return check_city_text(text, file.string(), limits);
}

}  // namespace odograph
