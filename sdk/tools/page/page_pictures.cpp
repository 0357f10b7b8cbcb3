// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/page/page_pictures.hpp"

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "sdk/tools/page/run_page.hpp"
#include "sdk/tools/replay/picture_source.hpp"

namespace odograph {

std::string base64(const std::vector<unsigned char>& bytes) {
  static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (size_t i = 0; i < bytes.size(); i += 3) {
    const auto byte = [&](size_t k) { return i + k < bytes.size() ? uint32_t(bytes[i + k]) : 0; };
    const uint32_t three = byte(0) << 16 | byte(1) << 8 | byte(2);
    for (int k = 0; k < 4; ++k)
      out += i + static_cast<size_t>(k) <= bytes.size() ? kDigits[three >> (18 - 6 * k) & 63] : '=';
  }
  return out;
}

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
  cv::Mat grey = grey_of(*frame);
  frame->loan.release(frame->loan.owner);
  std::vector<unsigned char> jpeg;
  if (grey.empty()) return jpeg;
  if (grey.cols > width) cv::resize(grey, grey, {width, grey.rows * width / grey.cols}, 0, 0, cv::INTER_AREA);
  cv::imencode(".jpg", grey, jpeg, {cv::IMWRITE_JPEG_QUALITY, 70});
  return jpeg;
}

std::vector<unsigned char> picture_of(const Recording& recording, size_t number, int width) {
  const auto frames = frames_of(recording, camera_of(recording));
  return number < frames.size() ? jpeg_of(*frames[number], width) : std::vector<unsigned char>();
}

}  // namespace odograph
