// SPDX-License-Identifier: Apache-2.0
#include "tests/recordings/phone/video_file.hpp"

#include <fstream>
#include <sstream>

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/opt.h>
}

#include "tests/support/support.hpp"

namespace {

constexpr int kTimeScale = 90000;

int64_t ticks_of(int64_t t_ns) { return (t_ns * kTimeScale + 500'000'000) / 1'000'000'000; }

/// Moves packets from the encoder to the file.
bool drain(AVFormatContext* out, AVCodecContext* encoder, AVStream* stream, AVPacket* packet) {
  while (avcodec_receive_packet(encoder, packet) == 0) {
    packet->duration = kTimeScale / 30;  // without it the file ends before its last frame is shown
    av_packet_rescale_ts(packet, encoder->time_base, stream->time_base);
    packet->stream_index = stream->index;
    if (av_interleaved_write_frame(out, packet) < 0) return false;
  }
  return true;
}

void fill(AVFrame* frame, const cv::Mat& picture) {
  for (int row = 0; row < picture.rows; ++row)
    std::copy_n(picture.ptr(row), picture.cols, frame->data[0] + row * frame->linesize[0]);
  for (int plane : {1, 2})
    for (int row = 0; row < (picture.rows + 1) / 2; ++row)
      std::fill_n(frame->data[plane] + row * frame->linesize[plane], (picture.cols + 1) / 2, uint8_t(128));
}

/// A box of an ISO base media file: size, name, content.
std::string box(const std::string& name, const std::string& content) {
  const auto size = static_cast<uint32_t>(8 + content.size());
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(size >> shift & 0xFF);
  return bytes + name + content;
}
std::string big(uint64_t value, int bytes) {
  std::string text;
  for (int i = bytes - 1; i >= 0; --i) text += static_cast<char>(value >> (8 * i) & 0xFF);
  return text;
}
uint32_t size_at(const std::string& bytes, size_t at) {
  uint32_t size = 0;
  for (size_t i = 0; i < 4; ++i) size = size << 8 | static_cast<unsigned char>(bytes[at + i]);
  return size;
}

/// The track's description: samples are consecutive from `offset` on.
std::string track_of(const std::vector<std::pair<int64_t, int64_t>>& samples, size_t offset) {
  const auto zeros = [](int n) { return std::string(static_cast<size_t>(n), '\0'); };
  const std::string key = "sensor_logger.epoch_timestamp";
  const std::string keys = box("keys", box(big(1, 4), box("keyd", "mdta" + key) + box("dtyp", big(0, 4) + big(74, 4))));
  std::string deltas, sizes;
  uint64_t duration = 0;
  for (size_t i = 0; i < samples.size(); ++i) {
    const int64_t next = i + 1 < samples.size() ? samples[i + 1].first : samples[i].first + 33'333'333;
    const auto delta = static_cast<uint64_t>(ticks_of(next) - ticks_of(samples[i].first));
    deltas += big(1, 4) + big(delta, 4), sizes += big(16, 4), duration += delta;
  }
  const uint64_t count = samples.size();
  const std::string matrix = big(0x10000, 4) + zeros(12) + big(0x10000, 4) + zeros(12) + big(0x40000000, 4);
  const std::string table = box("stsd", zeros(4) + big(1, 4) + box("mebx", zeros(6) + big(1, 2) + keys)) +
                            box("stts", zeros(4) + big(count, 4) + deltas) +
                            box("stsc", zeros(4) + big(1, 4) + big(1, 4) + big(count, 4) + big(1, 4)) +
                            box("stsz", zeros(8) + big(count, 4) + sizes) +
                            box("stco", zeros(4) + big(1, 4) + big(offset, 4));
  const std::string media =
      box("mdhd", zeros(12) + big(kTimeScale, 4) + big(duration, 4) + big(0x55C4, 2) + zeros(2)) +
      box("hdlr", zeros(4) + "mhlrmeta" + zeros(12) + zeros(1)) +
      box("minf", box("gmhd", box("gmin", zeros(4) + big(0x40, 2) + big(0x8000, 2) + big(0x8000, 2) + big(0x8000, 2) +
                                              zeros(4))) +
                      box("dinf", box("dref", zeros(4) + big(1, 4) + box("url ", big(1, 4)))) + box("stbl", table));
  return box("trak", box("tkhd", big(0xF, 4) + zeros(8) + big(2, 4) + zeros(4) + big(duration * 1000 / kTimeScale, 4) +
                                     zeros(16) + matrix + zeros(8)) +
                         box("mdia", media));
}

}  // namespace

bool write_video(const std::filesystem::path& file, const std::vector<cv::Mat>& pictures,
                 const std::vector<int64_t>& times_ns, int quality) {
  av_log_set_level(AV_LOG_QUIET);
  AVFormatContext* out = nullptr;
  const AVCodec* codec = avcodec_find_encoder_by_name("libx264");
  if (!codec || avformat_alloc_output_context2(&out, nullptr, nullptr, file.c_str()) < 0) return false;
  AVStream* stream = avformat_new_stream(out, nullptr);
  AVCodecContext* encoder = avcodec_alloc_context3(codec);
  encoder->width = pictures.front().cols, encoder->height = pictures.front().rows;
  encoder->pix_fmt = AV_PIX_FMT_YUV420P;
  encoder->time_base = stream->time_base = {1, kTimeScale};
  encoder->gop_size = 30, encoder->max_b_frames = 2;  // display order differs from storage order
  encoder->thread_count = 1;
  if (out->oformat->flags & AVFMT_GLOBALHEADER) encoder->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
  av_opt_set(encoder->priv_data, quality == 0 ? "qp" : "crf", std::to_string(quality).c_str(), 0);
  av_opt_set(encoder->priv_data, "preset", "veryfast", 0);
  bool good = avcodec_open2(encoder, codec, nullptr) >= 0 &&
              avcodec_parameters_from_context(stream->codecpar, encoder) >= 0 &&
              avio_open(&out->pb, file.c_str(), AVIO_FLAG_WRITE) >= 0 && avformat_write_header(out, nullptr) >= 0;
  AVPacket* packet = av_packet_alloc();
  AVFrame* frame = av_frame_alloc();
  frame->format = encoder->pix_fmt, frame->width = encoder->width, frame->height = encoder->height;
  good = good && av_frame_get_buffer(frame, 0) >= 0;
  for (size_t i = 0; good && i < pictures.size(); ++i) {
    good = av_frame_make_writable(frame) >= 0;
    fill(frame, pictures[i]);
    frame->pts = ticks_of(times_ns[i] - times_ns[0]);
    good = good && avcodec_send_frame(encoder, frame) >= 0 && drain(out, encoder, stream, packet);
  }
  good = good && avcodec_send_frame(encoder, nullptr) >= 0 && drain(out, encoder, stream, packet) &&
         av_write_trailer(out) >= 0;
  av_frame_free(&frame), av_packet_free(&packet), avcodec_free_context(&encoder);
  avio_closep(&out->pb), avformat_free_context(out);
  return good;
}

void add_metadata_track(const std::filesystem::path& file, const std::vector<std::pair<int64_t, int64_t>>& samples) {
  std::string bytes = read_text(file);
  size_t moov = 0;
  while (moov + 8 <= bytes.size() && bytes.substr(moov + 4, 4) != "moov") moov += size_at(bytes, moov);
  const std::string movie = bytes.substr(moov + 8, size_at(bytes, moov) - 8);
  std::string data;
  for (const auto& [moment, unix_ns] : samples) data += big(16, 4) + big(1, 4) + big(static_cast<uint64_t>(unix_ns), 8);
  const size_t offset = moov + 8;  // of the first sample, behind the head of its box
  write_text(file, bytes.substr(0, moov) + box("mdat", data) + box("moov", movie + track_of(samples, offset)));
}
