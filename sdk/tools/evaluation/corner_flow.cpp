// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/evaluation/corner_flow.hpp"

#include <algorithm>

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "sdk/tools/evaluation/evaluation.hpp"

namespace odograph {
namespace {

/// Rays at depth 1 of pixels, from the recording's calibration.
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

}  // namespace

void CornerFlowStatistics::add(const cv::Mat& picture, const odo_calibration& calibration) {
  if (!before_.empty()) follow(picture, calibration);
  refill(picture);
  before_ = picture;
  ++figures.frames;
}

void CornerFlowStatistics::follow(const cv::Mat& picture, const odo_calibration& calibration) {
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

void CornerFlowStatistics::refill(const cv::Mat& picture) {
  const int missing = kMaxCorners - static_cast<int>(corners_.size());
  if (missing < kMaxCorners / 10) return;
  cv::Mat free(picture.size(), CV_8U, cv::Scalar(255));
  for (const cv::Point2f& p : corners_) cv::circle(free, p, 10, 0, cv::FILLED);
  std::vector<cv::Point2f> fresh;
  cv::goodFeaturesToTrack(picture, fresh, missing, 0.01, 10, free);
  for (const cv::Point2f& p : fresh) corners_.push_back(p), births_.push_back(figures.frames);
}

}  // namespace odograph
