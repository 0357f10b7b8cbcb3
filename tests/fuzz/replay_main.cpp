// SPDX-License-Identifier: Apache-2.0
//
// Replacement for libFuzzer: runs the fuzz function over each seed and reproducible random mutations of it.
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

#include "sdk/tools/simulation/random.hpp"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size);

int main(int argc, char** argv) {
  size_t runs = 0;
  for (int a = 1; a < argc; ++a) {
    for (const auto& entry : std::filesystem::directory_iterator(argv[a])) {
      std::ifstream file(entry.path(), std::ios::binary);
      const std::vector<uint8_t> seed((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
      odograph::Random random(1, 1);
      for (int i = 0; i < 400; ++i, ++runs) {
        std::vector<uint8_t> bytes = seed;
        for (int k = 0; k < i % 12 && !bytes.empty(); ++k) {
          const size_t at = random.next() % bytes.size();
          switch (random.next() % 4) {
            case 0: bytes[at] = static_cast<uint8_t>(random.next()); break;
            case 1: bytes.erase(bytes.begin() + static_cast<std::ptrdiff_t>(at)); break;
            case 2:
              bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(at), bytes[random.next() % bytes.size()]);
              break;
            default: bytes.resize(at + 1);
          }
        }
        LLVMFuzzerTestOneInput(bytes.data(), bytes.size());
      }
    }
  }
  std::printf("%zu inputs\n", runs);
  return runs > 0 ? 0 : 1;
}
