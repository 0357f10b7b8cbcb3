// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include <opencv2/core.hpp>

namespace odograph {

/// What a phone's video compression does to pictures, after H.264's main tools: blocks of 16 x 16 predicted from the
/// picture before by motion of half pixels, or by their mean; the rest as cosine transform of 8 x 8, quantised with a
/// dead zone as coarsely as the bit rate demands; edges of blocks smoothed. Bits are estimated from the levels
/// (2 log2(level) + 5 for each that is not zero), not coded. Deterministic. Thread: one.
class VideoCodec {
 public:
  struct Parameters {
    double bit_rate = 5e6;      ///< bit/s of a video of `frame_rate_hz`
    double frame_rate_hz = 30;  ///< phones' video: a frame gets bit_rate / frame_rate_hz, however few are recorded
    int key_interval = 30;      ///< frames from one picture that is predicted from nothing to the next
    double key_share = 4;       ///< such a picture gets this many times a frame's bits
  };
  explicit VideoCodec(const Parameters& parameters) : p_(parameters) {}

  /// What the decoder shows of an 8-bit grey picture; in the order of time, all of one size.
  cv::Mat pass(const cv::Mat& grey);
  double step() const { return step_; }  ///< of quantisation of the last picture, grey values
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
