// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include <odograph/samples.h>

#include "sdk/host/checks/input_fault.hpp"

namespace odograph {

/// Checks how inertial samples are taken, in the order in which they are pushed: intervals, values that repeat, halves
/// that are not filled. For samples of one kind, with the same halves. No allocation. Not thread-safe.
class SamplingCheck {
 public:
  /// The shares on honest data are the worst of 22 real recordings.
  struct Parameters {
    int64_t too_dense_ns = 50'000;        ///< mean interval of an inertial sensor: 20 kHz; phones give 25 Hz to 1 kHz
    int64_t too_sparse_ns = 150'000'000;  ///< 7 Hz, at which a step has three samples
    int dense_samples = 100, sparse_samples = 10;  ///< in a row
    double batched = 0.2;                          ///< median over mean interval, without the two longest; honest 0.81
    double repeated = 0.6;                    ///< share of samples that equal the one before in all values; honest 0.3
    double half_filled = 0.03;                ///< share of zeros beside values that are none; honest 0
    double rate_radps = 0.1, force_mps2 = 1;  ///< of values that are no rest
  };

  /// `found` is called from add().
  void add(const odo_imu& imu, const FaultFound& found);

 private:
  static constexpr size_t kBatch = 200;  // samples, one second of a phone

  void end_batch(const FaultFound& found);

  Parameters p_;
  odo_imu last_{};
  int64_t first_ns_ = 0;
  int samples_ = 0, sparse_ = 0;  // since first_ns_; in a row with too long an interval
  std::array<int64_t, kBatch> intervals_ns_{};
  size_t intervals_ = 0, repeated_ = 0, zeros_ = 0, moving_ = 0;
};

}  // namespace odograph
