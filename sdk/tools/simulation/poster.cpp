// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/simulation/poster.hpp"

#include <algorithm>
#include <cmath>

#include <apriltag/tag36h11.h>
#include <opencv2/imgproc.hpp>

#include "sdk/tools/simulation/lens_model.hpp"
#include "sdk/tools/simulation/random.hpp"

namespace odograph {
namespace {

using Eigen::Vector3d;

constexpr int kPosterSide = 4;  // samples per pixel in each direction, for pictures in the foreground
constexpr double kLensBlur_px = 0.45;

int whole(double x) { return static_cast<int>(std::lround(x)); }

void draw_text(cv::Mat& picture, Random& random, const cv::Rect& box) {
  for (int y = box.y + 8; y < box.br().y; y += 14) {
    std::string line;
    for (int k = 0; k < 3 + static_cast<int>(random.next() % 6); ++k) {
      for (uint64_t n = 2 + random.next() % 8; n > 0; --n) line += static_cast<char>('a' + random.next() % 26);
      line += ' ';
    }
    cv::Mat inside = picture(box);
    cv::putText(inside, line, {2, y - box.y}, cv::FONT_HERSHEY_SIMPLEX, 0.42, random.uniform(10, 80), 1, cv::LINE_AA);
  }
}

void draw_plan(cv::Mat& picture, Random& random, const cv::Rect& box) {
  cv::Mat inside = picture(box);
  inside.setTo(random.uniform(200, 245));
  const auto point = [&](double x0, double x1, double y0, double y1) {
    const double y = random.uniform(y0, y1), x = random.uniform(x0, x1);
    return cv::Point(whole(x), whole(y));
  };
  const auto anywhere = [&] { return point(0, box.width, 0, box.height); };
  for (int k = 0; k < 14; ++k) {
    const cv::Point a = anywhere(), b = a + point(20, 90, 20, 70);
    cv::rectangle(inside, a, b, random.uniform(120, 215), cv::FILLED);
  }
  for (int k = 0; k < 9; ++k) {
    const int thickness = 1 + whole(random.uniform(0, 7));
    const double grey = random.uniform(20, 160);
    const cv::Point b = anywhere(), a = anywhere();
    cv::line(inside, a, b, grey, thickness, cv::LINE_AA);
  }
  for (int k = 0; k < 8; ++k) {
    const double grey = random.uniform(0, 110);
    const int radius = whole(random.uniform(4, 14));
    cv::circle(inside, anywhere(), radius, grey, cv::FILLED, cv::LINE_AA);
  }
}

void draw_photograph(cv::Mat& picture, Random& random, const cv::Rect& box) {
  cv::Mat sum(box.size(), CV_32F, cv::Scalar(random.uniform(90, 160)));
  for (int cells = 3; cells <= 48; cells *= 2) {
    cv::Mat coarse(cells, cells, CV_32F), fine;
    for (int y = 0; y < cells; ++y)
      for (int x = 0; x < cells; ++x) coarse.at<float>(y, x) = static_cast<float>(random.uniform(-1, 1));
    cv::resize(coarse, fine, box.size(), 0, 0, cv::INTER_CUBIC);
    sum += 110.0 / std::sqrt(cells) * fine;
  }
  cv::Mat inside = picture(box);
  sum.convertTo(inside, CV_8U);
}

}  // namespace

cv::Mat poster_picture(uint64_t layout, uint64_t content, cv::Size size_px) {
  // Drawn at one size, so that text and lines have the same width.
  const double aspect = static_cast<double>(size_px.width) / size_px.height;
  const int height = 720, width = whole(height * aspect);
  cv::Mat picture(height, width, CV_8U);
  Random place(layout, 11), what(content, 12);
  picture.setTo(place.uniform(205, 250));
  const int header = whole(place.uniform(0.1, 0.2) * height), margin = 12;
  const double tone = place.uniform(15, 110);
  cv::rectangle(picture, {0, 0, width, header}, tone, cv::FILLED);
  static const char* const kNames[] = {"NAVIBUS", "Ville", "Musee", "STATION", "Plan du quartier", "Horaires"};
  cv::putText(picture, kNames[place.next() % std::size(kNames)], {margin, header - header / 3}, cv::FONT_HERSHEY_DUPLEX,
              header / 60.0, 250, 2, cv::LINE_AA);
  const double split_x = place.uniform(0.4, 0.65), split_y = place.uniform(0.4, 0.65);
  const int left = whole(split_x * width), top = header + whole(split_y * (height - header));
  const bool plan_left = place.uniform() < 0.5;
  const cv::Rect a(margin, header + margin, left - 2 * margin, top - header - 2 * margin);
  const cv::Rect b(left, header + margin, width - left - margin, top - header - 2 * margin);
  const cv::Rect c(margin, top, left - 2 * margin, height - top - margin);
  const cv::Rect d(left, top, width - left - margin, height - top - margin);
  draw_plan(picture, what, plan_left ? a : b);
  draw_photograph(picture, what, plan_left ? b : a);
  draw_text(picture, what, c);
  if (place.uniform() < 0.5)
    draw_photograph(picture, what, d);
  else
    draw_text(picture, what, d);
  cv::rectangle(picture, {0, 0, width, height}, tone, 6);
  cv::Mat out;
  cv::resize(picture, out, size_px, 0, 0, size_px.height < height ? cv::INTER_AREA : cv::INTER_CUBIC);
  return out;
}

cv::Mat poster_on_wall(uint64_t number, double aspect) {
  constexpr int kLonger = 1024;
  const cv::Size size =
      aspect > 1 ? cv::Size(kLonger, whole(kLonger / aspect)) : cv::Size(whole(kLonger * aspect), kLonger);
  return poster_picture(number, number, size);
}

cv::Mat tag_board_picture(uint32_t tag, int side_px) {
  apriltag_family_t* family = tag36h11_create();
  image_u8_t* cells = apriltag_to_image(family, static_cast<int>(tag % family->ncodes));
  const int white = (family->total_width - family->width_at_border) / 2, side = family->width_at_border;
  cv::Mat board;
  const cv::Mat all(cells->height, cells->width, CV_8U, cells->buf, static_cast<size_t>(cells->stride));
  cv::resize(all(cv::Rect(white, white, side, side)), board, {side_px, side_px}, 0, 0, cv::INTER_NEAREST);
  image_u8_destroy(cells);
  tag36h11_destroy(family);
  return board;
}

PosterCamera::PosterCamera(const odo_calibration& lens) : lens_(lens) {
  const int width = static_cast<int>(lens.width), height = static_cast<int>(lens.height);
  std::vector<cv::Point2d> pixels;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) pixels.emplace_back(x, y);
  const std::vector<cv::Point2d> rays = rays_of(lens, pixels);
  rays_.create(height, width, CV_32FC2);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const cv::Point2d& ray = rays[static_cast<size_t>(y * width + x)];
      rays_.at<cv::Vec2f>(y, x) = {static_cast<float>(ray.x), static_cast<float>(ray.y)};
    }
}

Eigen::Vector2d PosterCamera::project(const Vector3d& p) const {
  const cv::Point2d pixel = odograph::project(lens_, p);
  return {pixel.x, pixel.y};
}

bool PosterCamera::sees(const FlatPicture& o, double margin_px) const {
  for (const double x : {-0.5, 0.0, 0.5})
    for (const double y : {-0.5, 0.0, 0.5}) {
      const Vector3d p = o.T_c_o * Vector3d(x * o.width_m, y * o.height_m, 0);
      if (p.z() < 0.2 || p.head<2>().norm() > 1.5 * p.z()) return false;
      const Eigen::Vector2d u = project(p);
      if (u.x() < margin_px || u.y() < margin_px || u.x() > lens_.width - 1 - margin_px ||
          u.y() > lens_.height - 1 - margin_px)
        return false;
    }
  return true;
}

/// Pixels covered by a picture's corners and edge midpoints, with a margin; none if a part is behind the camera.
cv::Rect PosterCamera::reach(const FlatPicture& o) const {
  double low_x = 1e9, low_y = 1e9, high_x = -1e9, high_y = -1e9;
  for (const double x : {-0.5, 0.0, 0.5})
    for (const double y : {-0.5, 0.0, 0.5}) {
      const Vector3d p = o.T_c_o * Vector3d(x * o.width_m, y * o.height_m, 0);
      if (p.z() < 0.1) return {};
      const Eigen::Vector2d u = project(p);
      low_x = std::min(low_x, u.x()), high_x = std::max(high_x, u.x());
      low_y = std::min(low_y, u.y()), high_y = std::max(high_y, u.y());
    }
  const auto near = [](double v) { return whole(std::clamp(v, -1e5, 1e5)); };
  return {cv::Point(near(low_x - 12), near(low_y - 12)), cv::Point(near(high_x + 12), near(high_y + 12))};
}

/// Texture coordinates of each sample in the box, with the camera moving from row to row.
void PosterCamera::look_up(const FlatPicture& o, const Shot& shot, int samples, const cv::Rect& box,
                           const cv::Size& texture, cv::Mat& map_x, cv::Mat& map_y) const {
  const double scale_x = texture.width / o.width_m, scale_y = texture.height / o.height_m;
  for (int i = 0; i < map_x.rows; ++i) {
    const double y = box.y + (i + 0.5) / samples - 0.5;
    const double after_s = (y - 0.5 * (lens_.height - 1)) * shot.line_time_s;
    // x_c(t) = x_c - t (rate x x_c + velocity)
    const Eigen::Matrix3d rotation =
        (Eigen::Matrix3d() << 1, after_s * shot.rate_c.z(), -after_s * shot.rate_c.y(), -after_s * shot.rate_c.z(), 1,
         after_s * shot.rate_c.x(), after_s * shot.rate_c.y(), -after_s * shot.rate_c.x(), 1)
            .finished();
    Eigen::Matrix3d plane;
    plane.leftCols<2>() = rotation * o.T_c_o.linear().leftCols<2>();
    plane.col(2) = rotation * o.T_c_o.translation() - after_s * shot.velocity_c;
    const Eigen::Matrix3d inverse = plane.inverse();
    const int y0 = std::clamp(static_cast<int>(std::floor(y)), 0, rays_.rows - 2);
    const auto wy = static_cast<float>(y - y0);
    for (int k = 0; k < map_x.cols; ++k) {
      const double x = box.x + (k + 0.5) / samples - 0.5;
      const int x0 = std::clamp(static_cast<int>(std::floor(x)), 0, rays_.cols - 2);
      const auto wx = static_cast<float>(x - x0);
      const auto *a = rays_.ptr<cv::Vec2f>(y0) + x0, *b = rays_.ptr<cv::Vec2f>(y0 + 1) + x0;
      const cv::Vec2f ray = (1 - wy) * ((1 - wx) * a[0] + wx * a[1]) + wy * ((1 - wx) * b[0] + wx * b[1]);
      const Vector3d q = inverse * Vector3d(ray[0], ray[1], 1);
      const bool met = q.z() > 1e-6;
      map_x.at<float>(i, k) = met ? static_cast<float>((q.x() / q.z() + 0.5 * o.width_m) * scale_x - 0.5) : -1e4F;
      map_y.at<float>(i, k) = met ? static_cast<float>((q.y() / q.z() + 0.5 * o.height_m) * scale_y - 0.5) : -1e4F;
    }
  }
}

void PosterCamera::paint(const FlatPicture& o, const Shot& shot, int samples, cv::Mat& light) const {
  cv::Rect box(0, 0, light.cols, light.rows);
  if (samples > 1) box &= reach(o);
  if (box.empty()) return;
  // Mipmaps where a sample spans more than a texel.
  const double texel_m = o.width_m / o.grey.cols, z = o.T_c_o.translation().norm();
  cv::Mat texture = o.grey;
  for (double span = z / lens_.fx / samples / texel_m; span >= 1.6 && texture.cols > 8; span *= 0.5)
    cv::resize(texture, texture, {}, 0.5, 0.5, cv::INTER_AREA);
  cv::Mat map_x(box.height * samples, box.width * samples, CV_32F), map_y(map_x.size(), CV_32F);
  look_up(o, shot, samples, box, texture.size(), map_x, map_y);
  cv::Mat fine, covered, cover;
  const bool wall = samples == 1;
  cv::remap(texture, fine, map_x, map_y, cv::INTER_LINEAR, wall ? cv::BORDER_REFLECT : cv::BORDER_REPLICATE);
  cv::Mat inside = (map_x >= -0.5) & (map_x < texture.cols - 0.5) & (map_y >= -0.5) & (map_y < texture.rows - 0.5);
  fine.convertTo(fine, CV_32F);
  if (wall) {
    fine.copyTo(light(box));
    return;
  }
  inside.convertTo(cover, CV_32F, 1 / 255.0);
  fine = fine.mul(cover);
  cv::resize(fine, fine, box.size(), 0, 0, cv::INTER_AREA);
  cv::resize(cover, covered, box.size(), 0, 0, cv::INTER_AREA);
  cv::Mat under = light(box);
  under = under.mul(1 - covered) + fine;
}

cv::Mat PosterCamera::take(const std::vector<FlatPicture>& pictures, const Shot& shot) const {
  const int width = static_cast<int>(lens_.width), height = static_cast<int>(lens_.height);
  cv::Mat light(height, width, CV_32F, cv::Scalar(110));
  for (size_t k = 0; k < pictures.size(); ++k) paint(pictures[k], shot, k == 0 ? 1 : kPosterSide, light);
  cv::GaussianBlur(light, light, {0, 0}, kLensBlur_px);
  // Motion blur at the centre: rotation and velocity at the first picture's distance.
  if (pictures.size() > 1) {
    const Vector3d p = pictures[1].T_c_o.translation();
    const Vector3d flow = -(shot.rate_c.cross(p) + shot.velocity_c);
    const double u = lens_.fx * (flow.x() - flow.z() * p.x() / p.z()) / p.z() * shot.exposure_s;
    const double v = lens_.fy * (flow.y() - flow.z() * p.y() / p.z()) / p.z() * shot.exposure_s;
    const int steps = std::clamp(whole(3 * std::hypot(u, v)), 1, 31);
    if (steps > 1) {
      cv::Mat sum(light.size(), CV_32F, cv::Scalar(0)), moved;
      for (int k = 0; k < steps; ++k) {
        const double part = (k + 0.5) / steps - 0.5;
        const cv::Matx23d shift(1, 0, part * u, 0, 1, part * v);
        cv::warpAffine(light, moved, shift, light.size(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
        sum += moved;
      }
      light = sum / steps;
    }
  }
  Random random(shot.seed, 77);
  const double direction = random.uniform(0, 2 * M_PI), edge_direction = random.uniform(0, 2 * M_PI);
  const double edge = random.uniform(-0.3, 0.3);
  cv::Mat out(height, width, CV_8U);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const double a = (x - 0.5 * width) / width, b = (y - 0.5 * height) / width;
      double gain = shot.light + shot.slope * (a * std::cos(direction) + b * std::sin(direction));
      gain *= 1 - 0.25 * (a * a + b * b) / 0.39;
      const double side = a * std::cos(edge_direction) + b * std::sin(edge_direction) - edge;
      if (shot.shadow < 1) gain *= 1 - (1 - shot.shadow) * std::clamp(side * width / 6 + 0.5, 0.0, 1.0);
      out.at<uint8_t>(y, x) =
          cv::saturate_cast<uint8_t>(8 + gain * light.at<float>(y, x) + shot.noise * random.normal());
    }
  return out;
}

}  // namespace odograph
