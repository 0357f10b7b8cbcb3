// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "plugins/fix/skyline/sky_features.hpp"

namespace odograph::skyline {

/// The colour of a picture: Cb and Cr of ITU-R BT.601, 8-bit around 128, both of one size, whichever. Empty: it is
/// grey.
struct Chroma {
  cv::Mat cb, cr;
  bool empty() const { return cb.empty(); }
};

/// Tells sky from the rest in colour pictures, pixel by pixel at full resolution. Around each place a small network
/// says, from 28 features of the surroundings, how brightness and colour tell sky there: between leaves by another
/// bound than along a white wall. A pixel's log-odds are then linear in its own Y, Cb and Cr, with four coefficients
/// that are smooth (as in a bilateral grid, Gharbi et al. 2017). Weights: `odograph-teach-sky`. Thread: one at a time.
class ColourSky {
 public:
  static constexpr int kFeatures = 28, kTerms = 4, kHidden = 24;
  struct Neuron {
    float inputs[kFeatures];
    float bias;
    float outputs[kTerms];
  };

  /// What the surroundings show, at half the resolution of `features`, which are the same picture's. `zenith`: its
  /// pixel in their picture, anywhere. `grey` is 8-bit.
  void look(const SkyFeatures& features, const cv::Mat& grey, const Chroma& chroma, const Eigen::Vector2d& zenith);
  /// The coefficients of all terms, by the network.
  void judge();
  /// Log-odds that each pixel shows sky, CV_32F, at any size of the same picture: after judge().
  void log_odds(const cv::Mat& grey, const Chroma& chroma, cv::Size size, cv::Mat& out);
  /// After look(), CV_32F, all of one size: for those who teach the network.
  const std::array<cv::Mat, kFeatures>& channels() const { return channels_; }
  /// What a pixel's log-odds are linear in.
  std::array<float, kTerms> terms(float y, float cb, float cr) const {
    return {1, (y - sky_) / 64, (cb - 128) / 16, (cr - 128) / 16};
  }

 private:
  void crossed(const cv::Mat& barrier, const Eigen::Vector2d& zenith, bool summed, cv::Mat& out) const;

  std::array<cv::Mat, kFeatures> channels_;
  std::array<cv::Mat, kTerms> coefficients_;
  float sky_ = 255;  // Y at the zenith
};

}  // namespace odograph::skyline
