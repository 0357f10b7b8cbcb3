// SPDX-License-Identifier: Apache-2.0
#include "plugins/shared/camera/corner_tracker.hpp"

#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

namespace odograph {

void CornerTracker::follow(const cv::Mat& grey, const std::vector<cv::Point2f>& expected) {
  grey.copyTo(latest_);  // the borrowed pixels are invalid after the call; new corners are detected in this copy
  const cv::Size window(p_.window_px, p_.window_px);
  cv::buildOpticalFlowPyramid(latest_, next_pyramid_, window, p_.levels);
  if (!pyramid_.empty() && !tracks_.empty()) {
    std::vector<cv::Point2f> from, to, back;
    for (const Track& track : tracks_) from.push_back(track.pixel);
    std::vector<uchar> found, found_back;
    const cv::TermCriteria stop(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 30, 0.01);
    const bool guided = expected.size() == from.size();
    if (guided) to = expected;
    cv::calcOpticalFlowPyrLK(pyramid_, next_pyramid_, from, to, found, cv::noArray(), window, p_.levels, stop,
                             guided ? cv::OPTFLOW_USE_INITIAL_FLOW : 0);
    back = from;
    cv::calcOpticalFlowPyrLK(next_pyramid_, pyramid_, to, back, found_back, cv::noArray(), window, p_.levels, stop,
                             cv::OPTFLOW_USE_INITIAL_FLOW);
    std::vector<Track> kept;
    const cv::Rect2f inside(1, 1, static_cast<float>(latest_.cols - 2), static_cast<float>(latest_.rows - 2));
    for (size_t i = 0; i < tracks_.size(); ++i)
      if (found[i] && found_back[i] && inside.contains(to[i]) && cv::norm(from[i] - back[i]) < p_.back_px)
        kept.push_back({tracks_[i].id, to[i]});
    tracks_.swap(kept);
  } else {
    tracks_.clear();
  }
  std::swap(pyramid_, next_pyramid_);
}

void CornerTracker::skip() { tracks_.clear(), pyramid_.clear(), latest_.release(); }

void CornerTracker::refill(const cv::Mat& mask) {
  if (latest_.empty()) return;
  const int columns = latest_.cols / p_.cell_px + 1, rows = latest_.rows / p_.cell_px + 1;
  std::vector<char> taken(static_cast<size_t>(columns * rows), 0);
  const auto cell = [&](const cv::Point2f& p) {
    const int row = static_cast<int>(p.y) / p_.cell_px, column = static_cast<int>(p.x) / p_.cell_px;
    return static_cast<size_t>(row * columns + column);
  };
  for (const Track& track : tracks_) taken[cell(track.pixel)] = 1;
  const int wanted = p_.max_corners - static_cast<int>(tracks_.size());
  if (wanted <= 0) return;
  std::vector<cv::Point2f> corners;
  cv::goodFeaturesToTrack(latest_, corners, 4 * p_.max_corners, p_.quality, 0.35 * p_.cell_px, mask, 5);
  std::vector<cv::Point2f> chosen;
  for (const cv::Point2f& corner : corners) {
    if (static_cast<int>(chosen.size()) >= wanted) break;
    if (taken[cell(corner)]) continue;
    taken[cell(corner)] = 1;
    chosen.push_back(corner);
  }
  if (chosen.empty()) return;
  cv::cornerSubPix(latest_, chosen, {4, 4}, {-1, -1}, {cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 20, 0.02});
  for (const cv::Point2f& corner : chosen) tracks_.push_back({next_id_++, corner});
}

void CornerTracker::drop(const std::vector<char>& keep) {
  std::vector<Track> kept;
  for (size_t i = 0; i < tracks_.size(); ++i)
    if (keep[i]) kept.push_back(tracks_[i]);
  tracks_.swap(kept);
}

CornerTracker CornerTracker::snapshot() const {
  CornerTracker copy = *this;
  copy.latest_ = latest_.clone();
  copy.next_pyramid_.clear();
  for (cv::Mat& level : copy.pyramid_) {
    // A level is a view into a larger picture; the margin is copied with it.
    cv::Size whole;
    cv::Point corner;
    level.locateROI(whole, corner);
    const cv::Size size = level.size();
    level.adjustROI(corner.y, whole.height - corner.y - size.height, corner.x, whole.width - corner.x - size.width);
    level = level.clone()(cv::Rect(corner, size));
  }
  return copy;
}

void CornerTracker::clear() {
  tracks_.clear();
  pyramid_.clear();
}

}  // namespace odograph
