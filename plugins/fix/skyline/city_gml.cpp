// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/skyline/city_gml.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <map>
#include <memory>
#include <stdexcept>

#include <expat.h>

#include "plugins/fix/skyline/model_to_navigation.hpp"
#include "sdk/math/number_text.hpp"

namespace odograph::skyline {
namespace {

using Eigen::Vector3d;
using Rings = std::vector<std::vector<Vector3d>>;

constexpr double kFarthestPoint_m = 1e8;
constexpr size_t kMaxDepth = 256;  // nesting of elements; CityGML has about twenty

constexpr std::array kBuilt = {"Building",
                               "BuildingPart",
                               "Bridge",
                               "BridgePart",
                               "Tunnel",
                               "OtherConstruction",
                               "BuildingUnit",
                               "BuildingInstallation",
                               "BridgeInstallation"};
constexpr std::array kGround = {"TINRelief",    "Road",    "Railway",   "Square",     "Track",        "Waterway",
                                "TrafficSpace", "LandUse", "WaterBody", "PlantCover", "ReliefFeature"};

template <class Names>
bool is_one_of(const Names& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::string_view local_name(const char* name) {
  const std::string_view whole = name;
  const auto colon = whole.rfind(':');
  return colon == std::string_view::npos ? whole : whole.substr(colon + 1);
}

/// Event-driven reader of a document. Exceptions must not pass through expat, which is C, so errors are stored.
class Reader {
 public:
  explicit Reader(const std::string& source) : name_(source), parser_(XML_ParserCreate(nullptr)) {
    XML_SetUserData(parser_.get(), this);
    XML_SetElementHandler(
        parser_.get(),
        [](void* self, const char* name, const char** attributes) {
          static_cast<Reader*>(self)->guarded([&](Reader& r) { r.begin(name, attributes); });
        },
        [](void* self, const char* name) {
          static_cast<Reader*>(self)->guarded([&](Reader& r) { r.end(local_name(name)); });
        });
    XML_SetCharacterDataHandler(parser_.get(), [](void* self, const char* text, int size) {
      static_cast<Reader*>(self)->guarded([&](Reader& r) {
        if (r.reads_numbers_) r.text_.append(text, static_cast<size_t>(size));
      });
    });
  }

  void read(const std::string& text) {
    constexpr size_t kPiece = 1u << 24;
    for (size_t from = 0; from < text.size() || from == 0; from += kPiece) {
      const size_t size = std::min(kPiece, text.size() - from);
      const bool last = from + size >= text.size();
      const auto status = XML_Parse(parser_.get(), text.data() + from, static_cast<int>(size), last);
      if (!wrong_.empty()) fail(wrong_);
      if (status != XML_STATUS_OK) fail(std::string("not XML: ") + XML_ErrorString(XML_GetErrorCode(parser_.get())));
      if (last) break;
    }
  }

  bool is_city() const { return is_city_; }
  const std::string& reference_system() const { return system_; }
  /// All rings in the file's coordinates, and their owners.
  Rings rings;
  std::vector<int> owners;

 private:
  struct Object {
    size_t depth;
    bool ground;
    std::map<int, Rings> by_level;
  };
  struct Free {
    void operator()(XML_Parser parser) const { XML_ParserFree(parser); }
  };

  [[noreturn]] void fail(const std::string& what) const {
    throw std::runtime_error(name_ + ":" + std::to_string(XML_GetCurrentLineNumber(parser_.get())) + ": " + what);
  }
  void stop(const std::string& what) {
    if (wrong_.empty()) wrong_ = what;
    XML_StopParser(parser_.get(), XML_FALSE);
  }
  template <class Work>
  void guarded(Work&& work) noexcept {
    if (!wrong_.empty()) return;
    try {
      work(*this);
    } catch (const std::exception& error) {
      stop(error.what());
    }
  }

  void begin(const char* whole_name, const char** attributes) {
    const std::string_view element = local_name(whole_name);
    if (depth_ == 0) is_city_ = element == "CityModel";
    if (++depth_ > kMaxDepth) return stop("elements lie more than 256 deep in each other");
    int dimension = 0;
    for (; attributes[0]; attributes += 2) {
      const std::string_view key = local_name(attributes[0]);
      if (key == "srsName" && system_.empty()) system_ = attributes[1];
      if (key == "srsDimension") dimension = std::atoi(attributes[1]);
    }
    const bool built = is_one_of(kBuilt, element);
    if (built || is_one_of(kGround, element)) objects_.push_back({depth_, !built, {}});
    if (element.size() > 4 && element.starts_with("lod") && std::isdigit(static_cast<unsigned char>(element[3])))
      levels_.push_back({depth_, element[3] - '0'});
    reads_numbers_ = element == "posList" || element == "pos" || element == "coordinates";
    if (reads_numbers_) text_.clear();
    if (dimension != 0) dimension_ = dimension;
    if (element == "LinearRing") ring_.clear(), in_ring_ = true;
  }

  void end(std::string_view element) {
    if (reads_numbers_ && in_ring_) take_numbers(element == "coordinates");
    reads_numbers_ = false;
    if (element == "LinearRing") end_ring();
    if (!levels_.empty() && levels_.back().first == depth_) levels_.pop_back();
    if (!objects_.empty() && objects_.back().depth == depth_) end_object();
    --depth_;
  }

  void take_numbers(bool commas) {
    if (commas) std::replace(text_.begin(), text_.end(), ',', ' ');
    if (dimension_ == 2) return stop("a ring in two dimensions; a city's surfaces have three");
    std::array<double, 3> at{};
    size_t k = 0;
    constexpr std::string_view kBlank = " \t\r\n";
    const std::string_view text = text_;
    for (size_t from = text.find_first_not_of(kBlank); from != std::string_view::npos;) {
      const size_t to = std::min(text.find_first_of(kBlank, from), text.size());
      const auto value = parse_number(text.substr(from, to - from));
      if (!value) return stop("a ring's coordinates are no numbers");
      if (!(std::abs(*value) < kFarthestPoint_m))
        return stop("a coordinate is farther than any reference system's zero");
      at[k++] = *value;
      if (k == 3) ring_.emplace_back(at[0], at[1], at[2]), k = 0;
      from = text.find_first_not_of(kBlank, to);
    }
    if (k != 0) stop("a ring's coordinates are not three numbers each");
  }

  void end_ring() {
    in_ring_ = false;
    if (ring_.size() > 1 && ring_.front() == ring_.back()) ring_.pop_back();
    if (ring_.size() < 3 || objects_.empty()) return;
    objects_.back().by_level[levels_.empty() ? 0 : levels_.back().second].push_back(std::move(ring_));
    ring_.clear();
  }

  /// A part is a separate object. Installations on a building belong to it and have their own number too.
  void end_object() {
    Object object = std::move(objects_.back());
    objects_.pop_back();
    if (object.by_level.empty()) return;
    for (auto& ring : object.by_level.rbegin()->second) {
      rings.push_back(std::move(ring));
      owners.push_back(object.ground ? Edge::kGround : building_);
    }
    building_ += !object.ground;
  }

  const std::string& name_;
  std::unique_ptr<std::remove_pointer_t<XML_Parser>, Free> parser_;
  std::string wrong_, system_, text_;
  size_t depth_ = 0;
  int dimension_ = 3, building_ = 0;
  bool is_city_ = false, reads_numbers_ = false, in_ring_ = false;
  std::vector<Object> objects_;
  std::vector<std::pair<size_t, int>> levels_;
  std::vector<Vector3d> ring_;
};

}  // namespace

bool is_xml(std::string_view text) {
  const auto first = text.substr(0, 64).find_first_not_of("\xEF\xBB\xBF \t\r\n");
  return first != std::string_view::npos && text[first] == '<';
}

std::vector<Edge> parse_city_gml(const std::string& text, const std::string& name, const CityPlacement& placement) {
  Reader reader(name);
  reader.read(text);
  if (!reader.is_city()) throw std::runtime_error(name + ": not CityGML: its root is no CityModel");
  const int epsg = epsg_of(reader.reference_system());
  const ModelToNavigation to_navigation(placement, epsg, name);
  const bool latitude_first = is_geographic(epsg);
  for (auto& ring : reader.rings)
    for (Vector3d& p : ring) {
      if (latitude_first) std::swap(p.x(), p.y());
      p = to_navigation(p);
      if (!(p.cwiseAbs().maxCoeff() < kFarthestPoint_m))
        throw std::runtime_error(name + ": a corner is farther than any reference system's zero");
    }
  auto edges = edges_of(reader.rings, reader.owners);
  if (edges.empty()) throw std::runtime_error(name + ": no building with surfaces in it");
  return edges;
}

}  // namespace odograph::skyline
