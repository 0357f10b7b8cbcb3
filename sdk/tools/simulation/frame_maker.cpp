// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/simulation/frame_maker.hpp"

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
                       std::vector<Exposure> exposures, unsigned threads)
    : camera_(camera), c_(scenario), journey_(journey), exposures_(std::move(exposures)) {
  if (threads == 0) threads = std::clamp(std::thread::hardware_concurrency(), 1u, 16u);
  for (unsigned i = 0; i < threads; ++i) views_.push_back(std::make_unique<View>(world, camera, scenario));
  if (c_.camera.bit_rate > 0) codec_.emplace(VideoCodec::Parameters{.bit_rate = c_.camera.bit_rate});
}

Result<std::vector<unsigned char>> FrameMaker::take(size_t k) {
  if (k >= exposures_.size()) return Failure{ODO_E_ARGUMENT, "no such frame"};
  if (k < batch_first_ || k >= batch_first_ + batch_.size()) make_batch(k);
  return std::move(batch_[k - batch_first_]);
}

void FrameMaker::each(size_t first, size_t last, const std::function<void(size_t thread, size_t k)>& make) {
  std::atomic<size_t> next{first};
  const auto work = [&](size_t thread) {
    for (size_t k = next++; k < last; k = next++) make(thread, k);
  };
  std::vector<std::thread> others;
  for (size_t i = 1; i < views_.size(); ++i) others.emplace_back(work, i);
  work(0);
  for (auto& thread : others) thread.join();
}

void FrameMaker::make_batch(size_t first) {
  const size_t last = std::min(exposures_.size(), first + 8 * views_.size());
  batch_first_ = first;
  moving_parts_.resize(last);
  batch_.assign(last - first, Failure{ODO_E_DATA, "not rendered"});
  std::vector<Times> times(views_.size());
  std::vector<cv::Mat> pictures(last - first), tints(last - first);
  const auto store = [&](size_t thread, size_t k) {
    const double start = now();
    const cv::Mat &picture = pictures[k - first], &tint = tints[k - first];
    batch_[k - first] = encode(tint.empty() ? picture : coloured(picture, tint), c_.camera.jpeg_quality);
    times[thread].encode_s += now() - start;
  };
  each(first, last, [&](size_t thread, size_t k) {
    const double start = now(), t = exposures_[k].t_s;
    const cv::Mat light = views_[thread]->render(journey_.phone, t, exposures_[k].duration_s);
    tints[k - first] = views_[thread]->tint().clone();
    moving_parts_[k] = static_cast<float>(views_[thread]->moving_part());
    const double rendered = now();
    pictures[k - first] = camera_.develop(light, k, journey_.open_at(t));
    times[thread].render_s += rendered - start;
    times[thread].develop_s += now() - rendered;
    if (!codec_) store(thread, k);
  });
  if (codec_) {
    const double start = now();
    for (cv::Mat& picture : pictures) picture = codec_->pass(picture);
    times[0].encode_s += now() - start;
    each(first, last, store);
  }
  for (const Times& t : times)
    times_.render_s += t.render_s, times_.develop_s += t.develop_s, times_.encode_s += t.encode_s;
}

}  // namespace odograph
