// SPDX-License-Identifier: Apache-2.0
#include "sdk/sim/frame_maker.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <thread>

#include <opencv2/imgcodecs.hpp>

namespace odograph {
namespace {

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

Result<std::vector<unsigned char>> encode(const cv::Mat& picture, int jpeg_quality) {
  std::vector<unsigned char> bytes;
  const bool done = jpeg_quality > 0 ? cv::imencode(".jpg", picture, bytes, {cv::IMWRITE_JPEG_QUALITY, jpeg_quality})
                                     : cv::imencode(".png", picture, bytes, {cv::IMWRITE_PNG_COMPRESSION, 1});
  if (!done) return Failure{ODO_E_DATA, "a picture could not be encoded"};
  return bytes;
}

}  // namespace

FrameMaker::FrameMaker(const World& world, const SimCamera& camera, const Scenario& scenario, const Journey& journey,
                       std::vector<double> exposures_s, unsigned threads)
    : camera_(camera), c_(scenario), journey_(journey), exposures_s_(std::move(exposures_s)) {
  if (threads == 0) threads = std::clamp(std::thread::hardware_concurrency(), 1u, 16u);
  for (unsigned i = 0; i < threads; ++i) views_.push_back(std::make_unique<View>(world, camera, scenario));
}

Result<std::vector<unsigned char>> FrameMaker::take(size_t k) {
  if (k >= exposures_s_.size()) return Failure{ODO_E_ARGUMENT, "no such frame"};
  if (k < batch_first_ || k >= batch_first_ + batch_.size()) make_batch(k);
  return std::move(batch_[k - batch_first_]);
}

void FrameMaker::make_batch(size_t first) {
  const size_t last = std::min(exposures_s_.size(), first + 8 * views_.size());
  batch_first_ = first;
  moving_parts_.resize(last);
  batch_.assign(last - first, Failure{ODO_E_DATA, "not rendered"});
  std::atomic<size_t> next{first};
  std::vector<Times> times(views_.size());
  const auto work = [&](size_t thread) {
    for (size_t k = next++; k < last; k = next++) {
      const double start = now();
      const cv::Mat light = views_[thread]->render(journey_.phone, exposures_s_[k]);
      moving_parts_[k] = static_cast<float>(views_[thread]->moving_part());
      const double rendered = now();
      const cv::Mat picture = camera_.develop(light, k, journey_.open_at(exposures_s_[k]));
      const double developed = now();
      batch_[k - first] = encode(picture, c_.camera.jpeg_quality);
      times[thread].render_s += rendered - start;
      times[thread].develop_s += developed - rendered;
      times[thread].encode_s += now() - developed;
    }
  };
  std::vector<std::thread> others;
  for (size_t i = 1; i < views_.size(); ++i) others.emplace_back(work, i);
  work(0);
  for (auto& thread : others) thread.join();
  for (const Times& t : times)
    times_.render_s += t.render_s, times_.develop_s += t.develop_s, times_.encode_s += t.encode_s;
}

}  // namespace odograph
