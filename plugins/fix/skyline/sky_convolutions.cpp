// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/skyline/sky_convolutions.hpp"

#include <algorithm>
#include <cstring>

namespace odograph::skyline {
namespace {

constexpr int kTogether = 4;  // computed together

/// kChunk pixels of kTogether outputs, from rows of all inputs and taps; compilers keep the sums in registers.
void chunk(const std::vector<const float*>& taps, const float* weights, int x,
           float (&sums)[kTogether][Volume::kChunk]) {
  float local[kTogether][Volume::kChunk];
  std::memcpy(local, sums, sizeof local);
  for (const float* tap : taps) {
    float in[Volume::kChunk];
    std::memcpy(in, tap + x, sizeof in);
    for (int o = 0; o < kTogether; ++o)
      for (int i = 0; i < Volume::kChunk; ++i) local[o][i] += weights[o] * in[i];
    weights += kTogether;
  }
  std::memcpy(sums, local, sizeof local);
}

/// Splits each plane into one of its even columns and one of its odd ones.
void split_columns(const Volume& in, Volume& split) {
  split.create(2 * in.channels(), in.height(), (in.width() + 1) / 2);
  for (int c = 0; c < in.channels(); ++c)
    for (int y = 0; y < in.height(); ++y) {
      const float* from = in.row(c, y);
      float *even = split.row(2 * c, y), *odd = split.row(2 * c + 1, y);
      for (int x = 0; x < in.width(); ++x) (x % 2 ? odd : even)[x / 2] = from[x];
    }
}

}  // namespace

void Volume::create(int channels, int height, int width) {
  const int pitch = (width + kChunk - 1) / kChunk * kChunk + 3;
  if (channels == channels_ && height == height_ && width == width_) return;  // borders are never written
  channels_ = channels, height_ = height, width_ = width, pitch_ = pitch;
  data_.assign(static_cast<size_t>(channels) * static_cast<size_t>(height + 2) * static_cast<size_t>(pitch) + kChunk,
               0.0f);
}

void convolve(const Convolution& layer, const Volume& in, bool rectified, Volume& split, Volume& out) {
  const int stride = layer.stride, reach = layer.side / 2;
  const int height = (in.height() + stride - 1) / stride, width = (in.width() + stride - 1) / stride;
  out.create(layer.outputs, height, width);
  if (stride == 2) split_columns(in, split);
  const auto taps_of = static_cast<size_t>(layer.inputs * layer.side * layer.side);
  // Weights of kTogether outputs side by side.
  const int groups = (layer.outputs + kTogether - 1) / kTogether;
  std::vector<float> packed(static_cast<size_t>(groups * kTogether) * taps_of, 0.0f);
  for (size_t o = 0; o < static_cast<size_t>(layer.outputs); ++o)
    for (size_t t = 0; t < taps_of; ++t)
      packed[(o / kTogether * taps_of + t) * kTogether + o % kTogether] = layer.weights[o * taps_of + t];
  std::vector<const float*> taps(taps_of);
  for (int y = 0; y < height; ++y) {
    size_t t = 0;
    for (int c = 0; c < layer.inputs; ++c)
      for (int dy = -reach; dy <= reach; ++dy)
        for (int dx = -reach; dx <= reach; ++dx)
          taps[t++] =
              stride == 1 ? in.row(c, y + dy) + dx : split.row(2 * c + (dx != 0), 2 * y + dy) + (dx < 0 ? -1 : 0);
    for (int g = 0; g < groups; ++g)
      for (int x = 0; x < width; x += Volume::kChunk) {
        float sums[kTogether][Volume::kChunk];
        const int first = g * kTogether, outputs = std::min(kTogether, layer.outputs - first);
        for (int o = 0; o < kTogether; ++o)
          std::fill_n(sums[o], Volume::kChunk, o < outputs ? layer.biases[static_cast<size_t>(first + o)] : 0.0f);
        chunk(taps, &packed[static_cast<size_t>(g) * taps_of * kTogether], x, sums);
        const int columns = std::min(Volume::kChunk, width - x);
        for (int o = 0; o < outputs; ++o) {
          float* to = out.row(first + o, y) + x;
          for (int i = 0; i < columns; ++i) to[i] = rectified ? std::max(0.0f, sums[o][i]) : sums[o][i];
        }
      }
  }
}

void convolve_each(const Convolution& layer, const Volume& in, Volume& out) {
  const int stride = layer.stride;
  const int height = (in.height() + stride - 1) / stride, width = (in.width() + stride - 1) / stride;
  out.create(layer.outputs, height, width);
  for (int c = 0; c < layer.outputs; ++c) {
    const float* w = &layer.weights[static_cast<size_t>(c) * 9];
    const float bias = layer.biases[static_cast<size_t>(c)];
    for (int y = 0; y < height; ++y) {
      const float *a = in.row(c, stride * y - 1), *b = in.row(c, stride * y), *d = in.row(c, stride * y + 1);
      float* to = out.row(c, y);
      const auto at = [&](int i) {
        return bias + w[0] * a[i - 1] + w[1] * a[i] + w[2] * a[i + 1] + w[3] * b[i - 1] + w[4] * b[i] +
               w[5] * b[i + 1] + w[6] * d[i - 1] + w[7] * d[i] + w[8] * d[i + 1];
      };
      if (stride == 1)
        for (int x = 0; x < width; ++x) to[x] = std::max(0.0f, at(x));
      else
        for (int x = 0; x < width; ++x) to[x] = std::max(0.0f, at(stride * x));
    }
  }
}

void add(const Volume& other, Volume& to) {
  for (int c = 0; c < to.channels(); ++c)
    for (int y = 0; y < to.height(); ++y) {
      const float* from = other.row(c, y);
      float* sum = to.row(c, y);
      for (int x = 0; x < to.width(); ++x) sum[x] = std::max(0.0f, sum[x] + from[x]);
    }
}

void add_doubled(const Volume& coarse, Volume& fine) {
  for (int c = 0; c < fine.channels(); ++c)
    for (int y = 0; y < fine.height(); ++y) {
      const float* from = coarse.row(c, y / 2);
      float* sum = fine.row(c, y);
      for (int x = 0; x < fine.width(); ++x) sum[x] = std::max(0.0f, sum[x] + from[x / 2]);
    }
}

}  // namespace odograph::skyline
