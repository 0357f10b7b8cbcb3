// SPDX-License-Identifier: Apache-2.0
#include <cstring>
#include <stdexcept>
#include <string>

#include "plugins/fix/skyline/skyline_database.hpp"

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, size_t size) {
  using namespace odograph::skyline;
  std::string bytes(reinterpret_cast<const char*>(data), size);
  if (size >= sizeof(DatabaseHeader)) {  // without a valid checksum nothing behind the header is read
    DatabaseHeader header;
    std::memcpy(&header, bytes.data(), sizeof header);
    header.checksum = checksum_of(header);
    std::memcpy(bytes.data(), &header, sizeof header);
  }
  try {
    const auto database = SkylineDatabase::view(bytes, "fuzz");
    Horizon horizon;
    for (size_t i = 0; i < database.size() && i < 100; ++i) (void)database.horizon(i, horizon);
    (void)database.edges();
    if (database.size() > 0) (void)database.nearest(1, 2);
  } catch (const std::runtime_error&) {  // rejected with a reason
  }
  return 0;
}
