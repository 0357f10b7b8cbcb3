// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "plugins/fix/known_object/plane_object.hpp"
#include "plugins/fix/known_object/rolling_lens.hpp"

namespace odograph::known_object {

/// An object's picture at falling resolution, each level half of the one before.
class Pyramid {
 public:
  explicit Pyramid(const PlaneObject& object);
  /// The picture's grey at (x, y) of o, m, seen by a pixel that spans the two vectors (m) and is blurred by `sigma_px`
  /// of them.
  float seen(const Eigen::Vector2d& at_m, const Eigen::Matrix2d& pixel_m, double sigma_px) const;
  int width() const { return levels_.front().cols; }
  int height() const { return levels_.front().rows; }
  double width_m() const { return width_m_; }
  double height_m() const { return height_m_; }

 private:
  std::vector<cv::Mat> levels_;  // float
  double width_m_, height_m_;
};

/// How well a pose explains a picture, pixel by pixel.
struct Alignment {
  Pose pose;
  Eigen::Matrix<double, 6, 6> information;  ///< of (theta, delta) of Pose::moved, rad and m, at the noise found
  double cost = 0;                          ///< sum of weighted squares over the noise's variance
  double noise_grey = 0;                    ///< standard deviation of what is left
  double correlation = 0;                   ///< of the picture expected and the one seen
  double agreeing_part = 0;  ///< of the object's parts that have a pattern: how many correlate themselves
  double visible_part = 0;   ///< inside of the frame and not masked
  double side_px = 0;        ///< root of its area in the frame
  double oblique_rad = 0;    ///< between the line of sight and the object's normal
};

/// Direct alignment of a known flat picture: Gauss-Newton over the six parameters of the pose and gain, offset and two
/// slopes of the light, with Huber weights, from coarse to fine (Lucas & Kanade 1981; Baker & Matthews, IJCV 56, 2004).
/// Each expected grey value is the picture's, averaged over what the pixel sees of it.
class Aligner {
 public:
  struct Parameters {
    std::vector<double> blur_px = {3, 1.2, 0};  ///< of frame and picture, from coarse to fine
    double lens_blur_px = 0.6;  ///< pixel, lens and interpolation, of frames that are not blurred further; judgement
    size_t points = 1600;       ///< compared
    double alike_points = 8;    ///< neighbours whose errors are alike: what information is divided by; bench
    int parts = 5;              ///< the object is cut into parts x parts for `agreeing_part`; judgement
    double part_correlation = 0.6;  ///< of a part that agrees; judgement
    int iterations = 12;            ///< of Gauss-Newton on a level; judgement
    int rounds = 3;                 ///< of what a pixel sees, computed anew between the iterations; judgement
    double rim = 2;                 ///< blurs: nearer to the object's rim a frame shows what is around it
    double min_visible = 0.5;       ///< of the object, in the frame and not masked; judgement
    size_t min_samples = 16;        ///< compared: ten unknowns and some
    double settled_px = 0.01;       ///< motion of the object's corners, that ends a level
    double first_noise_grey = 15;   ///< before a median is known: lets the light be off; judgement
    double min_noise_grey = 0.7;    ///< a camera's own, and rounding
    double huber = 1.345;           ///< of the noise: 95 % efficient (Huber 1981)
    double margin_px = 2;           ///< from the frame's border: where gradients are known
    double min_gain = 0.05;         ///< of the light: less, and it is no picture of the object; judgement
    double nearest_m = 0.1;         ///< of the object; judgement
    double max_step_rad = 0.5;      ///< of an iteration: more, and it diverges; judgement
    double max_oblique_rad = 1.5;   ///< 86 degrees: a line, no picture
  };
  /// One frame and its blurred copies; `mask` may be empty.
  struct Frame {
    Frame(const cv::Mat& grey, const cv::Mat& mask, const Parameters& parameters);
    std::vector<cv::Mat> blurred;  // float
    cv::Mat mask;
  };
  explicit Aligner(const Parameters& parameters) : p_(parameters) {}

  /// From a pose within some pixels, or, where `fine`, within one. Nothing where it does not converge or less than
  /// half of the object is in the frame.
  std::optional<Alignment> align(const Frame& frame, const RollingLens& lens, const Pyramid& picture, const Pose& start,
                                 bool fine = false) const;
  const Parameters& parameters() const { return p_; }

 private:
  struct Sample;
  struct Light {
    double gain = 1, offset = 0, slope_x = 0, slope_y = 0;
  };
  std::vector<Sample> expected(const RollingLens& lens, const Pyramid& picture, const Pose& pose,
                               double sigma_px) const;
  static Light first_light(const cv::Mat& grey, const RollingLens& lens, const std::vector<Sample>& samples,
                           const Pose& pose);
  /// Gauss-Newton's equations over pose (6) and light (4).
  struct Equations;
  Equations equations(const cv::Mat& grey, const cv::Mat& mask, const RollingLens& lens, const Pyramid& picture,
                      const std::vector<Sample>& samples, const Pose& pose, const Light& light, double noise) const;
  bool refine(const Frame& frame, size_t level, const RollingLens& lens, const Pyramid& picture, Alignment& a) const;
  void judge(const cv::Mat& grey, const cv::Mat& mask, const RollingLens& lens, const Pyramid& picture,
             const std::vector<Sample>& samples, const Light& light, Alignment& a) const;

  Parameters p_;
};

}  // namespace odograph::known_object
