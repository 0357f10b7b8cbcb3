// SPDX-License-Identifier: Apache-2.0
#include "plugins/shared/camera/picture_content.hpp"

#include <algorithm>

#include <opencv2/imgproc.hpp>

namespace odograph {

PictureContent content_of(const cv::Mat& grey) {
  constexpr int kBlock = 4;
  const cv::Rect whole(0, 0, grey.cols / kBlock * kBlock, grey.rows / kBlock * kBlock);
  if (whole.empty()) return {cv::mean(grey)[0], 0, 0};
  const cv::Mat picture = grey(whole);
  cv::Mat blocks;
  cv::resize(picture, blocks, {whole.width / kBlock, whole.height / kBlock}, 0, 0, cv::INTER_AREA);
  cv::Scalar mean, sigma, block_mean, block_sigma;
  cv::meanStdDev(picture, mean, sigma);
  cv::meanStdDev(blocks, block_mean, block_sigma);
  const double between = block_sigma[0] * block_sigma[0], within = std::max(0.0, sigma[0] * sigma[0] - between);
  const double noise = within / (kBlock * kBlock - 1);
  return {mean[0], std::max(0.0, between - noise), noise};
}

}  // namespace odograph
