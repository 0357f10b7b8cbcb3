// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/simulation/texture.hpp"

#include <algorithm>
#include <bit>

#include <apriltag/tag36h11.h>
#include <opencv2/imgproc.hpp>

#include "sdk/tools/simulation/random.hpp"

namespace odograph {
namespace {

constexpr int kSize = 1024;

/// Value noise over octaves from `coarsest` to `finest` cells per side; periodic.
cv::Mat noise(Random& random, int coarsest, int finest, double amplitude, double persistence) {
  cv::Mat sum(kSize, kSize, CV_32F, cv::Scalar(0));
  for (int cells = coarsest; cells <= finest; cells *= 2, amplitude *= persistence) {
    cv::Mat coarse(cells, cells, CV_32F), padded, fine;
    for (int y = 0; y < cells; ++y)
      for (int x = 0; x < cells; ++x) coarse.at<float>(y, x) = static_cast<float>(random.uniform(-1, 1));
    cv::copyMakeBorder(coarse, padded, 2, 2, 2, 2, cv::BORDER_WRAP);
    const int cell = kSize / cells;
    cv::resize(padded, fine, {}, cell, cell, cv::INTER_CUBIC);
    sum += amplitude * fine(cv::Rect(2 * cell, 2 * cell, kSize, kSize));
  }
  return sum;
}

cv::Point point(Random& random, double x0, double x1, double y0, double y1) {
  const double y = random.uniform(y0, y1), x = random.uniform(x0, x1);
  return {static_cast<int>(x), static_cast<int>(y)};
}

void draw_bricks(cv::Mat& picture, Random& random) {
  for (int row = 0; row < 128; ++row)
    for (int k = 0; k < 42; ++k) {
      const int x = k * 24 + (row % 2) * 12;
      const double tone = random.uniform(-14, 14);
      picture(cv::Rect(std::min(x, kSize - 23), row * 8, 22, 7)) += tone;
    }
}

/// Storeys of windows with frames and panes; `regular` ones repeat exactly, as on offices.
void draw_windows(cv::Mat& picture, cv::Mat& glass, Random& random, bool regular) {
  const int storey = regular ? 128 : 256, bay = regular ? 64 : 128;
  const int width = static_cast<int>(bay * random.uniform(0.45, 0.7)), height = static_cast<int>(storey * 0.55);
  const double frame = random.uniform(150, 235), dark = random.uniform(30, 70);
  for (int y = storey / 5; y + height < kSize; y += storey)
    for (int x = bay / 6; x + width < kSize; x += bay) {
      if (!regular && random.uniform() < 0.1) continue;
      const cv::Rect pane(x, y, regular ? width : width - static_cast<int>(random.uniform(0, 14)), height);
      cv::rectangle(picture, pane, regular ? dark : random.uniform(25, 100), cv::FILLED);
      cv::rectangle(glass, pane, 255, cv::FILLED);
      if (!regular && random.uniform() < 0.4) {  // a curtain
        const cv::Rect curtain(pane.x, pane.y, pane.width / 3, pane.height);
        cv::rectangle(picture, curtain, random.uniform(120, 200), cv::FILLED);
      }
      cv::rectangle(picture, pane, frame, 4);
      cv::rectangle(glass, pane, 0, 4);
      cv::line(picture, {pane.x + pane.width / 2, pane.y}, {pane.x + pane.width / 2, pane.y + pane.height}, frame, 3);
      if (!regular)
        cv::line(picture, {pane.x - 4, pane.y + height + 4}, {pane.x + pane.width + 4, pane.y + height + 4},
                 random.uniform(60, 220), 6);
    }
}

void draw_signs(cv::Mat& picture, Random& random) {
  static const char* const kWords[] = {"CAFE",   "HOTEL", "BANK", "BOOKS", "PHARMACIE",
                                       "BAKERY", "TAXI",  "24 h", "METRO"};
  for (int k = 0; k < 3; ++k) {
    const cv::Point at = point(random, 0, 700, 60, 1000);
    const double back = random.uniform(20, 230);
    cv::rectangle(picture, cv::Rect(at.x, at.y - 44, 280, 56) & cv::Rect(0, 0, kSize, kSize), back, cv::FILLED);
    cv::putText(picture, kWords[random.next() % std::size(kWords)], at + cv::Point(12, 0), cv::FONT_HERSHEY_DUPLEX, 1.5,
                back > 128 ? 20 : 240, 3, cv::LINE_AA);
  }
}

Texture facade(uint64_t seed, bool regular) {
  Random random(seed, 7);
  const double grey_level = random.uniform(105, 175);
  cv::Mat picture = noise(random, 4, 512, 14, 0.72) + grey_level;
  cv::Mat glass(kSize, kSize, CV_8U, cv::Scalar(0)), grey;
  if (!regular) draw_bricks(picture, random);
  draw_windows(picture, glass, random, regular);
  if (!regular) draw_signs(picture, random);
  picture += noise(random, 256, 512, 5, 0.8);
  picture.convertTo(grey, CV_8U);
  return {grey, glass, 12.0f};
}

Texture paving(uint64_t seed) {
  Random random(seed, 7);
  cv::Mat picture = noise(random, 8, 512, 16, 0.85) + 130, grey;
  for (int y = 0; y < kSize; y += 64)
    for (int x = 0; x < kSize; x += 64) {
      picture(cv::Rect(x, y, 64, 64)) += random.uniform(-14, 14);
      cv::rectangle(picture, cv::Rect(x, y, 64, 64), 85, 2);
    }
  picture.convertTo(grey, CV_8U);
  return {grey, {}, 8.0f};
}

Texture plain(uint64_t seed, double mean, double amplitude, double persistence, float side_m) {
  Random random(seed, 7);
  cv::Mat grey;
  cv::Mat(noise(random, 8, 512, amplitude, persistence) + mean).convertTo(grey, CV_8U);
  return {grey, {}, side_m};
}

/// Ripples that reflect the sky and the opposite bank.
Texture water(uint64_t seed) {
  Random random(seed, 7);
  cv::Mat grey;
  cv::Mat(noise(random, 8, 256, 22, 0.7) + 95).convertTo(grey, CV_8U);
  return {grey, cv::Mat(kSize, kSize, CV_8U, cv::Scalar(255)), static_cast<float>(TextureSet::kWater_m)};
}

/// Full-width panes between thin posts.
Texture glass_front(uint64_t seed) {
  Random random(seed, 7);
  cv::Mat picture(kSize, kSize, CV_32F, cv::Scalar(0)), glass(kSize, kSize, CV_8U, cv::Scalar(255)), grey;
  for (int y = 0; y < kSize; y += 256)
    for (int x = 0; x < kSize; x += 128) {
      const cv::Rect pane(x, y, 128, 256);
      picture(pane).setTo(random.uniform(45, 70));
      cv::rectangle(picture, pane, 150, 2);
      cv::rectangle(glass, pane, 0, 2);
    }
  picture.convertTo(grey, CV_8U);
  return {grey, glass, 12.0f};
}

/// Asphalt: stone grains, patches, cracks.
Texture asphalt(uint64_t seed) {
  Random random(seed, 7);
  const cv::Mat grains = noise(random, 128, 512, 16, 1.1), patches = noise(random, 4, 32, 9, 0.8);
  cv::Mat picture = patches + grains + 88, grey;
  for (int k = 0; k < 5; ++k) {
    cv::Point at = point(random, 0, kSize, 0, kSize);
    for (int i = 0; i < 30; ++i) {
      const cv::Point next = at + point(random, -25, 30, -8, 24);
      cv::line(picture, at, next, random.uniform(30, 55), 2);
      at = next;
    }
  }
  picture.convertTo(grey, CV_8U);
  return {grey, {}, 6.0f};
}

}  // namespace

Texture::Texture(const cv::Mat& grey, const cv::Mat& glass, float side_m)
    : texel_m_(side_m / static_cast<float>(grey.cols)) {
  cv::Mat level = grey, panes = glass;
  for (int size = grey.cols; size >= 4; size /= 2) {
    offsets_.push_back(pixels_.size());
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x) {
        const bool pane = !panes.empty() && panes.at<uint8_t>(y, x) > 127;
        pixels_.push_back(static_cast<uint8_t>((level.at<uint8_t>(y, x) & ~1u) | (pane ? 1u : 0u)));
      }
    cv::Mat half;
    cv::resize(level, half, {}, 0.5, 0.5, cv::INTER_AREA);
    level = half;
    if (!panes.empty()) cv::resize(glass, panes, half.size(), 0, 0, cv::INTER_AREA);
  }
  log2_size_ = std::countr_zero(static_cast<unsigned>(grey.cols));
}

Texture::Texel Texture::at(float u_m, float v_m, float footprint_m) const {
  // footprint = (1 + fraction) * 2^exponent texels, from the bits of the float.
  const auto bits = std::bit_cast<uint32_t>(std::max(1.0f, footprint_m / texel_m_));
  const int last = static_cast<int>(offsets_.size()) - 1;
  const int exponent = std::min(static_cast<int>(bits >> 23) - 127, last);
  const uint32_t fraction = exponent < last ? (bits >> 15) & 255u : 0u;  // in 256ths, as below
  const float per_metre = 256.0f / texel_m_;
  // Rounds towards zero where negative: recorded scenarios have these bits.
  // NOLINTNEXTLINE(bugprone-incorrect-roundings)
  const int u = static_cast<int>(u_m * per_metre + 0.5f), v = static_cast<int>(v_m * per_metre + 0.5f);
  const auto sample = [&](int l) {
    const int x = (u >> l) - 128, y = (v >> l) - 128, shift = log2_size_ - l, mask = (1 << shift) - 1;
    const auto wx = static_cast<uint32_t>(x & 255), wy = static_cast<uint32_t>(y & 255);
    const int x0 = (x >> 8) & mask, x1 = ((x >> 8) + 1) & mask;
    const uint8_t* level = pixels_.data() + offsets_[static_cast<size_t>(l)];
    const uint8_t *r0 = level + (((y >> 8) & mask) << shift), *r1 = level + ((((y >> 8) + 1) & mask) << shift);
    return ((256 - wx) * r0[x0] + wx * r0[x1]) * (256 - wy) + ((256 - wx) * r1[x0] + wx * r1[x1]) * wy;
  };
  float grey = static_cast<float>(sample(exponent));
  if (fraction > 0)
    grey += static_cast<float>(fraction) * (1 / 256.0f) * (static_cast<float>(sample(exponent + 1)) - grey);
  const int shift = log2_size_ - exponent, mask = (1 << shift) - 1;
  const int x = (u >> (8 + exponent)) & mask, y = (v >> (8 + exponent)) & mask;
  const uint8_t nearest = pixels_[offsets_[static_cast<size_t>(exponent)] + static_cast<size_t>((y << shift) + x)];
  return {grey * (1 / 65536.0f), (nearest & 1) != 0};
}

Texture tag_texture(uint32_t tag, float board_m) {
  apriltag_family_t* family = tag36h11_create();
  image_u8_t* cells = apriltag_to_image(family, static_cast<int>(tag % family->ncodes));
  cv::Mat fine, board;
  // Cells are not a whole number of pixels, so their edges are averaged.
  cv::resize(cv::Mat(cells->height, cells->width, CV_8U, cells->buf, static_cast<size_t>(cells->stride)), fine,
             {256 * cells->width, 256 * cells->height}, 0, 0, cv::INTER_NEAREST);
  cv::resize(fine, board, {512, 512}, 0, 0, cv::INTER_AREA);
  image_u8_destroy(cells);
  tag36h11_destroy(family);
  return {board, {}, board_m};
}

Texture poster_texture(const cv::Mat& grey, float longer_m) {
  const double scale = static_cast<double>(kSize) / std::max(grey.cols, grey.rows);
  cv::Mat shown, square;
  cv::resize(grey, shown, {}, scale, scale, scale < 1 ? cv::INTER_AREA : cv::INTER_CUBIC);
  cv::copyMakeBorder(shown, square, 0, kSize - shown.rows, 0, kSize - shown.cols, cv::BORDER_REPLICATE);
  return {square, {}, longer_m};
}

TextureSet::TextureSet(uint64_t seed) {
  for (uint64_t k = 0; k < kFacades; ++k) all.push_back(facade(seed * 64 + k, k % 3 == 2));
  all.push_back(paving(seed * 64 + 10));
  all.push_back(asphalt(seed * 64 + 11));
  all.push_back(plain(seed * 64 + 12, 80, 34, 0.85, 3.0f));   // leaves
  all.push_back(plain(seed * 64 + 13, 120, 60, 0.45, 7.0f));  // car paint, with unspecific reflections
  all.push_back(plain(seed * 64 + 14, 100, 45, 0.75, 2.0f));  // cloth
  all.push_back(plain(seed * 64 + 15, 205, 3, 0.8, 4.0f));    // a white wall
  all.push_back(water(seed * 64 + 16));
  all.push_back(glass_front(seed * 64 + 17));
}

}  // namespace odograph
