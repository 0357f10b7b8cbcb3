// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "plugins/fix/skyline/sky_convolutions.hpp"
#include "plugins/fix/skyline/sky_features.hpp"

namespace odograph::skyline {

/// The colour of a picture: Cb and Cr of ITU-R BT.601, 8-bit around 128, both of one size, whichever. Empty: it is
/// grey.
struct Chroma {
  cv::Mat cb, cr;
  bool empty() const { return cb.empty(); }
};

/// Tells sky from the rest in colour pictures, pixel by pixel at full resolution. A small convolutional network, an
/// encoder and a decoder (Ronneberger et al. 2015) on a grid of 160 columns, sees walls with their windows and says
/// how brightness and colour tell sky at each place. A pixel's log-odds are then linear in its own Y, Cb, Cr and blue,
/// with five coefficients that are smooth (as in a bilateral grid, Gharbi et al. 2017). Weights: `odograph-teach-sky`.
/// Thread: one at a time.
class ColourSky {
 public:
  static constexpr int kInputs = 13, kTerms = 5, kLayers = 10;
  struct Shape {
    int inputs, outputs, side, stride;
  };
  /// Six layers down to an eighth of the grid, three up again, each of which joins one from the way down, and the
  /// coefficients.
  static constexpr Shape kShapes[kLayers] = {{kInputs, 8, 1, 1}, {8, 12, 3, 2},    {12, 24, 3, 2}, {24, 32, 3, 2},
                                             {32, 32, 3, 1},     {32, 32, 3, 1},   {32, 24, 1, 1}, {24, 12, 1, 1},
                                             {12, 8, 1, 1},      {8, kTerms, 1, 1}};

  ColourSky();

  /// Takes a picture, whose `features` these are. `zenith`: its pixel, anywhere.
  void look(const SkyFeatures& features, const Chroma& chroma, const Eigen::Vector2d& zenith);
  /// The coefficients of all terms, by the network: after look().
  void judge();
  /// Log-odds that each pixel shows sky, CV_32F, at any size of the same picture: after judge().
  void log_odds(const cv::Mat& grey, const Chroma& chroma, cv::Size size, cv::Mat& out) const;
  /// What the network is told, after look(): for those who teach it.
  const Volume& inputs() const { return inputs_; }
  /// What a pixel's log-odds are linear in.
  static std::array<float, kTerms> terms(float y, float cb, float cr);

 private:
  void put(const cv::Mat& plane, int channel);

  std::array<Convolution, kLayers> layers_;
  std::array<Volume, kLayers> results_;
  Volume inputs_, split_;
};

}  // namespace odograph::skyline
