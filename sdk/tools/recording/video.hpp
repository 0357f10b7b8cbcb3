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

/// A video file: when its frames are shown, and their pictures, decoded as they are asked for. In order is cheap; going
/// back, or far ahead, seeks. Pictures are as stored: a phone's note of how it was held does not rotate them, since the
/// lens does not rotate either.
class Video : public PictureStore {
 public:
  struct Limits {
    size_t frames = 500'000;  ///< 4.6 hours at 30 Hz, a third of a gigabyte of messages
    int pixels = 16384;       ///< of a side, as everywhere
  };

  /// Looks through the whole file for times, without decoding. `keep` is held as long as the video: the folder that
  /// it was unpacked into. ODO_E_DATA in words: no video, too long, too large.
  static Result<std::shared_ptr<Video>> open(const std::filesystem::path& file, std::shared_ptr<const void> keep,
                                             const Limits& limits);
  static Result<std::shared_ptr<Video>> open(const std::filesystem::path& file, std::shared_ptr<const void> keep = {}) {
    return open(file, std::move(keep), Limits());
  }
  ~Video() override;
  Video(const Video&) = delete;
  Video& operator=(const Video&) = delete;

  /// When each frame is shown, on the file's own clock: ns, ascending.
  const std::vector<int64_t>& times_ns() const { return times_ns_; }
  uint32_t width() const { return width_; }
  uint32_t height() const { return height_; }

  /// A sample of the file's track of timed metadata.
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
