// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/simulation/tint.hpp"

#include <algorithm>
#include <array>
#include <bit>

#include "sdk/tools/simulation/texture.hpp"

namespace odograph {
namespace {

using Set = TextureSet;

constexpr float kBlue = 0.114f, kGreen = 0.587f, kRed = 0.299f;

/// Of a colour 0xRRGGBB.
Tint tint_of(uint32_t rgb) {
  const auto channel = [&](int shift) { return static_cast<float>((rgb >> shift) & 255u); };
  const float grey = kRed * channel(16) + kGreen * channel(8) + kBlue * channel(0);
  return {channel(0) / grey - 1, channel(16) / grey - 1};
}

/// One of the colours for each brightness.
template <size_t n>
Tint one_of(const std::array<uint32_t, n>& colours, float brightness) {
  return tint_of(colours[(std::bit_cast<uint32_t>(brightness) * 2654435761u >> 16) % n]);
}

}  // namespace

Tint surface_tint(uint32_t texture, float brightness) {
  if (texture < Set::kFacades)
    return one_of<8>({0xb06a52, 0xd0aa70, 0xe0d2b4, 0xa8b4be, 0xd4a898, 0xc8b090, 0xb8bca4, 0xc08060}, brightness);
  switch (texture) {
    case Set::kPaving: return tint_of(0xbeb4a6);
    case Set::kAsphalt: return tint_of(0x78797e);
    case Set::kLeaves:
      if (brightness == 0.6f || brightness == 0.7f) return tint_of(0x6e553c);  // a trunk
      return tint_of(0x5f873c);
    case Set::kPaint:
      if (brightness == 0.4f) return tint_of(0x5a5f69);  // a car's windows
      if (brightness == 0.6f) return tint_of(0x5a7882);  // the water of a city model
      if (brightness == 1.3f) return tint_of(0xe0ac8c);  // a face
      return one_of<7>({0xbe3232, 0x3c5fa0, 0xc8c8cc, 0xe0e0dc, 0x46484c, 0x3c6e50, 0xd2a032}, brightness);
    case Set::kCloth:
      return one_of<7>({0x32406e, 0x8c3232, 0x4b6446, 0x787878, 0xbea582, 0x5a3c64, 0x326e82}, brightness);
    case Set::kWater: return tint_of(0x5a7882);
    case Set::kGlassFront: return tint_of(0x96aab9);
    default: return {};  // walls, tags and posters
  }
}

Tint sky_tint(float up, float grey) {
  const float clear = std::clamp((235.0f - grey) / 60.0f, 0.15f, 1.0f);
  return clear * (0.4f + 0.6f * std::clamp(2 * up, 0.0f, 1.0f)) * tint_of(0x78a5dc);
}

cv::Mat coloured(const cv::Mat& grey, const cv::Mat& tint) {
  cv::Mat bgr(grey.size(), CV_8UC3);
  for (int y = 0; y < grey.rows; ++y)
    for (int x = 0; x < grey.cols; ++x) {
      const auto light = static_cast<float>(grey.at<uint8_t>(y, x));
      const auto [blue, red] = tint.at<Tint>(y, x).val;
      const float green = -(kBlue * blue + kRed * red) / kGreen, most = light * std::max({blue, green, red});
      const float strength = most > 255 - light ? (255 - light) / most : 1.0f;
      const auto channel = [&](float excess) { return cv::saturate_cast<uint8_t>(light * (1 + strength * excess)); };
      bgr.at<cv::Vec3b>(y, x) = {channel(blue), channel(green), channel(red)};
    }
  return bgr;
}

}  // namespace odograph
