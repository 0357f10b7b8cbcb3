// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

namespace odograph {

/// A square picture, periodic in both directions, with mipmaps.
class Texture {
 public:
  /// 8-bit grey of 2^n pixels per side; `glass` (same size, 255 on panes) may be empty.
  Texture(const cv::Mat& grey, const cv::Mat& glass, float side_m);

  struct Texel {
    float grey;
    bool glass;
  };
  /// At (u, v) metres, averaged over about `footprint_m`.
  Texel at(float u_m, float v_m, float footprint_m) const;

 private:
  /// All levels in sequence. The lowest bit of a pixel marks glass.
  std::vector<uint8_t> pixels_;
  std::vector<size_t> offsets_;
  int log2_size_ = 0;
  float texel_m_;
};

/// A tag of the AprilTag family 36h11 on its white board of width `board_m`.
Texture tag_texture(uint32_t tag, float board_m);

/// A picture of any shape with longer side `longer_m`, in the upper left corner of a square texture of that side.
Texture poster_texture(const cv::Mat& grey, float longer_m);

/// The textures of worlds, generated from the seed.
struct TextureSet {
  explicit TextureSet(uint64_t seed);
  static constexpr uint32_t kFacades = 6, kPaving = 6, kAsphalt = 7, kLeaves = 8, kPaint = 9, kCloth = 10, kWall = 11,
                            kWater = 12, kGlassFront = 13;
  static constexpr double kWater_m = 16;  ///< period of the water texture
  std::vector<Texture> all;
};

}  // namespace odograph
