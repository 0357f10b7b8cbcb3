// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "plugins/fix/skyline/sky_convolutions.hpp"
#include "plugins/shared/camera/camera_model.hpp"

namespace odograph::skyline {

/// The colour of a picture: Cb and Cr of ITU-R BT.601, 8-bit around 128, both of one size, whichever. Empty: it is
/// grey.
struct Chroma {
  cv::Mat cb, cr;
  bool empty() const { return cb.empty(); }
};

/// What a picture shows of the sky, on a grid of at most SkyNetwork::kLonger_px columns or rows.
struct SkyView {
  cv::Mat log_odds;  ///< CV_32F: natural logarithm of the odds that the pixel shows sky
  cv::Mat contrast;  ///< CV_32F: with the pixels next to it, 0.72 times the logarithm of 1 + grey values
  cv::Mat valid;     ///< CV_8U, 255 where the lens's calibration means something and no mask forbids
  double noise = 0;  ///< median of the contrast where there is sky
  double part = 0;   ///< of the valid pixels that shows sky
  double scale = 1;  ///< pixels of the picture for one of the grid

  /// Pixel of the grid for one of the picture.
  Eigen::Vector2d small_of(const Eigen::Vector2d& pixel) const {
    return (pixel.array() + 0.5).matrix() / scale - Eigen::Vector2d(0.5, 0.5);
  }
};

/// Tells sky from the rest, in colour and in grey, of cameras that look ahead, up or anywhere between, by one network
/// with one set of weights: an encoder and a decoder of separable convolutions (Ronneberger et al. 2015, Howard et al.
/// 2017) on a grid of about 160 x 128. It is told Y, Cb and Cr, where the lens sees and the elevation of each pixel,
/// and says the log-odds there and how they change with Y, Cb and Cr from a pixel to its neighbours, which makes them
/// as fine as the picture. How it was taught: docs/sky_network.md. Thread: one at a time.
class SkyNetwork {
 public:
  static constexpr int kLonger_px = 320;  ///< of SkyView: half a degree of a wide lens
  static constexpr int kGrid_px = 160;    ///< of the network's grid; the other side is a multiple of kMultiple
  static constexpr int kMultiple = 16;
  static constexpr int kPlanes = 5, kTerms = 4;

  /// `farthest_rad`: from the optical axis; what lies beyond is the rim of a fisheye lens and shows nothing.
  SkyNetwork(const CameraModel& camera, cv::Size size, double farthest_rad);

  /// `grey`: 8-bit, of the size given; `mask`: 0 where the picture is not to be used, may be empty; `up_c`: the
  /// zenith's direction in c, unit, in the picture or out of it; zero where no attitude is known.
  const SkyView& look(const cv::Mat& grey, const cv::Mat& mask, const Chroma& chroma, const Eigen::Vector3d& up_c);
  /// Log-odds of each pixel of the latest picture, which was this one, CV_32F.
  void log_odds(const cv::Mat& grey, const Chroma& chroma, cv::Size size, cv::Mat& out) const;
  /// What the network was told and what it said, for tests.
  const Volume& planes() const { return planes_; }
  const Volume& terms() const { return terms_; }

 private:
  struct Separable {
    Convolution deep, flat;
  };
  void measure(const cv::Mat& grey, const cv::Mat& mask);
  void tell(const cv::Mat& grey, const Chroma& chroma, const Eigen::Vector3d& up_c);
  void judge();
  void run(const Separable& block, const Volume& in, Volume& out);
  void run(const std::vector<Separable>& blocks, const Volume& in, Volume& out);
  void summarise();

  cv::Size size_, small_, grid_;
  cv::Mat lens_valid_;
  std::vector<Eigen::Vector3f> rays_;  // of the grid's pixels, unit; zero where there is none
  Convolution fine_, stem_, last_;
  std::vector<Separable> down_[4];  // to a half, a fourth, an eighth and a sixteenth
  struct Up {
    Convolution narrow;
    Separable join;
  };
  std::vector<Up> up_;
  Volume planes_, terms_, split_, deep_, narrow_, half_, levels_[5], swap_[2], joined_;
  cv::Mat told_[3];  // Y, Cb, Cr on the grid
  SkyView view_;
  cv::Mat image_, low_, high_, bytes_;
};

}  // namespace odograph::skyline
