// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/skyline/sky_network.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include <opencv2/imgproc.hpp>

#include "plugins/fix/skyline/sky_rays.hpp"

namespace odograph::skyline {
namespace {

constexpr int8_t kWeights[] = {
#include "plugins/fix/skyline/sky_network_weights.inc"
};
/// Scale of the weights and bias of each output, layer by layer.
constexpr float kOutputs[][2] = {
#include "plugins/fix/skyline/sky_network_outputs.inc"
};
// As in the training (docs/sky_network.md).
constexpr double kMiddle = 128, kUnits[3] = {64, 32, 32};  // of Y, Cb, Cr
constexpr int kFine = 8, kWidths[4] = {16, 32, 64, 88}, kBlocks[4] = {1, 2, 4, 4};
constexpr double kContrastUnit = 0.72;  // factor of the logarithm that maps 255 grey values to four

/// Reads the layers in their stored order.
class Reader {
 public:
  Convolution next(int inputs, int outputs, int side, int stride) {
    Convolution c{inputs, outputs, side, stride, {}, {}};
    for (int o = 0; o < outputs; ++o, ++output_) {
      for (int n = 0; n < inputs * side * side; ++n)
        c.weights.push_back(kOutputs[output_][0] * static_cast<float>(kWeights[weight_++]));
      c.biases.push_back(kOutputs[output_][1]);
    }
    return c;
  }

 private:
  size_t weight_ = 0, output_ = 0;
};

cv::Size grid_of(cv::Size size) {
  const int longer = std::max(size.width, size.height);
  const auto side = [&](int px) {
    const double of = static_cast<double>(px) * SkyNetwork::kGrid_px / longer / SkyNetwork::kMultiple;
    return std::max(1, static_cast<int>(std::lround(of))) * SkyNetwork::kMultiple;
  };
  return {side(size.width), side(size.height)};
}

void resize(const cv::Mat& from, cv::Mat& to, cv::Size size) {
  cv::resize(from, to, size, 0, 0, from.cols > size.width ? cv::INTER_AREA : cv::INTER_LINEAR);
}

cv::Mat plane_of(const Volume& volume, int channel) {
  cv::Mat plane(volume.height(), volume.width(), CV_32F);
  for (int y = 0; y < plane.rows; ++y)
    std::memcpy(plane.ptr<float>(y), volume.row(channel, y), sizeof(float) * static_cast<size_t>(plane.cols));
  return plane;
}

void put(const cv::Mat& plane, Volume& volume, int channel) {
  for (int y = 0; y < plane.rows; ++y)
    std::memcpy(volume.row(channel, y), plane.ptr<float>(y), sizeof(float) * static_cast<size_t>(plane.cols));
}

}  // namespace

SkyNetwork::SkyNetwork(const CameraModel& camera, cv::Size size, double farthest_rad)
    : size_(size), grid_(grid_of(size)) {
  view_.scale = std::max(1.0, std::max(size.width, size.height) / double(kLonger_px));
  const auto small = [&](int px) { return std::max(1, static_cast<int>(std::lround(px / view_.scale))); };
  small_ = {small(size.width), small(size.height)};
  lens_valid_ = cv::Mat(small_, CV_8U, cv::Scalar(0));
  Eigen::Vector3d ray(0, 0, 1);
  for (int y = 0; y < small_.height; ++y)
    for (int x = 0; x < small_.width; ++x)
      if (ray_of(camera, {(x + 0.5) * view_.scale - 0.5, (y + 0.5) * view_.scale - 0.5}, farthest_rad, ray))
        lens_valid_.at<uint8_t>(y, x) = 255;
  for (int y = 0; y < grid_.height; ++y)
    for (int x = 0; x < grid_.width; ++x) {
      const Eigen::Vector2d pixel((x + 0.5) * size.width / grid_.width - 0.5,
                                  (y + 0.5) * size.height / grid_.height - 0.5);
      const bool seen = ray_of(camera, pixel, farthest_rad, ray);
      rays_.push_back(seen ? Eigen::Vector3f(ray.cast<float>()) : Eigen::Vector3f::Zero());
    }
  Reader reader;
  const auto separable = [&](int inputs, int outputs, int stride) {
    Convolution deep = reader.next(1, inputs, 3, stride);
    return Separable{std::move(deep), reader.next(inputs, outputs, 1, 1)};
  };
  fine_ = reader.next(kPlanes, kFine, 3, 1);
  stem_ = reader.next(kPlanes, kWidths[0], 3, 2);
  for (size_t level = 0; level < 4; ++level)
    for (int k = 0; k < kBlocks[level]; ++k) {
      const bool first = k == 0 && level > 0;
      down_[level].push_back(separable(kWidths[first ? level - 1 : level], kWidths[level], first ? 2 : 1));
    }
  for (size_t level = 4; level-- > 0;) {
    const int outputs = level > 0 ? kWidths[level - 1] : kFine;
    Convolution narrow = reader.next(kWidths[level], outputs, 1, 1);
    up_.push_back({std::move(narrow), separable(outputs, outputs, 1)});
  }
  last_ = reader.next(kFine, kTerms, 1, 1);
}

/// Computes the reduced picture, its valid area and the contrast of adjacent pixels.
void SkyNetwork::measure(const cv::Mat& grey, const cv::Mat& mask) {
  cv::resize(grey, image_, small_, 0, 0, cv::INTER_AREA);
  lens_valid_.copyTo(view_.valid);
  if (!mask.empty()) {
    cv::resize(mask, low_, small_, 0, 0, cv::INTER_NEAREST);
    view_.valid.setTo(0, low_ == 0);
  }
  cv::blur(image_, high_, {3, 3});
  cv::erode(high_, low_, cv::Mat());
  cv::dilate(high_, high_, cv::Mat());
  cv::subtract(high_, low_, bytes_);
  bytes_.convertTo(view_.contrast, CV_32F, 1, 1);
  cv::log(view_.contrast, view_.contrast);
  view_.contrast *= kContrastUnit;
}

void SkyNetwork::set_inputs(const cv::Mat& grey, const Chroma& chroma, const Eigen::Vector3d& up_c) {
  planes_.create(kPlanes, grid_.height, grid_.width);
  const cv::Mat* const from[] = {&grey, &chroma.cb, &chroma.cr};
  cv::Mat bytes, valid;
  for (int k = 0; k < 3; ++k) {
    if (k > 0 && chroma.empty()) {
      input_planes_[k] = cv::Mat(grid_, CV_32F, cv::Scalar(0));
    } else {
      resize(*from[k], bytes, grid_);
      bytes.convertTo(input_planes_[k], CV_32F, 1 / kUnits[k], -kMiddle / kUnits[k]);
    }
    put(input_planes_[k], planes_, k);
  }
  cv::Mat sees;
  view_.valid.convertTo(valid, CV_32F, 1 / 255.0);
  cv::resize(valid, sees, grid_, 0, 0, cv::INTER_AREA);
  put(sees, planes_, 3);
  const Eigen::Vector3f up = up_c.cast<float>();
  for (int y = 0; y < grid_.height; ++y)
    for (int x = 0; x < grid_.width; ++x)
      planes_.row(4, y)[x] = rays_[static_cast<size_t>(y * grid_.width + x)].dot(up) * sees.at<float>(y, x);
}

void SkyNetwork::run(const Separable& block, const Volume& in, Volume& out) {
  const bool joins = block.deep.stride == 1 && block.flat.inputs == block.flat.outputs;
  convolve_each(block.deep, in, deep_);
  convolve(block.flat, deep_, !joins, split_, out);
  if (joins) add(in, out);
}

void SkyNetwork::run(const std::vector<Separable>& blocks, const Volume& in, Volume& out) {
  const Volume* from = &in;
  for (size_t k = 0; k < blocks.size(); ++k) {
    Volume& to = k + 1 == blocks.size() ? out : swap_[k % 2];
    run(blocks[k], *from, to);
    from = &to;
  }
}

void SkyNetwork::forward() {
  convolve(fine_, planes_, true, split_, levels_[0]);
  convolve(stem_, planes_, true, split_, half_);
  for (size_t level = 0; level < 4; ++level) run(down_[level], level == 0 ? half_ : levels_[level], levels_[level + 1]);
  const Volume* deeper = &levels_[4];
  for (size_t k = 0; k < up_.size(); ++k) {
    convolve(up_[k].narrow, *deeper, false, split_, narrow_);
    Volume& side = levels_[3 - k];
    add_doubled(narrow_, side);
    run(up_[k].join, side, k % 2 == 0 ? swap_[0] : swap_[1]);
    deeper = k % 2 == 0 ? &swap_[0] : &swap_[1];
  }
  convolve(last_, *deeper, false, split_, terms_);
}

void SkyNetwork::log_odds(const cv::Mat& grey, const Chroma& chroma, cv::Size size, cv::Mat& out) const {
  cv::resize(plane_of(terms_, 0), out, size, 0, 0, cv::INTER_LINEAR);
  const cv::Mat* const planes[] = {&grey, &chroma.cb, &chroma.cr};
  cv::Mat fine, wide, slope;
  for (int k = 0; k < (chroma.empty() ? 1 : 3); ++k) {
    resize(*planes[k], fine, size);
    fine.convertTo(fine, CV_32F, 1 / kUnits[k], -kMiddle / kUnits[k]);
    cv::resize(input_planes_[k], wide, size, 0, 0, cv::INTER_LINEAR);
    cv::resize(plane_of(terms_, k + 1), slope, size, 0, 0, cv::INTER_LINEAR);
    fine -= wide;
    cv::multiply(fine, slope, fine);
    out += fine;
  }
}

/// Computes the fraction of sky and its noise.
void SkyNetwork::summarise() {
  std::array<int, 256> histogram{};
  int valid = 0, sky = 0;
  for (int y = 0; y < small_.height; ++y)
    for (int x = 0; x < small_.width; ++x) {
      if (view_.valid.at<uint8_t>(y, x) == 0) continue;
      ++valid;
      if (view_.log_odds.at<float>(y, x) <= 0) continue;
      ++sky, ++histogram[bytes_.at<uint8_t>(y, x)];
    }
  view_.part = valid > 0 ? static_cast<double>(sky) / valid : 0;
  int sum = 0, median = 0;
  while (median < 255 && (sum += histogram[static_cast<size_t>(median)]) * 2 < sky) ++median;
  view_.noise = kContrastUnit * std::log(1.0 + median);
}

const SkyView& SkyNetwork::segment(const cv::Mat& grey, const cv::Mat& mask, const Chroma& chroma,
                                   const Eigen::Vector3d& up_c) {
  measure(grey, mask);
  set_inputs(grey, chroma, up_c);
  forward();
  log_odds(image_, chroma, small_, view_.log_odds);
  summarise();
  return view_;
}

}  // namespace odograph::skyline
