// SPDX-License-Identifier: Apache-2.0
//
// Augmented reality with the C API: a metre grid on the ground, the path walked, and anchors with names and distances,
// drawn over the pictures of a recording or a camera, as a video and as pictures.
//
//   ar_overlay samples/configs/walk.yaml walk.odo -o walk.mp4 --drop "9:Bakery:2.2,-0.6,8" --picture 14:street.png
#include <chrono>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>

#include <odograph/map.h>
#include <odograph/recording.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "scene.hpp"

namespace {

/// Pushes pictures and draws the overlay on them.
class App {
 public:
  App(odo_session* session, const Options& options)
      : session_(session), options_(options), scene_(session, options), taken_(options.pictures.size(), false) {}

  void calibrate(const odo_calibration& lens) { lens_ = lens; }

  /// The app lends the picture for the call only, so the library copies it.
  bool show(const cv::Mat& picture, odo_frame frame) {
    frame.format = picture.channels() == 1 ? ODO_FORMAT_GREY8 : ODO_FORMAT_RGB8;
    cv::Mat rgb;
    if (picture.channels() == 3)
      cv::cvtColor(picture, rgb, cv::COLOR_BGR2RGB);
    else
      rgb = picture;
    frame.width = static_cast<uint32_t>(rgb.cols), frame.height = static_cast<uint32_t>(rgb.rows);
    frame.planes[0].data = rgb.data;
    frame.planes[0].row_stride = static_cast<int64_t>(rgb.step);
    frame.planes[0].pixel_stride = static_cast<uint32_t>(rgb.channels());
    frame.loan.owner = nullptr, frame.loan.retain = nullptr, frame.loan.release = nullptr;
    odo_session_push(session_, &frame.header);
    const int64_t t_ns = frame.header.t_ns;
    if (first_ns_ == INT64_MIN) first_ns_ = t_ns;
    const double seconds = static_cast<double>(t_ns - first_ns_) * 1e-9;
    scene_.put_up(t_ns, seconds);
    return draw(picture, t_ns, seconds);
  }

  int frames() const { return frames_; }

 private:
  bool draw(const cv::Mat& picture, int64_t t_ns, double seconds) {
    ++frames_;
    const bool filmed = !options_.video.empty();
    bool wanted = filmed;
    for (size_t i = 0; i < taken_.size(); ++i) wanted = wanted || (!taken_[i] && seconds >= options_.pictures[i].at_s);
    if (!wanted) return seconds < options_.for_s;
    Canvas canvas(picture, lens_, options_.factor);
    scene_.draw(canvas, t_ns);
    for (size_t i = 0; i < taken_.size(); ++i) {
      if (taken_[i] || seconds < options_.pictures[i].at_s) continue;
      taken_[i] = true;
      if (!cv::imwrite(options_.pictures[i].file, canvas.picture()))
        std::fprintf(stderr, "ar_overlay: cannot write %s\n", options_.pictures[i].file.c_str());
    }
    if (filmed) film(canvas.picture(), t_ns);
    return seconds < options_.for_s;
  }

  /// The video starts with the second picture, whose interval from the first gives the frame rate.
  void film(const cv::Mat& picture, int64_t t_ns) {
    if (!video_.isOpened() && last_ns_ != INT64_MIN && t_ns > last_ns_)
      video_.open(options_.video, cv::VideoWriter::fourcc('m', 'p', '4', 'v'),
                  1e9 / static_cast<double>(t_ns - last_ns_), picture.size());
    last_ns_ = t_ns;
    if (video_.isOpened()) video_.write(picture);
  }

  odo_session* session_;
  const Options& options_;
  Scene scene_;
  odo_calibration lens_{};
  cv::VideoWriter video_;
  std::vector<bool> taken_;
  int64_t first_ns_ = INT64_MIN, last_ns_ = INT64_MIN;
  int frames_ = 0;
};

bool replay(odo_session* session, const Options& options, App& app) {
  odo_recording* recording = nullptr;
  odo_error error{};
  error.struct_size = sizeof error;
  const odo_string path{options.recording.data(), options.recording.size()};
  if (odo_recording_open(&path, &recording, &error) != ODO_OK)
    return std::fprintf(stderr, "ar_overlay: %s\n", error.message), false;
  const odo_header* message = nullptr;
  const void* encoded = nullptr;
  uint64_t size = 0;
  bool goes_on = true;
  int32_t status = ODO_OK;
  while (goes_on && (status = odo_recording_next(recording, &message, &encoded, &size)) != ODO_END) {
    if (status == ODO_E_DATA) continue;  // a damaged record costs only itself; odo_recording_loss counts it
    if (status != ODO_OK) break;
    if (ODO_IS_EVENT(message->type)) continue;
    if (message->type == ODO_TYPE_CALIBRATION) {
      odo_calibration lens;
      odo_copy(&lens, sizeof lens, message);
      app.calibrate(lens);
    }
    if (message->type != ODO_TYPE_FRAME) {
      odo_session_push(session, message);
      continue;
    }
    odo_frame frame;
    odo_copy(&frame, sizeof frame, message);
    frame.header.struct_size = sizeof frame;
    const cv::Mat bytes(1, static_cast<int>(size), CV_8U, const_cast<void*>(encoded));
    const cv::Mat picture = encoded ? cv::imdecode(bytes, cv::IMREAD_ANYCOLOR) : cv::Mat();
    if (!picture.empty()) goes_on = app.show(picture, frame);
  }
  error.struct_size = sizeof error;
  if (odo_recording_loss(recording, &error) == ODO_OK && error.status != ODO_OK)
    std::fprintf(stderr, "ar_overlay: %s: %s\n", options.recording.c_str(), error.message);
  odo_recording_close(recording);
  return status == ODO_OK || status == ODO_END;
}

/// A file that is not there is an empty map.
bool read_map(odo_session* session, const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (path.empty() || !file) return true;
  const std::string data{std::istreambuf_iterator<char>(file), {}};
  if (odo_map_load(session, data.data(), data.size()) == ODO_OK) return true;
  odo_error error{};
  error.struct_size = sizeof error;
  odo_session_last_error(session, &error);
  return std::fprintf(stderr, "ar_overlay: %s: %s\n", path.c_str(), error.message), false;
}

bool write_map(odo_session* session, const std::string& path) {
  std::string data;
  for (int64_t size; (size = odo_map_save(session, data.data(), data.size())) > static_cast<int64_t>(data.size());)
    data.resize(static_cast<size_t>(size));
  if (data.empty()) return std::fprintf(stderr, "ar_overlay: no map: has the config fix/map?\n"), false;
  std::ofstream file(path, std::ios::binary);
  if (file.write(data.data(), static_cast<std::streamsize>(data.size())).flush()) return true;
  return std::fprintf(stderr, "ar_overlay: cannot write %s\n", path.c_str()), false;
}

/// A camera without an inertial sensor: no metric scale unless the config's front-end or steps give one.
bool live(const Options& options, App& app) {
  cv::VideoCapture camera(options.camera, cv::CAP_V4L2);
  if (!camera.isOpened()) return std::fprintf(stderr, "ar_overlay: no camera %d\n", options.camera), false;
  odo_calibration lens{};
  lens.width = static_cast<uint32_t>(camera.get(cv::CAP_PROP_FRAME_WIDTH));
  lens.height = static_cast<uint32_t>(camera.get(cv::CAP_PROP_FRAME_HEIGHT));
  lens.fx = lens.fy = 0.8 * lens.width;  // typical for a webcam; the config's camera.yaml takes precedence
  lens.cx = (lens.width - 1) / 2.0, lens.cy = (lens.height - 1) / 2.0;
  app.calibrate(lens);
  cv::Mat picture;
  bool goes_on = true;
  while (goes_on && camera.read(picture)) {
    odo_frame frame{};
    frame.header.struct_size = sizeof frame;
    frame.header.type = ODO_TYPE_FRAME;
    frame.header.t_ns = std::chrono::steady_clock::now().time_since_epoch().count();
    goes_on = app.show(picture, frame);
  }
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  if (!read_options(argc, argv, options)) return 2;
  odo_session_options o{};
  o.struct_size = sizeof o;
  o.run = options.camera < 0 ? ODO_RUN_REPLAY : ODO_RUN_LIVE;
  o.config_path = {options.config.data(), options.config.size()};
  odo_session* session = nullptr;
  odo_error error{};
  error.struct_size = sizeof error;
  if (odo_session_create(&o, &session, &error) != ODO_OK) return std::fprintf(stderr, "%s\n", error.message), 2;
  int frames = 0;
  bool done = read_map(session, options.map);
  if (done) {
    App app(session, options);
    done = options.camera < 0 ? replay(session, options, app) : live(options, app);
    frames = app.frames();
    if (!options.map.empty()) done = write_map(session, options.map) && done;
  }
  odo_statistics statistics{};
  statistics.struct_size = sizeof statistics;
  odo_session_get_statistics(session, &statistics);
  std::printf("%d pictures, %lld anchors, walked %.1f m, tracking for %.1f s\n", frames,
              static_cast<long long>(odo_anchor_list(session, nullptr, 0)), statistics.distance_m,
              statistics.tracking_s);
  odo_session_destroy(session);
  return done && frames > 0 ? 0 : 1;
}
