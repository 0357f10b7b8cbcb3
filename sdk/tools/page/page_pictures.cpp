// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/page/page_pictures.hpp"

extern "C" {
#include <libavutil/base64.h>
}
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "sdk/tools/page/run_page.hpp"
#include "sdk/tools/replay/picture_source.hpp"

namespace odograph {

std::string base64(const std::vector<unsigned char>& bytes) {
  std::string out(AV_BASE64_SIZE(bytes.size()), '\0');
  av_base64_encode(out.data(), static_cast<int>(out.size()), bytes.data(), static_cast<int>(bytes.size()));
  out.pop_back();  // removes the terminating NUL
  return out;
}

namespace {

/// A plane's bytes, `width` per row.
cv::Mat plane(const odo_frame& f, size_t i, uint32_t width, uint32_t height, int type) {
  return {static_cast<int>(height), static_cast<int>(width), type, const_cast<uint8_t*>(f.planes[i].data),
          static_cast<size_t>(f.planes[i].row_stride)};
}

/// In colour if the camera has it.
cv::Mat bgr_of(const odo_frame& f) {
  cv::Mat out;
  const uint32_t w = f.width, h = f.height, half_w = (w + 1) / 2, half_h = (h + 1) / 2;
  if (f.format == ODO_FORMAT_RGB8 && f.planes[0].pixel_stride == 3) {
    cv::cvtColor(plane(f, 0, w, h, CV_8UC3), out, cv::COLOR_RGB2BGR);
  } else if ((f.format == ODO_FORMAT_NV12 || f.format == ODO_FORMAT_NV21) && w % 2 == 0 && h % 2 == 0) {
    cv::cvtColorTwoPlane(plane(f, 0, w, h, CV_8UC1), plane(f, 1, half_w, half_h, CV_8UC2), out,
                         f.format == ODO_FORMAT_NV12 ? cv::COLOR_YUV2BGR_NV12 : cv::COLOR_YUV2BGR_NV21);
  } else if (f.format == ODO_FORMAT_YUV420 && w % 2 == 0 && h % 2 == 0 && f.planes[1].pixel_stride == 1) {
    cv::Mat pair;
    cv::merge(std::vector<cv::Mat>{plane(f, 1, half_w, half_h, CV_8UC1), plane(f, 2, half_w, half_h, CV_8UC1)}, pair);
    cv::cvtColorTwoPlane(plane(f, 0, w, h, CV_8UC1), pair, out, cv::COLOR_YUV2BGR_NV12);
  } else {
    out = grey_of(f);
  }
  return out;
}

}  // namespace

const odo_calibration* camera_of(const Recording& recording) {
  for (const RecordedMessage& m : recording.messages)
    if (m.message.header().type == ODO_TYPE_CALIBRATION) return &as<odo_calibration>(m.message.header());
  return nullptr;
}

std::vector<const RecordedMessage*> frames_of(const Recording& recording, const odo_calibration* camera) {
  std::vector<const RecordedMessage*> frames;
  for (const RecordedMessage& m : recording.messages)
    if (m.message.header().type == ODO_TYPE_FRAME && (!camera || m.message.header().source == camera->header.source))
      frames.push_back(&m);
  return frames;
}

std::vector<unsigned char> jpeg_of(const RecordedMessage& message, int width) {
  const auto frame = load_frame(message);
  if (!frame) return {};
  cv::Mat picture = bgr_of(*frame);
  frame->loan.release(frame->loan.owner);
  std::vector<unsigned char> jpeg;
  if (picture.empty()) return jpeg;
  if (picture.cols > width)
    cv::resize(picture, picture, {width, picture.rows * width / picture.cols}, 0, 0, cv::INTER_AREA);
  cv::imencode(".jpg", picture, jpeg, {cv::IMWRITE_JPEG_QUALITY, 70});
  return jpeg;
}

std::vector<unsigned char> picture_of(const Recording& recording, size_t number, int width) {
  const auto frames = frames_of(recording, camera_of(recording));
  return number < frames.size() ? jpeg_of(*frames[number], width) : std::vector<unsigned char>();
}

}  // namespace odograph
