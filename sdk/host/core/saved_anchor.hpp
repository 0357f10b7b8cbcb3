// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "sdk/host/messages/bounds.hpp"

namespace odograph {

/// An anchor as it is saved: geodetic where n was georeferenced, otherwise in n.
struct SavedAnchor {
  uint32_t kind, reference, height_above, reserved;
  double geodetic[3], q[4], p[3], sigma_m;
  char name[64];
};
static_assert(sizeof(SavedAnchor) == 168);
inline constexpr uint32_t kSavedGeodetic = 1, kSavedNavigation = 2;

inline bool is_valid(const SavedAnchor& saved) {
  using bounds::are_numbers;
  if (!are_numbers(saved.geodetic, 3) || !are_numbers(saved.q, 4) || !are_numbers(saved.p, 3)) return false;
  if (!are_numbers(&saved.sigma_m, 1) || saved.sigma_m < 0) return false;
  const double norm = Eigen::Map<const Eigen::Vector4d>(saved.q).norm();
  return norm > 0.9 && norm < 1.1 && bounds::kLatitude_rad.holds(saved.geodetic[0]) &&
         bounds::kLongitude_rad.holds(saved.geodetic[1]) &&
         (saved.reference == kSavedGeodetic || saved.reference == kSavedNavigation) &&
         saved.name[sizeof saved.name - 1] == 0;
}

/// Nothing if they are damaged. Their number is checked when they are added.
inline std::optional<std::vector<SavedAnchor>> saved_anchors_of(std::span<const uint8_t> blob) {
  if (blob.size() % sizeof(SavedAnchor) != 0) return {};
  std::vector<SavedAnchor> all(blob.size() / sizeof(SavedAnchor));
  if (!blob.empty()) std::memcpy(all.data(), blob.data(), blob.size());
  if (!std::all_of(all.begin(), all.end(), is_valid)) return {};
  return all;
}

}  // namespace odograph
