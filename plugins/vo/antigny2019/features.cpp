// SPDX-License-Identifier: Apache-2.0
#include "plugins/vo/antigny2019/features.hpp"

#include <algorithm>
#include <map>
#include <numeric>

// Debian builds dlib with BLAS, which SURF does not need.
#include <dlib/assert.h>
#include <dlib/test_for_odr_violations.h>
#undef DLIB_USE_BLAS
#undef DLIB_USE_LAPACK
#include <dlib/image_keypoint/surf.h>
#include <dlib/opencv.h>
#include <opencv2/features2d.hpp>

namespace odograph::antigny2019 {
namespace {

class Surf : public FeatureFinder {
 public:
  explicit Surf(int most) : most_(most) {}
  Features find(const cv::Mat& grey, const cv::Mat& mask) override {
    const dlib::cv_image<unsigned char> image(grey);
    const auto points = dlib::get_surf_points(image, most_, 10.0);
    Features out;
    out.descriptors.create(static_cast<int>(points.size()), 64, CV_32F);
    int row = 0;
    for (const auto& point : points) {
      const cv::Point2f at(static_cast<float>(point.p.center.x()), static_cast<float>(point.p.center.y()));
      const cv::Point pixel = at;  // rounded
      if (!cv::Rect(0, 0, grey.cols, grey.rows).contains(pixel) || (!mask.empty() && !mask.at<uint8_t>(pixel)))
        continue;
      out.pixels.push_back(at);
      out.strength.push_back(static_cast<float>(point.p.score));
      for (int k = 0; k < 64; ++k) out.descriptors.at<float>(row, k) = static_cast<float>(point.des(k));
      ++row;
    }
    out.descriptors.resize(static_cast<size_t>(row));
    return out;
  }

 private:
  int most_;
};

class OfOpenCV : public FeatureFinder {
 public:
  explicit OfOpenCV(cv::Ptr<cv::Feature2D> detector) : detector_(std::move(detector)) {}
  Features find(const cv::Mat& grey, const cv::Mat& mask) override {
    std::vector<cv::KeyPoint> keypoints;
    Features out;
    detector_->detectAndCompute(grey, mask, keypoints, out.descriptors);
    for (const auto& keypoint : keypoints) out.pixels.push_back(keypoint.pt), out.strength.push_back(keypoint.response);
    return out;
  }

 private:
  cv::Ptr<cv::Feature2D> detector_;
};

}  // namespace

std::unique_ptr<FeatureFinder> FeatureFinder::make(const std::string& kind, int most) {
  if (kind == "sift") return std::make_unique<OfOpenCV>(cv::SIFT::create(most));
  if (kind == "orb") return std::make_unique<OfOpenCV>(cv::ORB::create(most));
  if (kind == "akaze") return std::make_unique<OfOpenCV>(cv::AKAZE::create());
  return std::make_unique<Surf>(most);
}

Features sparse(const Features& all, cv::Size picture, int cell_px, int in_a_cell) {
  std::vector<int> order(all.pixels.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return all.strength[static_cast<size_t>(a)] > all.strength[static_cast<size_t>(b)];
  });
  const int columns = picture.width / cell_px + 1, rows = picture.height / cell_px + 1;
  std::vector<int> taken(static_cast<size_t>(columns * rows), 0);
  Features out;
  for (const int i : order) {
    const cv::Point2f& at = all.pixels[static_cast<size_t>(i)];
    int& count =
        taken[static_cast<size_t>(static_cast<int>(at.y) / cell_px * columns + static_cast<int>(at.x) / cell_px)];
    if (count >= in_a_cell) continue;
    ++count;
    out.pixels.push_back(at);
    out.strength.push_back(all.strength[static_cast<size_t>(i)]);
    out.descriptors.push_back(all.descriptors.row(i));
  }
  return out;
}

std::vector<std::pair<int, int>> match(const Features& first, const Features& second, double ratio) {
  std::vector<std::pair<int, int>> pairs;
  if (first.pixels.size() < 2 || second.pixels.size() < 2) return pairs;
  const bool bits = first.descriptors.depth() == CV_8U;
  cv::BFMatcher matcher(bits ? cv::NORM_HAMMING : cv::NORM_L2SQR);
  std::vector<std::vector<cv::DMatch>> there;
  std::vector<cv::DMatch> back;
  matcher.knnMatch(first.descriptors, second.descriptors, there, 2);
  matcher.match(second.descriptors, first.descriptors, back);
  for (const auto& two : there)
    if (two.size() == 2 && two[0].distance < ratio * two[1].distance &&
        back[static_cast<size_t>(two[0].trainIdx)].trainIdx == two[0].queryIdx)
      pairs.emplace_back(two[0].queryIdx, two[0].trainIdx);
  return pairs;
}

}  // namespace odograph::antigny2019
