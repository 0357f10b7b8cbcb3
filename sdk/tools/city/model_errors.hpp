// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>

#include "sdk/host/base/result.hpp"

namespace odograph {

/// Errors of a city model against the city.
struct ModelErrors {
  double missing = 0;       ///< about this fraction of the buildings is removed, as if they were newer than the model
  double roof_sigma_m = 0;  ///< each building's roofs are off by one height of this standard deviation, m
  uint64_t seed = 1;
  bool any() const { return missing > 0 || roof_sigma_m > 0; }
};

/// Writes a CityJSON model with errors. Parts of a building share its errors; what lies within two metres of a
/// building's lowest corner stays. Returns the number of buildings left.
Result<size_t> write_model_with_errors(const std::filesystem::path& model, const std::filesystem::path& output,
                                       const ModelErrors& errors);

}  // namespace odograph
