// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/simulation/codec.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>

#include <opencv2/imgproc.hpp>

#include "sdk/math/scalar.hpp"

namespace odograph {
namespace {

constexpr int kMacro = 16, kBlock = 8, kBorder = 64;            // pixels
constexpr double kFinest = 2, kCoarsest = 120;                  // quantisation steps, grey values
constexpr float kDeadZone = 1.0f / 6, kDeadZoneKey = 1.0f / 3;  // rounding offsets before truncation, as in x264

/// Orthonormal 8 x 8 discrete cosine transform.
class Transform {
 public:
  Transform() {
    for (int k = 0; k < kBlock; ++k)
      for (int i = 0; i < kBlock; ++i)
        basis_[k * kBlock + i] =
            static_cast<float>((k == 0 ? std::sqrt(0.125) : 0.5) * std::cos((2 * i + 1) * k * kPi / 16));
    for (int k = 0; k < kBlock; ++k)
      for (int i = 0; i < kBlock; ++i) transposed_[i * kBlock + k] = basis_[k * kBlock + i];
  }
  void forward(const float* x, float* y) const { apply(basis_, x, y); }
  void back(const float* x, float* y) const { apply(transposed_, x, y); }

 private:
  /// y = A x A^T
  static void apply(const std::array<float, 64>& a, const float* x, float* y) {
    std::array<float, 64> half{};
    for (size_t r = 0; r < 8; ++r)
      for (size_t k = 0; k < 8; ++k)
        for (size_t i = 0; i < 8; ++i) half[r * 8 + i] += a[r * 8 + k] * x[k * 8 + i];
    for (size_t r = 0; r < 8; ++r)
      for (size_t i = 0; i < 8; ++i) {
        float sum = 0;
        for (size_t k = 0; k < 8; ++k) sum += half[r * 8 + k] * a[i * 8 + k];
        y[r * 8 + i] = sum;
      }
  }
  std::array<float, 64> basis_{}, transposed_{};
};

const Transform& transform() {
  static const Transform t;
  return t;
}

int difference(const cv::Mat& a, int ax, int ay, const cv::Mat& b, int bx, int by) {
  int sum = 0;
  for (int y = 0; y < kMacro; ++y) {
    const auto *p = a.ptr<uint8_t>(ay + y) + ax, *q = b.ptr<uint8_t>(by + y) + bx;
    for (int x = 0; x < kMacro; ++x) sum += std::abs(p[x] - q[x]);
  }
  return sum;
}

/// Block of the previous picture displaced by half-pixel motion (twice the motion is an integer).
void fetch(const cv::Mat& before, int x, int y, cv::Point2f motion, cv::Mat& out) {
  const int u = static_cast<int>(std::lround(2 * motion.x)), v = static_cast<int>(std::lround(2 * motion.y));
  const int px = x + kBorder + (u >> 1), py = y + kBorder + (v >> 1), dx = u & 1, dy = v & 1;
  for (int r = 0; r < kMacro; ++r) {
    const auto *a = before.ptr<uint8_t>(py + r) + px, *b = before.ptr<uint8_t>(py + r + dy) + px;
    auto* to = out.ptr<uint8_t>(r);
    for (int c = 0; c < kMacro; ++c) to[c] = static_cast<uint8_t>((a[c] + a[c + dx] + b[c] + b[c + dx] + 2) >> 2);
  }
}

int level_of(float coefficient, float step, float dead_zone) {
  return static_cast<int>(std::abs(coefficient) / step + dead_zone);
}

}  // namespace

cv::Point2f VideoCodec::search(const cv::Mat& picture, int x, int y, const std::vector<cv::Point2f>& guesses,
                               int* cost) const {
  const auto cost_at = [&](cv::Point m) {
    if (std::abs(m.x) > kBorder - 2 || std::abs(m.y) > kBorder - 2) return 1 << 30;
    return difference(picture, x, y, before_, x + kBorder + m.x, y + kBorder + m.y);
  };
  cv::Point best(0, 0);
  *cost = cost_at(best);
  const auto consider = [&](cv::Point m) {
    if (const int c = cost_at(m); c < *cost) *cost = c, best = m;
  };
  for (const cv::Point2f& guess : guesses) consider({cvRound(guess.x), cvRound(guess.y)});
  for (int reach = 8; reach >= 1; reach /= 2)
    for (int round = 0; round < 6; ++round) {
      const cv::Point middle = best;
      for (const cv::Point d : {cv::Point(1, 0), cv::Point(-1, 0), cv::Point(0, 1), cv::Point(0, -1)})
        consider(middle + reach * d);
      if (best == middle) break;
    }
  cv::Mat moved(kMacro, kMacro, CV_8U);
  cv::Point2f fine(static_cast<float>(best.x), static_cast<float>(best.y));
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx) {
      const cv::Point2f m(static_cast<float>(best.x) + 0.5f * static_cast<float>(dx),
                          static_cast<float>(best.y) + 0.5f * static_cast<float>(dy));
      fetch(before_, x, y, m, moved);
      if (const int c = difference(picture, x, y, moved, 0, 0); c < *cost) *cost = c, fine = m;
    }
  return fine;
}

void VideoCodec::predict(const cv::Mat& picture, bool key) {
  const int across = picture.cols / kMacro, down = picture.rows / kMacro;
  const auto of_before = motion_;
  motion_.assign(static_cast<size_t>(across * down), {0, 0});
  prediction_.create(picture.size(), CV_8U);
  side_bits_ = 0;
  for (int j = 0; j < down; ++j)
    for (int i = 0; i < across; ++i) {
      const int x = i * kMacro, y = j * kMacro;
      const cv::Rect here(x, y, kMacro, kMacro);
      const auto at = static_cast<size_t>(j * across + i);
      const double mean = cv::mean(picture(here))[0];
      cv::Mat to = prediction_(here);
      to.setTo(std::round(mean));
      side_bits_ += 10;  // prediction mode
      if (key) continue;
      int flat_cost = 0, cost = 0;
      for (int r = 0; r < kMacro; ++r)
        for (int c = 0; c < kMacro; ++c)
          flat_cost += std::abs(picture.at<uint8_t>(y + r, x + c) - static_cast<int>(std::round(mean)));
      std::vector<cv::Point2f> guesses;
      if (i > 0) guesses.push_back(motion_[at - 1]);
      if (j > 0) guesses.push_back(motion_[at - static_cast<size_t>(across)]);
      if (j > 0 && i + 1 < across) guesses.push_back(motion_[at - static_cast<size_t>(across) + 1]);
      if (!of_before.empty()) guesses.push_back(of_before[at]);
      const cv::Point2f motion = search(picture, x, y, guesses, &cost);
      if (cost >= flat_cost) continue;
      motion_[at] = motion;
      fetch(before_, x, y, motion, to);
    }
}

void VideoCodec::quantise(double budget, bool key) {
  const float dead_zone = key ? kDeadZoneKey : kDeadZone;
  const auto bits_at = [&](double step) {
    double bits = side_bits_;
    for (const Block& block : blocks_)
      for (const float c : block)
        if (const int level = level_of(c, static_cast<float>(step), dead_zone); level > 0)
          bits += 2 * (std::bit_width(static_cast<unsigned>(level)) - 1) + 5;
    return bits;
  };
  double fine = kFinest, coarse = kCoarsest;
  if (bits_at(fine) <= budget) coarse = fine;
  for (int i = 0; i < 10 && coarse > fine; ++i) {
    const double middle = std::sqrt(fine * coarse);
    (bits_at(middle) > budget ? fine : coarse) = middle;
  }
  step_ = coarse;
  bits_ = bits_at(step_);
  const auto step = static_cast<float>(step_);
  for (Block& block : blocks_)
    for (float& c : block) c = std::copysign(step * static_cast<float>(level_of(c, step, dead_zone)), c);
}

/// Deblocks across block edges where the step is within the quantisation error (H.264's normal filter).
void VideoCodec::smooth_edges(cv::Mat& picture) const {
  const int most = static_cast<int>(step_), flat = most / 2, limit = std::max(1, most / 4);
  const auto smooth = [&](uint8_t& p1, uint8_t& p0, uint8_t& q0, uint8_t& q1) {
    if (std::abs(p0 - q0) >= most || std::abs(p1 - p0) >= flat || std::abs(q1 - q0) >= flat) return;
    const int d = std::clamp(((q0 - p0) * 4 + (p1 - q1) + 4) >> 3, -limit, limit);
    p0 = cv::saturate_cast<uint8_t>(p0 + d), q0 = cv::saturate_cast<uint8_t>(q0 - d);
  };
  for (int y = 0; y < picture.rows; ++y) {
    auto* row = picture.ptr<uint8_t>(y);
    for (int x = kBlock; x < picture.cols; x += kBlock) smooth(row[x - 2], row[x - 1], row[x], row[x + 1]);
  }
  for (int y = kBlock; y < picture.rows; y += kBlock)
    for (int x = 0; x < picture.cols; ++x)
      smooth(picture.at<uint8_t>(y - 2, x), picture.at<uint8_t>(y - 1, x), picture.at<uint8_t>(y, x),
             picture.at<uint8_t>(y + 1, x));
}

cv::Mat VideoCodec::pass(const cv::Mat& grey) {
  cv::Mat picture;
  const auto fill = [](int n) { return (n + kMacro - 1) / kMacro * kMacro - n; };
  cv::copyMakeBorder(grey, picture, 0, fill(grey.rows), 0, fill(grey.cols), cv::BORDER_REPLICATE);
  const bool key = frame_++ % p_.key_interval == 0;
  predict(picture, key);
  const int across = picture.cols / kBlock, down = picture.rows / kBlock;
  blocks_.resize(static_cast<size_t>(across * down));
  Block x;
  for (int j = 0; j < down; ++j)
    for (int i = 0; i < across; ++i) {
      for (int r = 0; r < kBlock; ++r)
        for (int c = 0; c < kBlock; ++c)
          x[static_cast<size_t>(r * kBlock + c)] =
              static_cast<float>(picture.at<uint8_t>(j * kBlock + r, i * kBlock + c) -
                                 prediction_.at<uint8_t>(j * kBlock + r, i * kBlock + c));
      transform().forward(x.data(), blocks_[static_cast<size_t>(j * across + i)].data());
    }
  const double frame_bits = p_.bit_rate / p_.frame_rate_hz, interval = p_.key_interval;
  quantise(key ? p_.key_share * frame_bits : frame_bits * (interval - p_.key_share) / (interval - 1), key);
  cv::Mat decoded(picture.size(), CV_8U);
  for (int j = 0; j < down; ++j)
    for (int i = 0; i < across; ++i) {
      transform().back(blocks_[static_cast<size_t>(j * across + i)].data(), x.data());
      for (int r = 0; r < kBlock; ++r)
        for (int c = 0; c < kBlock; ++c)
          decoded.at<uint8_t>(j * kBlock + r, i * kBlock + c) =
              cv::saturate_cast<uint8_t>(static_cast<float>(prediction_.at<uint8_t>(j * kBlock + r, i * kBlock + c)) +
                                         x[static_cast<size_t>(r * kBlock + c)]);
    }
  smooth_edges(decoded);
  cv::copyMakeBorder(decoded, before_, kBorder, kBorder, kBorder, kBorder, cv::BORDER_REPLICATE);
  return decoded(cv::Rect(0, 0, grey.cols, grey.rows)).clone();
}

}  // namespace odograph
