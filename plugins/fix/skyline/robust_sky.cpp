// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/skyline/robust_sky.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "plugins/fix/skyline/sky_rays.hpp"

namespace odograph::skyline {
namespace {

constexpr int kColumns = SkyFinder::kDirections;
constexpr float kNever = 1e6f;
constexpr int kKnots = 4;  // samples between two evaluations of the lens model

float bilinear(const cv::Mat& grey, const Eigen::Vector2d& p) {
  const int x = static_cast<int>(p.x()), y = static_cast<int>(p.y());
  const auto a = static_cast<float>(p.x() - x), b = static_cast<float>(p.y() - y);
  const auto *top = grey.ptr<uint8_t>(y) + x, *low = grey.ptr<uint8_t>(y + 1) + x;
  return (1 - b) * ((1 - a) * top[0] + a * top[1]) + b * ((1 - a) * low[0] + a * low[1]);
}

}  // namespace

RobustSkyFinder::RobustSkyFinder(const Parameters& parameters, const CameraModel& camera, cv::Size size)
    : p_(parameters), camera_(camera), network_(camera, size, parameters.farthest_rad) {}

const std::vector<SkyEdge>& RobustSkyFinder::find(const cv::Mat& grey, const cv::Mat& mask, const Eigen::Vector3d& up_c,
                                                  const Eigen::Vector3d& north_c, const Chroma& chroma) {
  edges_.clear();
  sky_ = &network_.segment(grey, mask, chroma, up_c);
  if (sky_->part < p_.min_sky_part) return edges_;
  sample(up_c, north_c);
  unary();
  draw_line();
  extract_edges(grey);
  return edges_;
}

/// Samples the log-odds by direction and angle from the zenith.
void RobustSkyFinder::sample(const Eigen::Vector3d& up_c, const Eigen::Vector3d& north_c) {
  up_ = up_c;
  step_rad_ = sky_->scale / camera_.focal();
  rows_ = static_cast<int>(p_.lowest_rad / step_rad_);
  const Eigen::Vector3d north = (north_c - north_c.dot(up_c) * up_c).normalized(), east = north.cross(up_c);
  horizontal_.resize(kColumns), columns_.resize(kColumns);
  samples_.assign(static_cast<size_t>(kColumns * rows_), 0.0f);
  edges_at_.assign(samples_.size(), 0.0f);
  const cv::Mat& contrast = sky_->contrast;
  const auto smooth = static_cast<float>(sky_->noise) + p_.edge_from;
  const auto worth = static_cast<float>(p_.edge_odds);
  const auto most = static_cast<float>(p_.max_odds);
  std::vector<Eigen::Vector2d> angles;  // cosine and sine from the zenith
  for (int i = 0; i < rows_; ++i) angles.emplace_back(std::cos((i + 0.5) * step_rad_), std::sin((i + 0.5) * step_rad_));
  for (int j = 0; j < kColumns; ++j) {
    const double azimuth = (j + 0.5) * 2 * std::numbers::pi / kColumns;
    const Eigen::Vector3d horizontal = std::cos(azimuth) * north + std::sin(azimuth) * east;
    horizontal_[static_cast<size_t>(j)] = horizontal;
    Column column{rows_, rows_};
    float* to = &samples_[static_cast<size_t>(j * rows_)];
    float* edge = &edges_at_[static_cast<size_t>(j * rows_)];
    // The lens model is evaluated at every fourth sample, at most two degrees apart; pixels between are interpolated.
    Eigen::Vector2d knots[2];
    bool known[2] = {false, false};
    const auto knot = [&](int i, Eigen::Vector2d& pixel) {
      const Eigen::Vector2d& angle = angles[static_cast<size_t>(std::min(i, rows_ - 1))];
      return pixel_of(camera_, angle.x() * up_c + angle.y() * horizontal, p_.farthest_rad, pixel);
    };
    for (int i = 0; i < rows_; ++i) {
      if (i % kKnots == 0) {
        if (i == 0) known[1] = knot(0, knots[1]);
        knots[0] = knots[1], known[0] = known[1];
        known[1] = i + kKnots < rows_ && knot(i + kKnots, knots[1]);
      }
      Eigen::Vector2d pixel;
      bool seen = known[0] && known[1];
      if (seen)
        pixel = knots[0] + (knots[1] - knots[0]) * (static_cast<double>(i % kKnots) / kKnots);
      else
        seen = knot(i, pixel);
      if (seen) {
        const Eigen::Vector2d at = sky_->small_of(pixel);
        const int x = static_cast<int>(std::lround(at.x())), y = static_cast<int>(std::lround(at.y()));
        seen = x >= 1 && y >= 1 && x + 1 < sky_->log_odds.cols && y + 1 < sky_->log_odds.rows &&
               sky_->valid.at<uint8_t>(y, x) != 0;
        if (seen) {
          to[i] = std::clamp(sky_->log_odds.at<float>(y, x), -most, most);
          edge[i] = worth * std::max(0.0f, contrast.at<float>(y, x) - smooth);
        }
      }
      if (seen && column.first == rows_) column.first = i;
      if (!seen && column.first < rows_) {
        column.last = i;
        break;
      }
    }
    columns_[static_cast<size_t>(j)] = column;
  }
}

/// Cost of each position of the line in each direction: non-sky above it, sky below it.
void RobustSkyFinder::unary() {
  cost_.create(kColumns, rows_ + 1, CV_32F);
  cost_.setTo(kNever);
  const int reach = std::max(1, static_cast<int>(p_.below_rad / step_rad_));
  for (int j = 0; j < kColumns; ++j) {
    const Column& c = columns_[static_cast<size_t>(j)];
    float* to = cost_.ptr<float>(j);
    if (c.first >= c.last) {
      std::fill(to, to + rows_ + 1, 0.0f);  // outside the picture: the neighbours determine the line
      continue;
    }
    const float* l = &samples_[static_cast<size_t>(j * rows_)];
    const float* edge = &edges_at_[static_cast<size_t>(j * rows_)];
    float above = 0, below = 0;
    for (int k = c.first; k < std::min(c.last, c.first + reach); ++k) below += l[k];
    for (int i = c.first; i <= c.last; ++i) {
      to[i] = below - above;
      if (i == c.last) break;
      if (i > c.first) to[i] -= edge[i];
      above += l[i], below -= l[i];
      if (i + reach < c.last) below += l[i + reach];
    }
  }
}

/// Viterbi algorithm over the directions, two rounds, for a closed line.
void RobustSkyFinder::draw_line() {
  const auto slope = static_cast<float>(p_.jump_per_rad * step_rad_), most = static_cast<float>(p_.max_jump);
  const int n = rows_ + 1;
  std::vector<float> best(cost_.ptr<float>(0), cost_.ptr<float>(0) + n), next(static_cast<size_t>(n));
  from_.create(2 * kColumns, n, CV_16S);
  for (int t = 1; t < 2 * kColumns; ++t) {
    const float* here = cost_.ptr<float>(t % kColumns);
    auto* from = from_.ptr<int16_t>(t);
    // Cheapest path from any position in the previous direction: along the slope (two sweeps) or by a jump.
    const auto cheapest = static_cast<int>(std::min_element(best.begin(), best.end()) - best.begin());
    const float jump = best[static_cast<size_t>(cheapest)] + most;
    for (int i = 0; i < n; ++i) {
      const auto k = static_cast<size_t>(i);
      next[k] = best[k], from[i] = static_cast<int16_t>(i);
      if (i > 0 && next[k - 1] + slope < next[k]) next[k] = next[k - 1] + slope, from[i] = from[i - 1];
    }
    for (int i = n - 1; i >= 0; --i) {
      const auto k = static_cast<size_t>(i);
      if (i + 1 < n && next[k + 1] + slope < next[k]) next[k] = next[k + 1] + slope, from[i] = from[i + 1];
      if (jump < next[k]) next[k] = jump, from[i] = static_cast<int16_t>(cheapest);
    }
    for (int i = 0; i < n; ++i) next[static_cast<size_t>(i)] += here[i];
    best.swap(next);
  }
  line_.assign(kColumns, 0);
  auto at = static_cast<int>(std::min_element(best.begin(), best.end()) - best.begin());
  for (int t = 2 * kColumns - 1; t >= kColumns / 2; --t) {
    // The middle of the two rounds is independent of the start and of the end.
    if (t < 2 * kColumns - kColumns / 2) line_[static_cast<size_t>(t % kColumns)] = at;
    at = from_.at<int16_t>(t, at);
  }
}

void RobustSkyFinder::extract_edges(const cv::Mat& grey) {
  const int other = std::max(1, static_cast<int>(p_.other_rad / step_rad_));
  const double fine_rad = 0.5 / camera_.focal();
  const int reach = static_cast<int>(std::lround(p_.refine_px * sky_->scale / 2 / 0.5));
  std::vector<float> profile, falls;
  for (int j = 0; j < kColumns; ++j) {
    const Column& c = columns_[static_cast<size_t>(j)];
    if (c.first >= c.last) continue;
    const int i = std::clamp(line_[static_cast<size_t>(j)], c.first, c.last);
    const Eigen::Vector3d& horizontal = horizontal_[static_cast<size_t>(j)];
    const auto ray = [&](double angle) -> Eigen::Vector3d {
      return std::cos(angle) * up_ + std::sin(angle) * horizontal;
    };
    SkyEdge edge{.open = i >= c.last - 1, .above = c.first > 0 && i <= c.first, .weight = 1};
    const float* cost = cost_.ptr<float>(j);
    float second_best_ratio = kNever;
    for (int k = c.first; k <= c.last; ++k)
      if (std::abs(k - i) > other) second_best_ratio = std::min(second_best_ratio, cost[k]);
    edge.weight =
        std::clamp((static_cast<double>(second_best_ratio) - static_cast<double>(cost[i])) / p_.sure_margin, 0.0, 1.0);
    double angle = i * step_rad_;
    if (c.first == 0 && i == 0) continue;  // a roof at the zenith
    if (!edge.open && !edge.above) {
      // Grey values along the direction, half a pixel apart. The roof's edge is the first from the sky's side that is
      // not much weaker than the strongest: windows below it may be stronger.
      profile.clear();
      const int up = std::min(i * 4, static_cast<int>(p_.first_edge_rad / fine_rad));
      bool whole = true;
      for (int k = -up - 3; k <= reach + 3 && whole; ++k) {
        Eigen::Vector2d p;
        whole = pixel_of(camera_, ray(angle + k * fine_rad), p_.farthest_rad, p) && p.x() >= 0 && p.y() >= 0 &&
                p.x() < grey.cols - 1 && p.y() < grey.rows - 1;
        if (whole) profile.push_back(bilinear(grey, p));
      }
      const auto n = static_cast<int>(profile.size());
      falls.assign(profile.size(), 0.0f);
      float most = 0;
      for (int k = 3; k + 3 < n; ++k) {
        const auto m = static_cast<size_t>(k);
        falls[m] = std::abs(profile[m - 3] + profile[m - 2] + profile[m - 1] - profile[m + 1] - profile[m + 2] -
                            profile[m + 3]);
        most = std::max(most, falls[m]);
      }
      const auto least = std::max(static_cast<float>(p_.first_edge_part) * most, p_.min_fall);
      for (int k = 3; k + 3 < n; ++k) {
        const auto m = static_cast<size_t>(k);
        if (falls[m] < least || falls[m] < falls[m + 1] || falls[m] < falls[m - 1]) continue;
        angle += (k - 3 - up) * fine_rad;
        break;
      }
    }
    edge.ray_c = ray(angle);
    edges_.push_back(edge);
  }
}

}  // namespace odograph::skyline
