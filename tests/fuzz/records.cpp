// SPDX-License-Identifier: Apache-2.0
//
// Recordings with correct checksums: the input is split into records (type, size, payload), which a writer assembles.
#include <filesystem>

#include "sdk/tools/recording/odo_file.hpp"
#include "tests/fuzz/bytes.hpp"
#include "tests/fuzz/scratch.hpp"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const std::filesystem::path path = fuzz::folder() / "records.odo";
  {
    auto writer = odograph::RecordWriter::create(path);
    if (!writer) return 0;
    for (fuzz::Bytes left(data, size); !left.empty();) {
      const auto type = left.take<uint32_t>();
      const auto length = left.take<uint16_t>();
      writer->write(type, left.take(length % 1024));
    }
    (void)writer->finish();
  }
  if (const auto recording = odograph::read_recording(path))
    for (const auto& message : recording->messages)
      if (message.message.header().type == ODO_TYPE_FRAME)
        if (const auto frame = odograph::load_frame(message)) frame->loan.release(frame->loan.owner);
  return 0;
}
