// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <vector>

#include "sdk/tools/recording/recording.hpp"

struct AVCodecContext;
struct AVFormatContext;
struct AVFrame;
struct AVPacket;
struct SwsContext;

namespace odograph {

/// A video file: display times of its frames, and their pictures, decoded on demand. Sequential access is cheap; going
/// back or far ahead seeks. Pictures are as stored: the phone's rotation tag is ignored, because the lens parameters
/// refer to the sensor's orientation.
class Video : public PictureStore {
 public:
  struct Limits {
    size_t frames = 500'000;  ///< 4.6 hours at 30 Hz, a third of a gigabyte of messages
    int pixels = 16384;       ///< per side, as everywhere
  };

  /// Scans the whole file for times, without decoding. `keep`, the folder that it was unpacked into, is held as long as
  /// the video. ODO_E_DATA with the reason: no video, too long, too large.
  static Result<std::shared_ptr<Video>> open(const std::filesystem::path& file, std::shared_ptr<const void> keep,
                                             const Limits& limits);
  static Result<std::shared_ptr<Video>> open(const std::filesystem::path& file, std::shared_ptr<const void> keep = {}) {
    return open(file, std::move(keep), Limits());
  }
  ~Video() override;
  Video(const Video&) = delete;
  Video& operator=(const Video&) = delete;

  /// Display time of each frame on the file's own clock: ns, ascending.
  const std::vector<int64_t>& times_ns() const { return times_ns_; }
  uint32_t width() const { return width_; }
  uint32_t height() const { return height_; }

  /// A sample of the file's timed metadata track.
  struct Metadata {
    int64_t t_ns;
    std::vector<unsigned char> bytes;
  };
  const std::vector<Metadata>& metadata() const { return metadata_; }

  Result<odo_frame> load(uint64_t number, const odo_frame& frame) override;

 private:
  Video() = default;
  Result<bool> scan(const Limits& limits);
  Result<bool> decode_until(int64_t pts);
  bool next_frame();
  Failure wrong(const std::string& text) const;

  std::filesystem::path file_;
  std::shared_ptr<const void> keep_;
  AVFormatContext* format_ = nullptr;
  AVCodecContext* codec_ = nullptr;
  AVPacket* packet_ = nullptr;
  AVFrame* decoded_ = nullptr;  // the latest
  SwsContext* scaler_ = nullptr;
  int stream_ = -1;
  bool ended_ = false;
  uint32_t width_ = 0, height_ = 0;
  std::vector<int64_t> pts_, times_ns_;
  std::vector<Metadata> metadata_;
  std::mutex mutex_;
};

}  // namespace odograph
