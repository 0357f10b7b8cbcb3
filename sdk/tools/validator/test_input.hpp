// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "sdk/host/messages/messages.hpp"

namespace odograph {

/// Consistent walking-like input of every kind: a phone lying flat, screen up, carried north at 1.4 m/s, two steps of
/// 0.7 m a second, one odometry motion a second, gyroscope at 100 Hz, pictures of 64 x 48 pixels and platform poses at
/// 10 Hz, ranges to a known point 100 m ahead and 20 m up. Messages point into the pixels that it owns.
class TestInput {
 public:
  static constexpr int64_t kStart_ns = 1'000'000'000;
  static constexpr uint32_t kWidth = 64, kHeight = 48;
  static constexpr double kSpeed_mps = 1.4, kUnit_mps = 1.0;

  explicit TestInput(double seconds);

  std::vector<AnyMessage> messages;  ///< in time order
  /// Only messages of these types.
  std::vector<AnyMessage> of(const std::vector<uint32_t>& types) const;

 private:
  template <class M>
  void add(const M& message) {
    messages.emplace_back(message.header);
  }
  void add_camera(int k, int64_t t_ns);
  void add_slow(int i, double t, int64_t t_ns);

  std::vector<std::unique_ptr<std::vector<uint8_t>>> pixels_;
};

/// Shifts all times of a message.
void shift(AnyMessage& message, int64_t by_ns);

}  // namespace odograph
