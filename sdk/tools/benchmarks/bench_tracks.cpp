// SPDX-License-Identifier: Apache-2.0
//
// `odograph bench tracks`: how well corners can be followed through the pictures of recordings, real beside simulated.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "sdk/tools/benchmarks/benchmarks.hpp"
#include "sdk/tools/console/console.hpp"
#include "sdk/tools/evaluation/excitation.hpp"
#include "sdk/tools/plot/plot.hpp"
#include "sdk/tools/recording/recording.hpp"
#include "sdk/tools/replay/picture_source.hpp"
#include "sdk/tools/replay/runner.hpp"

namespace odograph {
namespace {

struct TrackArguments {
  std::vector<std::string> recordings;
  std::string plot, config = "samples/configs/monocular_odograph.yaml";
  size_t frames = 200;
  bool excitation_only = false;
};

struct TrackFigures {
  std::vector<double> lengths;  ///< frames, of corners first seen in the first half
  std::vector<double> inliers;  ///< of each pair of frames, part of the followed corners that one motion explains
  std::vector<double> flow_px;  ///< of each pair, median
  std::vector<double> kept;     ///< of each pair, part of the corners that were found again
  size_t frames = 0;
  double rate_hz = 0;
};

constexpr int kCorners = 400;

/// Pixels to rays at depth 1, by the recording's own calibration.
std::vector<cv::Point2f> rays_of(const std::vector<cv::Point2f>& pixels, const odo_calibration& c) {
  const cv::Matx33d K(c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1);
  const std::vector<double> distortion(c.distortion, c.distortion + c.distortion_count);
  std::vector<cv::Point2f> rays;
  if (pixels.empty()) return rays;
  if (c.model == ODO_CAMERA_KANNALA_BRANDT)
    cv::fisheye::undistortPoints(pixels, rays, K, cv::Mat(distortion, true));
  else
    cv::undistortPoints(pixels, rays, K, distortion);
  return rays;
}

/// Follows corners with pyramidal Lucas-Kanade, forwards and back.
class Follower {
 public:
  explicit Follower(size_t frames_in_all) : half_(frames_in_all / 2) {}

  void add(const cv::Mat& picture, const odo_calibration& calibration) {
    if (!before_.empty()) follow(picture, calibration);
    refill(picture);
    before_ = picture;
    ++figures.frames;
  }
  void finish() {
    for (const size_t birth : births_) end(birth);
  }

  TrackFigures figures;

 private:
  void end(size_t birth) {
    if (birth < half_) figures.lengths.push_back(static_cast<double>(figures.frames - birth));
  }

  void follow(const cv::Mat& picture, const odo_calibration& calibration) {
    std::vector<cv::Point2f> there, back;
    std::vector<uint8_t> found, found_back;
    std::vector<float> error;
    if (corners_.empty()) return;
    cv::calcOpticalFlowPyrLK(before_, picture, corners_, there, found, error, {21, 21}, 4);
    cv::calcOpticalFlowPyrLK(picture, before_, there, back, found_back, error, {21, 21}, 4);
    std::vector<cv::Point2f> from, to;
    std::vector<size_t> births;
    std::vector<double> flow;
    for (size_t i = 0; i < corners_.size(); ++i) {
      const cv::Point2f p = there[i];
      const bool inside = p.x >= 2 && p.y >= 2 && p.x < static_cast<float>(picture.cols - 2) &&
                          p.y < static_cast<float>(picture.rows - 2);
      if (!found[i] || !found_back[i] || !inside || cv::norm(back[i] - corners_[i]) > 0.7) {
        end(births_[i]);
        continue;
      }
      from.push_back(corners_[i]), to.push_back(p), births.push_back(births_[i]);
      flow.push_back(cv::norm(p - corners_[i]));
    }
    figures.kept.push_back(static_cast<double>(to.size()) / static_cast<double>(corners_.size()));
    if (to.size() >= 20) {
      cv::Mat inliers;
      cv::findEssentialMat(rays_of(from, calibration), rays_of(to, calibration), cv::Mat::eye(3, 3, CV_64F), cv::RANSAC,
                           0.999, 1.0 / calibration.fx, inliers);
      figures.inliers.push_back(cv::countNonZero(inliers) / static_cast<double>(to.size()));
      figures.flow_px.push_back(percentile(flow, 0.5));
    }
    corners_ = std::move(to), births_ = std::move(births);
  }

  void refill(const cv::Mat& picture) {
    const int missing = kCorners - static_cast<int>(corners_.size());
    if (missing < kCorners / 10) return;
    cv::Mat free(picture.size(), CV_8U, cv::Scalar(255));
    for (const cv::Point2f& p : corners_) cv::circle(free, p, 10, 0, cv::FILLED);
    std::vector<cv::Point2f> fresh;
    cv::goodFeaturesToTrack(picture, fresh, missing, 0.01, 10, free);
    for (const cv::Point2f& p : fresh) corners_.push_back(p), births_.push_back(figures.frames);
  }

  const size_t half_;
  cv::Mat before_;
  std::vector<cv::Point2f> corners_;
  std::vector<size_t> births_;
};

Result<TrackFigures> figures_of(const std::string& file, size_t most) {
  const auto recording = open_recording(file);
  if (!recording) return recording.failure();
  odo_calibration calibration{};
  std::vector<const RecordedMessage*> frames;
  for (const auto& m : recording->messages) {
    if (m.message.header().type == ODO_TYPE_CALIBRATION) calibration = as<odo_calibration>(m.message.header());
    if (m.message.header().type == ODO_TYPE_FRAME && frames.size() < most) frames.push_back(&m);
  }
  if (frames.size() < 10 || calibration.fx <= 0)
    return Failure{ODO_E_DATA, file + ": needs ten frames and a calibration"};
  Progress progress(file);
  Follower follower(frames.size());
  for (size_t i = 0; i < frames.size(); ++i) {
    progress.show(i, frames.size());
    const auto frame = load_frame(*frames[i]);
    if (!frame) return frame.failure();
    follower.add(grey_of(*frame), calibration);
    frame->release(&*frame);
  }
  follower.finish();
  const auto span = frames.back()->message.header().t_ns - frames.front()->message.header().t_ns;
  follower.figures.rate_hz = static_cast<double>(frames.size() - 1) / std::max(1e-9, static_cast<double>(span) * 1e-9);
  return std::move(follower.figures);
}

constexpr double kWindows_s[] = {4, 8};

std::string name_of(std::string file) {
  while (file.size() > 1 && file.back() == '/') file.pop_back();
  return std::filesystem::path(file).filename().string();
}

/// S, N and the pull of each recording that has truth, in a table of their own.
Result<bool> print_excitation(const TrackArguments& a) {
  std::error_code error;
  const bool with_error = std::filesystem::exists(a.config, error);
  std::printf(
      "\nS: true motion about the quadratic in time that fits a window best, rms; N: error of %s after Sim(3) in that\n"
      "window, about a quadratic too, rms. Medians over windows that overlap by half, standing ones left out.\n"
      "Pull: S^2 / (S^2 + N^2).\n\n",
      a.config.c_str());
  if (!with_error)
    std::printf("%s: no such file (run from the source folder, or say where), so there is no N.\n\n", a.config.c_str());
  std::printf("%-34s", "");
  for (const double window : kWindows_s) std::printf(" | %2.0f s windows: S mm  N mm  pull   n", window);
  std::printf("\n");
  for (const std::string& file : a.recordings) {
    const auto recording = open_recording(file);
    if (!recording) return recording.failure();
    const std::string name = name_of(file);
    std::printf("%-34s", name.c_str());
    if (recording->truth.size() < 10) {
      std::printf(" | no truth\n");
      continue;
    }
    Pairs pairs{recording->truth, recording->truth};
    if (with_error) {
      Progress progress(name);
      RunOptions options;
      options.config = a.config;
      options.progress = [&](size_t i, size_t n) { progress.show(i, n); };
      const auto result = replay(*recording, options);
      if (!result) return result.failure();
      // A camera's clock that the recording does not know of may be off by more than an evaluation would forgive.
      pairs = associate(recording->truth, result->track, 0.045);
    }
    for (const double window : kWindows_s) {
      const Excitation e = excitation_of(pairs, {.window_s = window});
      std::printf(" |               %5.1f", 1e3 * e.motion_m);
      if (with_error)
        std::printf(" %5.1f  %4.2f", 1e3 * e.error_m, e.pull);
      else
        std::printf(" %5s  %4s", "-", "-");
      std::printf(" %3zu", e.windows);
    }
    std::printf("\n");
  }
  return true;
}

Result<bool> print_tracks(const TrackArguments& a) {
  Plot plot{.title = "Corners still followed", .x_label = "frames", .y_label = "part"};
  std::printf(
      "Up to %d corners, pyramidal Lucas-Kanade there and back within 0.7 px, five-point RANSAC within 1 px.\n\n",
      kCorners);
  std::printf("%-34s %6s %6s | %-22s | %-16s | %-16s | %-16s\n", "", "frames", "Hz", "track length (frames)",
              "found again", "one motion", "median flow (px)");
  std::printf("%-34s %6s %6s | %6s %7s %7s | %7s %8s | %7s %8s | %7s %8s\n", "", "", "", "25 %", "50 %", "75 %", "50 %",
              "10 %", "50 %", "10 %", "50 %", "90 %");
  for (const std::string& file : a.recordings) {
    const auto f = figures_of(file, a.frames);
    if (!f) return f.failure();
    const std::string name = name_of(file);
    std::printf("%-34s %6zu %6.1f | %6.0f %7.0f %7.0f | %7.3f %8.3f | %7.3f %8.3f | %7.2f %8.2f\n", name.c_str(),
                f->frames, f->rate_hz, percentile(f->lengths, 0.25), percentile(f->lengths, 0.5),
                percentile(f->lengths, 0.75), percentile(f->kept, 0.5), percentile(f->kept, 0.1),
                percentile(f->inliers, 0.5), percentile(f->inliers, 0.1), percentile(f->flow_px, 0.5),
                percentile(f->flow_px, 0.9));
    PlotSeries series{.name = name, .style = "lines"};
    const auto longest = static_cast<double>(std::min<size_t>(f->frames / 2, 60));
    for (double k = 1; k <= longest; ++k) {
      const auto alive = std::count_if(f->lengths.begin(), f->lengths.end(), [k](double l) { return l >= k; });
      series.points.emplace_back(
          k, static_cast<double>(alive) / static_cast<double>(std::max<size_t>(1, f->lengths.size())));
    }
    plot.series.push_back(std::move(series));
  }
  return a.plot.empty() ? Result<bool>(true) : write_svg(plot, a.plot);
}

int tracks(const TrackArguments& a) {
  if (!a.excitation_only)
    if (const auto done = print_tracks(a); !done) return complain(done.failure());
  if (const auto done = print_excitation(a); !done) return complain(done.failure());
  return kDone;
}

}  // namespace

void add_bench_tracks(CLI::App& bench, int& status) {
  auto a = std::make_shared<TrackArguments>();
  auto* command = bench.add_subcommand(
      "tracks", "How corners can be followed through recordings: lengths of tracks, inliers, flow");
  command->add_option("recordings", a->recordings, "recordings with a camera, real and simulated")->required();
  command->add_option("--frames", a->frames, "the first so many of each")->capture_default_str();
  command->add_option("--plot", a->plot, "write how long corners are followed as SVG");
  command->add_flag(
      "--excitation-only", a->excitation_only,
      "S, N and the pull alone: rms of the true motion about a quadratic in time, rms error of a visual "
      "trajectory after Sim(3), and S^2/(S^2+N^2), in windows of 4 and 8 s (medians; overlapping by half; "
      "windows with less than 0.25 m/s left out)");
  command->add_option("-c,--config", a->config, "the pipeline whose error N is; vision alone")->capture_default_str();
  command->callback([a, &status] { status = tracks(*a); });
}

}  // namespace odograph
