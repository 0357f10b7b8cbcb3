// SPDX-License-Identifier: Apache-2.0
//
// Readers of a single text table: trajectories, truth, traces. The first byte selects the kind.
#include "sdk/tools/recording/recording.hpp"
#include "tests/fuzz/scratch.hpp"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  if (size == 0) return 0;
  const auto& path = fuzz::put("table.txt", {data + 1, size - 1});
  switch (data[0] % 4) {
    case 0: (void)odograph::read_tum(path); break;
    case 1: (void)odograph::read_kitti_poses(path, {}); break;
    case 2: (void)odograph::read_euroc_truth(path); break;
    default: (void)odograph::read_indoor_location(path);
  }
  return 0;
}
