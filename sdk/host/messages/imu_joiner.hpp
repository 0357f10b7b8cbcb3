// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>

#include <odograph/types.h>

namespace odograph {

/// Builds complete IMU samples from an accelerometer and a gyroscope that are delivered separately (as on Android): the
/// accelerometer is interpolated linearly at the gyroscope's times. Complete samples pass through; without an
/// accelerometer, gyroscope samples pass 0.1 s late. Input in time order.
class ImuJoiner {
 public:
  /// Calls `take(const odo_imu&)`, in order, for each sample that the new one completes and for each whose wait timed
  /// out, which has only ODO_IMU_GYRO.
  template <class Take>
  void push(const odo_imu& sample, Take&& take) {
    constexpr uint32_t both = ODO_IMU_GYRO | ODO_IMU_ACCEL;
    if ((sample.header.flags & both) == both) return take(sample);
    if (sample.header.flags & ODO_IMU_GYRO) {
      size_t alone = waiting_count_ == waiting_.size() ? 1 : 0;
      while (alone < waiting_count_ && sample.header.t_ns - waiting_[alone].header.t_ns > kLongestWait_ns) ++alone;
      for (size_t i = 0; i < alone; ++i) take(waiting_[i]);
      std::copy(waiting_.begin() + alone, waiting_.begin() + waiting_count_, waiting_.begin());
      waiting_count_ -= alone;
      waiting_[waiting_count_++] = sample;
      return;
    }
    if ((sample.header.flags & ODO_IMU_ACCEL) == 0) return;
    if (last_accel_) {
      for (size_t i = 0; i < waiting_count_; ++i)
        if (waiting_[i].header.t_ns >= last_accel_->header.t_ns) take(joined(waiting_[i], *last_accel_, sample));
    }
    waiting_count_ = 0;
    last_accel_ = sample;
  }
  void reset() { *this = ImuJoiner(); }

 private:
  static odo_imu joined(odo_imu gyro, const odo_imu& before, const odo_imu& after) {
    const double span = static_cast<double>(after.header.t_ns - before.header.t_ns);
    const double w = span > 0 ? static_cast<double>(gyro.header.t_ns - before.header.t_ns) / span : 0.0;
    for (int i = 0; i < 3; ++i) gyro.accel_b[i] = before.accel_b[i] + w * (after.accel_b[i] - before.accel_b[i]);
    gyro.header.flags |= ODO_IMU_ACCEL;
    return gyro;
  }

  static constexpr int64_t kLongestWait_ns = 100'000'000;  // twice the sample interval of an accelerometer at 20 Hz
  std::array<odo_imu, 64> waiting_{};
  size_t waiting_count_ = 0;
  std::optional<odo_imu> last_accel_;
};

}  // namespace odograph
