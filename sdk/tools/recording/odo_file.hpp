// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <span>

#include "sdk/host/messages/record_file.hpp"
#include "sdk/tools/recording/recording.hpp"

namespace odograph {

/// Writer of Odograph's recording format, *.odo; docs/recording.md has layout and types. A message's payload is its ABI
/// struct with the writer's size; a frame's is the struct without pointers, followed by the encoded picture (PNG or
/// JPEG).
class OdoWriter {
 public:
  static constexpr uint32_t kTruthPose =
      0x10000;  // i64 t_ns, f64 q[4] (w x y z), f64 p[3]: the camera, or the body without one

  /// i64 t_ns, f64 q[4] (w x y z), p[3], v[3], gyro bias[3], accelerometer bias[3]: the body; u32 ODO_MODE_*, u32 0
  static constexpr uint32_t kTrueState = 0x10001;

  /// i64 t_ns; u32 directions, u32 0; f32 elevation[directions], f32 distance[directions]
  static constexpr uint32_t kTrueSkyline = 0x10002;

  /// i64 t_ns; u32 tag, f32 visible part; f64 corners[8] (px)
  static constexpr uint32_t kTrueSighting = 0x10003;

  /// An odo_step with the writer's size
  static constexpr uint32_t kTrueStep = 0x10004;

  /// An existing file remains until finish(). jpeg_quality 0: lossless PNG; negative: grey PGM.
  static Result<std::unique_ptr<OdoWriter>> create(const std::filesystem::path& file, int jpeg_quality);

  /// Writes any message; a frame needs its pixels.
  Result<bool> write(const odo_header& message);
  /// Writes a frame whose picture is already encoded.
  Result<bool> write_encoded_frame(const odo_frame& frame, std::span<const unsigned char> picture);
  Result<bool> write_truth(const StampedPose& pose);
  Result<bool> write_true_state(const TrueState& state);
  Result<bool> write_true_skyline(const TrueSkyline& skyline);
  Result<bool> write_true_sighting(const TrueSighting& sighting);
  Result<bool> write_true_step(const odo_step& step);
  /// Writes the end mark and moves the file to its path.
  Result<bool> finish() { return records_.finish(); }
  int jpeg_quality() const { return jpeg_quality_; }

 private:
  OdoWriter(std::filesystem::path file, RecordWriter records, int jpeg_quality)
      : path_(std::move(file)), records_(std::move(records)), jpeg_quality_(jpeg_quality) {}
  Result<bool> written(bool good) const;
  Result<bool> record(uint32_t type, std::span<const unsigned char> head, std::span<const unsigned char> tail = {});

  std::filesystem::path path_;
  RecordWriter records_;
  int jpeg_quality_;
};

/// Encodes a frame's picture as PNG (quality 0) or JPEG.
Result<std::vector<unsigned char>> encode_picture(const odo_frame& frame, int jpeg_quality);
/// The bytes of a frame's PNG or JPEG as stored, or as PNG otherwise; empty if the picture cannot be read.
Result<std::vector<unsigned char>> picture_as_file(const RecordedMessage& message);

}  // namespace odograph
