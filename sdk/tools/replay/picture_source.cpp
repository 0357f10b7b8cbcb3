// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/replay/picture_source.hpp"

#include <algorithm>
#include <filesystem>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "sdk/math/time.hpp"
#include "sdk/tools/recording/recording.hpp"
#include "sdk/tools/recording/video.hpp"

namespace odograph {
namespace {

namespace fs = std::filesystem;

constexpr int64_t kBetween_ns = 300'000'000;

bool ends_as(const fs::path& file, std::initializer_list<const char*> endings) {
  std::string ending = file.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
  return std::find(endings.begin(), endings.end(), ending) != endings.end();
}
bool is_picture(const fs::path& file) {
  return ends_as(file, {".png", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff", ".pgm", ".ppm", ".webp"});
}
bool is_video(const fs::path& file) { return ends_as(file, {".mp4", ".mov", ".m4v", ".avi", ".mkv", ".webm", ".3gp"}); }

/// As stored: the EXIF rotation is ignored, because the lens parameters refer to the sensor's orientation.
PictureSource of_file(const fs::path& file) {
  return {file.filename().string(), [file] {
            try {
              return cv::imread(file.string(), cv::IMREAD_GRAYSCALE | cv::IMREAD_IGNORE_ORIENTATION);
            } catch (const cv::Exception&) {
              return cv::Mat();
            }
          }};
}

std::vector<PictureSource> of_folder(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error))
    if (entry.is_regular_file(error) && is_picture(entry.path())) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  std::vector<PictureSource> sources;
  for (const fs::path& file : files) sources.push_back(of_file(file));
  return sources;
}

cv::Mat load_grey(const Result<odo_frame>& frame) {
  if (!frame) return {};
  const cv::Mat grey = grey_of(*frame);
  frame->loan.release(frame->loan.owner);
  return grey;
}

Result<std::vector<PictureSource>> of_recording(const std::string& path) {
  auto read = read_recording(path);
  if (!read) return read.failure();
  const auto recording = std::make_shared<const Recording>(std::move(*read));
  std::vector<PictureSource> sources;
  int64_t last_ns = INT64_MIN / 2;
  for (size_t i = 0; i < recording->messages.size(); ++i) {
    const odo_header& header = recording->messages[i].message.header();
    if (header.type != ODO_TYPE_FRAME || header.t_ns - last_ns < kBetween_ns) continue;
    last_ns = header.t_ns;
    sources.push_back({"frame at " + std::to_string(header.t_ns) + " ns",
                       [recording, i] { return load_grey(load_frame(recording->messages[i])); }});
  }
  return sources;
}

Result<std::vector<PictureSource>> of_video(const std::string& path) {
  const auto video = Video::open(path);
  if (!video) return video.failure();
  std::vector<PictureSource> sources;
  int64_t last_ns = INT64_MIN / 2;
  for (size_t i = 0; i < (*video)->times_ns().size(); ++i) {
    if ((*video)->times_ns()[i] - last_ns < kBetween_ns) continue;
    last_ns = (*video)->times_ns()[i];
    sources.push_back({"frame " + std::to_string(i), [video = *video, i] { return load_grey(video->load(i, {})); }});
  }
  return sources;
}

}  // namespace

cv::Mat grey_of(const odo_frame& frame) {
  const bool colour = frame.format == ODO_FORMAT_RGB8;
  const cv::Mat pixels(static_cast<int>(frame.height), static_cast<int>(frame.width), colour ? CV_8UC3 : CV_8U,
                       const_cast<uint8_t*>(frame.planes[0].data), static_cast<size_t>(frame.planes[0].row_stride));
  cv::Mat grey;
  if (colour)
    cv::cvtColor(pixels, grey, cv::COLOR_RGB2GRAY);
  else
    grey = pixels.clone();  // grey, or a video's luma
  return grey;
}

Result<std::vector<PictureSource>> pictures_of(const std::string& path) {
  std::error_code error;
  if (!fs::exists(path, error)) return Failure{ODO_E_NOT_FOUND, path + ": does not exist"};
  if (is_picture(path)) return std::vector<PictureSource>{of_file(path)};
  if (is_video(path)) return of_video(path);
  if (fs::is_directory(path, error))
    if (auto sources = of_folder(path); !sources.empty()) return sources;
  auto sources = of_recording(path);
  if (sources && sources->empty()) return Failure{ODO_E_DATA, path + ": contains no pictures"};
  return sources;
}

Result<TrackFigures> measure_corner_flow(const Recording& recording, size_t most,
                                         const std::function<void(size_t done, size_t all)>& progress) {
  odo_calibration calibration{};
  std::vector<const RecordedMessage*> frames;
  for (const auto& m : recording.messages) {
    if (m.message.header().type == ODO_TYPE_CALIBRATION) calibration = as<odo_calibration>(m.message.header());
    if (m.message.header().type == ODO_TYPE_FRAME && frames.size() < most) frames.push_back(&m);
  }
  if (frames.size() < 10 || calibration.fx <= 0)
    return Failure{ODO_E_DATA, recording.path.string() + ": needs ten frames and a calibration"};
  CornerFlowStatistics follower(frames.size());
  for (size_t i = 0; i < frames.size(); ++i) {
    if (progress) progress(i, frames.size());
    const auto frame = load_frame(*frames[i]);
    if (!frame) return frame.failure();
    follower.add(grey_of(*frame), calibration);
    frame->loan.release(frame->loan.owner);
  }
  follower.finish();
  const auto span_ns = frames.back()->message.header().t_ns - frames.front()->message.header().t_ns;
  follower.figures.rate_hz = static_cast<double>(frames.size() - 1) / std::max(1e-9, seconds(span_ns));
  return std::move(follower.figures);
}

}  // namespace odograph
