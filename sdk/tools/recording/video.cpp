// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/recording/video.hpp"

#include <algorithm>

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/imgutils.h>
#include <libswscale/swscale.h>
}

#include "sdk/tools/recording/frame_loan.hpp"

namespace odograph {
namespace fs = std::filesystem;

namespace {

/// Formats that contain video themselves: playlists and scripts would make the library open the files that they name.
constexpr const char* kContainers = "mov,mp4,m4a,3gp,3g2,mj2,matroska,webm,avi";
constexpr size_t kMaxMetadataSample = 4096;
/// Beyond this many frames, a seek is cheaper than decoding all frames between.
constexpr size_t kSeekAhead = 90;

struct FreeFrame {
  void operator()(AVFrame* frame) const { av_frame_free(&frame); }
};
using OwnedFrame = std::unique_ptr<AVFrame, FreeFrame>;

/// The ABI's pixel format; 0 if the pixels must be converted.
uint32_t format_of(int pixels) {
  switch (pixels) {
    case AV_PIX_FMT_YUV420P:
    case AV_PIX_FMT_YUVJ420P: return ODO_FORMAT_YUV420;
    case AV_PIX_FMT_NV12: return ODO_FORMAT_NV12;
    case AV_PIX_FMT_NV21: return ODO_FORMAT_NV21;
    case AV_PIX_FMT_GRAY8: return ODO_FORMAT_GREY8;
    default: return 0;
  }
}

void set_planes(odo_frame& frame, const AVFrame& pixels, uint32_t format) {
  frame.format = format;
  frame.width = static_cast<uint32_t>(pixels.width), frame.height = static_cast<uint32_t>(pixels.height);
  frame.plane_count = format == ODO_FORMAT_GREY8 ? 1 : format == ODO_FORMAT_YUV420 ? 3 : 2;
  for (uint32_t p = 0; p < frame.plane_count; ++p)
    frame.planes[p] = {pixels.data[p], pixels.linesize[p], p > 0 && frame.plane_count == 2 ? 2u : 1u, 0};
}

int64_t time_of(const AVPacket& packet) { return packet.pts != AV_NOPTS_VALUE ? packet.pts : packet.dts; }

}  // namespace

Failure Video::wrong(const std::string& text) const { return {ODO_E_DATA, file_.string() + ": " + text}; }

Video::~Video() {
  sws_freeContext(scaler_);
  av_frame_free(&decoded_);
  av_packet_free(&packet_);
  avcodec_free_context(&codec_);
  avformat_close_input(&format_);
}

Result<std::shared_ptr<Video>> Video::open(const fs::path& file, std::shared_ptr<const void> keep,
                                           const Limits& limits) {
  std::shared_ptr<Video> video(new Video);
  video->file_ = file, video->keep_ = std::move(keep);
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return Failure{ODO_E_NOT_FOUND, file.string() + ": no such file"};
  av_log_set_level(AV_LOG_QUIET);  // the library's messages about damaged files are replaced by ours
  AVDictionary* options = nullptr;
  av_dict_set(&options, "protocol_whitelist", "file", 0);
  av_dict_set(&options, "format_whitelist", kContainers, 0);
  const int opened = avformat_open_input(&video->format_, ("file:" + file.string()).c_str(), nullptr, &options);
  av_dict_free(&options);
  if (opened < 0)
    return video->wrong("not a video that can be read (MP4, MOV, MKV, WebM, AVI); was the recording cut off?");
  const AVCodec* decoder = nullptr;
  if (avformat_find_stream_info(video->format_, nullptr) < 0 ||
      (video->stream_ = av_find_best_stream(video->format_, AVMEDIA_TYPE_VIDEO, -1, -1, &decoder, 0)) < 0 || !decoder)
    return video->wrong("no video track in it that can be decoded");
  const AVStream* stream = video->format_->streams[video->stream_];
  video->codec_ = avcodec_alloc_context3(decoder);
  video->packet_ = av_packet_alloc(), video->decoded_ = av_frame_alloc();
  if (!video->codec_ || !video->packet_ || !video->decoded_ ||
      avcodec_parameters_to_context(video->codec_, stream->codecpar) < 0)
    return video->wrong("its video track cannot be decoded");
  const auto& size = *stream->codecpar;
  if (size.width < 16 || size.height < 16 || size.width > limits.pixels || size.height > limits.pixels)
    return video->wrong("pictures of " + std::to_string(size.width) + "x" + std::to_string(size.height) +
                        "; expected 16 to " + std::to_string(limits.pixels) + " pixels");
  video->width_ = static_cast<uint32_t>(size.width), video->height_ = static_cast<uint32_t>(size.height);
  video->codec_->thread_count = 2;
  if (avcodec_open2(video->codec_, decoder, nullptr) < 0) return video->wrong("its video track cannot be decoded");
  if (const auto scanned = video->scan(limits); !scanned) return scanned.failure();
  return video;
}

/// Reads the times of all frames and all timed metadata, from packets only.
Result<bool> Video::scan(const Limits& limits) {
  const AVRational ns{1, 1'000'000'000};
  while (av_read_frame(format_, packet_) >= 0) {
    const AVStream* stream = format_->streams[packet_->stream_index];
    if (packet_->stream_index == stream_) {
      if (time_of(*packet_) != AV_NOPTS_VALUE && !(packet_->flags & AV_PKT_FLAG_DISCARD))
        pts_.push_back(time_of(*packet_));
    } else if (stream->codecpar->codec_type == AVMEDIA_TYPE_DATA && packet_->size > 0 &&
               packet_->size <= static_cast<int>(kMaxMetadataSample) && metadata_.size() < 4 * limits.frames) {
      metadata_.push_back({av_rescale_q(time_of(*packet_), stream->time_base, ns),
                           std::vector<unsigned char>(packet_->data, packet_->data + packet_->size)});
    }
    av_packet_unref(packet_);
    if (pts_.size() > limits.frames)
      return wrong("more than " + std::to_string(limits.frames) +
                   " frames; cut it into parts (ffmpeg -ss, -t), each with its own part of the sensor files");
  }
  if (pts_.empty()) return wrong("no frames in it; was the recording cut off?");
  std::sort(pts_.begin(), pts_.end());
  pts_.erase(std::unique(pts_.begin(), pts_.end()), pts_.end());
  for (const int64_t pts : pts_) times_ns_.push_back(av_rescale_q(pts, format_->streams[stream_]->time_base, ns));
  av_seek_frame(format_, stream_, pts_.front(), AVSEEK_FLAG_BACKWARD);
  return true;
}

/// Decodes the next frame; false at the end.
bool Video::next_frame() {
  for (;;) {
    av_frame_unref(decoded_);
    const int got = avcodec_receive_frame(codec_, decoded_);
    if (got == 0) return true;
    if (got != AVERROR(EAGAIN) || ended_) return false;
    if (av_read_frame(format_, packet_) < 0) {
      ended_ = true;
      avcodec_send_packet(codec_, nullptr);
      continue;
    }
    if (packet_->stream_index == stream_)
      avcodec_send_packet(codec_, packet_);  // a damaged packet costs only its own frames
    av_packet_unref(packet_);
  }
}

Result<bool> Video::decode_until(int64_t pts) {
  const auto at_most = [&](int64_t t) { return t != AV_NOPTS_VALUE && t <= pts; };
  const bool has_one = decoded_->data[0] != nullptr;
  const auto place = [&](int64_t t) { return std::lower_bound(pts_.begin(), pts_.end(), t) - pts_.begin(); };
  if (has_one && decoded_->best_effort_timestamp == pts) return true;
  const bool near = has_one && at_most(decoded_->best_effort_timestamp) &&
                    place(pts) - place(decoded_->best_effort_timestamp) < static_cast<std::ptrdiff_t>(kSeekAhead);
  const bool at_start = !has_one && !ended_ && place(pts) < static_cast<std::ptrdiff_t>(kSeekAhead);
  if (!near && !at_start) {
    if (av_seek_frame(format_, stream_, pts, AVSEEK_FLAG_BACKWARD) < 0) return wrong("cannot be searched");
    avcodec_flush_buffers(codec_);
    ended_ = false;
  }
  while (next_frame())
    if (decoded_->best_effort_timestamp >= pts) break;
  if (!decoded_->data[0] || decoded_->best_effort_timestamp != pts) return wrong("a frame cannot be decoded");
  return true;
}

Result<odo_frame> Video::load(uint64_t number, const odo_frame& head) {
  const std::lock_guard lock(mutex_);
  if (number >= pts_.size()) return wrong("no frame " + std::to_string(number));
  if (const auto found = decode_until(pts_[number]); !found) return found.failure();
  if (decoded_->width != static_cast<int>(width_) || decoded_->height != static_cast<int>(height_))
    return wrong("frame " + std::to_string(number) + " has another size");
  OwnedFrame held(av_frame_alloc());
  if (!held) return wrong("out of memory");
  uint32_t format = format_of(decoded_->format);
  if (format != 0) {
    if (av_frame_ref(held.get(), decoded_) < 0) return wrong("out of memory");
  } else {  // ten bits, other chroma
    held->format = AV_PIX_FMT_YUV420P;
    held->width = decoded_->width, held->height = decoded_->height;
    scaler_ = sws_getCachedContext(scaler_, decoded_->width, decoded_->height,
                                   static_cast<AVPixelFormat>(decoded_->format), decoded_->width, decoded_->height,
                                   AV_PIX_FMT_YUV420P, SWS_POINT, nullptr, nullptr, nullptr);
    if (!scaler_ || av_frame_get_buffer(held.get(), 0) < 0 ||
        sws_scale(scaler_, decoded_->data, decoded_->linesize, 0, decoded_->height, held->data, held->linesize) !=
            decoded_->height)
      return wrong("frame " + std::to_string(number) + " has pixels of an unknown kind");
    format = ODO_FORMAT_YUV420;
  }
  odo_frame frame = head;
  set_planes(frame, *held, format);
  set_loan(frame, std::move(held));
  return frame;
}

}  // namespace odograph
