// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/imgproc.hpp>

#include "odograph/types.h"
#include "plugins/fix/skyline/sky_network.hpp"

namespace odograph::skyline {

/// Min sum of the spans of Cb and Cr in a colour picture: a monochrome sensor sends 128 throughout.
constexpr double kMinColour = 12;

/// A copy of a frame's chroma at half its size; empty where it has none.
inline Chroma chroma_of(const odo_frame& frame) {
  const int rows = static_cast<int>(frame.height / 2), columns = static_cast<int>(frame.width / 2);
  Chroma c;
  const auto plane = [&](size_t number, uint32_t offset, cv::Mat& out) {
    const odo_plane& from = frame.planes[number];
    out.create(rows, columns, CV_8U);
    for (int y = 0; y < rows; ++y)
      for (int x = 0; x < columns; ++x)
        out.at<uint8_t>(y, x) = from.data[y * from.row_stride + static_cast<int64_t>(x) * from.pixel_stride + offset];
  };
  const auto colours = [&](int type, int to_rgb) {
    cv::Mat half, planes[3];
    cv::resize(cv::Mat(static_cast<int>(frame.height), static_cast<int>(frame.width), type,
                       const_cast<uint8_t*>(frame.planes[0].data), static_cast<size_t>(frame.planes[0].row_stride)),
               half, {columns, rows}, 0, 0, cv::INTER_AREA);
    if (to_rgb >= 0) cv::cvtColor(half, half, to_rgb);
    cv::cvtColor(half, half, cv::COLOR_RGB2YCrCb);
    cv::split(half, planes);
    c = {planes[2], planes[1]};
  };
  switch (frame.format) {
    case ODO_FORMAT_NV12: plane(1, 0, c.cb), plane(1, 1, c.cr); break;
    case ODO_FORMAT_NV21: plane(1, 1, c.cb), plane(1, 0, c.cr); break;
    case ODO_FORMAT_YUV420: plane(1, 0, c.cb), plane(2, 0, c.cr); break;
    case ODO_FORMAT_RGB8: colours(CV_8UC3, -1); break;
    case ODO_FORMAT_RGBA8: colours(CV_8UC4, cv::COLOR_RGBA2RGB); break;
    case ODO_FORMAT_BGRA8: colours(CV_8UC4, cv::COLOR_BGRA2RGB); break;
    default: return {};
  }
  double low = 0, high = 0, span = 0;
  for (const cv::Mat* m : {&c.cb, &c.cr}) cv::minMaxLoc(*m, &low, &high), span += high - low;
  return span < kMinColour ? Chroma{} : c;
}

}  // namespace odograph::skyline
