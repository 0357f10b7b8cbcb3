// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "plugins/fix/skyline/sky_convolutions.hpp"
#include "plugins/shared/camera/camera_model.hpp"

namespace odograph::skyline {

/// The colour of a picture: Cb and Cr of ITU-R BT.601, 8-bit around 128, both of the same size, which may differ from
/// the picture's. Empty for a grey picture.
struct Chroma {
  cv::Mat cb, cr;
  bool empty() const { return cb.empty(); }
};

/// Sky segmentation of a picture, on a grid of at most SkyNetwork::kLonger_px columns or rows.
struct SkyView {
  cv::Mat log_odds;  ///< CV_32F: natural logarithm of the odds that the pixel shows sky
  cv::Mat contrast;  ///< CV_32F: contrast with adjacent pixels: 0.72 times the logarithm of 1 + grey values
  cv::Mat valid;     ///< CV_8U, 255 where the lens's calibration is valid and the mask allows
  double noise = 0;  ///< median of the contrast in the sky
  double part = 0;   ///< fraction of the valid pixels that shows sky
  double scale = 1;  ///< pixels of the picture per pixel of the grid

  /// Pixel of the grid for a pixel of the picture.
  Eigen::Vector2d small_of(const Eigen::Vector2d& pixel) const {
    return (pixel.array() + 0.5).matrix() / scale - Eigen::Vector2d(0.5, 0.5);
  }
};

/// Segments the sky, in colour and in grey, for cameras that face ahead, up or anywhere between: one network with one
/// set of weights, an encoder and a decoder of separable convolutions (Ronneberger et al. 2015, Howard et al. 2017) on
/// a grid of about 160 x 128. Inputs are Y, Cb and Cr, the valid area and the elevation of each pixel. Outputs are the
/// log-odds of sky and their derivatives by Y, Cb and Cr within a neighbourhood, which give log-odds at the picture's
/// resolution. Training: docs/sky_network.md. Thread: one at a time.
class SkyNetwork {
 public:
  static constexpr int kLonger_px = 320;  ///< of SkyView: half a degree per pixel with a wide lens
  static constexpr int kGrid_px = 160;    ///< of the network's grid; the other side is a multiple of kMultiple
  static constexpr int kMultiple = 16;
  static constexpr int kPlanes = 5, kTerms = 4;

  /// `farthest_rad`: from the optical axis; beyond is the rim of a fisheye lens.
  SkyNetwork(const CameraModel& camera, cv::Size size, double farthest_rad);

  /// `grey`: 8-bit, of the size given; `mask`: 0 where the picture must not be used, may be empty; `up_c`: the zenith's
  /// direction in c, unit, inside or outside the picture; zero without an attitude.
  const SkyView& segment(const cv::Mat& grey, const cv::Mat& mask, const Chroma& chroma, const Eigen::Vector3d& up_c);
  /// Log-odds of each pixel of the latest picture, CV_32F; the arguments must be that picture's.
  void log_odds(const cv::Mat& grey, const Chroma& chroma, cv::Size size, cv::Mat& out) const;
  /// Inputs and outputs of the network, for tests.
  const Volume& planes() const { return planes_; }
  const Volume& terms() const { return terms_; }

 private:
  struct Separable {
    Convolution deep, flat;
  };
  void measure(const cv::Mat& grey, const cv::Mat& mask);
  void set_inputs(const cv::Mat& grey, const Chroma& chroma, const Eigen::Vector3d& up_c);
  void forward();
  void run(const Separable& block, const Volume& in, Volume& out);
  void run(const std::vector<Separable>& blocks, const Volume& in, Volume& out);
  void summarise();

  cv::Size size_, small_, grid_;
  cv::Mat lens_valid_;
  std::vector<Eigen::Vector3f> rays_;  // of the grid's pixels, unit; zero where there is none
  Convolution fine_, stem_, last_;
  std::vector<Separable> down_[4];  // to 1/2, 1/4, 1/8 and 1/16
  struct Up {
    Convolution narrow;
    Separable join;
  };
  std::vector<Up> up_;
  Volume planes_, terms_, split_, deep_, narrow_, half_, levels_[5], swap_[2], joined_;
  cv::Mat input_planes_[3];  // Y, Cb, Cr on the grid
  SkyView view_;
  cv::Mat image_, low_, high_, bytes_;
};

}  // namespace odograph::skyline
