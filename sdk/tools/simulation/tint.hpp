// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include <opencv2/core.hpp>

namespace odograph {

/// Blue and red minus grey, relative to grey (luma of ITU-R BT.601). The simulator renders grey; colour is added to the
/// finished picture and leaves its grey as it is, so that a colour camera and a grey one see the same.
using Tint = cv::Vec2f;

/// The tint of a surface with a texture of TextureSet: cars, clothes and houses of other brightness differ in colour.
Tint surface_tint(uint32_t texture, float brightness);
/// The tint of the sky: blue, less so at the horizon and in clouds and glare, which are bright.
Tint sky_tint(float up, float grey);

/// BGR of a grey picture (8 bits) and the tint of each pixel (two floats). Colours fade where a channel would saturate.
cv::Mat coloured(const cv::Mat& grey, const cv::Mat& tint);

}  // namespace odograph
