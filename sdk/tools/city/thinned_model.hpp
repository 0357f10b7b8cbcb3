// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>

#include "sdk/host/base/result.hpp"

namespace odograph {

/// Writes a CityJSON model once more without about this part of its buildings, drawn by the seed, as if they had been
/// built later than the model. Parts of a building go with it; nothing else does. Gives how many buildings are left.
Result<size_t> write_thinned_model(const std::filesystem::path& model, const std::filesystem::path& output,
                                   double missing, uint64_t seed);

}  // namespace odograph
