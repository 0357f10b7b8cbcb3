// SPDX-License-Identifier: Apache-2.0
#include "sdk/recording/odo_file.hpp"

#include <cstring>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <zlib.h>

namespace odograph {
namespace fs = std::filesystem;

namespace {

constexpr char kMagic[8] = {'O', 'D', 'O', 'R', 'E', 'C', '1', '\n'};
constexpr uint32_t kRecord = 0x524F444F;  // "ODOR"
constexpr uint32_t kLargestPayload = 64u << 20;

struct RecordHead {
  uint32_t magic, type, size, crc;
};
static_assert(sizeof(RecordHead) == 16);

uint32_t checksum(uint32_t type, uint32_t size, std::span<const unsigned char> head,
                  std::span<const unsigned char> tail) {
  const uint32_t numbers[2] = {type, size};
  uLong crc = crc32(0, reinterpret_cast<const Bytef*>(numbers), sizeof numbers);
  crc = crc32(crc, head.data(), static_cast<uInt>(head.size()));
  if (!tail.empty()) crc = crc32(crc, tail.data(), static_cast<uInt>(tail.size()));
  return static_cast<uint32_t>(crc);
}

template <class T>
std::span<const unsigned char> bytes_of(const T& value) {
  return {reinterpret_cast<const unsigned char*>(&value), sizeof value};
}

struct TruthRecord {
  int64_t t_ns;
  double q[4];
  double p[3];
};

struct StateRecord {
  TruthRecord pose;
  double v[3], gyro_bias[3], accel_bias[3];
  uint32_t mode, zero;
};
static_assert(sizeof(StateRecord) == 144);
static_assert(sizeof(TrueSighting) == 80 && std::is_trivially_copyable_v<TrueSighting>);

struct SkylineHead {
  int64_t t_ns;
  uint32_t directions, zero;
};

}  // namespace

OdoWriter::OdoWriter(fs::path file, int jpeg_quality)
    : path_(std::move(file)), out_(path_, std::ios::binary | std::ios::trunc), jpeg_quality_(jpeg_quality) {
  const uint32_t version[2] = {1, 0};
  out_.write(kMagic, sizeof kMagic);
  out_.write(reinterpret_cast<const char*>(version), sizeof version);
}

Result<std::unique_ptr<OdoWriter>> OdoWriter::create(const fs::path& file, int jpeg_quality) {
  std::unique_ptr<OdoWriter> writer(new OdoWriter(file, jpeg_quality));
  if (!writer->out_) return Failure{ODO_E_NOT_FOUND, file.string() + ": cannot be written"};
  return writer;
}

Result<bool> OdoWriter::record(uint32_t type, std::span<const unsigned char> head,
                               std::span<const unsigned char> tail) {
  const auto size = static_cast<uint32_t>(head.size() + tail.size());
  const RecordHead record{kRecord, type, size, checksum(type, size, head, tail)};
  out_.write(reinterpret_cast<const char*>(&record), sizeof record);
  out_.write(reinterpret_cast<const char*>(head.data()), static_cast<std::streamsize>(head.size()));
  out_.write(reinterpret_cast<const char*>(tail.data()), static_cast<std::streamsize>(tail.size()));
  if (!out_) return Failure{ODO_E_NOT_FOUND, path_.string() + ": writing failed; is the disk full?"};
  return true;
}

Result<bool> OdoWriter::write(const odo_header& message) {
  if (message.type == ODO_TYPE_FRAME) {
    const auto& frame = as<odo_frame>(message);
    const auto picture = encode_picture(frame, jpeg_quality_);
    if (!picture) return picture.failure();
    return write_encoded_frame(frame, *picture);
  }
  AnyMessage copy;
  if (!copy.assign(message)) return Failure{ODO_E_STRUCT_SIZE, "a message of unknown type or too small"};
  return record(message.type, {copy.bytes, copy.header().struct_size});
}

Result<bool> OdoWriter::write_encoded_frame(const odo_frame& frame, std::span<const unsigned char> picture) {
  odo_frame bare = frame;  // pointers mean nothing in a file
  for (auto& plane : bare.planes) plane = {};
  bare.mask = {};
  bare.owner = nullptr;
  bare.retain = nullptr;
  bare.release = nullptr;
  bare.header.flags &= ~ODO_FRAME_MASK;
  return record(ODO_TYPE_FRAME, bytes_of(bare), picture);
}

Result<bool> OdoWriter::write_truth(const StampedPose& pose) {
  const TruthRecord truth{
      pose.t_ns, {pose.q.w(), pose.q.x(), pose.q.y(), pose.q.z()}, {pose.p.x(), pose.p.y(), pose.p.z()}};
  return record(kTruthPose, bytes_of(truth));
}

Result<bool> OdoWriter::write_true_state(const TrueState& s) {
  StateRecord r{{s.t_ns, {s.q.w(), s.q.x(), s.q.y(), s.q.z()}, {s.p.x(), s.p.y(), s.p.z()}}, {}, {}, {}, s.mode, 0};
  Eigen::Vector3d::Map(r.v) = s.v;
  Eigen::Vector3d::Map(r.gyro_bias) = s.gyro_bias;
  Eigen::Vector3d::Map(r.accel_bias) = s.accel_bias;
  return record(kTrueState, bytes_of(r));
}

Result<bool> OdoWriter::write_true_skyline(const TrueSkyline& s) {
  const SkylineHead head{s.t_ns, static_cast<uint32_t>(s.elevation_rad.size()), 0};
  std::vector<float> lines = s.elevation_rad;
  lines.insert(lines.end(), s.distance_m.begin(), s.distance_m.end());
  return record(kTrueSkyline, bytes_of(head),
                {reinterpret_cast<const unsigned char*>(lines.data()), lines.size() * sizeof(float)});
}

Result<bool> OdoWriter::write_true_sighting(const TrueSighting& s) { return record(kTrueSighting, bytes_of(s)); }

bool OdoWriter::flush() { return static_cast<bool>(out_.flush()); }

Result<std::vector<unsigned char>> encode_picture(const odo_frame& frame, int jpeg_quality) {
  const int rows = static_cast<int>(frame.height), columns = static_cast<int>(frame.width);
  auto* data = const_cast<uint8_t*>(frame.planes[0].data);
  const auto stride = static_cast<size_t>(frame.planes[0].row_stride);
  cv::Mat image;
  switch (frame.format) {
    case ODO_FORMAT_RGB8: cv::cvtColor(cv::Mat(rows, columns, CV_8UC3, data, stride), image, cv::COLOR_RGB2BGR); break;
    case ODO_FORMAT_RGBA8:
      cv::cvtColor(cv::Mat(rows, columns, CV_8UC4, data, stride), image, cv::COLOR_RGBA2BGR);
      break;
    default: image = cv::Mat(rows, columns, CV_8UC1, data, stride);
  }
  std::vector<unsigned char> bytes;
  const bool encoded = jpeg_quality > 0 ? cv::imencode(".jpg", image, bytes, {cv::IMWRITE_JPEG_QUALITY, jpeg_quality})
                                        : cv::imencode(".png", image, bytes, {cv::IMWRITE_PNG_COMPRESSION, 1});
  if (!encoded) return Failure{ODO_E_DATA, "a picture could not be encoded"};
  return bytes;
}

namespace {

/// Takes one whole record into the recording.
void take(Recording& recording, const RecordHead& head, std::span<const unsigned char> payload, uint64_t offset) {
  if (head.type == OdoWriter::kTruthPose && payload.size() >= sizeof(TruthRecord)) {
    TruthRecord t;
    std::memcpy(&t, payload.data(), sizeof t);
    recording.truth.push_back(
        {t.t_ns, Eigen::Quaterniond(t.q[0], t.q[1], t.q[2], t.q[3]).normalized(), {t.p[0], t.p[1], t.p[2]}});
    return;
  }
  if (head.type == OdoWriter::kTrueState && payload.size() >= sizeof(StateRecord)) {
    StateRecord r;
    std::memcpy(&r, payload.data(), sizeof r);
    using Eigen::Vector3d;
    const double* q = r.pose.q;
    recording.true_states.push_back({r.pose.t_ns, Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized(),
                                     Vector3d::Map(r.pose.p), Vector3d::Map(r.v), Vector3d::Map(r.gyro_bias),
                                     Vector3d::Map(r.accel_bias), r.mode});
    return;
  }
  if (head.type == OdoWriter::kTrueSighting && payload.size() >= sizeof(TrueSighting)) {
    std::memcpy(&recording.true_sightings.emplace_back(), payload.data(), sizeof(TrueSighting));
    return;
  }
  if (head.type == OdoWriter::kTrueSkyline && payload.size() >= sizeof(SkylineHead)) {
    SkylineHead s;
    std::memcpy(&s, payload.data(), sizeof s);
    if ((payload.size() - sizeof s) / (2 * sizeof(float)) < s.directions) return;
    TrueSkyline& line = recording.true_skylines.emplace_back();
    line.t_ns = s.t_ns;
    line.elevation_rad.resize(s.directions), line.distance_m.resize(s.directions);
    const size_t size = s.directions * sizeof(float);
    if (size > 0) {
      std::memcpy(line.elevation_rad.data(), payload.data() + sizeof s, size);
      std::memcpy(line.distance_m.data(), payload.data() + sizeof s + size, size);
    }
    return;
  }
  const MessageInfo* info = message_info(head.type);
  if (!info || payload.size() < info->size) return;  // a newer version's record: not for us
  alignas(8) unsigned char aligned[kLargestMessage] = {};
  std::memcpy(aligned, payload.data(), std::min(payload.size(), sizeof aligned));
  auto& message = *reinterpret_cast<odo_header*>(aligned);
  if (message.type != head.type || message.struct_size < info->size || message.struct_size > payload.size()) return;
  if (head.type == ODO_TYPE_STEP) recording.true_steps.push_back(as<odo_step>(message));
  if (head.type == ODO_TYPE_FRAME) {
    auto& frame = reinterpret_cast<odo_frame&>(message);
    for (auto& plane : frame.planes) plane = {};
    frame.owner = nullptr, frame.retain = nullptr, frame.release = nullptr;
    recording.add(message, {recording.path, offset + message.struct_size, payload.size() - message.struct_size});
  } else if (info->is_input) {
    recording.add(message);
  }
}

}  // namespace

Result<Recording> read_odo(const fs::path& file) {
  Recording recording{.format = "Odograph", .path = file};
  std::ifstream in(file, std::ios::binary);
  char magic[8] = {};
  uint32_t version[2] = {};
  in.read(magic, sizeof magic);
  in.read(reinterpret_cast<char*>(version), sizeof version);
  if (!in || std::memcmp(magic, kMagic, sizeof magic) != 0)
    return Failure{ODO_E_DATA, file.string() + ": not an Odograph recording"};
  if (version[0] != 1)
    return Failure{ODO_E_VERSION, file.string() + ": recording version " + std::to_string(version[0]) +
                                      "; this program reads version 1"};
  uint64_t offset = 16;
  std::vector<unsigned char> payload;
  for (;;) {
    RecordHead head{};
    in.read(reinterpret_cast<char*>(&head), sizeof head);
    if (in.gcount() == 0) break;
    bool whole = in.gcount() == sizeof head && head.magic == kRecord && head.size <= kLargestPayload;
    if (whole) {
      payload.resize(head.size);
      in.read(reinterpret_cast<char*>(payload.data()), head.size);
      whole = in.gcount() == static_cast<std::streamsize>(head.size) &&
              checksum(head.type, head.size, payload, {}) == head.crc;
    }
    if (!whole) {  // a crash while it was written: what came before is good
      recording.warnings.push_back("damaged or cut off at byte " + std::to_string(offset) +
                                   "; everything before it was read");
      break;
    }
    take(recording, head, payload, offset + sizeof head);
    offset += sizeof head + head.size;
  }
  if (recording.messages.empty()) return Failure{ODO_E_DATA, file.string() + ": no whole record in it"};
  recording.sort();
  return recording;
}

}  // namespace odograph
