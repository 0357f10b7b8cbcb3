// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/known_object/picture_search.hpp"

#include <algorithm>
#include <cmath>

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

namespace odograph::known_object {
namespace {

// Views from the front, from the side (foreshortened width) and from below.
constexpr double kViews[][2] = {{1, 1}, {0.6, 1}, {0.36, 1}, {1, 0.6}};

/// A foreshortened picture, anti-aliased.
cv::Mat foreshortened(const cv::Mat& picture, double along_x, double along_y) {
  const auto sigma = [](double part) { return part < 1 ? 0.8 * std::sqrt(1 / (part * part) - 1) : 0.01; };
  cv::Mat blurred, view;
  cv::GaussianBlur(picture, blurred, {0, 0}, sigma(along_x), sigma(along_y));
  cv::resize(blurred, view, {}, along_x, along_y, cv::INTER_LINEAR);
  return view;
}

cv::Ptr<cv::SIFT> sift(int features, double contrast) { return cv::SIFT::create(features, 3, contrast); }

}  // namespace

std::vector<Pose> plane_poses(const std::vector<cv::Point3d>& points_o, const std::vector<cv::Point2d>& normalised) {
  std::vector<cv::Mat> rotations, translations;
  std::vector<Pose> poses;
  try {
    cv::solvePnPGeneric(points_o, normalised, cv::Matx33d::eye(), cv::noArray(), rotations, translations, false,
                        cv::SOLVEPNP_IPPE);
  } catch (const cv::Exception&) {
    return {};  // collinear points
  }
  for (size_t k = 0; k < rotations.size(); ++k) {
    cv::Matx33d R;
    cv::Rodrigues(rotations[k], R);
    Pose pose;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) pose.R_c_o(i, j) = R(i, j);
      pose.t_c_o[i] = translations[k].at<double>(i);
    }
    const bool in_front = pose.t_c_o.z() > 0.1 && pose.R_c_o.col(2).dot(pose.t_c_o) > 0;  // and seen from its front
    if (pose.R_c_o.allFinite() && pose.t_c_o.allFinite() && in_front) poses.push_back(pose);
  }
  return poses;
}

PictureSearch::PictureSearch(const Parameters& parameters, const std::vector<PlaneObject>& objects)
    : p_(parameters), objects_(objects) {
  for (const PlaneObject& object : objects) {
    Known& known = known_.emplace_back();
    if (object.tag >= 0) continue;
    const double scale = std::min(1.0, p_.longest_px / std::max(object.picture.cols, object.picture.rows));
    cv::Mat picture;
    cv::resize(object.picture, picture, {}, scale, scale, cv::INTER_AREA);
    for (const auto& view : kViews) {
      const cv::Mat seen = foreshortened(picture, view[0], view[1]);
      std::vector<cv::KeyPoint> keypoints;
      cv::Mat descriptors;
      sift(p_.picture_features, p_.contrast)->detectAndCompute(seen, cv::noArray(), keypoints, descriptors);
      for (const cv::KeyPoint& k : keypoints)
        known.points_m.emplace_back(static_cast<float>(((k.pt.x + 0.5) / seen.cols - 0.5) * object.width_m),
                                    static_cast<float>(((k.pt.y + 0.5) / seen.rows - 0.5) * object.height_m));
      known.descriptors.push_back(descriptors);
    }
  }
}

PictureSearch::Features PictureSearch::look(const cv::Mat& grey, const cv::Mat& mask, const CameraModel& camera) const {
  Features features;
  sift(p_.frame_features, p_.contrast)->detectAndCompute(grey, mask, features.keypoints, features.descriptors);
  std::vector<cv::Point2f> pixels;
  for (const cv::KeyPoint& k : features.keypoints) pixels.push_back(k.pt);
  camera.undistort(pixels, features.normalised);
  return features;
}

std::vector<PictureSearch::Place> PictureSearch::find(size_t number, const Features& features,
                                                      const CameraModel& camera) const {
  const Known& known = known_[number];
  if (known.descriptors.rows < 8 || features.descriptors.rows < p_.min_inliers) return {};
  std::vector<std::vector<cv::DMatch>> matches;
  cv::BFMatcher(cv::NORM_L2).knnMatch(features.descriptors, known.descriptors, matches, 5);
  const PlaneObject& object = objects_[number];
  const float apart_m = p_.other_place * static_cast<float>(std::max(object.width_m, object.height_m));
  std::vector<cv::Point2d> on_object, seen;
  const double focal = camera.focal();
  for (const auto& best : matches) {
    if (best.empty()) continue;
    const cv::Point2f place = known.points_m[static_cast<size_t>(best[0].trainIdx)];
    float other = best.back().distance;  // upper bound; the views of one position are consecutive
    for (const cv::DMatch& m : best)
      if (cv::norm(known.points_m[static_cast<size_t>(m.trainIdx)] - place) > apart_m) {
        other = m.distance;
        break;
      }
    if (best[0].distance > p_.ratio * other) continue;
    on_object.push_back(place);
    seen.push_back(focal * features.normalised[static_cast<size_t>(best[0].queryIdx)]);
  }
  std::vector<Place> places;
  while (static_cast<int>(seen.size()) >= p_.min_inliers && places.size() < p_.max_places) {
    std::vector<uint8_t> inliers;
    const cv::Mat H = cv::findHomography(on_object, seen, cv::RANSAC, p_.inlier_px, inliers, 1000, 0.999);
    const int count = cv::countNonZero(inliers);
    if (H.empty() || count < p_.min_inliers) break;
    std::vector<cv::Point3d> points_o;
    std::vector<cv::Point2d> normalised, other_object, other_seen;
    for (size_t k = 0; k < seen.size(); ++k) {
      if (inliers[k]) {
        points_o.emplace_back(on_object[k].x, on_object[k].y, 0);
        normalised.push_back(seen[k] / focal);
      } else {
        other_object.push_back(on_object[k]);
        other_seen.push_back(seen[k]);
      }
    }
    places.push_back({plane_poses(points_o, normalised), count});
    on_object = std::move(other_object), seen = std::move(other_seen);
  }
  return places;
}

}  // namespace odograph::known_object
