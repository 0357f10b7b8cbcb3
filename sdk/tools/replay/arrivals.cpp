// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/replay/arrivals.hpp"

#include <algorithm>

namespace odograph {

std::vector<Arrival> arrivals_of(const Recording& recording, const Lateness& a) {
  std::vector<Arrival> out;
  const auto imu_late = static_cast<int64_t>(a.imu_late_ms * 1e6),
             frame_late = static_cast<int64_t>(a.frame_late_ms * 1e6);
  const auto period = static_cast<int64_t>(1e9 / a.accel_hz);
  int64_t next_ns = INT64_MIN;
  const odo_imu* last = nullptr;
  for (const RecordedMessage& message : recording.messages) {
    const odo_header& header = message.message.header();
    if (header.type != ODO_TYPE_IMU) {
      const bool frame = header.type == ODO_TYPE_FRAME;
      out.push_back({header.t_ns + (frame ? frame_late : imu_late), {}, &message});
      continue;
    }
    const auto& imu = as<odo_imu>(header);
    Arrival gyro{header.t_ns + imu_late, imu};
    gyro.imu.header.flags = ODO_IMU_GYRO;
    out.push_back(gyro);
    if (next_ns == INT64_MIN) next_ns = header.t_ns;
    for (; last && next_ns <= header.t_ns; next_ns += period) {
      if (next_ns < last->header.t_ns) continue;
      const double w =
          static_cast<double>(next_ns - last->header.t_ns) / static_cast<double>(header.t_ns - last->header.t_ns);
      Arrival accel{next_ns + imu_late, imu};
      accel.imu.header.t_ns = next_ns;
      accel.imu.header.flags = ODO_IMU_ACCEL;
      for (int i = 0; i < 3; ++i) accel.imu.accel_b[i] = last->accel_b[i] + w * (imu.accel_b[i] - last->accel_b[i]);
      out.push_back(accel);
    }
    last = &imu;
  }
  std::stable_sort(out.begin(), out.end(), [](const Arrival& x, const Arrival& y) { return x.at_ns < y.at_ns; });
  return out;
}

}  // namespace odograph
