// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/calibration/corner_tracks.hpp"

#include <algorithm>

#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

namespace odograph {

TrackedFrame CornerTracks::follow(const cv::Mat& grey, int64_t t_ns) {
  const cv::Size window(p_.window_px, p_.window_px);
  std::vector<cv::Mat> pyramid;
  cv::buildOpticalFlowPyramid(grey, pyramid, window, p_.levels);
  TrackedFrame next{.t_ns = t_ns, .ids = {}, .pixels = {}};
  if (!latest_.pixels.empty()) {
    std::vector<cv::Point2f> there, back = latest_.pixels;
    std::vector<uint8_t> found, found_back;
    const cv::TermCriteria stop(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 30, 0.01);
    cv::calcOpticalFlowPyrLK(pyramid_, pyramid, latest_.pixels, there, found, cv::noArray(), window, p_.levels, stop);
    cv::calcOpticalFlowPyrLK(pyramid, pyramid_, there, back, found_back, cv::noArray(), window, p_.levels, stop,
                             cv::OPTFLOW_USE_INITIAL_FLOW);
    const cv::Rect2f inside(2, 2, static_cast<float>(grey.cols - 4), static_cast<float>(grey.rows - 4));
    for (size_t i = 0; i < there.size(); ++i)
      if (found[i] && found_back[i] && inside.contains(there[i]) &&
          cv::norm(back[i] - latest_.pixels[i]) < p_.back_px) {
        next.ids.push_back(latest_.ids[i]);
        next.pixels.push_back(there[i]);
      }
  }
  pyramid_ = std::move(pyramid);
  latest_ = std::move(next);
  refill(grey);
  return latest_;
}

void CornerTracks::refill(const cv::Mat& grey) {
  const int wanted = p_.most - static_cast<int>(latest_.ids.size());
  if (wanted < p_.most / 10) return;
  const double apart_px = std::max(5.0, p_.apart_px * grey.cols / 640.0);
  cv::Mat free(grey.size(), CV_8U, cv::Scalar(255));
  for (const cv::Point2f& p : latest_.pixels) cv::circle(free, p, static_cast<int>(apart_px), 0, cv::FILLED);
  std::vector<cv::Point2f> fresh;
  cv::goodFeaturesToTrack(grey, fresh, wanted, p_.quality, apart_px, free);
  for (const cv::Point2f& p : fresh) {
    latest_.ids.push_back(next_id_++);
    latest_.pixels.push_back(p);
  }
}

}  // namespace odograph
