// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/evaluation/degrade.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "sdk/math/time.hpp"
#include "sdk/tools/simulation/random.hpp"

namespace odograph {
namespace {

constexpr double kEquator_m = 6378137.0;

enum Stream : uint64_t {
  kNoise = 71,
  kJitter,
  kOutliers,
  kLost
};  // random streams, so that one fault does not change another's numbers

odo_imu& imu_of(RecordedMessage& m) { return reinterpret_cast<odo_imu&>(m.message.header()); }
odo_frame& frame_of(RecordedMessage& m) { return reinterpret_cast<odo_frame&>(m.message.header()); }
uint32_t type_of(const RecordedMessage& m) { return m.message.header().type; }
int64_t time_of(const RecordedMessage& m) { return m.message.header().t_ns; }
/// Gyroscope and accelerometer may have separate samples, each in time order.
uint32_t sensors_of(const RecordedMessage& m) { return m.message.header().flags & (ODO_IMU_GYRO | ODO_IMU_ACCEL); }

template <class Action>
void for_imu(Recording& recording, Action action) {
  for (RecordedMessage& m : recording.messages)
    if (type_of(m) == ODO_TYPE_IMU) action(m);
}

template <class Condition>
void drop(Recording& recording, Condition condition) {
  recording.messages.erase(std::remove_if(recording.messages.begin(), recording.messages.end(), condition),
                           recording.messages.end());
}

int64_t first_frame_ns(const Recording& recording) {
  for (const RecordedMessage& m : recording.messages)
    if (type_of(m) == ODO_TYPE_FRAME) return time_of(m);
  return recording.messages.empty() ? 0 : time_of(recording.messages.front());
}

/// Rate of the samples with a gyroscope, or of all samples if there is none.
double imu_rate_hz(const Recording& recording) {
  int64_t first = 0, last = 0;
  size_t n = 0;
  for (const RecordedMessage& m : recording.messages)
    if (type_of(m) == ODO_TYPE_IMU && (sensors_of(m) & ODO_IMU_GYRO)) {
      if (n++ == 0) first = time_of(m);
      last = time_of(m);
    }
  return n > 1 ? static_cast<double>(n - 1) * 1e9 / static_cast<double>(std::max<int64_t>(1, last - first)) : 200;
}

void cut(Recording& recording, double s) {
  const int64_t begin = first_frame_ns(recording) + nanoseconds(s);
  drop(recording, [begin](const RecordedMessage& m) {
    const bool describes = type_of(m) == ODO_TYPE_CALIBRATION || type_of(m) == ODO_TYPE_IMU_NOISE;
    return time_of(m) < begin && !describes;
  });
  for (RecordedMessage& m : recording.messages) m.message.header().t_ns = std::max(begin, time_of(m));
}

void end_after(Recording& recording, double s) {
  const int64_t end = first_frame_ns(recording) + nanoseconds(s);
  drop(recording, [end](const RecordedMessage& m) { return time_of(m) > end; });
}

void relight(Recording& recording, const Degradation& d) {
  const int64_t first = first_frame_ns(recording);
  for (RecordedMessage& m : recording.messages) {
    if (type_of(m) != ODO_TYPE_FRAME) continue;
    const double phase = 2 * EIGEN_PI * d.flicker_hz * seconds(time_of(m) - first);
    m.picture.gamma_percent = static_cast<uint16_t>(std::lround(100 * d.gamma));
    m.picture.gain_percent = static_cast<uint16_t>(std::lround(100 * (1 + d.flicker * std::sin(phase))));
  }
}

void leave_out_frames(Recording& recording, const Degradation& d) {
  const int64_t first = first_frame_ns(recording);
  const auto within = [first](const RecordedMessage& m, double from_s, double for_s) {
    const int64_t t = time_of(m) - first;
    return type_of(m) == ODO_TYPE_FRAME && t >= nanoseconds(from_s) && t < nanoseconds(from_s + for_s);
  };
  for (RecordedMessage& m : recording.messages)
    if (within(m, d.dark_from_s, d.dark_for_s)) m.picture.gain_percent = 0;
  drop(recording, [&](const RecordedMessage& m) { return within(m, d.gap_from_s, d.gap_for_s); });
}

void decimate(Recording& recording, double hz) {
  const int64_t period = nanoseconds(1 / hz);
  int64_t next_ns[4] = {INT64_MIN, INT64_MIN, INT64_MIN, INT64_MIN};  // by the sensors of a sample
  drop(recording, [&](const RecordedMessage& m) {
    if (type_of(m) != ODO_TYPE_IMU) return false;
    int64_t& next = next_ns[sensors_of(m)];
    const int64_t early = period / 20;  // accepts a sample shortly before its due time
    if (next != INT64_MIN && time_of(m) < next - early) return true;
    next = next == INT64_MIN || time_of(m) > next + period ? time_of(m) + period : next + period;
    return false;
  });
}

void degrade_values(Recording& recording, const Degradation& d, uint64_t seed) {
  Random random(seed, kNoise);
  const double added = std::sqrt(std::max(0.0, d.imu_noise_factor * d.imu_noise_factor - 1) * imu_rate_hz(recording));
  for_imu(recording, [&](RecordedMessage& m) {
    odo_imu& imu = imu_of(m);
    for (int k = 0; k < 3; ++k) {
      imu.gyro_b[k] = (1 + d.imu_scale_error) * imu.gyro_b[k];
      imu.accel_b[k] = (1 + d.imu_scale_error) * imu.accel_b[k] + d.accel_bias_mps2;
      if (added == 0) continue;
      imu.gyro_b[k] += added * kPhoneGyroNoise * random.normal();
      imu.accel_b[k] += added * kPhoneAccelNoise * random.normal();
    }
  });
}

void add_outliers(Recording& recording, double per_minute, uint64_t seed) {
  Random random(seed, kOutliers);
  const double chance = per_minute / (60 * imu_rate_hz(recording));
  for_imu(recording, [&](RecordedMessage& m) {
    if (random.uniform() >= chance) return;
    odo_imu& imu = imu_of(m);
    for (int k = 0; k < 3; ++k) {
      imu.gyro_b[k] = random.uniform() < 0.5 ? -kOutlierGyro_radps : kOutlierGyro_radps;
      imu.accel_b[k] = random.uniform() < 0.5 ? -kOutlierAccel_mps2 : kOutlierAccel_mps2;
    }
  });
}

void without_accelerometer(Recording& recording) {
  drop(recording,
       [](const RecordedMessage& m) { return type_of(m) == ODO_TYPE_IMU && sensors_of(m) == ODO_IMU_ACCEL; });
  for_imu(recording, [](RecordedMessage& m) {
    m.message.header().flags &= ~ODO_IMU_ACCEL;
    std::fill_n(imu_of(m).accel_b, 3, 0.0);
  });
}

void degrade_times(Recording& recording, const Degradation& d, uint64_t seed) {
  Random random(seed, kJitter);
  int64_t last_ns[4] = {INT64_MIN, INT64_MIN, INT64_MIN, INT64_MIN};
  constexpr int64_t kMin_ns = 1000;
  // The truth is on the camera's stated clock, so the IMU times are shifted.
  for_imu(recording, [&](RecordedMessage& m) {
    int64_t& t = m.message.header().t_ns;
    t += nanoseconds(d.time_offset_s);
    if (d.stamp_jitter_s <= 0) return;
    int64_t& last = last_ns[sensors_of(m)];
    t += nanoseconds(d.stamp_jitter_s * random.normal());
    if (last != INT64_MIN) t = std::max(t, last + kMin_ns);
    last = t;
  });
  recording.sort();
}

}  // namespace

Recording degraded(const Recording& recording, const Degradation& d, uint64_t seed) {
  Recording r = recording;
  if (d.cut_s > 0) cut(r, d.cut_s);
  if (d.length_s > 0) end_after(r, d.length_s);
  leave_out_frames(r, d);
  if (d.lost_frames > 0) {
    Random random(seed, kLost);
    drop(r, [&](const RecordedMessage& m) { return type_of(m) == ODO_TYPE_FRAME && random.uniform() < d.lost_frames; });
  }
  if (d.gamma != 1 || d.flicker != 0) relight(r, d);
  if (d.imu_rate_hz > 0) decimate(r, d.imu_rate_hz);
  degrade_values(r, d, seed);
  if (d.outliers_per_minute > 0) add_outliers(r, d.outliers_per_minute, seed);
  if (!d.accelerometer) without_accelerometer(r);
  for (RecordedMessage& m : r.messages) {
    const auto longer = [&](int64_t& line_ns) {
      line_ns = std::llround(d.line_time_factor * static_cast<double>(line_ns));
    };
    if (type_of(m) == ODO_TYPE_FRAME) longer(frame_of(m).line_time_ns);
    if (type_of(m) == ODO_TYPE_CALIBRATION) longer(reinterpret_cast<odo_calibration&>(m.message.header()).line_time_ns);
  }
  if (d.time_offset_s != 0 || d.stamp_jitter_s > 0) degrade_times(r, d, seed);
  return r;
}

Result<bool> parse_interval(const std::string& given, const char* option, double& from_s, double& for_s) {
  int end = 0;
  if (given.empty() || (std::sscanf(given.c_str(), "%lf:%lf%n", &from_s, &for_s, &end) == 2 &&
                        given[static_cast<size_t>(end)] == 0 && from_s >= 0 && for_s > 0))
    return true;
  return Failure{ODO_E_ARGUMENT, std::string(option) + " " + given + ": expected FROM:FOR in seconds, such as 10:2"};
}

std::vector<Degradation> sensor_qualities() {
  return {{.name = "as recorded"},
          {.name = "IMU noise x5", .imu_noise_factor = 5},
          {.name = "accel bias 0.3 m/s^2", .accel_bias_mps2 = 0.3},
          {.name = "IMU scale +2 %", .imu_scale_error = 0.02},
          {.name = "IMU 50 Hz", .imu_rate_hz = 50},
          {.name = "IMU 100 Hz", .imu_rate_hz = 100},
          {.name = "no accelerometer", .accelerometer = false},
          {.name = "time offset +20 ms", .time_offset_s = 0.02},
          {.name = "time offset -20 ms", .time_offset_s = -0.02},
          {.name = "line time +20 %", .line_time_factor = 1.2},
          {.name = "stamps jitter 1.4 ms", .stamp_jitter_s = 1.4e-3},
          {.name = "one wild sample a min", .outliers_per_minute = 1},
          {.name = "10 % of frames lost", .lost_frames = 0.1},
          {.name = "gamma 2.2", .gamma = 2.2},
          {.name = "brightness +-50 %", .flicker = 0.5}};
}

std::vector<std::string> names_of(const std::vector<Degradation>& degradations) {
  std::vector<std::string> names;
  for (const Degradation& d : degradations) names.push_back(d.name);
  return names;
}

void shift_gnss(Recording& recording, double from_s, double to_s, double east_m) {
  const int64_t start_ns = recording.true_states.front().t_ns;
  for (RecordedMessage& m : recording.messages) {
    if (m.message.header().type != ODO_TYPE_GNSS) continue;
    auto& gnss = reinterpret_cast<odo_gnss&>(m.message.header());
    const double t = seconds(gnss.header.t_ns - start_ns);
    if (t > from_s && t < to_s) gnss.longitude_rad += east_m / (kEquator_m * std::cos(gnss.latitude_rad));
  }
}

namespace {

Eigen::Vector2d normal2(Random& random, double sigma) {
  const double y = random.normal(), x = random.normal();
  return sigma * Eigen::Vector2d(x, y);
}

}  // namespace

void add_gnss_velocities(Recording& recording, double sigma_mps, uint64_t seed) {
  constexpr size_t kHalf = 100;  // states, at 200 Hz
  const double keep = std::exp(-0.5);
  Random random(seed, 41);
  Eigen::Vector2d error = normal2(random, sigma_mps);
  const auto& truth = recording.true_states;
  size_t at = 0;
  for (RecordedMessage& m : recording.messages) {
    if (m.message.header().type != ODO_TYPE_GNSS) continue;
    auto& gnss = reinterpret_cast<odo_gnss&>(m.message.header());
    while (at + 1 < truth.size() && truth[at].t_ns < gnss.header.t_ns) ++at;
    const auto &from = truth[at > kHalf ? at - kHalf : 0], &to = truth[std::min(truth.size() - 1, at + kHalf)];
    const double dt_s = seconds(to.t_ns - from.t_ns);
    const double kick = sigma_mps * std::sqrt(1 - keep * keep);
    error = keep * error + normal2(random, kick);
    const Eigen::Vector2d velocity = (to.p - from.p).head<2>() / std::max(0.1, dt_s) + error;
    gnss.header.flags |= ODO_GNSS_VELOCITY;
    gnss.velocity_n[0] = velocity.x(), gnss.velocity_n[1] = velocity.y();
  }
}

}  // namespace odograph
