// SPDX-License-Identifier: Apache-2.0
#include "canvas.hpp"

#include <algorithm>

#include <opencv2/imgproc.hpp>

namespace {

constexpr int kShift = 4;  // of OpenCV's fixed-point coordinates
constexpr int kOne = 1 << kShift;
constexpr double kFarthest_px = 20000;

}  // namespace

Canvas::Canvas(const cv::Mat& picture, const odo_calibration& lens, int factor) : lens_(lens), factor_(factor) {
  cv::Mat colour;
  if (picture.channels() == 1)
    cv::cvtColor(picture, colour, cv::COLOR_GRAY2BGR);
  else
    colour = picture;
  cv::resize(colour, picture_, cv::Size(), factor, factor, cv::INTER_CUBIC);
}

/// Pinhole with radial-tangential distortion; undistort a fisheye picture first.
cv::Point Canvas::pixel(const Point& p) const {
  const double x = p.x / p.z, y = p.y / p.z, r2 = x * x + y * y;
  const double* k = lens_.distortion;
  const bool bent = lens_.model == ODO_CAMERA_PINHOLE && lens_.distortion_count >= 4 && r2 < 1.0;
  const double radial = bent ? 1 + r2 * (k[0] + r2 * k[1]) : 1;
  const double dx = bent ? 2 * k[2] * x * y + k[3] * (r2 + 2 * x * x) : 0;
  const double dy = bent ? k[2] * (r2 + 2 * y * y) + 2 * k[3] * x * y : 0;
  const auto to = [&](double f, double value, double c) {
    const double px = factor_ * (f * value + c + 0.5) - 0.5;
    return static_cast<int>(std::lround(kOne * std::clamp(px, -kFarthest_px, kFarthest_px)));
  };
  return {to(lens_.fx, x * radial + dx, lens_.cx), to(lens_.fy, y * radial + dy, lens_.cy)};
}

/// Clips a line to the part in front of the camera; false if there is none.
bool Canvas::clip(Point& a, Point& b) const {
  if (a.z < kNear_m && b.z < kNear_m) return false;
  if (a.z < kNear_m) a = b + (a - b) * ((b.z - kNear_m) / (b.z - a.z));
  if (b.z < kNear_m) b = a + (b - a) * ((a.z - kNear_m) / (a.z - b.z));
  return true;
}

void Canvas::blend(const std::vector<cv::Point>& corners, const cv::Scalar& colour, double opacity) {
  std::vector<cv::Point> whole;
  for (const cv::Point& p : corners) whole.emplace_back(p.x / kOne, p.y / kOne);
  const cv::Rect box =
      (cv::boundingRect(whole) + cv::Size(3, 3) - cv::Point(1, 1)) & cv::Rect(cv::Point(), picture_.size());
  if (box.empty()) return;
  cv::Mat part = picture_(box), over = part.clone();
  std::vector<cv::Point> shifted;
  for (const cv::Point& p : corners) shifted.emplace_back(p.x - kOne * box.x, p.y - kOne * box.y);
  cv::fillConvexPoly(over, shifted, colour, cv::LINE_AA, kShift);
  cv::addWeighted(over, opacity, part, 1 - opacity, 0, part);
}

void Canvas::line(const Point& from, const Point& to, const cv::Scalar& colour, double opacity, int width_px) {
  Point a = from, b = to;
  if (opacity <= 0 || !clip(a, b)) return;
  items_.push_back({std::max(length(a), length(b)), [=, this] {
                      const cv::Point p = pixel(a), q = pixel(b);
                      const cv::Point2d along(q.x - p.x, q.y - p.y);
                      const double norm = std::max(1.0, std::hypot(along.x, along.y));
                      const cv::Point side(static_cast<int>(-along.y / norm * kOne * width_px / 2),
                                           static_cast<int>(along.x / norm * kOne * width_px / 2));
                      blend({p + side, q + side, q - side, p - side}, colour, opacity);
                    }});
}

void Canvas::polygon(const std::vector<Point>& corners, const cv::Scalar& colour, double opacity) {
  std::vector<Point> shown;
  double distance_m = 0;
  for (size_t i = 0; i < corners.size(); ++i) {
    Point a = corners[i], b = corners[(i + 1) % corners.size()];
    if (!clip(a, b)) continue;
    shown.push_back(a);
    shown.push_back(b);
    distance_m += length(corners[i]) / static_cast<double>(corners.size());
  }
  if (shown.size() < 3) return;
  items_.push_back({distance_m, [=, this] {
                      std::vector<cv::Point> pixels;
                      for (const Point& p : shown) pixels.push_back(pixel(p));
                      blend(pixels, colour, opacity);
                    }});
}

void Canvas::ring(const Point& centre, const Point& up, double radius_m, const cv::Scalar& colour, double opacity) {
  const Point side = up.cross(Point(0.3, 0.1, 1));
  const Point u = side * (1 / length(side)), v = up.cross(u);
  constexpr int kParts = 24;
  for (int i = 0; i < kParts; ++i) {
    const auto at = [&](int n, double r) {
      const double angle = 2 * CV_PI * n / kParts;
      return centre + (u * std::cos(angle) + v * std::sin(angle)) * (r * radius_m);
    };
    polygon({at(i, 1), at(i + 1, 1), at(i + 1, 0.72), at(i, 0.72)}, colour, opacity);
  }
}

void Canvas::label(const Point& at, const std::string& text, const std::string& below, const cv::Scalar& colour) {
  if (at.z < kNear_m) return;
  const double distance_m = length(at);
  items_.push_back({distance_m, [=, this] { draw_label(pixel(at), text, below, colour, distance_m); }});
}

void Canvas::draw_label(cv::Point tip, const std::string& text, const std::string& below, const cv::Scalar& colour,
                        double distance_m) {
  const double size = std::clamp(4.0 / distance_m, 0.42, 0.75) * factor_ * lens_.width / 1280.0 * 1.9;
  constexpr int kFont = cv::FONT_HERSHEY_DUPLEX;
  const int thickness = std::max(1, static_cast<int>(std::lround(1.4 * size)));
  int base = 0;
  const cv::Size first = cv::getTextSize(text, kFont, size, thickness, &base);
  const cv::Size second = cv::getTextSize(below, kFont, 0.72 * size, 1, &base);
  const int margin = static_cast<int>(14 * size), gap = static_cast<int>(10 * size);
  const cv::Size plate(std::max(first.width, second.width) + 2 * margin,
                       first.height + second.height + gap + 2 * margin);
  tip.x /= kOne, tip.y /= kOne;
  const cv::Point corner(tip.x - plate.width / 2, tip.y - plate.height - static_cast<int>(16 * size));
  const cv::Rect box(corner, plate), inside = box & cv::Rect(cv::Point(), picture_.size());
  if (inside.empty()) return;
  const auto px = [](int x, int y) { return cv::Point(kOne * x, kOne * y); };
  const int r = static_cast<int>(8 * size);
  blend({px(box.x + r, box.y), px(box.br().x - r, box.y), px(box.br().x, box.y + r), px(box.br().x, box.br().y - r),
         px(box.br().x - r, box.br().y), px(tip.x + r, box.br().y), px(tip.x, tip.y), px(tip.x - r, box.br().y),
         px(box.x + r, box.br().y), px(box.x, box.br().y - r), px(box.x, box.y + r)},
        cv::Scalar(40, 28, 20), 0.78);
  cv::line(picture_, {box.x + r, box.y + 2}, {box.br().x - r, box.y + 2}, colour, 3, cv::LINE_AA);
  cv::putText(picture_, text, {box.x + margin, box.y + margin + first.height}, kFont, size, {255, 255, 255}, thickness,
              cv::LINE_AA);
  cv::putText(picture_, below, {box.x + margin, box.y + margin + first.height + gap + second.height}, kFont,
              0.72 * size, {215, 215, 215}, 1, cv::LINE_AA);
}

void Canvas::finish() {
  std::stable_sort(items_.begin(), items_.end(),
                   [](const Item& a, const Item& b) { return a.distance_m > b.distance_m; });
  for (const Item& item : items_) item.draw();
  items_.clear();
}

void Canvas::map(const std::vector<cv::Point2d>& path, const std::vector<Mark>& marks, double radius_m,
                 const cv::Scalar& path_colour) {
  const double scale = picture_.cols / 1280.0;
  const int radius = static_cast<int>(120 * scale);
  const cv::Point centre(picture_.cols - radius - static_cast<int>(24 * scale), radius + static_cast<int>(24 * scale));
  const cv::Rect box = cv::Rect(centre.x - radius - 2, centre.y - radius - 2, 2 * radius + 5, 2 * radius + 5) &
                       cv::Rect(cv::Point(), picture_.size());
  if (box.empty()) return;
  cv::Mat part = picture_(box), disc = part.clone(), mask(part.size(), CV_8U, cv::Scalar(0));
  const cv::Point middle = centre - box.tl();
  cv::circle(mask, middle, radius, 255, -1, cv::LINE_AA);
  disc = disc * 0.25 + cv::Scalar(40, 28, 20) * 0.75;
  const auto to = [&](const cv::Point2d& m) {
    return cv::Point(static_cast<int>(std::lround(kOne * (middle.x + m.x / radius_m * radius))),
                     static_cast<int>(std::lround(kOne * (middle.y - m.y / radius_m * radius))));
  };
  for (const double part_m : {0.5, 1.0})
    cv::circle(disc, middle, static_cast<int>(part_m * radius) - 1, cv::Scalar(120, 110, 100), 1, cv::LINE_AA);
  std::vector<cv::Point> line;
  for (const cv::Point2d& m : path) line.push_back(to(m));
  cv::polylines(disc, line, false, path_colour, std::max(2, static_cast<int>(4 * scale)), cv::LINE_AA, kShift);
  const int dot = static_cast<int>(kOne * 6 * scale);
  for (const Mark& mark : marks) cv::circle(disc, to(mark.at), dot, mark.colour, -1, cv::LINE_AA, kShift);
  const int a = static_cast<int>(9 * scale);
  cv::fillConvexPoly(disc,
                     std::vector<cv::Point>{{middle.x, middle.y - 2 * a},
                                            {middle.x + a, middle.y + a},
                                            {middle.x, middle.y + a / 2},
                                            {middle.x - a, middle.y + a}},
                     cv::Scalar(255, 255, 255), cv::LINE_AA);
  disc.copyTo(part, mask);
}

void Canvas::status(const std::string& text, const cv::Scalar& colour) {
  const double size = 0.62 * picture_.cols / 1280.0;
  const int height = static_cast<int>(46 * picture_.cols / 1280.0), top = picture_.rows - height;
  const auto px = [](int x, int y) { return cv::Point(kOne * x, kOne * y); };
  blend({px(0, top), px(picture_.cols, top), px(picture_.cols, picture_.rows), px(0, picture_.rows)},
        cv::Scalar(40, 28, 20), 0.72);
  cv::circle(picture_, {height / 2 + 4, top + height / 2}, height / 5, colour, -1, cv::LINE_AA);
  cv::putText(picture_, text, {height + 8, top + static_cast<int>(0.64 * height)}, cv::FONT_HERSHEY_DUPLEX, size,
              {255, 255, 255}, 1, cv::LINE_AA);
}
