// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/skyline/colour_sky.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <opencv2/imgproc.hpp>

namespace odograph::skyline {
namespace {

constexpr ColourSky::Neuron kNeurons[] = {
#include "plugins/fix/skyline/colour_sky_weights.inc"
};
constexpr float kBiases[ColourSky::kTerms] = {
#include "plugins/fix/skyline/colour_sky_biases.inc"
};
constexpr int kGrey[] = {0, 1, 2, 3, 4, 5, 6, 7, 9, 10, 11, 12};  // channels of SkyFeatures that count here too
constexpr float kDark = 0.45f;                                    // of the sky's Y: leaves and shadows are below
constexpr float kGreen = -4, kWarm = 2;                           // of Cb, of Cr: leaves; bricks and plaster in the sun
constexpr float kMostCrossed = 4;

void blur(const cv::Mat& in, int side, float factor, cv::Mat& out) {
  cv::blur(in, out, {side, side});
  out *= factor;
}

/// From a spread of bytes or floats to about 0 for none and 3 for leaves.
void logarithm(cv::Mat& x) {
  x += 1;
  cv::log(x, x);
  x *= 0.72;
}

}  // namespace

/// The strongest barrier, or their sum, on the straight way in the picture from the zenith to each pixel: ring by ring.
void ColourSky::crossed(const cv::Mat& barrier, const Eigen::Vector2d& zenith, bool summed, cv::Mat& out) const {
  barrier.copyTo(out);
  const int columns = out.cols, rows = out.rows;
  const int cx = std::clamp(static_cast<int>(std::lround(zenith.x())), 0, columns - 1);
  const int cy = std::clamp(static_cast<int>(std::lround(zenith.y())), 0, rows - 1);
  const auto at = [&](int x, int y) {
    return out.at<float>(std::clamp(y, 0, rows - 1), std::clamp(x, 0, columns - 1));
  };
  const auto put = [&](int x, int y, float before) {
    float& v = out.at<float>(y, x);
    v = summed ? std::min(kMostCrossed, before + v) : std::max(before, v);
  };
  for (int k = 1; k < std::max(columns, rows); ++k)
    for (const int side : {-1, 1})
      for (int d = -k; d <= k; ++d) {
        const float nearer = static_cast<float>(d) * static_cast<float>(k - 1) / static_cast<float>(k);
        const int i = static_cast<int>(std::floor(nearer));
        const float part = nearer - static_cast<float>(i);
        if (const int x = cx + side * k, y = cy + d, from = x - side; x >= 0 && x < columns && y >= 0 && y < rows)
          put(x, y, (1 - part) * at(from, cy + i) + part * at(from, cy + i + 1));
        if (const int x = cx + d, y = cy + side * k, from = y - side;
            std::abs(d) < k && x >= 0 && x < columns && y >= 0 && y < rows)
          put(x, y, (1 - part) * at(cx + i, from) + part * at(cx + i + 1, from));
      }
}

void ColourSky::look(const SkyFeatures& features, const cv::Mat& grey, const Chroma& chroma,
                     const Eigen::Vector2d& zenith) {
  const cv::Size small = features.valid.size(), size(small.width / 2, small.height / 2);
  // What SkyFeatures' second channel was taken against.
  sky_ = (features.channels[0].at<float>(0, 0) + 1) * 128 - 64 * features.channels[1].at<float>(0, 0);
  size_t n = 0;
  for (const int k : kGrey) cv::resize(features.channels[k], channels_[n++], size, 0, 0, cv::INTER_AREA);
  cv::Mat bytes, y, cb, cr, part;
  const auto half = [&](const cv::Mat& plane, double zero, cv::Mat& out) {
    cv::resize(plane, bytes, size, 0, 0, cv::INTER_AREA);
    bytes.convertTo(out, CV_32F, 1, -zero);
  };
  half(grey, 0, y), half(chroma.cb, 128, cb), half(chroma.cr, 128, cr);
  cb.convertTo(channels_[n++], CV_32F, 1 / 16.0);
  cr.convertTo(channels_[n++], CV_32F, 1 / 16.0);
  for (const int side : {5, 13}) {
    blur(cb, side, 1 / 16.0f, channels_[n++]);
    blur(cr, side, 1 / 16.0f, channels_[n++]);
  }
  const auto share = [&](const cv::Mat& where, int side) {
    where.convertTo(part, CV_32F, 1 / 255.0);
    blur(part, side, 2, channels_[n++]);
  };
  const cv::Mat dark = y<kDark * sky_, green = (cb < kGreen) & (cr < 0), warm = cr> kWarm;
  share(dark, 5), share(dark, 17), share(green, 5), share(green, 17), share(warm, 17);
  // How straight edges are: those of walls are, of leaves not (the structure tensor's coherence).
  cv::Mat gx, gy, xx, yy, xy, coherence;
  cv::Sobel(y, gx, CV_32F, 1, 0), cv::Sobel(y, gy, CV_32F, 0, 1);
  const cv::Mat gxx = gx.mul(gx), gyy = gy.mul(gy), gxy = gx.mul(gy);
  const auto straight = [&](int side, cv::Mat& out) {
    blur(gxx, side, 1, xx), blur(gyy, side, 1, yy), blur(gxy, side, 1, xy);
    const cv::Mat d = xx - yy;
    cv::sqrt(d.mul(d) + 4 * xy.mul(xy), out);
    out = out / (xx + yy + 50);
  };
  straight(11, channels_[n++]);
  straight(5, coherence);
  // What is crossed on the way from the zenith: contrast, colour, straight edges, and all contrast together.
  const cv::Mat& contrast = channels_[4];
  cv::Mat low, high, colour, above;
  cv::erode(cb, low, cv::Mat()), cv::dilate(cb, high, cv::Mat());
  colour = high - low;
  cv::erode(cr, low, cv::Mat()), cv::dilate(cr, high, cv::Mat());
  colour += high - low;
  logarithm(colour);
  above = (contrast - channels_[8]) / 15;  // the ninth is the sky's own
  cv::max(above, 0, above);
  const Eigen::Vector2d at = (features.small_of(zenith).array() + 0.5) / 2 - 0.5;
  crossed(contrast, at, false, channels_[n++]);
  crossed(colour, at, false, channels_[n++]);
  crossed(contrast.mul(coherence), at, false, channels_[n++]);
  crossed(above, at, true, channels_[n++]);
}

void ColourSky::judge() {
  const cv::Size size = channels_[0].size();
  for (auto& c : coefficients_) c.create(size, CV_32F);
  std::vector<float> sums(static_cast<size_t>(size.width));
  for (int row = 0; row < size.height; ++row) {
    for (size_t t = 0; t < kTerms; ++t) std::fill_n(coefficients_[t].ptr<float>(row), size.width, kBiases[t]);
    for (const Neuron& neuron : kNeurons) {  // column by column, so that compilers find the vectors
      std::fill(sums.begin(), sums.end(), neuron.bias);
      for (size_t k = 0; k < kFeatures; ++k) {
        const float w = neuron.inputs[k];
        const float* in = channels_[k].ptr<float>(row);
        for (size_t x = 0; x < sums.size(); ++x) sums[x] += w * in[x];
      }
      for (float& s : sums) s = std::max(0.0f, s);
      for (size_t t = 0; t < kTerms; ++t) {
        auto* to = coefficients_[t].ptr<float>(row);
        for (size_t x = 0; x < sums.size(); ++x) to[x] += neuron.outputs[t] * sums[x];
      }
    }
  }
}

void ColourSky::log_odds(const cv::Mat& grey, const Chroma& chroma, cv::Size size, cv::Mat& out) {
  const cv::Mat* const planes[] = {&grey, &chroma.cb, &chroma.cr};
  const std::array<float, kTerms> zero = terms(0, 0, 0), one = terms(1, 1, 1);
  cv::resize(coefficients_[0], out, size, 0, 0, cv::INTER_LINEAR);
  cv::Mat coefficient, bytes, term;
  for (size_t t = 1; t < kTerms; ++t) {
    const cv::Mat& plane = *planes[t - 1];
    const bool shrinks = plane.cols > size.width;
    cv::resize(plane, bytes, size, 0, 0, shrinks ? cv::INTER_AREA : cv::INTER_LINEAR);
    bytes.convertTo(term, CV_32F, static_cast<double>(one[t] - zero[t]), static_cast<double>(zero[t]));
    cv::resize(coefficients_[t], coefficient, size, 0, 0, cv::INTER_LINEAR);
    cv::multiply(coefficient, term, term);
    out += term;
  }
}

}  // namespace odograph::skyline
