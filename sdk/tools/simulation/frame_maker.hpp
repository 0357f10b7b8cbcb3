// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "sdk/host/base/result.hpp"
#include "sdk/tools/simulation/camera.hpp"
#include "sdk/tools/simulation/codec.hpp"
#include "sdk/tools/simulation/journey.hpp"

namespace odograph {

/// Exposure time of a frame's middle row (its middle), and duration.
struct Exposure {
  double t_s, duration_s;
};

/// Renders, develops and encodes frames in parallel, each in one thread from its number only; a video codec processes
/// them in order. The bytes do not depend on the number of threads.
class FrameMaker {
 public:
  struct Times {
    double render_s = 0, develop_s = 0, encode_s = 0;  ///< summed over threads
  };
  /// `threads` 0: one per core.
  FrameMaker(const World& world, const SimCamera& camera, const Scenario& scenario, const Journey& journey,
             std::vector<Exposure> exposures, unsigned threads);

  /// The encoded picture of frame k; call in ascending order. Valid until the next call.
  Result<std::vector<unsigned char>> take(size_t k);
  const Times& times() const { return times_; }
  /// For each frame made so far, the fraction of pixels that show moving objects.
  const std::vector<float>& moving_parts() const { return moving_parts_; }
  unsigned threads() const { return static_cast<unsigned>(views_.size()); }

 private:
  void make_batch(size_t first);
  /// Calls `make` for each frame from `first` up to but excluding `last`, on all threads.
  void each(size_t first, size_t last, const std::function<void(size_t thread, size_t k)>& make);

  const SimCamera& camera_;
  const Scenario& c_;
  const Journey& journey_;
  std::vector<Exposure> exposures_;
  std::vector<std::unique_ptr<View>> views_;
  std::optional<VideoCodec> codec_;
  std::vector<Result<std::vector<unsigned char>>> batch_;
  size_t batch_first_ = 0;
  Times times_;
  std::vector<float> moving_parts_;
};

}  // namespace odograph
