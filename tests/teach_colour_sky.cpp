// SPDX-License-Identifier: Apache-2.0
//
// Teaches the network of ColourSky on photographs of an upward fisheye lens with masks. Of the photographs, sorted by
// name, every other ten are held back for tests, or those tens that are named.
// odograph-teach-sky IMAGES MASKS RADIUS_PX FOLDER [TENS, such as 024] [STEPS]
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "plugins/fix/skyline/colour_sky.hpp"
#include "tests/teach_convolutions.hpp"

namespace odograph::skyline {
namespace {

namespace fs = std::filesystem;
constexpr int kTerms = ColourSky::kTerms, kLayers = ColourSky::kLayers, kDeepest = 5;
constexpr int kVariants = 14, kPixels = 6000;
constexpr float kRate = 0.003f, kDecay = 1e-4f;
constexpr float kShade = 0.3f, kNoise = 0.1f;         // of a wall's brightness; of the inputs
constexpr double kRateFalls = 100, kRateRises = 100;  // a factor over all steps; steps at first
constexpr double kSharpLeaves_px = 9;                 // solid is what has no sky within half of this
constexpr double kRim = 0.96;                         // of the radius: the lens's rim shows nothing

struct Picture {
  Volume inputs;
  cv::Mat y, cb, cr, mask;  // in full
};

struct Network {
  std::vector<Learner> layers;
  std::array<Volume, kLayers> sums;  // of the way up, by the layer that was joined
  std::array<Volume, kLayers> gradients;

  explicit Network(std::mt19937& random) {
    for (int k = 0; k < kLayers; ++k) {
      const ColourSky::Shape& s = ColourSky::kShapes[k];
      layers.emplace_back(s.inputs, s.outputs, s.side, s.stride, k <= kDeepest, random);
    }
  }
  const Volume& forward(const Volume& inputs) {
    for (int k = 0; k <= kDeepest; ++k) layer(k).forward(k == 0 ? inputs : layer(k - 1).out);
    const Volume* deeper = &layer(kDeepest).out;
    for (int k = kDeepest + 1; k + 1 < kLayers; ++k) {
      Volume& sum = sums[static_cast<size_t>(joined(k))];
      sum = layer(joined(k)).out;
      add_doubled(layer(k).forward(*deeper), sum);
      deeper = &sum;
    }
    return layer(kLayers - 1).forward(*deeper);
  }
  /// gradients[kLayers - 1] is that of the coefficients.
  void backward() {
    for (int k = 0; k + 1 < kLayers; ++k) clear(gradient(k), layer(k).out);
    // joined(kLayers - 2), joined by the last layer, and so on: gradient of the sums, which is that of both parts.
    layer(kLayers - 1).backward(gradient(kLayers - 1), &gradient(joined(kLayers - 2)));
    for (int k = kLayers - 2; k > kDeepest; --k) {
      add_doubled_backward(sums[static_cast<size_t>(joined(k))], gradient(joined(k)), gradient(k));
      layer(k).backward(gradient(k), &gradient(k == kDeepest + 1 ? kDeepest : joined(k - 1)));
    }
    for (int k = kDeepest; k >= 0; --k) layer(k).backward(gradient(k), k > 0 ? &gradient(k - 1) : nullptr);
  }
  Learner& layer(int k) { return layers[static_cast<size_t>(k)]; }
  Volume& gradient(int k) { return gradients[static_cast<size_t>(k)]; }
  static int joined(int k) { return kDeepest + 3 - k; }

  /// Weights as bytes, each output with a factor of its own.
  void write(const fs::path& folder) const {
    std::ofstream weights(folder / "colour_sky_weights.inc"), outputs(folder / "colour_sky_outputs.inc");
    char text[64];
    for (const Learner& learner : layers) {
      const auto& w = learner.layer.weights;
      const size_t taps = w.size() / learner.layer.biases.size();
      for (size_t o = 0; o < learner.layer.biases.size(); ++o) {
        float most = 1e-20f;
        for (size_t t = 0; t < taps; ++t) most = std::max(most, std::abs(w[o * taps + t]));
        for (size_t t = 0; t < taps; ++t) weights << std::lround(127 * w[o * taps + t] / most) << ',';
        weights << '\n';
        std::snprintf(text, sizeof text, "{%.6ef, %.6ef},\n", static_cast<double>(most / 127),
                      static_cast<double>(learner.layer.biases[o]));
        outputs << text;
      }
    }
  }
};

bool look(const cv::Mat& bgr, const cv::Mat& mask, SkyFeatureMaker& maker, Picture& to) {
  cv::Mat planes[3], both;
  cv::cvtColor(bgr, both, cv::COLOR_BGR2YCrCb);
  cv::split(both, planes);
  Chroma chroma;  // at half the size, as phones give it
  cv::resize(planes[2], chroma.cb, bgr.size() / 2, 0, 0, cv::INTER_AREA);
  cv::resize(planes[1], chroma.cr, bgr.size() / 2, 0, 0, cv::INTER_AREA);
  SkyFeatures features;
  if (!maker.make(planes[0], {}, Eigen::Vector3d::UnitZ(), features)) return false;
  ColourSky sky;
  sky.look(features, chroma, {0.5 * (bgr.cols - 1), 0.5 * (bgr.rows - 1)});
  to.inputs = sky.inputs(), to.y = planes[0], to.mask = mask;
  cv::resize(chroma.cb, to.cb, bgr.size()), cv::resize(chroma.cr, to.cr, bgr.size());
  return true;
}

/// The same photograph with what stands solid brighter or darker and of another tint. Leaves stay as they are: masks
/// tell sky between them by how blue it is.
cv::Mat varied(const cv::Mat& bgr, const cv::Mat& mask, std::mt19937& random) {
  std::uniform_real_distribution<double> u(0, 1);
  const auto about = [&](double part) { return 1 + part * (u(random) - 0.5); };
  const double brighter = 0.7 + 1.2 * u(random), all = about(0.14);
  const cv::Scalar tint(brighter * about(0.2), brighter, brighter * about(0.2)),
      balance(all * about(0.04), all, all * about(0.04));
  cv::Mat out, other, solid;
  const cv::Size side(static_cast<int>(kSharpLeaves_px), static_cast<int>(kSharpLeaves_px));
  cv::morphologyEx(mask == 0, solid, cv::MORPH_OPEN, cv::getStructuringElement(cv::MORPH_ELLIPSE, side));
  bgr.convertTo(out, CV_32FC3);
  cv::multiply(out, tint, other);
  // Walls stand in the sun or in the shade.
  cv::Mat shade(4, 4, CV_32F), shades[3];
  std::normal_distribution<float> normal;
  for (float& s : cv::Mat_<float>(shade)) s = std::exp(kShade * normal(random));
  cv::resize(shade, shades[0], bgr.size(), 0, 0, cv::INTER_LINEAR);
  shades[1] = shades[2] = shades[0];
  cv::merge(shades, 3, shade);
  cv::multiply(other, shade, other);
  other.copyTo(out, solid);
  cv::multiply(out, balance, out);
  out.convertTo(out, CV_8UC3);
  return out;
}

/// One of the eight ways to lay a square on itself: where (x, y) comes from.
void source_of(int symmetry, double side, double& x, double& y) {
  if (symmetry & 1) x = side - 1 - x;
  if (symmetry & 2) y = side - 1 - y;
  if (symmetry & 4) std::swap(x, y);
}

Volume turned(const Volume& in, int symmetry) {
  Volume out;
  out.create(in.channels(), in.height(), in.width());
  for (int c = 0; c < in.channels(); ++c)
    for (int y = 0; y < in.height(); ++y)
      for (int x = 0; x < in.width(); ++x) {
        double from_x = x, from_y = y;
        source_of(symmetry, in.width(), from_x, from_y);
        out.row(c, y)[x] = in.row(c, static_cast<int>(from_y))[static_cast<int>(from_x)];
      }
  return out;
}

/// The logarithmic loss of pixels drawn at random, and its gradient by the coefficients.
double loss_of(const Picture& p, int symmetry, const Volume& told, double radius_px, std::mt19937& random,
               Volume& gradient) {
  clear(gradient, told);
  const int side = p.y.cols;
  const double scale = static_cast<double>(side) / told.width();
  double loss = 0;
  for (int n = 0; n < kPixels; ++n) {
    const auto draw = [&] { return static_cast<int>(random() % static_cast<unsigned>(side)); };
    const int tx = draw(), ty = draw();  // of the turned picture
    if (std::hypot(tx - 0.5 * (side - 1), ty - 0.5 * (side - 1)) > kRim * radius_px) continue;
    double sx = tx, sy = ty;
    source_of(symmetry, side, sx, sy);
    const int x = static_cast<int>(sx), y = static_cast<int>(sy);
    const auto terms = ColourSky::terms(p.y.at<uint8_t>(y, x), p.cb.at<uint8_t>(y, x), p.cr.at<uint8_t>(y, x));
    const double gx = std::clamp((tx + 0.5) / scale - 0.5, 0.0, told.width() - 1.001);
    const double gy = std::clamp((ty + 0.5) / scale - 0.5, 0.0, told.height() - 1.001);
    const int ix = static_cast<int>(gx), iy = static_cast<int>(gy);
    const auto a = static_cast<float>(gx - ix), b = static_cast<float>(gy - iy);
    const float parts[] = {(1 - a) * (1 - b), a * (1 - b), (1 - a) * b, a * b};
    float odds = 0;
    for (int t = 0; t < kTerms; ++t)
      for (int k = 0; k < 4; ++k)
        odds += terms[static_cast<size_t>(t)] * parts[k] * told.row(t, iy + k / 2)[ix + k % 2];
    const float sky = p.mask.at<uint8_t>(y, x) ? 1.0f : 0.0f, likely = 1 / (1 + std::exp(-odds));
    loss -= std::log(std::max(1e-6, static_cast<double>(sky > 0 ? likely : 1 - likely)));
    for (int t = 0; t < kTerms; ++t)
      for (int k = 0; k < 4; ++k)
        gradient.row(t, iy + k / 2)[ix + k % 2] += (likely - sky) / kPixels * terms[static_cast<size_t>(t)] * parts[k];
  }
  return loss / kPixels;
}

int teach(const fs::path& images, const fs::path& masks, double radius_px, const fs::path& folder,
          const std::string& tens, int steps) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(images)) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  std::mt19937 random(5);
  std::vector<Picture> pictures;
  for (size_t i = 0; i < files.size(); ++i) {
    if (tens.find(static_cast<char>('0' + i / 10)) == std::string::npos) continue;
    const cv::Mat photo = cv::imread(files[i].string());
    const cv::Mat mask = cv::imread((masks / files[i].stem()).string() + ".png", cv::IMREAD_GRAYSCALE) > 127;
    if (photo.empty() || mask.size() != photo.size()) return std::fprintf(stderr, "%s: no mask\n", files[i].c_str()), 3;
    if (photo.rows != photo.cols) return std::fprintf(stderr, "%s: not square\n", files[i].c_str()), 3;
    const double f = radius_px / (0.5 * std::numbers::pi), middle = 0.5 * (photo.cols - 1);
    const CameraModel lens{
        .distortion = CameraModel::Distortion::kannala_brandt, .fx = f, .fy = f, .cx = middle, .cy = middle};
    SkyFeatureMaker maker(lens, photo.size(), 1.52);
    for (int variant = 0; variant < kVariants; ++variant) {
      cv::Mat photo_now = variant > 0 ? varied(photo, mask, random) : photo, mask_now = mask.clone();
      if (variant % 2 == 0 && variant > 0) {
        const auto middle_px = static_cast<float>(middle);
        const double degrees = std::uniform_real_distribution<double>(0, 360)(random);
        const cv::Mat rotation = cv::getRotationMatrix2D({middle_px, middle_px}, degrees, 1);
        cv::warpAffine(photo_now.clone(), photo_now, rotation, photo.size(), cv::INTER_LINEAR, cv::BORDER_REFLECT);
        cv::warpAffine(mask, mask_now, rotation, photo.size(), cv::INTER_NEAREST);
      }
      Picture p;
      if (look(photo_now, mask_now, maker, p)) pictures.push_back(std::move(p));
    }
  }
  if (pictures.empty()) return std::fprintf(stderr, "no photographs\n"), 3;
  Network network(random);
  std::normal_distribution<float> normal;
  double loss = 0;
  for (int n = 1; n <= steps; ++n) {
    const Picture& p = pictures[random() % pictures.size()];
    const int symmetry = static_cast<int>(random() % 8);
    Volume inputs = turned(p.inputs, symmetry);
    for (int c = 0; c < inputs.channels(); ++c) {
      const float shift = kNoise * normal(random);
      for (int y = 0; y < inputs.height(); ++y)
        for (int x = 0; x < inputs.width(); ++x) inputs.row(c, y)[x] += shift;
    }
    const Volume& told = network.forward(inputs);
    loss += loss_of(p, symmetry, told, radius_px, random, network.gradient(kLayers - 1));
    network.backward();
    const double part = static_cast<double>(n) / steps;
    const auto rate = kRate * static_cast<float>(std::pow(kRateFalls, -part) * std::min(1.0, n / kRateRises));
    for (Learner& layer : network.layers) layer.step(rate, n, kDecay);
    if (n % 500 == 0) std::printf("%d steps, loss %.4f\n", n, loss / 500), std::fflush(stdout), loss = 0;
  }
  network.write(folder);
  return 0;
}

}  // namespace
}  // namespace odograph::skyline

int main(int argc, char** argv) {
  if (argc < 5 || argc > 7)
    return std::fprintf(stderr, "odograph-teach-sky IMAGES MASKS RADIUS_PX FOLDER [TENS] [STEPS]\n"), 2;
  return odograph::skyline::teach(argv[1], argv[2], std::stod(argv[3]), argv[4], argc > 5 ? argv[5] : "024",
                                  argc > 6 ? std::stoi(argv[6]) : 6000);
}
