// SPDX-License-Identifier: Apache-2.0
//
// Loads a recorded frame's picture from its file or store.
#include <cmath>
#include <cstring>
#include <fstream>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "sdk/tools/recording/frame_loan.hpp"
#include "sdk/tools/recording/picture_header.hpp"
#include "sdk/tools/recording/recording.hpp"

namespace odograph {
namespace fs = std::filesystem;

namespace {

constexpr uint64_t kLargestPicture = 1u << 30;
/// Without the EXIF rotation, because the lens parameters refer to the sensor's own orientation.
constexpr int kAsStored = cv::IMREAD_ANYCOLOR | cv::IMREAD_IGNORE_ORIENTATION;

cv::Mat decode(const PictureRef& picture) {
  std::error_code error;
  if (!picture.file || !fs::is_regular_file(*picture.file, error)) return {};  // a pipe would block
  if (picture.size == 0) return cv::imread(picture.file->string(), kAsStored);
  std::ifstream file(*picture.file, std::ios::binary);
  std::vector<uchar> bytes(picture.size);
  file.seekg(static_cast<std::streamoff>(picture.offset));
  file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (!file) return {};
  return cv::imdecode(bytes, kAsStored);
}

/// A copy of a store's picture in OpenCV's form: grey or BGR.
cv::Mat decode_stored(const RecordedMessage& recorded) {
  const auto frame =
      recorded.picture.store->load(recorded.picture.offset, copy_as<odo_frame>(recorded.message.header()));
  if (!frame) return {};
  const bool grey = frame->format != ODO_FORMAT_RGB8;  // a luma plane is grey
  const cv::Mat pixels(static_cast<int>(frame->height), static_cast<int>(frame->width), grey ? CV_8UC1 : CV_8UC3,
                       const_cast<uint8_t*>(frame->planes[0].data), static_cast<size_t>(frame->planes[0].row_stride));
  cv::Mat out;
  if (grey)
    out = pixels.clone();
  else
    cv::cvtColor(pixels, out, cv::COLOR_RGB2BGR);
  frame->loan.release(frame->loan.owner);
  return out;
}

/// Applies the picture's gamma and gain.
void relight(const PictureRef& picture, cv::Mat& image) {
  if (!picture.relit() || image.empty() || image.depth() != CV_8U) return;
  cv::Mat levels(1, 256, CV_8U);
  for (int g = 0; g < 256; ++g)
    levels.at<uchar>(g) =
        cv::saturate_cast<uchar>(2.55 * picture.gain_percent * std::pow(g / 255.0, picture.gamma_percent / 100.0));
  cv::LUT(image, levels, image);
}

/// The bytes of a picture's file; empty if the picture has no separate file or must be modified.
std::vector<unsigned char> picture_file(const PictureRef& picture) {
  std::error_code error;
  if (picture.relit()) return {};
  if (picture.store) return picture.store->encoded(picture.offset);
  if (!picture.file || !fs::is_regular_file(*picture.file, error)) return {};
  const uint64_t size = picture.size > 0 ? picture.size : fs::file_size(*picture.file, error);
  if (error || size < 8 || size > kLargestPicture) return {};
  std::vector<unsigned char> bytes(size);
  std::ifstream file(*picture.file, std::ios::binary);
  file.seekg(static_cast<std::streamoff>(picture.offset));
  return file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size))
             ? bytes
             : std::vector<unsigned char>();
}

}  // namespace

std::vector<unsigned char> encoded_picture(const PictureRef& picture) {
  auto bytes = picture_file(picture);
  if (bytes.size() < 8) return {};
  const bool is_png = std::memcmp(bytes.data(), "\x89PNG\r\n\x1a\n", 8) == 0;
  const bool is_jpeg = bytes[0] == 0xFF && bytes[1] == 0xD8 && bytes[2] == 0xFF;
  return is_png || is_jpeg ? bytes : std::vector<unsigned char>();
}

Result<odo_frame> load_frame(const RecordedMessage& recorded) {
  const PictureRef& picture = recorded.picture;
  if (picture.store && !picture.relit())
    return picture.store->load(picture.offset, copy_as<odo_frame>(recorded.message.header()));
  const std::string name = picture.file ? picture.file->string() : "no file";
  std::error_code error;
  if (picture.file && fs::is_regular_file(*picture.file, error))
    if (const auto size = picture_size(*picture.file, picture.offset); !size) return size.failure();
  cv::Mat image;
  try {
    image = picture.store ? decode_stored(recorded) : decode(picture);
  } catch (const std::exception& thrown) {
    return Failure{ODO_E_DATA, name + ": " + thrown.what()};
  }
  relight(picture, image);
  return borrow_image(image, copy_as<odo_frame>(recorded.message.header()), name);
}

Result<odo_frame> borrow_image(cv::Mat image, const odo_frame& head, const std::string& name) {
  if (image.empty() || image.depth() != CV_8U)
    return Failure{ODO_E_DATA, name + ": the picture cannot be read as 8-bit grey or colour"};
  if (image.channels() != 1) {
    cv::Mat rgb;
    cv::cvtColor(image, rgb, image.channels() == 4 ? cv::COLOR_BGRA2RGB : cv::COLOR_BGR2RGB);
    image = rgb;
  }
  odo_frame frame = head;
  frame.width = static_cast<uint32_t>(image.cols);
  frame.height = static_cast<uint32_t>(image.rows);
  frame.format = image.channels() == 1 ? ODO_FORMAT_GREY8 : ODO_FORMAT_RGB8;
  frame.plane_count = 1;
  frame.planes[0] = {image.data, static_cast<int64_t>(image.step[0]), static_cast<uint32_t>(image.channels()), 0};
  set_loan(frame, image);
  return frame;
}

}  // namespace odograph
