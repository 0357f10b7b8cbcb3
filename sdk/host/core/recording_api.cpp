// SPDX-License-Identifier: Apache-2.0
//
// The C API of recordings: checks arguments and stops exceptions.
#include <odograph/messages.h>
#include <odograph/recording.h>

#include <algorithm>
#include <cstdio>
#include <new>

#include "sdk/host/core/c_guard.hpp"
#include "sdk/host/messages/record_file.hpp"
#include "sdk/host/platform/utf8_path.hpp"

struct odo_recording {
  odograph::RecordReader reader;
  struct Place {
    int64_t t_ns;
    uint64_t payload_offset;
  };
  std::vector<Place> places;  // in time order
  size_t next = 0;
  odograph::AnyMessage message;
};

struct odo_recorder {
  odograph::RecordWriter writer;
  bool good = true;
};

namespace {

using odograph::fail;
using odograph::guarded;

int32_t open(const std::filesystem::path& path, odo_recording** out, odo_error* error) {
  auto reader = odograph::RecordReader::open(path);
  if (!reader) return fail(error, reader.failure());
  auto recording = std::make_unique<odo_recording>(odo_recording{std::move(*reader), {}, 0, {}});
  std::span<const unsigned char> picture;
  const auto is_kept = [](uint32_t type) {  // a recording contains only types that a recorder accepts
    return !ODO_IS_RESERVED(type) && (!ODO_IS_BORROWED(type) || type == ODO_TYPE_FRAME);
  };
  while (recording->reader.next())
    if (recording->reader.message(recording->message, picture) && is_kept(recording->message.header().type))
      recording->places.push_back({recording->message.header().t_ns, recording->reader.payload_offset()});
  const auto& loss = recording->reader.loss();
  if (recording->places.empty() && loss.any())
    return fail(error, {ODO_E_DATA, path.string() + ": contains no complete message; " + loss.text()});
  std::stable_sort(recording->places.begin(), recording->places.end(),
                   [](const auto& a, const auto& b) { return a.t_ns < b.t_ns; });
  *out = recording.release();
  return ODO_OK;
}

std::filesystem::path path_of(const odo_string& text) {
  return odograph::utf8_path({text.data, static_cast<size_t>(text.size)});
}

}  // namespace

extern "C" {

int32_t odo_recording_open(const odo_string* path, odo_recording** recording, odo_error* error) {
  if (recording) *recording = nullptr;
  if (!path || !path->data || !recording) return fail(error, {ODO_E_ARGUMENT, "path and recording must not be null"});
  return guarded([&] { return open(path_of(*path), recording, error); });
}

int32_t odo_recording_next(odo_recording* recording, const odo_header** message, const void** picture,
                           uint64_t* picture_size) {
  if (!recording || !message) return ODO_E_ARGUMENT;
  *message = nullptr;
  if (picture) *picture = nullptr;
  if (picture_size) *picture_size = 0;
  if (recording->next >= recording->places.size()) return ODO_END;
  return guarded([&]() -> int32_t {
    const uint64_t at = recording->places[recording->next++].payload_offset;
    std::span<const unsigned char> bytes;
    if (!recording->reader.read_at(at) || !recording->reader.message(recording->message, bytes)) return ODO_E_DATA;
    *message = &recording->message.header();
    if (picture && !bytes.empty()) *picture = bytes.data();
    if (picture_size) *picture_size = bytes.size();
    return ODO_OK;
  });
}

int32_t odo_recording_loss(odo_recording* recording, odo_error* loss) {
  if (!recording || !loss) return ODO_E_ARGUMENT;
  if (loss->struct_size < ODO_ERROR_SIZE_MIN) return ODO_E_STRUCT_SIZE;
  return guarded([&]() -> int32_t {
    const std::string text = recording->reader.loss().text();
    return fail(loss, {text.empty() ? ODO_OK : ODO_E_DATA, text}), ODO_OK;
  });
}

void odo_recording_close(odo_recording* recording) { delete recording; }

int32_t odo_recorder_create(const odo_string* path, odo_recorder** recorder, odo_error* error) {
  if (recorder) *recorder = nullptr;
  if (!path || !path->data || !recorder) return fail(error, {ODO_E_ARGUMENT, "path and recorder must not be null"});
  return guarded([&]() -> int32_t {
    auto writer = odograph::RecordWriter::create(path_of(*path));
    if (!writer) return fail(error, writer.failure());
    *recorder = new odo_recorder{std::move(*writer)};
    return ODO_OK;
  });
}

int32_t odo_recorder_write(odo_recorder* recorder, const odo_header* message, const void* picture,
                           uint64_t picture_size) {
  if (!recorder || !message || ODO_IS_RESERVED(message->type) || (picture_size > 0 && !picture)) return ODO_E_ARGUMENT;
  if (ODO_IS_BORROWED(message->type) && message->type != ODO_TYPE_FRAME) return ODO_E_UNSUPPORTED;
  if (picture_size > ODO_LARGEST_PICTURE) return ODO_E_ARGUMENT;
  if (message->struct_size < sizeof *message) return ODO_E_STRUCT_SIZE;
  return guarded([&]() -> int32_t {
    odograph::AnyMessage copy;
    if (!copy.assign(*message)) return ODO_E_STRUCT_SIZE;
    if (!odograph::recorded_fault(copy.header()).empty()) return ODO_E_DISCARD;
    const auto* bytes = static_cast<const unsigned char*>(picture);
    const bool written =
        recorder->writer.write(copy.header(), {bytes, static_cast<size_t>(picture_size)}) && recorder->writer.flush();
    recorder->good = recorder->good && written;
    return written ? ODO_OK : ODO_E_IO;
  });
}

int32_t odo_recorder_close(odo_recorder* recorder) {
  if (!recorder) return ODO_OK;
  bool good = recorder->good;
  if (good) good = guarded([&] { return recorder->writer.finish() ? ODO_OK : ODO_E_IO; }) == ODO_OK;
  if (!good) recorder->writer.abandon();  // data that reached the disk matters more than disk space
  delete recorder;
  return good ? ODO_OK : ODO_E_IO;
}

}  // extern "C"
