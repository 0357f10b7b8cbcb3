// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

namespace odograph::skyline {

/// Planes of floats of one size, each with a border of one zero; rows are numbered from -1 to height.
class Volume {
 public:
  static constexpr int kChunk = 8;  ///< pixels that are computed together: rows are readable this far beyond their end

  /// Allocates the planes, filled with zeros; the same size again keeps their content.
  void create(int channels, int height, int width);
  int channels() const { return channels_; }
  int height() const { return height_; }
  int width() const { return width_; }
  float* row(int channel, int y) { return data_.data() + offset(channel, y); }
  const float* row(int channel, int y) const { return data_.data() + offset(channel, y); }

 private:
  std::ptrdiff_t offset(int channel, int y) const {
    return (static_cast<std::ptrdiff_t>(channel) * (height_ + 2) + y + 1) * pitch_ + 1;
  }
  int channels_ = 0, height_ = 0, width_ = 0, pitch_ = 0;
  std::vector<float> data_;
};

/// A convolution of `side` x `side` pixels (1 or 3), at every `stride`-th pixel (1 or 2), each output with a bias.
/// `weights`: by output, input, row, column.
struct Convolution {
  int inputs, outputs, side, stride;
  std::vector<float> weights, biases;
};

/// `out` has (size + stride - 1) / stride rows and columns. Negative results become 0 where `rectified`. `split` is a
/// work buffer. The order of summation does not depend on the machine.
void convolve(const Convolution& layer, const Volume& in, bool rectified, Volume& split, Volume& out);

/// One filter of 3 x 3 pixels for each plane, at every `stride`-th pixel; negative results become 0. `inputs` of the
/// layer is 1.
void convolve_each(const Convolution& layer, const Volume& in, Volume& out);

/// `to` += `other`; negative sums become 0.
void add(const Volume& other, Volume& to);

/// `fine` += `coarse`, which is at half its resolution, by nearest neighbour; negative sums become 0.
void add_doubled(const Volume& coarse, Volume& fine);

}  // namespace odograph::skyline
