// SPDX-License-Identifier: Apache-2.0
//
// The extension odo.skylines: builds and queries databases of skylines through the plugin that has the city model.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <new>
#include <optional>
#include <utility>

#include <odograph/plugin.hpp>
#include <odograph/skylines.h>

#include "plugins/fix/skyline/binary_sky.hpp"
#include "plugins/fix/skyline/ground.hpp"
#include "plugins/fix/skyline/horizon.hpp"
#include "plugins/fix/skyline/skyline_database.hpp"

namespace odograph::skyline {

/// State of the extension's functions. Thread: the one that controls the plugin. It must not move: the host keeps
/// pointers to it.
class DatabaseExtension {
 public:
  /// Without a `city` nothing can be built. `origin`: easting, northing and height of the origin of its n in the
  /// model's reference system.
  DatabaseExtension(const odo::Output& host, std::optional<City> city, const Eigen::Vector3d& origin)
      : host_(host), city_(std::move(city)), origin_(origin) {}
  DatabaseExtension(const DatabaseExtension&) = delete;
  DatabaseExtension& operator=(const DatabaseExtension&) = delete;

  const odo_skylines* table() const { return &table_; }

 private:
  /// Runs a request; errors are reported to the host and returned as a status.
  template <class Work>
  static int32_t call(void* user, Work&& work) noexcept {
    auto& self = *static_cast<DatabaseExtension*>(user);
    try {
      return work(self);
    } catch (const std::bad_alloc&) {
      return ODO_E_MEMORY;
    } catch (const std::exception& error) {
      self.host_.report(ODO_SEVERITY_ERROR, "skylines", error.what());
      return ODO_E_DATA;
    }
  }
  static int32_t ODO_CALL build(void* user, const odo_string* file, const double* places_n, uint64_t count,
                                double spacing_m, odo_skyline_progress progress, void* context) noexcept {
    return call(user, [&](DatabaseExtension& self) -> int32_t {
      if (!self.city_) return ODO_E_STATE;
      std::vector<Eigen::Vector3d> places;
      for (uint64_t i = 0; i < count; ++i) places.emplace_back(places_n + 3 * i);
      DatabaseParameters p;
      p.origin = self.origin_, p.spacing_m = spacing_m;
      const bool done = build_database(self.city_->edges(), places, p, std::string(odo::view(*file)),
                                       [&](size_t n) { return !progress || progress(context, n, count) != 0; });
      return done ? ODO_OK : ODO_E_DISCARD;
    });
  }
  static int32_t ODO_CALL open(void* user, const odo_string* file, odo_skyline_database* what) noexcept {
    return call(user, [&](DatabaseExtension& self) -> int32_t {
      self.opened_ = SkylineDatabase::open(std::string(odo::view(*file)));
      what->places = self.opened_.size(), what->bytes = self.opened_.bytes();
      Eigen::Vector3d::Map(what->origin) = self.opened_.origin();
      what->spacing_m = self.opened_.spacing_m();
      return ODO_OK;
    });
  }
  static int32_t ODO_CALL nearest(void* user, double north_m, double east_m, uint64_t* place) noexcept {
    return call(user, [&](DatabaseExtension& self) -> int32_t {
      if (self.opened_.size() == 0) return ODO_E_STATE;
      if (!std::isfinite(north_m) || !std::isfinite(east_m)) return ODO_E_ARGUMENT;
      *place = self.opened_.nearest(north_m, east_m);
      return ODO_OK;
    });
  }
  static int32_t ODO_CALL skyline(void* user, uint64_t place, double* p_n, float* elevation_rad, float* height_m,
                                  float* distance_m) noexcept {
    return call(user, [&](DatabaseExtension& self) -> int32_t {
      if (place >= self.opened_.size()) return ODO_E_NOT_FOUND;
      Eigen::Vector3d::Map(p_n) = self.opened_.place(place);
      if (!elevation_rad && !height_m && !distance_m) return ODO_OK;
      Horizon horizon;
      if (!self.opened_.horizon(place, horizon)) return ODO_E_DATA;
      if (elevation_rad) std::copy(horizon.elevation.begin(), horizon.elevation.end(), elevation_rad);
      if (height_m) std::copy(horizon.height_m.begin(), horizon.height_m.end(), height_m);
      if (distance_m) std::copy(horizon.distance_m.begin(), horizon.distance_m.end(), distance_m);
      return ODO_OK;
    });
  }

  static int32_t ODO_CALL look(void* user, const double* p_n, float* elevation_rad, int32_t* object) noexcept {
    return call(user, [&](DatabaseExtension& self) -> int32_t {
      if (!self.city_) return ODO_E_STATE;
      const Eigen::Vector3d at(p_n);
      if (!at.allFinite()) return ODO_E_ARGUMENT;
      self.city_->select_near_edges(at, 1, kLowest);
      Horizon horizon;
      City::EdgeIndices edge_indices;
      self.city_->horizon(at, horizon, edge_indices);
      std::copy(horizon.elevation.begin(), horizon.elevation.end(), elevation_rad);
      for (size_t j = 0; j < edge_indices.size(); ++j)
        object[j] =
            edge_indices[j] < 0 ? Edge::kUnknown : self.city_->edges()[static_cast<size_t>(edge_indices[j])].object;
      return ODO_OK;
    });
  }
  static int32_t ODO_CALL ground(void* user, double north_m, double east_m, double* down_m, int32_t* terrain) noexcept {
    return call(user, [&](DatabaseExtension& self) -> int32_t {
      if (!self.city_) return ODO_E_STATE;
      if (!std::isfinite(north_m) || !std::isfinite(east_m)) return ODO_E_ARGUMENT;
      if (!self.ground_) self.ground_.emplace(self.city_->edges());
      const auto at = self.ground_->at({north_m, east_m});
      if (!at) return ODO_E_NOT_FOUND;
      *down_m = at->down_m, *terrain = at->terrain;
      return ODO_OK;
    });
  }
  static int32_t ODO_CALL edge(void* user, uint64_t number, double* from_n, double* to_n, int32_t* object) noexcept {
    return call(user, [&](DatabaseExtension& self) -> int32_t {
      if (!self.city_) return ODO_E_STATE;
      if (number >= self.city_->edges().size()) return ODO_E_NOT_FOUND;
      const Edge& e = self.city_->edges()[number];
      Eigen::Vector3d::Map(from_n) = e.from, Eigen::Vector3d::Map(to_n) = e.to, *object = e.object;
      return ODO_OK;
    });
  }
  static int32_t ODO_CALL correlate(void*, const float* seen_rad, const float* place_rad,
                                    double* correlation) noexcept {
    std::array<float, BinarySky::kColumns> seen, place;
    std::copy_n(seen_rad, seen.size(), seen.begin()), std::copy_n(place_rad, place.size(), place.begin());
    *correlation = cross_correlation(BinarySky(seen), BinarySky(place));
    return ODO_OK;
  }

  static constexpr double kLowest = 0.01;  // tangent of the lowest elevation of a skyline
  odo::Output host_;
  std::optional<City> city_;
  std::optional<Ground> ground_;
  Eigen::Vector3d origin_;
  SkylineDatabase opened_;
  odo_skylines table_ = {sizeof(odo_skylines), 0, this, build, open, nearest, skyline, look, ground, edge, correlate};
};

}  // namespace odograph::skyline
