// SPDX-License-Identifier: Apache-2.0
//
// Models of the ground and of objects. The first byte selects the format.
#include <stdexcept>

#include "plugins/fix/terrain/terrain.hpp"
#include "sdk/tools/simulation/city_model.hpp"
#include "tests/fuzz/scratch.hpp"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const char* const names[] = {"ground.asc", "ground.obj", "ground.tif"};
  if (size == 0) return 0;
  const auto file = fuzz::put(names[data[0] % 3], {data + 1, size - 1});
  try {
    double height_m = 0;
    (void)odograph::terrain::read_terrain(file.string()).height_at(1, 2, 3, height_m);
  } catch (const std::runtime_error&) {  // rejected, with a reason
  }
  if (data[0] % 3 == 1) (void)odograph::read_city_model(file);
  return 0;
}
