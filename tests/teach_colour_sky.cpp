// SPDX-License-Identifier: Apache-2.0
//
// Teaches the network of ColourSky on photographs of an upward fisheye lens with masks; every other ten of them are
// held back for tests. odograph-teach-sky IMAGES MASKS RADIUS_PX FOLDER
#include <algorithm>
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

namespace odograph::skyline {
namespace {

namespace fs = std::filesystem;
constexpr size_t kIn = ColourSky::kFeatures, kOut = ColourSky::kTerms, kHidden = ColourSky::kHidden;
constexpr size_t kOutputs = kHidden * (kIn + 1), kWeights = kOutputs + kOut * (kHidden + 1);
constexpr int kVariants = 5, kPixels = 5000, kEpochs = 8;
constexpr size_t kBatch = 256;

struct Sample {
  std::array<float, kIn> in;
  std::array<float, kOut> terms;
  float sky;
};

struct Network {
  std::vector<float> w = std::vector<float>(kWeights), mean = w, square = w, gradient = w;
  std::array<float, kHidden> hidden{};

  explicit Network(std::mt19937& random) {
    std::normal_distribution<float> normal;
    for (size_t k = 0; k < kWeights; ++k) w[k] = normal(random) * (k < kOutputs ? std::sqrt(1.5f / kIn) : 0.15f);
  }
  float log_odds(const Sample& s) {
    float sum = 0;
    for (size_t t = 0; t < kOut; ++t) sum += w[kOutputs + t * (kHidden + 1) + kHidden] * s.terms[t];
    for (size_t h = 0; h < kHidden; ++h) {
      const float* p = &w[h * (kIn + 1)];
      float a = p[kIn];
      for (size_t k = 0; k < kIn; ++k) a += p[k] * s.in[k];
      hidden[h] = std::max(0.0f, a);
      for (size_t t = 0; t < kOut; ++t) sum += w[kOutputs + t * (kHidden + 1) + h] * hidden[h] * s.terms[t];
    }
    return sum;
  }
  void learn(const Sample& s) {
    const float off = 1 / (1 + std::exp(-log_odds(s))) - s.sky;
    for (size_t t = 0; t < kOut; ++t) gradient[kOutputs + t * (kHidden + 1) + kHidden] += off * s.terms[t];
    for (size_t h = 0; h < kHidden; ++h) {
      if (hidden[h] <= 0) continue;
      float back = 0;
      for (size_t t = 0; t < kOut; ++t) {
        const size_t k = kOutputs + t * (kHidden + 1) + h;
        gradient[k] += off * s.terms[t] * hidden[h], back += off * s.terms[t] * w[k];
      }
      float* g = &gradient[h * (kIn + 1)];
      for (size_t k = 0; k < kIn; ++k) g[k] += back * s.in[k];
      g[kIn] += back;
    }
  }
  /// One step of Adam (Kingma & Ba 2015).
  void step(float rate, double steps) {
    const auto a = static_cast<float>(1 - std::pow(0.9, steps)), b = static_cast<float>(1 - std::pow(0.999, steps));
    for (size_t k = 0; k < kWeights; ++k) {
      const float g = gradient[k] / kBatch + 3e-5f * w[k];
      mean[k] = 0.9f * mean[k] + 0.1f * g, square[k] = 0.999f * square[k] + 0.001f * g * g;
      w[k] -= rate * (mean[k] / a) / (std::sqrt(square[k] / b) + 1e-8f);
      gradient[k] = 0;
    }
  }
  void write(const fs::path& folder) const {
    std::ofstream neurons(folder / "colour_sky_weights.inc"), biases(folder / "colour_sky_biases.inc");
    char text[32];
    const auto put = [&](std::ofstream& out, size_t k) {
      std::snprintf(text, sizeof text, "%.5gf", static_cast<double>(w[k]));
      std::string s = text;
      if (s.find_first_of(".e") == std::string::npos) s.insert(s.size() - 1, ".0");
      out << s;
    };
    for (size_t h = 0; h < kHidden; ++h) {
      neurons << "    {{";
      for (size_t k = 0; k < kIn; ++k) put(neurons, h * (kIn + 1) + k), neurons << (k + 1 < kIn ? ", " : "}, ");
      put(neurons, h * (kIn + 1) + kIn);
      neurons << ", {";
      for (size_t t = 0; t < kOut; ++t)
        put(neurons, kOutputs + t * (kHidden + 1) + h), neurons << (t + 1 < kOut ? ", " : "}},\n");
    }
    for (size_t t = 0; t < kOut; ++t)
      biases << (t ? " " : "    "), put(biases, kOutputs + t * (kHidden + 1) + kHidden), biases << ",";
    biases << '\n';
  }
};

struct Picture {
  cv::Mat grey;
  Chroma chroma;
  ColourSky sky;
};

bool look(const cv::Mat& bgr, SkyFeatureMaker& maker, Picture& to) {
  cv::Mat planes[3], both;
  cv::cvtColor(bgr, both, cv::COLOR_BGR2YCrCb);
  cv::split(both, planes);
  to.grey = planes[0], to.chroma = {planes[2], planes[1]};
  SkyFeatures features;
  if (!maker.make(to.grey, {}, Eigen::Vector3d::UnitZ(), features)) return false;
  to.sky.look(features, to.grey, to.chroma, {0.5 * (bgr.cols - 1), 0.5 * (bgr.rows - 1)});
  return true;
}

/// The same photograph with what is not sky, and then all of it, brighter or darker and of another tint.
cv::Mat varied(const cv::Mat& bgr, const cv::Mat& mask, std::mt19937& random) {
  std::uniform_real_distribution<double> u(0, 1);
  const auto about = [&](double part) { return 1 + part * (u(random) - 0.5); };
  const double brighter = 0.75 + 1.1 * u(random), all = 0.8 + 0.45 * u(random);
  const cv::Scalar tint(brighter * about(0.16), brighter, brighter * about(0.16)),
      balance(all * about(0.06), all, all * about(0.06));
  cv::Mat out, other;
  bgr.convertTo(out, CV_32FC3);
  cv::multiply(out, tint, other);
  other.copyTo(out, mask == 0);
  cv::multiply(out, balance, out);
  out.convertTo(out, CV_8UC3);
  return out;
}

int teach(const fs::path& images, const fs::path& masks, double radius_px, const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(images)) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  std::mt19937 random(5);
  std::vector<Sample> samples;
  for (size_t i = 0; i < files.size(); ++i) {
    if (i / 10 % 2 == 1) continue;  // every other ten are held back
    const cv::Mat photo = cv::imread(files[i].string());
    const cv::Mat mask = cv::imread((masks / files[i].stem()).string() + ".png", cv::IMREAD_GRAYSCALE) > 127;
    if (photo.empty() || mask.size() != photo.size()) return std::fprintf(stderr, "%s: no mask\n", files[i].c_str()), 3;
    const double f = radius_px / (0.5 * std::numbers::pi), cx = 0.5 * (photo.cols - 1), cy = 0.5 * (photo.rows - 1);
    const CameraModel lens{.distortion = CameraModel::Distortion::kannala_brandt, .fx = f, .fy = f, .cx = cx, .cy = cy};
    SkyFeatureMaker maker(lens, photo.size(), 1.52);
    for (int variant = 0; variant < kVariants; ++variant) {
      Picture p;
      if (!look(variant > 0 ? varied(photo, mask, random) : photo, maker, p)) continue;
      const auto& channels = p.sky.channels();
      const double scale = static_cast<double>(photo.cols) / channels[0].cols;
      for (int n = 0; n < kPixels; ++n) {
        const int x = static_cast<int>(random() % static_cast<unsigned>(photo.cols));
        const int y = static_cast<int>(random() % static_cast<unsigned>(photo.rows));
        if (std::hypot(x - cx, y - cy) > 0.955 * radius_px) continue;  // the lens's rim
        const auto sx = static_cast<float>((x + 0.5) / scale - 0.5), sy = static_cast<float>((y + 0.5) / scale - 0.5);
        Sample s{.terms = p.sky.terms(p.grey.at<uint8_t>(y, x), p.chroma.cb.at<uint8_t>(y, x),
                                      p.chroma.cr.at<uint8_t>(y, x)),
                 .sky = mask.at<uint8_t>(y, x) ? 1.0f : 0.0f};
        for (size_t k = 0; k < kIn; ++k) {
          cv::Mat one;
          cv::getRectSubPix(channels[k], {1, 1}, {sx, sy}, one);
          s.in[k] = one.at<float>(0);
        }
        samples.push_back(s);
      }
    }
  }
  Network network(random);
  const double steps = kEpochs * static_cast<double>(samples.size() / kBatch);
  double done = 0;
  for (int epoch = 0; epoch < kEpochs; ++epoch) {
    std::shuffle(samples.begin(), samples.end(), random);
    for (size_t first = 0; first + kBatch <= samples.size(); first += kBatch) {
      for (size_t k = first; k < first + kBatch; ++k) network.learn(samples[k]);
      ++done;
      network.step(static_cast<float>(0.004 * std::pow(30.0, -done / steps)), done);
    }
  }
  network.write(folder);
  size_t right = 0;
  for (const Sample& s : samples) right += (network.log_odds(s) > 0) == (s.sky > 0.5f);
  std::printf("%zu samples, %.2f %% right\n", samples.size(),
              100 * static_cast<double>(right) / static_cast<double>(samples.size()));
  return 0;
}

}  // namespace
}  // namespace odograph::skyline

int main(int argc, char** argv) {
  if (argc != 5) return std::fprintf(stderr, "odograph-teach-sky IMAGES MASKS RADIUS_PX FOLDER\n"), 2;
  return odograph::skyline::teach(argv[1], argv[2], std::stod(argv[3]), argv[4]);
}
