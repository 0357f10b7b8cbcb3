// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/skyline/city_gml.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>

#include <expat.h>

#include "plugins/fix/skyline/implicit_geometry.hpp"
#include "plugins/fix/skyline/model_to_navigation.hpp"
#include "sdk/math/number_text.hpp"

namespace odograph::skyline {
namespace {

using Eigen::Vector3d;
using Corners = std::vector<Vector3d>;

/// A ring of a surface, or an implicit geometry that is defined elsewhere in the document.
struct Ring {
  Corners corners;
  size_t system = 0;                          ///< its reference system
  std::optional<Vector3d> reference_point{};  ///< of an implicit geometry; its corners are offsets
  ImplicitMatrix matrix{};                    ///< only with `shape`
  std::string shape{};                        ///< identifier of the geometry that is placed here
};
using Rings = std::vector<Ring>;

constexpr double kFarthestPoint_m = 1e8;
constexpr size_t kMaxSystems = 16;  // a survey's file names one or two
constexpr size_t kMaxDepth = 256;   // nesting of elements; CityGML has about twenty

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
constexpr std::array kShapes = {"relativeGMLGeometry", "relativeGeometry"};

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
  size_t flat_rings() const { return flat_rings_; }
  /// Names of the reference systems; the first holds where an element and those around it name none.
  const std::vector<std::string>& systems() const { return systems_; }
  /// All rings in the file's coordinates, and their owners.
  Rings rings;
  std::vector<int> owners;

  /// Replaces implicit geometries that are defined elsewhere by their rings.
  void place_shapes() {
    size_t corners = 0;
    for (size_t k = 0, given = rings.size(); k < given; ++k) {
      if (rings[k].shape.empty()) continue;
      const Ring instance = std::exchange(rings[k], {});
      const auto shape = shapes_.find(instance.shape);
      if (shape == shapes_.end())
        throw std::runtime_error(name_ + ": no implicit geometry has the identifier '" + instance.shape + "'");
      for (const Corners& local : shape->second) {
        if ((corners += local.size()) > kMaxPlacedCorners)
          throw std::runtime_error(name_ + ": more than 20 million corners of implicit geometries");
        rings.push_back({local, instance.system, instance.reference_point});
        for (Vector3d& p : rings.back().corners) p = transformed(instance.matrix, p);
        owners.push_back(owners[k]);
      }
    }
  }

 private:
  struct Object {
    size_t depth;
    bool ground;
    std::map<int, Rings> by_level;
  };
  struct Implicit {
    size_t depth;
    ImplicitMatrix matrix = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    std::optional<Vector3d> reference_point{};
    std::vector<Corners> shape{};
    std::vector<std::string> identifiers{};  ///< of the shape
    std::string elsewhere{};                 ///< identifier of a shape that is defined elsewhere
  };
  template <class T>
  using Scopes = std::vector<std::pair<size_t, T>>;  ///< values with the depth of the element that they hold in
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
    for (; attributes[0]; attributes += 2) {
      const std::string_view key = local_name(attributes[0]);
      if (key == "srsName") systems_in_.push_back({depth_, system_index(attributes[1])});
      if (key == "srsDimension") dimensions_.push_back({depth_, std::atoi(attributes[1])});
      if (key == "id" && implicit_) implicit_->identifiers.push_back(attributes[1]);
      if (key == "href" && implicit_ && attributes[1][0] == '#' && is_one_of(kShapes, element))
        implicit_->elsewhere = attributes[1] + 1;
    }
    const bool built = is_one_of(kBuilt, element);
    if (built || is_one_of(kGround, element)) objects_.push_back({depth_, !built, {}});
    if (element.size() > 4 && element.starts_with("lod") && std::isdigit(static_cast<unsigned char>(element[3])))
      levels_.push_back({depth_, element[3] - '0'});
    if (element == "ImplicitGeometry" && !implicit_) implicit_.emplace(Implicit{.depth = depth_});
    if (element == "referencePoint") in_reference_point_ = implicit_.has_value();
    reads_numbers_ = element == "posList" || element == "pos" || element == "coordinates" ||
                     (implicit_ && element == "transformationMatrix");
    if (reads_numbers_) text_.clear();
    if (element == "LinearRing") ring_.clear(), in_ring_ = true, is_flat_ = false;
  }

  void end(std::string_view element) {
    if (reads_numbers_) take_numbers(element);
    reads_numbers_ = false;
    if (element == "LinearRing") end_ring();
    if (element == "referencePoint") in_reference_point_ = false;
    if (implicit_ && implicit_->depth == depth_) end_implicit();
    const auto leave = [&](auto& scopes) {
      while (!scopes.empty() && scopes.back().first == depth_) scopes.pop_back();
    };
    leave(levels_), leave(systems_in_), leave(dimensions_);
    if (!objects_.empty() && objects_.back().depth == depth_) end_object();
    --depth_;
  }

  size_t system_index(const char* name) {
    const auto known = std::find(systems_.begin(), systems_.end(), name);
    if (known != systems_.end()) return static_cast<size_t>(known - systems_.begin());
    if (systems_.size() == kMaxSystems) {
      stop("more than 16 reference systems");
      return 0;
    }
    systems_.push_back(name);
    return systems_.size() - 1;
  }
  size_t system() const { return systems_in_.empty() ? 0 : systems_in_.back().second; }

  /// Numbers of a ring, or of an implicit geometry's place; those of other elements, as of addresses, are passed over.
  void take_numbers(std::string_view element) {
    if (element == "transformationMatrix") {
      std::vector<double> numbers;
      if (!parse_numbers(numbers)) return;
      if (numbers.size() != implicit_->matrix.size()) return stop("a transformation matrix without sixteen numbers");
      std::copy(numbers.begin(), numbers.end(), implicit_->matrix.begin());
    } else if (in_ring_ || in_reference_point_) {
      if (element == "coordinates") std::replace(text_.begin(), text_.end(), ',', ' ');
      if (in_ring_ && !dimensions_.empty() && dimensions_.back().second == 2) {
        is_flat_ = true;
        return;
      }
      std::vector<double> numbers;
      if (!parse_numbers(numbers)) return;
      if (numbers.size() % 3 != 0) return stop("a ring's coordinates are not three numbers each");
      if (in_ring_)
        for (size_t k = 0; k < numbers.size(); k += 3) ring_.emplace_back(numbers[k], numbers[k + 1], numbers[k + 2]);
      else if (numbers.size() == 3)
        implicit_->reference_point = Vector3d(numbers.data());
    }
  }

  bool parse_numbers(std::vector<double>& numbers) {
    constexpr std::string_view kBlank = " \t\r\n";
    const std::string_view text = text_;
    for (size_t from = text.find_first_not_of(kBlank); from != std::string_view::npos;) {
      const size_t to = std::min(text.find_first_of(kBlank, from), text.size());
      const auto value = parse_number(text.substr(from, to - from));
      if (!value) return stop("a ring's coordinates are no numbers"), false;
      if (!(std::abs(*value) < kFarthestPoint_m))
        return stop("a coordinate is farther than any reference system's zero"), false;
      numbers.push_back(*value);
      from = text.find_first_not_of(kBlank, to);
    }
    return true;
  }

  void end_ring() {
    in_ring_ = false;
    flat_rings_ += is_flat_;
    if (ring_.size() > 1 && ring_.front() == ring_.back()) ring_.pop_back();
    if (ring_.size() < 3) return;
    if (implicit_)
      implicit_->shape.push_back(std::move(ring_));
    else
      add({std::move(ring_), system()});
    ring_.clear();
  }

  void add(Ring ring) {
    if (!objects_.empty())
      objects_.back().by_level[levels_.empty() ? 0 : levels_.back().second].push_back(std::move(ring));
  }

  void end_implicit() {
    Implicit implicit = std::move(*implicit_);
    implicit_.reset();
    for (const std::string& identifier : implicit.identifiers) shapes_[identifier] = implicit.shape;
    if (implicit.shape.empty() && implicit.elsewhere.empty()) return;  // a file outside the document
    if (!implicit.reference_point) return stop("an implicit geometry without a reference point");
    if (!implicit.elsewhere.empty()) add({{}, system(), implicit.reference_point, implicit.matrix, implicit.elsewhere});
    for (Corners& corners : implicit.shape) {
      for (Vector3d& p : corners) p = transformed(implicit.matrix, p);
      add({std::move(corners), system(), implicit.reference_point});
    }
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
  std::string wrong_, text_;
  size_t depth_ = 0, flat_rings_ = 0;
  int building_ = 0;
  bool is_city_ = false, reads_numbers_ = false, in_ring_ = false, is_flat_ = false, in_reference_point_ = false;
  std::vector<Object> objects_;
  std::vector<std::string> systems_;
  Scopes<int> levels_, dimensions_;
  Scopes<size_t> systems_in_;
  std::optional<Implicit> implicit_;
  std::map<std::string, std::vector<Corners>> shapes_;
  Corners ring_;
};

}  // namespace

bool is_xml(std::string_view text) {
  const auto first = text.substr(0, 64).find_first_not_of("\xEF\xBB\xBF \t\r\n");
  return first != std::string_view::npos && text[first] == '<';
}

std::vector<Edge> parse_city_gml(const std::string& text, const std::string& name, const CityPlacement& placement,
                                 Georeference* georeference) {
  Reader reader(name);
  reader.read(text);
  if (!reader.is_city()) throw std::runtime_error(name + ": not CityGML: its root is no CityModel");
  reader.place_shapes();
  std::vector<Corners> points(std::max<size_t>(1, reader.systems().size()));
  for (const Ring& ring : reader.rings)
    for (const Vector3d& p : ring.corners) points[ring.system].push_back(ring.reference_point.value_or(p));
  std::vector<Corners> rings;
  for (Ring& ring : reader.rings) rings.push_back(std::move(ring.corners));
  for (size_t system = 0; system < points.size(); ++system) {
    if (system > 0 && points[system].empty()) continue;
    const ModelToNavigation to_navigation(placement, reader.systems().empty() ? "" : reader.systems()[system],
                                          points[system], name);
    for (size_t k = 0; k < rings.size(); ++k) {
      if (reader.rings[k].system != system) continue;
      const auto& reference_point = reader.rings[k].reference_point;
      for (Vector3d& p : rings[k]) {
        p = reference_point ? to_navigation(*reference_point, p) : to_navigation(p);
        if (!(p.cwiseAbs().maxCoeff() < kFarthestPoint_m))
          throw std::runtime_error(name + ": a corner is farther than any reference system's zero");
      }
    }
    const Georeference found = to_navigation.georeference();
    if (georeference && (georeference->description.empty() || found.accuracy_m > georeference->accuracy_m))
      *georeference = found;
  }
  auto edges = edges_of(rings, reader.owners);
  if (edges.empty())
    throw std::runtime_error(name + (reader.flat_rings() > 0 ? ": its surfaces have two dimensions alone"
                                                             : ": no building with surfaces in it"));
  return edges;
}

}  // namespace odograph::skyline
