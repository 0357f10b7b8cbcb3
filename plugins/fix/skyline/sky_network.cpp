// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "plugins/fix/skyline/robust_sky.hpp"

namespace odograph::skyline {
namespace {

struct Neuron {
  float inputs[SkyFeatures::kCount];
  float bias, output;
};

constexpr Neuron kHidden[] = {
#include "plugins/fix/skyline/sky_weights.inc"
};
constexpr float kBias = -0.3158f;

}  // namespace

void sky_log_odds(const SkyFeatures& features, cv::Mat& log_odds) {
  log_odds.create(features.valid.size(), CV_32F);
  const float* inputs[SkyFeatures::kCount];
  std::vector<float> sums(static_cast<size_t>(log_odds.cols));
  for (int y = 0; y < log_odds.rows; ++y) {
    for (int k = 0; k < SkyFeatures::kCount; ++k) inputs[k] = features.channels[k].ptr<float>(y);
    auto* out = log_odds.ptr<float>(y);
    std::fill(out, out + log_odds.cols, kBias);
    for (const Neuron& neuron : kHidden) {  // column by column, so that compilers find the vectors
      std::fill(sums.begin(), sums.end(), neuron.bias);
      for (int k = 0; k < SkyFeatures::kCount; ++k) {
        const float w = neuron.inputs[k];
        const float* in = inputs[k];
        for (int x = 0; x < log_odds.cols; ++x) sums[static_cast<size_t>(x)] += w * in[x];
      }
      for (int x = 0; x < log_odds.cols; ++x) out[x] += neuron.output * std::max(0.0f, sums[static_cast<size_t>(x)]);
    }
  }
}

}  // namespace odograph::skyline
