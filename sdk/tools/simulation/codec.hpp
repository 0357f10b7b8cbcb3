// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include <opencv2/core.hpp>

namespace odograph {

/// Artefacts of phone video compression, modelled on H.264's main tools: 16 x 16 blocks predicted from the previous
/// picture by half-pixel motion, or by their mean; the residual as 8 x 8 cosine transform, quantised with a dead zone
/// as coarsely as the bit rate requires; deblocking. Bits are estimated from the levels (2 log2(level) + 5 for each
/// non-zero one), not coded. Deterministic. Not thread-safe.
class VideoCodec {
 public:
  struct Parameters {
    double bit_rate = 5e6;  ///< bit/s of a video of `frame_rate_hz`
    /// Of the phone's video: a frame gets bit_rate / frame_rate_hz, even if fewer frames are recorded.
    double frame_rate_hz = 30;
    int key_interval = 30;  ///< frames between intra-coded pictures
    double key_share = 4;   ///< ratio of the bits of such a picture to those of others
  };
  explicit VideoCodec(const Parameters& parameters) : p_(parameters) {}

  /// Decoded picture of an 8-bit grey picture. Call in time order, with pictures of one size.
  cv::Mat pass(const cv::Mat& grey);
  double step() const { return step_; }  ///< quantisation step of the last picture, grey values
  double bits() const { return bits_; }  ///< of the last picture, estimated

 private:
  using Block = std::array<float, 64>;
  void predict(const cv::Mat& picture, bool key);
  cv::Point2f search(const cv::Mat& picture, int x, int y, const std::vector<cv::Point2f>& guesses, int* cost) const;
  void quantise(double budget, bool key);
  void smooth_edges(cv::Mat& picture) const;

  Parameters p_;
  cv::Mat before_;      // decoded, with a border
  cv::Mat prediction_;  // 16-bit
  std::vector<cv::Point2f> motion_;
  std::vector<Block> blocks_;
  double step_ = 1, bits_ = 0, side_bits_ = 0;
  int frame_ = 0;
};

}  // namespace odograph
