// SPDX-License-Identifier: Apache-2.0
//
// The extension odo.places: tools read, join and thin maps.
#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include <odograph/places.h>
#include <odograph/plugin.hpp>

#include "plugins/fix/map/map_section.hpp"
#include "plugins/fix/map/merge.hpp"
#include "sdk/math/rotation.hpp"

namespace odograph::place_map {

/// A plugin's map as it is saved: u64 id, which names its frame, and map_section.hpp.
inline std::vector<uint8_t> with_id(uint64_t id, const std::vector<uint8_t>& section) {
  std::vector<uint8_t> out;
  for (int i = 0; i < 8; ++i) out.push_back(static_cast<uint8_t>(id >> 8 * i));
  out.insert(out.end(), section.begin(), section.end());
  return out;
}
/// The id in front; throws if there is none.
inline uint64_t id_of(std::span<const uint8_t> map) {
  uint64_t id = 0;
  for (size_t i = 0; i < 8 && i < map.size(); ++i) id |= uint64_t{map[i]} << 8 * i;
  if (map.size() < 8 || id == 0) throw odo::Error(ODO_E_DATA, "a map of fewer than 8 bytes, or without an id");
  return id;
}

/// State of the extension's functions. Thread: the one that controls the plugin. It must not move: the host keeps
/// pointers to it.
class PlacesExtension {
 public:
  explicit PlacesExtension(const odo::Output& host) : host_(host) {}
  PlacesExtension(const PlacesExtension&) = delete;
  PlacesExtension& operator=(const PlacesExtension&) = delete;

  const odo_places* table() const { return &table_; }

 private:
  /// Runs a request; errors are reported to the host and returned as a status.
  template <class Work>
  static int32_t call(void* user, Work&& work) noexcept {
    auto& self = *static_cast<PlacesExtension*>(user);
    try {
      return work(self);
    } catch (const std::bad_alloc&) {
      return ODO_E_MEMORY;
    } catch (const std::exception& error) {
      self.host_.report(ODO_SEVERITY_ERROR, "places", error.what());
      return ODO_E_DATA;
    }
  }
  /// Throws if it is damaged.
  static PlaceMap map_of(std::span<const uint8_t> bytes) {
    if (bytes.size() < 8) throw odo::Error(ODO_E_DATA, "a map of fewer than 8 bytes");
    auto frames = key_frames_of(bytes.subspan(8));
    if (const auto* reason = std::get_if<std::string>(&frames)) throw odo::Error(ODO_E_DATA, *reason);
    PlaceMap map;
    map.restore(std::move(std::get<std::vector<KeyFrame>>(frames)));
    return map;
  }
  static int32_t ODO_CALL open(void* user, const uint8_t* data, uint64_t size, uint64_t* views) noexcept {
    return call(user, [&](PlacesExtension& self) -> int32_t {
      const std::span<const uint8_t> bytes(data, size);
      const uint64_t id = id_of(bytes);
      self.map_ = map_of(bytes), self.id_ = id;
      *views = self.map_.key_frames().size();
      return ODO_OK;
    });
  }
  static int32_t ODO_CALL view(void* user, uint64_t number, odo_place_view* view, double* p_m) noexcept {
    const auto& frames = static_cast<PlacesExtension*>(user)->map_.key_frames();
    if (number >= frames.size()) return ODO_E_NOT_FOUND;
    const KeyFrame& frame = frames[number];
    view->landmarks = static_cast<uint32_t>(frame.landmarks.size()), view->epoch = frame.epoch;
    put_quaternion(frame.T_m_k.q, view->q_m_c);
    Eigen::Vector3d::Map(view->p_m_c) = frame.T_m_k.p;
    for (size_t i = 0; p_m && i < frame.landmarks.size(); ++i)
      Eigen::Vector3d::Map(p_m + 3 * i) =
          frame.T_m_k * Eigen::Vector3f::Map(frame.landmarks[i].p_k.data()).cast<double>();
    return ODO_OK;
  }
  static int32_t ODO_CALL join(void* user, const uint8_t* data, uint64_t size, odo_place_joint* joint) noexcept {
    return call(user, [&](PlacesExtension& self) -> int32_t {
      const std::span<const uint8_t> bytes(data, size);
      const PlaceMap other = map_of(bytes);
      const Placed placed = place_of(other, self.map_);
      const auto number = [](size_t count) { return static_cast<uint32_t>(count); };
      joint->asked = number(placed.asked), joint->recognised = number(placed.recognised);
      joint->agreeing = number(placed.agreeing);
      put_quaternion(placed.T_m_o.q, joint->q_m_o);
      Eigen::Vector3d::Map(joint->p_m_o) = placed.T_m_o.p;
      joint->sigma_m = placed.sigma_m;
      if (!placed.is_found) return ODO_E_NOT_FOUND;
      JoinedFrames frames;
      frames.add(self.map_, {}), frames.add(other, placed.T_m_o);
      self.map_.restore(frames.take());
      return ODO_OK;
    });
  }
  static int32_t ODO_CALL thin(void* user, uint64_t most) noexcept {
    return call(user, [&](PlacesExtension& self) -> int32_t {
      uint64_t size = 0;
      for (size_t count; (count = self.map_.key_frames().size()) > 1 && (size = self.saved().size()) > most;)
        self.map_.keep(std::clamp<size_t>(count * most / size, 1, count - 1));
      return ODO_OK;
    });
  }
  static int64_t ODO_CALL save(void* user, uint8_t* data, uint64_t capacity) noexcept {
    int64_t size = 0;
    const int32_t status = call(user, [&](PlacesExtension& self) -> int32_t {
      const auto bytes = self.saved();
      size = static_cast<int64_t>(bytes.size());
      if (bytes.size() <= capacity) std::copy(bytes.begin(), bytes.end(), data);
      return ODO_OK;
    });
    return status == ODO_OK ? size : status;
  }
  std::vector<uint8_t> saved() const { return with_id(id_, bytes_of(map_)); }

  odo::Output host_;
  uint64_t id_ = 0;
  PlaceMap map_;
  odo_places table_ = {sizeof(odo_places), 0, this, open, view, join, thin, save};
};

}  // namespace odograph::place_map
