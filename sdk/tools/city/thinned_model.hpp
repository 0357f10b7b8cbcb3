// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>

#include "sdk/host/base/result.hpp"

namespace odograph {

/// Writes a CityJSON model without a random fraction of about `missing` of its buildings, as if they were newer than
/// the model. Parts of a building are removed with it. Returns the number of buildings left.
Result<size_t> write_thinned_model(const std::filesystem::path& model, const std::filesystem::path& output,
                                   double missing, uint64_t seed);

}  // namespace odograph
