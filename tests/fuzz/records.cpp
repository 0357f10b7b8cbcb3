// SPDX-License-Identifier: Apache-2.0
//
// Recordings whose checksums are right: the input is cut into records (type, size, payload), which a writer puts
// together.
#include <algorithm>
#include <cstring>
#include <span>
#include <string>

#include <unistd.h>

#include "sdk/recording/odo_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const std::string path = "/tmp/odograph-fuzz-records-" + std::to_string(getpid()) + ".odo";
  unlink(path.c_str());
  {
    auto writer = odograph::RecordWriter::create(path);
    if (!writer) return 0;
    for (size_t at = 0; at + 6 <= size;) {
      uint32_t type = 0;
      uint16_t length = 0;
      std::memcpy(&type, data + at, sizeof type);
      std::memcpy(&length, data + at + 4, sizeof length);
      at += 6;
      const size_t take = std::min<size_t>(length % 1024, size - at);
      writer->write(type, std::span(data + at, take));
      at += take;
    }
    (void)writer->finish();
  }
  if (const auto recording = odograph::read_recording(path))
    for (const auto& message : recording->messages)
      if (message.message.header().type == ODO_TYPE_FRAME)
        if (const auto frame = odograph::load_frame(message)) frame->release(&*frame);
  unlink(path.c_str());
  return 0;
}
