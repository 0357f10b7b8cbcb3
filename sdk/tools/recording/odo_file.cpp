// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/recording/odo_file.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace odograph {
namespace fs = std::filesystem;

namespace {

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

Result<std::unique_ptr<OdoWriter>> OdoWriter::create(const fs::path& file, int jpeg_quality) {
  auto records = RecordWriter::create(file);
  if (!records) return records.failure();
  return std::unique_ptr<OdoWriter>(new OdoWriter(file, std::move(*records), jpeg_quality));
}

Result<bool> OdoWriter::written(bool good) const {
  if (!good) return Failure{ODO_E_IO, path_.string() + ": writing failed; is the disk full?"};
  return true;
}

Result<bool> OdoWriter::record(uint32_t type, std::span<const unsigned char> head,
                               std::span<const unsigned char> tail) {
  return written(records_.write(type, head, tail));
}

Result<bool> OdoWriter::write(const odo_header& message) {
  if (message.type == ODO_TYPE_FRAME) {
    const auto& frame = as<odo_frame>(message);
    const auto picture = encode_picture(frame, jpeg_quality_);
    if (!picture) return picture.failure();
    return write_encoded_frame(frame, *picture);
  }
  if (ODO_IS_RESERVED(message.type) || ODO_IS_BORROWED(message.type))
    return Failure{ODO_E_UNSUPPORTED, "a " + message_name(message.type) + " cannot be recorded"};
  if (AnyMessage copy; !copy.assign(message))
    return Failure{ODO_E_STRUCT_SIZE, "a " + message_name(message.type) + " with struct_size = " +
                                          std::to_string(message.struct_size) + " cannot be recorded"};
  return written(records_.write(message, {}));
}

Result<bool> OdoWriter::write_encoded_frame(const odo_frame& frame, std::span<const unsigned char> picture) {
  if (picture.size() > ODO_LARGEST_PICTURE)
    return Failure{ODO_E_DATA, "a picture of " + std::to_string(picture.size()) +
                                   " bytes; a recording stores at most " + std::to_string(ODO_LARGEST_PICTURE)};
  return written(records_.write(frame.header, picture));
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

Result<bool> OdoWriter::write_true_step(const odo_step& s) { return record(kTrueStep, bytes_of(s)); }

namespace {

/// A video frame in colour: luma, and chroma at half resolution.
cv::Mat bgr_of_yuv(const odo_frame& frame) {
  const int rows = static_cast<int>(frame.height), columns = static_cast<int>(frame.width);
  const auto plane = [&](int p, int height, int width, int type) {
    return cv::Mat(height, width, type, const_cast<uint8_t*>(frame.planes[p].data),
                   static_cast<size_t>(frame.planes[p].row_stride));
  };
  const int half_rows = (rows + 1) / 2, half_columns = (columns + 1) / 2;
  std::vector<cv::Mat> halves;
  if (frame.format == ODO_FORMAT_YUV420)
    halves = {plane(1, half_rows, half_columns, CV_8UC1), plane(2, half_rows, half_columns, CV_8UC1)};
  else
    cv::split(plane(1, half_rows, half_columns, CV_8UC2), halves);
  if (frame.format == ODO_FORMAT_NV21) std::swap(halves[0], halves[1]);
  std::vector<cv::Mat> channels(3);
  channels[0] = plane(0, rows, columns, CV_8UC1);
  for (int i : {0, 1}) {  // OpenCV's order is Y Cr Cb
    cv::Mat large;
    cv::resize(halves[static_cast<size_t>(1 - i)], large, {2 * half_columns, 2 * half_rows}, 0, 0, cv::INTER_NEAREST);
    channels[static_cast<size_t>(1 + i)] = large(cv::Rect(0, 0, columns, rows));
  }
  cv::Mat image;
  cv::merge(channels, image);
  cv::cvtColor(image, image, cv::COLOR_YCrCb2BGR);
  return image;
}

}  // namespace

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
    case ODO_FORMAT_BGRA8:
      cv::cvtColor(cv::Mat(rows, columns, CV_8UC4, data, stride), image, cv::COLOR_BGRA2BGR);
      break;
    case ODO_FORMAT_YUV420:
    case ODO_FORMAT_NV12:
    case ODO_FORMAT_NV21: image = bgr_of_yuv(frame); break;
    default: image = cv::Mat(rows, columns, CV_8UC1, data, stride);
  }
  std::vector<unsigned char> bytes;
  if (jpeg_quality < 0 && image.channels() == 3) cv::cvtColor(image, image, cv::COLOR_BGR2GRAY);
  const bool encoded = jpeg_quality < 0   ? cv::imencode(".pgm", image, bytes)
                       : jpeg_quality > 0 ? cv::imencode(".jpg", image, bytes, {cv::IMWRITE_JPEG_QUALITY, jpeg_quality})
                                          : cv::imencode(".png", image, bytes, {cv::IMWRITE_PNG_COMPRESSION, 1});
  if (!encoded) return Failure{ODO_E_DATA, "a picture could not be encoded"};
  return bytes;
}

namespace {

/// The orientation as written, normalised if its norm is off by more than rounding.
Eigen::Quaterniond unit(const double* q) {
  const Eigen::Quaterniond as_written(q[0], q[1], q[2], q[3]);
  return std::abs(as_written.squaredNorm() - 1) < 1e-12 ? as_written : as_written.normalized();
}

/// A message from an older or newer program; for a frame, its picture follows the struct.
void take_message(Recording& recording, const RecordReader& record, const std::shared_ptr<const fs::path>& file,
                  bool events) {
  AnyMessage message;
  std::span<const unsigned char> picture;
  if (!record.message(message, picture)) return;
  const odo_header& header = message.header();
  if (header.type == ODO_TYPE_FRAME)
    recording.add(header, {file, record.payload_offset() + header.struct_size, static_cast<uint32_t>(picture.size())});
  else if ((is_input(header.type) && !ODO_IS_BORROWED(header.type)) || (events && ODO_IS_EVENT(header.type)))
    recording.add(header);
}

/// Adds one complete record to the recording.
void take(Recording& recording, const RecordReader& record, const std::shared_ptr<const fs::path>& file,
          const ReadOptions& options) {
  const auto payload = record.payload();
  if (record.type() == OdoWriter::kTruthPose && payload.size() >= sizeof(TruthRecord)) {
    TruthRecord t;
    std::memcpy(&t, payload.data(), sizeof t);
    if (!is_plausible_time(t.t_ns)) {
      ++recording.loss.times_out_of_range;
      return;
    }
    recording.truth.push_back({t.t_ns, unit(t.q), {t.p[0], t.p[1], t.p[2]}});
    return;
  }
  if (record.type() == OdoWriter::kTrueState && payload.size() >= sizeof(StateRecord)) {
    if (!options.true_states) return;
    StateRecord r;
    std::memcpy(&r, payload.data(), sizeof r);
    using Eigen::Vector3d;
    recording.true_states.push_back({r.pose.t_ns, unit(r.pose.q), Vector3d::Map(r.pose.p), Vector3d::Map(r.v),
                                     Vector3d::Map(r.gyro_bias), Vector3d::Map(r.accel_bias), r.mode});
    return;
  }
  if (record.type() == OdoWriter::kTrueSighting && payload.size() >= sizeof(TrueSighting)) {
    std::memcpy(&recording.true_sightings.emplace_back(), payload.data(), sizeof(TrueSighting));
    return;
  }
  if (record.type() == OdoWriter::kTrueStep && payload.size() >= ODO_STEP_SIZE_MIN) {
    odo_step& step = recording.true_steps.emplace_back();
    std::memcpy(static_cast<void*>(&step), payload.data(), std::min(payload.size(), sizeof step));
    return;
  }
  if (record.type() == OdoWriter::kTrueSkyline && payload.size() >= sizeof(SkylineHead)) {
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
  take_message(recording, record, file, options.events);
}

}  // namespace

Result<Recording> read_odo(const fs::path& file, const ReadOptions& options) {
  Recording recording{.format = "Odograph", .path = file};
  auto records = RecordReader::open(file);
  if (!records) return records.failure();
  const auto shared = std::make_shared<const fs::path>(file);
  while (records->next()) take(recording, *records, shared, options);
  recording.loss.file = records->loss();
  if (const std::string lost = recording.loss.file.text(); !lost.empty()) recording.warnings.push_back(lost);
  if (recording.messages.empty())
    return Failure{ODO_E_DATA, file.string() + ": contains no complete message" +
                                   (recording.loss.file.any() ? "; " + recording.loss.file.text() : "")};
  recording.sort();
  return recording;
}

Result<std::vector<unsigned char>> picture_as_file(const RecordedMessage& message) {
  if (auto bytes = encoded_picture(message.picture); !bytes.empty()) return bytes;
  const auto frame = load_frame(message);
  if (!frame) return std::vector<unsigned char>();
  auto encoded = encode_picture(*frame, 0);
  frame->loan.release(frame->loan.owner);
  return encoded;
}

}  // namespace odograph
