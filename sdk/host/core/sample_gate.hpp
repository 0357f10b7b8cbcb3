// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include <odograph/types.h>

namespace odograph {

/// Rejects values that a sensor cannot have measured: values outside its range, and isolated spikes in the inertial
/// samples. An inertial sample that jumps from the previous one waits for the next one, which distinguishes a spike
/// (dropped) from a shock (both are passed on). No allocation. Not thread-safe.
class SampleGate {
 public:
  /// Widest ranges of phone sensors plus 15 % for scale and bias errors; spike thresholds are judgement.
  struct Parameters {
    double gyro_range_radps = 40;       ///< +-2000 deg/s (Bosch BMI270, TDK ICM-42688 data sheets)
    double accel_range_mps2 = 180;      ///< +-16 g (the same)
    double field_range_t = 5.6e-3;      ///< +-4912 uT (AKM AK09918 data sheet)
    double pressure_low_pa = 25'000;    ///< 300 hPa (Bosch BMP390 data sheet)
    double pressure_high_pa = 145'000;  ///< 1250 hPa (the same)
    double gyro_spike_radps = 12;       ///< a hand's 500 rad/s^2 over 20 ms, with a margin
    double accel_spike_mps2 = 80;       ///< twice the shock of a heel strike at the hand
    int64_t neighbour_ns = 50'000'000;  ///< samples further apart are not neighbours
  };

  SampleGate() = default;
  explicit SampleGate(const Parameters& parameters) : parameters_(parameters) {}

  /// A value outside the range of any phone's sensor, with the unit that it may be in; empty if there is none. Other
  /// message types always pass.
  std::string range_fault(const odo_header& sample) const;
  bool within_range(const odo_header& sample) const { return range_fault(sample).empty(); }

  /// Checks an inertial sample that is within range. Calls `take(const odo_imu&)` for each sample to pass on, in order
  /// of arrival: none (held), the sample, or the held one and the sample. Returns the number of spikes dropped, 0 or 1.
  template <class Take>
  int push(const odo_imu& sample, Take&& take) {
    Track& track = tracks_[sample.header.flags & (ODO_IMU_GYRO | ODO_IMU_ACCEL)];
    if (track.holding) {
      track.holding = false;
      const bool spike = differs(track.held, sample) && !differs(track.last, sample);
      if (!spike) take(track.held);
      take(sample);
      track.last = sample;
      return spike ? 1 : 0;
    }
    if (track.begun && differs(track.last, sample)) {
      track.held = sample;
      track.holding = true;
      return 0;
    }
    take(sample);
    track.last = sample;
    track.begun = true;
    return 0;
  }
  /// Discards all samples, after the sensor clock was set back.
  void reset() { tracks_ = {}; }

 private:
  struct Track {
    bool begun = false, holding = false;
    odo_imu last{}, held{};
  };

  /// Whether two samples are neighbours but differ by more than the spike threshold.
  bool differs(const odo_imu& a, const odo_imu& b) const;

  Parameters parameters_;
  std::array<Track, 4> tracks_{};  // by flags: neither, gyroscope, accelerometer, both
};

}  // namespace odograph
