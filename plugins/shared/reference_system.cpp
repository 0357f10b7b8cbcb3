// SPDX-License-Identifier: Apache-2.0
#include "plugins/shared/reference_system.hpp"

#include <proj.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <stdexcept>
#include <string_view>
#include <utility>

namespace odograph {
namespace {

constexpr int kWgs84 = 4326;
constexpr double kMargin_deg = 5;  // surveys use a zone beyond its borders, for instance 25832 in the whole of Bavaria

struct Destroy {
  void operator()(PJ* p) const { proj_destroy(p); }
  void operator()(PJ_CONTEXT* c) const { proj_context_destroy(c); }
};
using Object = std::unique_ptr<PJ, Destroy>;

/// The number at the end of a text; 0 where there is none, or one too long for a code.
int code_at_end(std::string_view text) {
  while (!text.empty() && text.back() == '/') text.remove_suffix(1);
  const auto before = text.find_last_not_of("0123456789");
  const std::string_view digits = before == std::string_view::npos ? text : text.substr(before + 1);
  return digits.size() > 6 ? 0 : std::atoi(std::string(digits).c_str());
}

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

struct Axis {
  std::string direction, unit;
  double unit_si = 1;
};

Axis axis_of(PJ_CONTEXT* context, const PJ* system, int index) {
  const Object axes(proj_crs_get_coordinate_system(context, system));
  const char *direction = nullptr, *unit = nullptr;
  Axis axis;
  if (axes && proj_cs_get_axis_info(context, axes.get(), index, nullptr, nullptr, &direction, &axis.unit_si, &unit,
                                    nullptr, nullptr))
    axis.direction = direction, axis.unit = unit ? unit : "";
  return axis;
}

/// The steps of a transformation that change the datum: `MGI to WGS 84 (3)`.
std::string datum_steps(const PJ* operation) {
  const char* whole = proj_pj_info(const_cast<PJ*>(operation)).description;
  std::string steps;
  constexpr std::string_view kAnd = " + ";
  for (std::string_view rest = whole ? whole : ""; !rest.empty();) {
    const auto end = rest.find(kAnd);
    const std::string_view step = rest.substr(0, end);
    if (step.find(" to ") != std::string_view::npos && !step.starts_with("Null "))
      steps += (steps.empty() ? "" : ", ") + std::string(step);
    rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + kAnd.size());
  }
  return steps;
}

std::string text_of(const char* format, double a, double b = 0) {
  char text[80];
  std::snprintf(text, sizeof text, format, a, b);
  return text;
}

}  // namespace

SystemName parse_system_name(const std::string& name) {
  SystemName system;
  const std::string low = lower(name);
  if (low.find("crs84") != std::string::npos) return {.epsg = kWgs84};
  for (const auto& [survey, zone0] : {std::pair{"etrs89_utm", 25800}, {"dhdn_3gk", 31464}})
    if (const auto at = low.find(survey); at != std::string::npos)
      return {.epsg = zone0 + std::atoi(low.substr(at + std::string_view(survey).size(), 2).c_str())};
  system.authority_order = low.starts_with("urn:") || low.find("/def/crs") != std::string::npos;
  for (size_t at = low.find("epsg"); at != std::string::npos;) {
    const size_t end = std::min(low.find_first_of(",&+ ", at), low.size());
    (system.epsg ? system.vertical_epsg : system.epsg) = code_at_end(std::string_view(low).substr(at, end - at));
    at = low.find("epsg", end);
    if (low.substr(end, 1) == "+" && at == std::string::npos) system.vertical_epsg = code_at_end(low.substr(end));
  }
  return system;
}

struct ReferenceSystem::Parts {
  std::unique_ptr<PJ_CONTEXT, Destroy> context{proj_context_create()};
  Object horizontal, operation;  // both with easting or longitude first
  int epsg = 0;
  bool geographic = false, northing_first = false, exchanged = false, moves = false;
  double west_deg = -180, south_deg = -90, east_deg = 180, north_deg = 90;  // area of use
  std::string name, unit, height_unit, datum_steps;
  double unit_m = 0, height_unit_m = 1, accuracy_m = 0;
  mutable std::mutex mutex;  // PROJ's objects belong to one thread at a time

  Object create(int code) const {
    Object made(
        proj_create_from_database(context.get(), "EPSG", std::to_string(code).c_str(), PJ_CATEGORY_CRS, 0, nullptr));
    if (made) return made;
    if (!proj_context_get_database_path(context.get()))
      throw std::runtime_error(
          "PROJ does not find its database proj.db (Debian's package proj-data; PROJ_DATA names another folder)");
    throw std::runtime_error("its reference system (EPSG " + std::to_string(code) + ") is unknown to PROJ " +
                             proj_info().release);
  }

  void take_heights(const PJ* system, int axis) {
    const Axis up = axis_of(context.get(), system, axis);
    height_unit_m = up.direction == "down" ? -up.unit_si : up.unit_si;
    height_unit = up.unit;
  }

  PJ_COORD transform(PJ* by, PJ_DIRECTION direction, double x, double y) const {
    const std::lock_guard lock(mutex);
    return proj_trans(by, direction, proj_coord(x, y, 0, HUGE_VAL));
  }

  /// Whether the transformation gives a place another latitude or longitude than its own datum does.
  bool changes_datum(const ModelPoint& place) const {
    constexpr double kSame_deg = 1e-8;  // a millimetre
    const Object own(proj_crs_get_geodetic_crs(context.get(), horizontal.get()));
    Object within(proj_create_crs_to_crs_from_pj(context.get(), horizontal.get(), own.get(), nullptr, nullptr));
    if (within) within.reset(proj_normalize_for_visualization(context.get(), within.get()));
    if (!within) return true;
    const auto [x, y] = northing_first ? std::pair{place.second, place.first} : std::pair{place.first, place.second};
    const PJ_COORD here = transform(within.get(), PJ_FWD, x, y), there = transform(operation.get(), PJ_FWD, x, y);
    return !(std::abs(here.xy.x - there.xy.x) < kSame_deg && std::abs(here.xy.y - there.xy.y) < kSame_deg);
  }

  /// Distance from the area of use, degrees; 0 inside it.
  double outside_deg(const PJ_COORD& place) const {
    const double longitude = place.xy.x, latitude = place.xy.y;
    if (!(std::abs(latitude) <= 90 && std::abs(longitude) <= 360)) return HUGE_VAL;
    const double width = east_deg - west_deg + (east_deg < west_deg ? 360 : 0);
    const double from_middle = std::abs(std::remainder(longitude - (west_deg + 0.5 * width), 360));
    return std::max({0.0, south_deg - latitude, latitude - north_deg, from_middle - 0.5 * width});
  }
};

ReferenceSystem::ReferenceSystem(const SystemName& name) : parts_(std::make_unique<Parts>()) {
  Parts& p = *parts_;
  if (name.epsg == 0) throw std::runtime_error("the model states no reference system with an EPSG code");
  PJ_CONTEXT* context = p.context.get();
  proj_context_set_enable_network(context, 0);
  proj_log_level(context, PJ_LOG_NONE);
  p.epsg = name.epsg;
  Object system = p.create(name.epsg);
  p.name = "EPSG:" + std::to_string(name.epsg) + " (" + proj_get_name(system.get()) + ")";
  Object vertical;
  if (proj_get_type(system.get()) == PJ_TYPE_COMPOUND_CRS) {
    vertical.reset(proj_crs_get_sub_crs(context, system.get(), 1));
    system.reset(proj_crs_get_sub_crs(context, system.get(), 0));
  }
  const PJ_TYPE type = proj_get_type(system.get());
  p.geographic = type == PJ_TYPE_GEOGRAPHIC_2D_CRS || type == PJ_TYPE_GEOGRAPHIC_3D_CRS;
  if (!p.geographic && type != PJ_TYPE_PROJECTED_CRS)
    throw std::runtime_error("its reference system " + p.name + " is neither projected nor geographic");
  const Axis first = axis_of(context, system.get(), 0);
  p.northing_first = name.authority_order && first.direction == "north";
  p.unit_m = p.geographic ? 0 : first.unit_si, p.unit = first.unit;
  if (!p.geographic) p.height_unit_m = p.unit_m, p.height_unit = p.unit;
  if (axis_of(context, system.get(), 2).direction == "up") p.take_heights(system.get(), 2);
  if (name.vertical_epsg != 0) {
    vertical = p.create(name.vertical_epsg);
    if (proj_get_type(vertical.get()) != PJ_TYPE_VERTICAL_CRS)
      throw std::runtime_error("the reference system of its heights (EPSG " + std::to_string(name.vertical_epsg) +
                               ") is no vertical one");
  }
  if (vertical) p.take_heights(vertical.get(), 0);
  const char* area = nullptr;
  double west = 0, south = 0, east = 0, north = 0;
  if (proj_get_area_of_use(context, system.get(), &west, &south, &east, &north, &area) && west > -1000)
    p.west_deg = west, p.south_deg = south, p.east_deg = east, p.north_deg = north;
  p.horizontal = std::move(system);
}

ReferenceSystem::~ReferenceSystem() = default;
ReferenceSystem::ReferenceSystem(ReferenceSystem&&) noexcept = default;
ReferenceSystem& ReferenceSystem::operator=(ReferenceSystem&&) noexcept = default;

double ReferenceSystem::unit_m() const { return parts_->unit_m; }
double ReferenceSystem::height_unit_m() const { return parts_->height_unit_m; }
const std::string& ReferenceSystem::unit() const { return parts_->unit_m == 1 ? parts_->height_unit : parts_->unit; }
double ReferenceSystem::accuracy_m() const { return parts_->moves ? parts_->accuracy_m : 0; }
bool ReferenceSystem::northing_first() const { return parts_->northing_first; }

ReferenceSystem::Order ReferenceSystem::choose_around(const ModelPoint& place) {
  Parts& p = *parts_;
  PJ_CONTEXT* context = p.context.get();
  const Object wgs84 = p.create(kWgs84);
  static const char* const options[] = {"ALLOW_BALLPARK=NO", nullptr};  // which may be off by hundreds of metres
  Object all(proj_create_crs_to_crs_from_pj(context, p.horizontal.get(), wgs84.get(), nullptr, options));
  if (all) all.reset(proj_normalize_for_visualization(context, all.get()));
  if (!all) throw std::runtime_error("EPSG has no transformation from its reference system " + p.name + " to WGS 84");
  const auto outside_deg = [&](bool northing_first) {
    const auto [x, y] = northing_first ? std::pair{place.second, place.first} : std::pair{place.first, place.second};
    return p.outside_deg(p.transform(all.get(), PJ_FWD, x, y));
  };
  const double other = outside_deg(!p.northing_first), named = outside_deg(p.northing_first);
  if (std::min(named, other) > kMargin_deg)
    throw std::runtime_error("its coordinates (" + text_of("%.10g, %.10g", place.first, place.second) +
                             ") lie outside the area of its reference system " + p.name + " (latitudes " +
                             text_of("%.4g to %.4g", p.south_deg, p.north_deg) + ", longitudes " +
                             text_of("%.4g to %.4g", p.west_deg, p.east_deg) + "); is it the right one?");
  p.exchanged = named > 0 && (other == 0 || named > kMargin_deg);
  if (p.exchanged) p.northing_first = !p.northing_first, outside_deg(p.northing_first);
  p.operation.reset(proj_trans_get_last_used_operation(all.get()));
  if (!p.operation) p.operation = std::move(all);
  p.accuracy_m = std::max(0.0, proj_coordoperation_get_accuracy(context, p.operation.get()));
  p.moves = p.changes_datum(place);
  p.datum_steps = datum_steps(p.operation.get());
  return p.exchanged ? Order::exchanged : (other == 0) == (named == 0) ? Order::either : Order::named;
}

Geodetic ReferenceSystem::geodetic(const ModelPoint& point) const {
  const Parts& p = *parts_;
  const auto [x, y] = p.northing_first ? std::pair{point.second, point.first} : std::pair{point.first, point.second};
  const PJ_COORD at = p.transform(p.operation.get(), PJ_FWD, x, y);
  return {at.xy.y, at.xy.x};
}

std::optional<ModelPoint> ReferenceSystem::model(const Geodetic& point) const {
  const Parts& p = *parts_;
  const PJ_COORD at = p.transform(p.operation.get(), PJ_INV, point.longitude_deg, point.latitude_deg);
  if (!std::isfinite(at.xy.x) || !std::isfinite(at.xy.y)) return std::nullopt;
  return p.northing_first ? ModelPoint{at.xy.y, at.xy.x} : ModelPoint{at.xy.x, at.xy.y};
}

std::string ReferenceSystem::description() const {
  const Parts& p = *parts_;
  const char* north = p.geographic ? "latitude" : "northing";
  const char* east = p.geographic ? "longitude" : "easting";
  std::string text = p.name + ", " + (p.northing_first ? north : east) + " first";
  if (p.exchanged) text += " (against its name's order, which would put the model elsewhere)";
  if (p.unit_m != 1 && !p.geographic) text += ", in units of " + text_of("%.9g m", p.unit_m);
  if (p.height_unit_m != 1) text += ", heights in units of " + text_of("%.9g m", p.height_unit_m);
  if (!p.datum_steps.empty()) text += ", by " + p.datum_steps;
  return text + (p.accuracy_m > 0 ? ", accurate to " + text_of("%.3g m", p.accuracy_m) : "");
}

}  // namespace odograph
