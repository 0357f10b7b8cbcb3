// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <random>
#include <vector>

#include "plugins/fix/skyline/sky_convolutions.hpp"

namespace odograph::skyline {

/// A convolution that learns: gradients by the chain rule, steps by Adam (Kingma & Ba 2015).
class Learner {
 public:
  Learner(int inputs, int outputs, int side, int stride, bool rectified, std::mt19937& random)
      : layer{inputs, outputs, side, stride, {}, std::vector<float>(static_cast<size_t>(outputs))},
        rectified_(rectified) {
    std::normal_distribution<float> normal;
    const int taps = inputs * side * side;
    // He et al. 2015; the last layer begins near nothing.
    const float sigma = (rectified ? 1.0f : 0.5f) * std::sqrt(2.0f / static_cast<float>(taps));
    for (int k = 0; k < taps * outputs; ++k) layer.weights.push_back(sigma * normal(random));
    state_.resize(layer.weights.size() + layer.biases.size());
  }

  const Volume& forward(const Volume& in) {
    in_ = &in;
    convolve(layer, in, rectified_, split_, out);
    return out;
  }

  /// `g`: the loss's gradient by the output, which is changed; adds the one by the input to `to`, where there is one.
  void backward(Volume& g, Volume* to) {
    const int reach = layer.side / 2, stride = layer.stride;
    const auto width = static_cast<size_t>(out.width());
    std::vector<float> in_row(width), to_row(width);
    for (int o = 0; o < layer.outputs; ++o)
      for (int y = 0; y < out.height(); ++y) {
        float *d = g.row(o, y), sum = 0;
        const float* v = out.row(o, y);
        for (size_t x = 0; x < width; ++x) {
          if (rectified_ && v[x] <= 0) d[x] = 0;
          sum += d[x];
        }
        state_[layer.weights.size() + static_cast<size_t>(o)].gradient += sum;
      }
    for (int y = 0; y < out.height(); ++y)
      for (int c = 0; c < layer.inputs; ++c)
        for (int dy = -reach; dy <= reach; ++dy)
          for (int dx = -reach; dx <= reach; ++dx) {
            const float* from = in_->row(c, stride * y + dy);
            const auto at = [&](size_t x) { return stride * static_cast<int>(x) + dx; };
            // Beyond the picture the border is zero, and of no use to the gradient.
            for (size_t x = 0; x < width; ++x) in_row[x] = at(x) < in_->width() ? from[at(x)] : 0.0f, to_row[x] = 0;
            for (int o = 0; o < layer.outputs; ++o) {
              const size_t w = weight(o, c, dy + reach, dx + reach);
              const float* d = g.row(o, y);
              state_[w].gradient += dot(d, in_row.data(), width);
              for (size_t x = 0; x < width; ++x) to_row[x] += layer.weights[w] * d[x];
            }
            const int row = stride * y + dy;
            if (!to || row < 0 || row >= in_->height()) continue;
            float* into = to->row(c, row);
            for (size_t x = 0; x < width; ++x)
              if (at(x) >= 0 && at(x) < in_->width()) into[at(x)] += to_row[x];
          }
  }

  void step(float rate, double steps, float decay) {
    const auto a = static_cast<float>(1 - std::pow(0.9, steps)), b = static_cast<float>(1 - std::pow(0.999, steps));
    for (size_t k = 0; k < state_.size(); ++k) {
      State& s = state_[k];
      float& value = k < layer.weights.size() ? layer.weights[k] : layer.biases[k - layer.weights.size()];
      const float g = s.gradient + (k < layer.weights.size() ? decay * value : 0.0f);
      s.mean = 0.9f * s.mean + 0.1f * g, s.square = 0.999f * s.square + 0.001f * g * g;
      value -= rate * (s.mean / a) / (std::sqrt(s.square / b) + 1e-8f);
      s.gradient = 0;
    }
  }

  Convolution layer;
  Volume out;

 private:
  struct State {
    float gradient = 0, mean = 0, square = 0;
  };
  size_t weight(int o, int c, int row, int column) const {
    return static_cast<size_t>(((o * layer.inputs + c) * layer.side + row) * layer.side + column);
  }
  static float dot(const float* a, const float* b, size_t n) {
    float part[16] = {}, sum = 0;
    size_t k = 0;
    for (; k + 16 <= n; k += 16)
      for (size_t i = 0; i < 16; ++i) part[i] += a[k + i] * b[k + i];
    for (; k < n; ++k) sum += a[k] * b[k];
    for (const float p : part) sum += p;
    return sum;
  }

  bool rectified_;
  const Volume* in_ = nullptr;
  Volume split_;
  std::vector<State> state_;
};

/// The gradient of add_doubled: what came to `fine`'s results (`sums`), which is changed, is handed on to `coarse`.
inline void add_doubled_backward(const Volume& sums, Volume& fine, Volume& coarse) {
  const int rows = coarse.height() - 1, columns = coarse.width() - 1;
  for (int c = 0; c < fine.channels(); ++c)
    for (int y = 0; y < fine.height(); ++y) {
      float *d = fine.row(c, y), *a = coarse.row(c, std::min(y / 2, rows)),
            *b = coarse.row(c, std::min((y + 1) / 2, rows));
      const float* v = sums.row(c, y);
      for (int x = 0; x < fine.width(); ++x) {
        if (v[x] <= 0) d[x] = 0;
        const float part = 0.25f * d[x];
        const int left = std::min(x / 2, columns), right = std::min((x + 1) / 2, columns);
        a[left] += part, a[right] += part, b[left] += part, b[right] += part;
      }
    }
}

inline void clear(Volume& v, const Volume& like) {
  v.create(like.channels(), like.height(), like.width());
  for (int c = 0; c < v.channels(); ++c)
    for (int y = 0; y < v.height(); ++y) std::fill_n(v.row(c, y), v.width(), 0.0f);
}

}  // namespace odograph::skyline
