// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <odograph/odograph.h>
#include <opencv2/core.hpp>

#include "geometry.hpp"

/// Draws objects over a picture, farthest first, so that near ones occlude far ones. Points are in the camera's axes,
/// m; colours are blue, green, red.
class Canvas {
 public:
  static constexpr double kNear_m = 0.15;  // near clipping distance

  /// The picture is enlarged by an integer factor, so that lines and letters are finer than its pixels.
  Canvas(const cv::Mat& picture, const odo_calibration& lens, int factor);

  void line(const Point& a, const Point& b, const cv::Scalar& colour, double opacity, int width_px);
  void polygon(const std::vector<Point>& corners, const cv::Scalar& colour, double opacity);
  /// A ring of the given radius around a point on the ground, `up` being the direction away from the ground.
  void ring(const Point& centre, const Point& up, double radius_m, const cv::Scalar& colour, double opacity);
  /// Two lines of text on a plate above a point, with a stem down to it.
  void label(const Point& at, const std::string& text, const std::string& below, const cv::Scalar& colour);
  /// Draws everything. Nothing may be added afterwards.
  void finish();
  /// Overlay: a round map in the upper right corner with the direction ahead up. Points in m from the phone, right and
  /// ahead; the path as a line, marks as dots in their colours.
  struct Mark {
    cv::Point2d at;
    cv::Scalar colour;
  };
  void map(const std::vector<cv::Point2d>& path, const std::vector<Mark>& marks, double radius_m,
           const cv::Scalar& path_colour);
  /// Overlay: a line of text along the lower edge, with an indicator in a colour.
  void status(const std::string& text, const cv::Scalar& colour);
  const cv::Mat& picture() const { return picture_; }

 private:
  struct Item {
    double distance_m;
    std::function<void()> draw;
  };
  cv::Point pixel(const Point& p) const;  // in sixteenths
  bool clip(Point& a, Point& b) const;
  void blend(const std::vector<cv::Point>& corners, const cv::Scalar& colour, double opacity);
  void draw_label(cv::Point tip, const std::string& text, const std::string& below, const cv::Scalar& colour,
                  double distance_m);

  cv::Mat picture_;
  odo_calibration lens_;
  int factor_;
  std::vector<Item> items_;
};
