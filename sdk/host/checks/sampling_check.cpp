// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/checks/sampling_check.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Core>

#include "sdk/host/base/saturating.hpp"
#include "sdk/math/time.hpp"

namespace odograph {

using Eigen::Vector3d;

void SamplingCheck::add(const odo_imu& imu, const FaultFound& found) {
  const int64_t t_ns = imu.header.t_ns;
  const int64_t interval_ns = samples_ == 0 ? 0 : saturating_difference(t_ns, last_.header.t_ns);
  const bool follows = last_.header.struct_size != 0 && interval_ns >= 0;
  if (samples_ == 0 || interval_ns < 0) first_ns_ = t_ns, samples_ = sparse_ = 0;
  ++samples_;
  if (follows) {
    const uint32_t halves = imu.header.flags & (ODO_IMU_GYRO | ODO_IMU_ACCEL);
    const auto change = [&](const double* now, const double* before) {
      return (Vector3d(now) - Vector3d(before)).norm();
    };
    const double rate = halves & ODO_IMU_GYRO ? change(imu.gyro_b, last_.gyro_b) : 0,
                 force = halves & ODO_IMU_ACCEL ? change(imu.accel_b, last_.accel_b) : 0;
    repeated_ += rate == 0 && force == 0;
    moving_ += Vector3d(imu.gyro_b).norm() > p_.rate_radps;
    const auto empty = [](const double* now, const double* before, double least) {
      return Vector3d(now).isZero(0) && Vector3d(before).norm() > least;
    };
    if (halves == (ODO_IMU_GYRO | ODO_IMU_ACCEL))
      zeros_ += empty(imu.accel_b, last_.accel_b, p_.force_mps2) || empty(imu.gyro_b, last_.gyro_b, p_.rate_radps);
    intervals_ns_[intervals_++] = saturating_difference(t_ns, last_.header.t_ns);
    if (intervals_ == kBatch) end_batch(found);
  }
  last_ = imu;
  sparse_ = interval_ns > p_.too_sparse_ns ? sparse_ + 1 : 0;  // one long interval is a pause
  if (sparse_ >= p_.sparse_samples) found(InputFault::imu_slow, true, seconds(interval_ns), {});
  if (samples_ <= p_.dense_samples) return;
  const double mean_ns = static_cast<double>(saturating_difference(t_ns, first_ns_)) / (samples_ - 1);
  found(InputFault::time_unit, mean_ns < static_cast<double>(p_.too_dense_ns), mean_ns, {});
  if (sparse_ == 0) found(InputFault::imu_slow, false, 0, {});
  samples_ = 0;
}

void SamplingCheck::end_batch(const FaultFound& found) {
  constexpr size_t kPauses = 2;  // the longest intervals do not count
  std::sort(intervals_ns_.begin(), intervals_ns_.end());
  double sum_ns = 0;
  for (size_t i = 0; i + kPauses < kBatch; ++i) sum_ns += static_cast<double>(intervals_ns_[i]);
  const int64_t middle_ns = intervals_ns_[kBatch / 2];
  const double mean_ns = sum_ns / (kBatch - kPauses), median_ns = static_cast<double>(middle_ns), share = 1.0 / kBatch;
  found(InputFault::imu_batched, median_ns < p_.batched * mean_ns, seconds(middle_ns), {});
  const bool moves = static_cast<double>(moving_) * share > 1 - p_.repeated;  // at rest values repeat
  const double repeated = static_cast<double>(repeated_) * share, zeros = static_cast<double>(zeros_) * share;
  found(InputFault::imu_repeated, moves && repeated > p_.repeated, 100 * repeated, {});
  found(InputFault::imu_half_filled, zeros > p_.half_filled, 100 * zeros, {});
  intervals_ = repeated_ = zeros_ = moving_ = 0;
}

}  // namespace odograph
