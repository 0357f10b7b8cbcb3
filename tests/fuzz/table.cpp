// SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <fstream>
#include <string>

#include <unistd.h>

#include "sdk/recording/recording.hpp"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const std::string path = "/tmp/odograph-fuzz-" + std::to_string(getpid()) + ".txt";
  std::ofstream(path, std::ios::binary).write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  (void)odograph::read_tum(path);
  (void)odograph::read_kitti_poses(path, {});
  (void)odograph::read_euroc_truth(path);
  (void)odograph::read_indoor_location(path);
  unlink(path.c_str());
  return 0;
}
