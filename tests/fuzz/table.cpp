// SPDX-License-Identifier: Apache-2.0
//
// Readers of one table of text: trajectories, truth, traces.
#include "sdk/recording/recording.hpp"
#include "tests/fuzz/scratch.hpp"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const auto path = fuzz::put("table.txt", {data, size});
  (void)odograph::read_tum(path);
  (void)odograph::read_kitti_poses(path, {});
  (void)odograph::read_euroc_truth(path);
  (void)odograph::read_indoor_location(path);
  return 0;
}
