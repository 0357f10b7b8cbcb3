// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "plugins/fix/known_object/plane_object.hpp"
#include "plugins/fix/known_object/rolling_lens.hpp"

namespace odograph::known_object {

/// Image pyramid of an object's picture; each level has half the resolution of the previous one.
class Pyramid {
 public:
  explicit Pyramid(const PlaneObject& object);
  /// Grey value at (x, y) of o, m, as seen by a pixel that spans the two vectors (m), blurred by `sigma_px` pixels.
  float seen(const Eigen::Vector2d& at_m, const Eigen::Matrix2d& pixel_m, double sigma_px) const;
  int width() const { return levels_.front().cols; }
  int height() const { return levels_.front().rows; }
  double width_m() const { return width_m_; }
  double height_m() const { return height_m_; }

 private:
  std::vector<cv::Mat> levels_;  // float
  double width_m_, height_m_;
};

/// Result of the direct alignment of a pose.
struct Alignment {
  Pose pose;
  Eigen::Matrix<double, 6, 6> information;  ///< of (theta, delta) of Pose::moved, rad and m, at the estimated noise
  double cost = 0;                          ///< sum of weighted squares over the noise variance
  double noise_grey = 0;                    ///< standard deviation of the residuals
  double correlation = 0;                   ///< of the expected picture with the frame
  double agreeing_part = 0;                 ///< share of the object's patterned parts that correlate individually
  double visible_part = 0;                  ///< share inside the frame and not masked
  double side_px = 0;                       ///< square root of its area in the frame
  double oblique_rad = 0;                   ///< between the line of sight and the normal of the object
};

/// Direct alignment of a known planar picture: Gauss-Newton over the six parameters of the pose and gain, offset and
/// two slopes of the illumination, with Huber weights, coarse to fine (Lucas & Kanade 1981; Baker & Matthews, IJCV 56,
/// 2004). Each expected grey value is the mean of the picture over the pixel's footprint.
class Aligner {
 public:
  struct Parameters {
    std::vector<double> blur_px = {3, 1.2, 0};  ///< of frame and picture, coarse to fine
    double lens_blur_px = 0.6;                  ///< pixel, lens and interpolation, without further blurring; empirical
    size_t points = 1600;                       ///< samples compared
    double correlated_points = 8;   ///< neighbours with correlated errors, by which the information is divided; bench
    int parts = 5;                  ///< the object is divided into parts x parts for `agreeing_part`; empirical
    double part_correlation = 0.6;  ///< min of a part that agrees; empirical
    int iterations = 12;            ///< of Gauss-Newton per level; empirical
    int rounds = 3;                 ///< recomputations of the pixel footprints between the iterations; empirical
    double rim = 2;                 ///< in blurs: closer to the rim a frame mixes in the surroundings
    double min_visible = 0.5;       ///< share of the object in the frame and not masked; empirical
    size_t min_samples = 16;        ///< for ten unknowns
    double converged_px = 0.01;     ///< motion of the object's corners below which a level ends
    double first_noise_grey = 15;   ///< before the first median: allows for an illumination error; empirical
    double min_noise_grey = 0.7;    ///< camera noise and rounding
    double huber = 1.345;           ///< in units of the noise: 95 % efficient (Huber 1981)
    double margin_px = 2;           ///< from the frame's border, where gradients are valid
    double min_gain = 0.05;         ///< of the illumination: below it the frame does not show the object; empirical
    double nearest_m = 0.1;         ///< min distance of the object; empirical
    double max_step_rad = 0.5;      ///< per iteration: above it the iteration diverges; empirical
    double max_oblique_rad = 1.5;   ///< 86 degrees: nearly edge-on
  };
  /// A frame and its blurred copies; `mask` may be empty.
  struct Frame {
    Frame(const cv::Mat& grey, const cv::Mat& mask, const Parameters& parameters);
    std::vector<cv::Mat> blurred;  // float
    cv::Mat mask;
  };
  explicit Aligner(const Parameters& parameters) : p_(parameters) {}

  /// Starts from a pose accurate to some pixels, or to one pixel with `fine`. Nothing if it does not converge or less
  /// than half of the object is in the frame.
  std::optional<Alignment> align(const Frame& frame, const RollingLens& lens, const Pyramid& picture, const Pose& start,
                                 bool fine = false) const;
  const Parameters& parameters() const { return p_; }

 private:
  struct Sample;
  struct Illumination {
    double gain = 1, offset = 0, slope_x = 0, slope_y = 0;
  };
  std::vector<Sample> expected(const RollingLens& lens, const Pyramid& picture, const Pose& pose,
                               double sigma_px) const;
  static Illumination initial_illumination(const cv::Mat& grey, const RollingLens& lens,
                                           const std::vector<Sample>& samples, const Pose& pose);
  /// Gauss-Newton equations over pose (6) and illumination (4).
  struct Equations;
  Equations equations(const cv::Mat& grey, const cv::Mat& mask, const RollingLens& lens, const Pyramid& picture,
                      const std::vector<Sample>& samples, const Pose& pose, const Illumination& light,
                      double noise) const;
  bool refine(const Frame& frame, size_t level, const RollingLens& lens, const Pyramid& picture, Alignment& a) const;
  void score(const cv::Mat& grey, const cv::Mat& mask, const RollingLens& lens, const Pyramid& picture,
             const std::vector<Sample>& samples, const Illumination& light, Alignment& a) const;

  Parameters p_;
};

}  // namespace odograph::known_object
