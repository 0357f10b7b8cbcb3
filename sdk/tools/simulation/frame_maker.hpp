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

/// When a frame's middle row is exposed (its middle), and for how long.
struct Exposure {
  double t_s, duration_s;
};

/// Renders, develops and encodes frames, several at a time, each by one thread from its number alone; a video codec
/// takes them in their order. The same bytes whatever the number of threads.
class FrameMaker {
 public:
  struct Times {
    double render_s = 0, develop_s = 0, encode_s = 0;  ///< summed over threads
  };
  /// `threads` 0: as many as there are cores.
  FrameMaker(const World& world, const SimCamera& camera, const Scenario& scenario, const Journey& journey,
             std::vector<Exposure> exposures, unsigned threads);

  /// The encoded picture of frame k; ask in ascending order. The picture is gone with the next call.
  Result<std::vector<unsigned char>> take(size_t k);
  const Times& times() const { return times_; }
  /// Of each frame made so far: how much of it shows something that moves.
  const std::vector<float>& moving_parts() const { return moving_parts_; }
  unsigned threads() const { return static_cast<unsigned>(views_.size()); }

 private:
  void make_batch(size_t first);
  /// Does something with each frame from `first` until before `last`, on all threads.
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
