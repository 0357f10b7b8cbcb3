// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/skyline/colour_sky.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

#include <opencv2/imgproc.hpp>

namespace odograph::skyline {
namespace {

constexpr int8_t kWeights[] = {
#include "plugins/fix/skyline/colour_sky_weights.inc"
};
/// Of each layer's outputs: what its weights are multiplied by, and its bias.
constexpr float kOutputs[][2] = {
#include "plugins/fix/skyline/colour_sky_outputs.inc"
};
constexpr int kChannels[] = {0, 1, 2, 4, 5, 6, 7, 8};  // of SkyFeatures; then Cb, Cr and where the lens sees
constexpr int kContrast = 4;                           // of them
constexpr double kBlue = 1.772;                        // of Cb in blue: ITU-R BT.601
// Between leaves sky is what is bluer than about this: where hand-made masks put it. The network moves it.
constexpr double kBlueBetween = 149, kBlueUnit = 12, kMaxBlue = 2;
constexpr double kLuma = 64, kChromaUnit = 16, kMiddle = 128;

/// Each pixel becomes the largest value on the straight line from the zenith to it in the picture, ring by ring.
void largest_from(const Eigen::Vector2d& zenith, cv::Mat& plane) {
  const int columns = plane.cols, rows = plane.rows;
  const int cx = std::clamp(static_cast<int>(std::lround(zenith.x())), 0, columns - 1);
  const int cy = std::clamp(static_cast<int>(std::lround(zenith.y())), 0, rows - 1);
  const auto at = [&](int x, int y) {
    return plane.at<float>(std::clamp(y, 0, rows - 1), std::clamp(x, 0, columns - 1));
  };
  for (int k = 1; k < std::max(columns, rows); ++k)
    for (const int side : {-1, 1})
      for (int d = -k; d <= k; ++d) {
        const float nearer = static_cast<float>(d) * static_cast<float>(k - 1) / static_cast<float>(k);
        const int i = static_cast<int>(std::floor(nearer));
        const float part = nearer - static_cast<float>(i);
        if (const int x = cx + side * k, y = cy + d, from = x - side; x >= 0 && x < columns && y >= 0 && y < rows)
          plane.at<float>(y, x) =
              std::max(plane.at<float>(y, x), (1 - part) * at(from, cy + i) + part * at(from, cy + i + 1));
        if (const int x = cx + d, y = cy + side * k, from = y - side;
            std::abs(d) < k && x >= 0 && x < columns && y >= 0 && y < rows)
          plane.at<float>(y, x) =
              std::max(plane.at<float>(y, x), (1 - part) * at(cx + i, from) + part * at(cx + i + 1, from));
      }
}

}  // namespace

ColourSky::ColourSky() {
  size_t weight = 0, output = 0;
  for (size_t k = 0; k < kLayers; ++k) {
    const Shape& s = kShapes[k];
    layers_[k] = {s.inputs, s.outputs, s.side, s.stride, {}, {}};
    for (int o = 0; o < s.outputs; ++o, ++output) {
      for (int n = 0; n < s.inputs * s.side * s.side; ++n)
        layers_[k].weights.push_back(kOutputs[output][0] * static_cast<float>(kWeights[weight++]));
      layers_[k].biases.push_back(kOutputs[output][1]);
    }
  }
}

void ColourSky::put(const cv::Mat& plane, int channel) {
  for (int y = 0; y < plane.rows; ++y)
    std::memcpy(inputs_.row(channel, y), plane.ptr<float>(y), sizeof(float) * static_cast<size_t>(plane.cols));
}

void ColourSky::look(const SkyFeatures& features, const Chroma& chroma, const Eigen::Vector2d& zenith) {
  const cv::Size small = features.valid.size(), size(small.width / 2, small.height / 2);
  inputs_.create(kInputs, size.height, size.width);
  int channel = 0;
  cv::Mat resized, floats, contrast;
  const auto take = [&](const cv::Mat& plane, double scale, double zero) {
    cv::resize(plane, resized, size, 0, 0, cv::INTER_AREA);
    resized.convertTo(floats, CV_32F, scale, -scale * zero);
    put(floats, channel++);
  };
  for (const int k : kChannels) {
    take(features.channels[k], 1, 0);
    if (k == kContrast) floats.copyTo(contrast);
  }
  cv::Mat low, high, colour(size, CV_32F, cv::Scalar(1));
  for (const cv::Mat* plane : {&chroma.cb, &chroma.cr}) {
    take(*plane, 1 / kChromaUnit, kMiddle);
    cv::erode(resized, low, cv::Mat()), cv::dilate(resized, high, cv::Mat());
    cv::subtract(high, low, low);
    cv::add(colour, low, colour, cv::noArray(), CV_32F);
  }
  take(features.valid, 1 / 255.0, 0);
  // What must be crossed from the zenith: contrast, and change of colour, from 0 for none to 3.
  cv::log(colour, colour);
  colour *= 0.72;
  const Eigen::Vector2d at = (features.small_of(zenith).array() + 0.5) / 2 - 0.5;
  for (cv::Mat* barrier : {&contrast, &colour}) largest_from(at, *barrier), put(*barrier, channel++);
}

void ColourSky::judge() {
  constexpr size_t kDeepest = 5;
  for (size_t k = 0; k <= kDeepest; ++k)
    convolve(layers_[k], k == 0 ? inputs_ : results_[k - 1], true, split_, results_[k]);
  // Up again: each joins the result of its own size, which is not needed otherwise any more.
  const Volume* deeper = &results_[kDeepest];
  for (size_t k = kDeepest + 1; k + 1 < kLayers; ++k) {
    convolve(layers_[k], *deeper, false, split_, results_[k]);
    Volume& joined = results_[kDeepest + 3 - k];
    add_doubled(results_[k], joined);
    deeper = &joined;
  }
  convolve(layers_[kLayers - 1], *deeper, false, split_, results_[kLayers - 1]);
}

std::array<float, ColourSky::kTerms> ColourSky::terms(float y, float cb, float cr) {
  const double blue = (static_cast<double>(y) + kBlue * (static_cast<double>(cb) - kMiddle) - kBlueBetween) / kBlueUnit;
  return {1, static_cast<float>((static_cast<double>(y) - kMiddle) / kLuma),
          static_cast<float>((static_cast<double>(cb) - kMiddle) / kChromaUnit),
          static_cast<float>((static_cast<double>(cr) - kMiddle) / kChromaUnit),
          static_cast<float>(std::clamp(blue, -kMaxBlue, kMaxBlue))};
}

void ColourSky::log_odds(const cv::Mat& grey, const Chroma& chroma, cv::Size size, cv::Mat& out) const {
  const Volume& told = results_[kLayers - 1];
  cv::Mat small(told.height(), told.width(), CV_32F), coefficient, sized[3], term;
  const auto coefficient_of = [&](int t) {
    for (int y = 0; y < small.rows; ++y)
      std::memcpy(small.ptr<float>(y), told.row(t, y), sizeof(float) * static_cast<size_t>(small.cols));
    cv::resize(small, coefficient, size, 0, 0, cv::INTER_LINEAR);
  };
  const cv::Mat* const planes[] = {&grey, &chroma.cb, &chroma.cr};
  const double units[] = {kLuma, kChromaUnit, kChromaUnit};
  coefficient_of(0);
  coefficient.copyTo(out);
  const auto add = [&](int t) {
    coefficient_of(t);
    cv::multiply(coefficient, term, term);
    out += term;
  };
  for (int k = 0; k < 3; ++k) {
    const bool shrinks = planes[k]->cols > size.width;
    cv::resize(*planes[k], sized[k], size, 0, 0, shrinks ? cv::INTER_AREA : cv::INTER_LINEAR);
    sized[k].convertTo(term, CV_32F, 1 / units[k], -kMiddle / units[k]);
    add(k + 1);
  }
  cv::addWeighted(sized[0], 1 / kBlueUnit, sized[1], kBlue / kBlueUnit, -(kBlue * kMiddle + kBlueBetween) / kBlueUnit,
                  term, CV_32F);
  cv::min(term, kMaxBlue, term);
  cv::max(term, -kMaxBlue, term);
  add(4);
}

}  // namespace odograph::skyline
