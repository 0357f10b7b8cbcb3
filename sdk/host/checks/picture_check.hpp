// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <odograph/samples.h>

#include "sdk/host/checks/input_fault.hpp"
#include "sdk/host/checks/profiles.hpp"
#include "sdk/host/checks/row_shift.hpp"
#include "sdk/host/checks/still_edges.hpp"
#include "sdk/math/ring.hpp"
#include "sdk/math/timed_ring.hpp"

namespace odograph {

/// Checks a camera's mount, orientation, focal length and clock by the gyroscope: while the phone turns, pictures shift
/// by the focal length times the angle; what is drawn over them stays; none is the one before. No allocation. Not
/// thread-safe.
class PictureCheck {
 public:
  struct Parameters {
    double interval_s = 0.06;     ///< s between pictures that are compared
    double max_gap_s = 0.3;       ///< s between them at most
    double min_contrast = 1;      ///< grey levels rms of the profiles: no dark pocket, no white wall; judgement
    double min_likeness = 0.8;    ///< correlation of the profiles; judgement
    size_t min_pairs = 15;        ///< a second of motion
    double turned_rad2 = 0.0015;  ///< rad^2, sum of the squared angles about each axis of the picture: 20 pictures that
                                  ///< each turned by half a degree
    double agrees = 0.6;          ///< correlation of shift and rotation; below 0.2 it contradicts; judgement
    double contradicts = 0.2;
    double explains = 0.8;  ///< for a statement about orientation, clock or focal length
    /// Of measured over stated focal length along both axes of the picture: translation adds to the shift along one or
    /// both (held by an arm), or takes from that along one (around an object). In real and simulated recordings the
    /// larger is at least 1.00, the smaller at most 1.25.
    double focal_low = 0.95, focal_high = 1.3;
    double off_middle = 0.3;             ///< of the principal point, share of the picture's size; 0.05 in the lenses of
                                         ///< the recordings that the tests use, 0.5 if it is not filled
    double sigmas = 3;                   ///< of the ratio, by which it must be beyond
    int64_t other_time_ns = 90'000'000;  ///< the best lag; 0.06 s at most in real and simulated recordings
    double halved = 0.5;                 ///< share of the contradiction that this lag leaves at most; judgement
    double overlay = 0.005;              ///< share of the picture's edges that stay still; real pictures have none
    double repeated = 0.3;               ///< share of pictures that are identical to the one before; honest 0 ...
    int of_pictures = 20;                ///< ... of so many, between each two of which the camera turned by ...
    double turned_rad = 0.005;           ///< ... rad: some pixels
    int varied = 32;                     ///< of 256 samples, that differ from their mean by ...
    int varied_by = 8;                   ///< ... grey levels: no night with a lamp
  };

  explicit PictureCheck(FaultFound found) : found_(std::move(found)) {}
  void add(const odo_calibration& calibration);
  /// A sample with a gyroscope, in time order with the frames.
  void add(const odo_imu& imu);
  void add(const odo_frame& frame);
  void reset();

 private:
  struct Turned {
    int64_t t_ns = 0;
    Eigen::Vector3d turned_b = Eigen::Vector3d::Zero();  // integral of the rate; small differences are rotations
  };
  /// What the clocks may differ by in a fit, from the first to the last, the middle being none.
  static constexpr size_t kLags = 31, kNoLag = kLags / 2;
  static constexpr int64_t kLag_ns = 20'000'000;
  /// Two pictures, the shift from one to the other in focal lengths, and the rotation of the camera in its axes, if its
  /// clock was behind the IMU's by each lag.
  struct Pair {
    int64_t from_ns = 0, to_ns = 0;
    Eigen::Vector2d shift = Eigen::Vector2d::Zero();
    std::array<Eigen::Vector3d, kLags> turned_c{};
    bool known = false;
  };
  /// Shift and expected shift along an axis of the picture.
  struct Component {
    double product = 0, power = 0, energy = 0;  // of both, of the shift, of what is expected
    size_t pairs = 0;
    void add(double shift, double expected);
    double correlation() const { return power * energy > 0 ? product / std::sqrt(power * energy) : 0; }
    double ratio() const { return energy > 0 ? product / energy : 1; }
    /// Of a regression through zero: what the correlation leaves, over the number of pairs.
    double relative_sigma() const {
      const double r2 = correlation() * correlation();
      return r2 > 0 ? std::sqrt((1 / r2 - 1) / static_cast<double>(pairs)) : 1;
    }
  };
  struct Fit {
    Component x, y;
    double worse() const { return std::min(x.correlation(), y.correlation()); }
  };

  std::optional<Eigen::Vector3d> rotation_c(int64_t from_ns, int64_t to_ns) const;
  Fit fit(const SignedAxes& axes, size_t lag = kNoLag) const;
  void complete_pairs();
  void check_repeated(const odo_frame& frame);
  void check();

  Parameters p_;
  FaultFound found_;
  bool calibrated_ = false;
  double f_px_ = 0;
  Eigen::Quaterniond q_b_c_ = Eigen::Quaterniond::Identity();
  TimedRing<Turned, 1024> turned_;  // 5 s at 200 Hz
  Ring<Pair, 64> pairs_;
  size_t open_ = 0;  // of the newest pairs, that wait for the gyroscope to reach them
  StillEdges still_;
  std::array<Profiles, 2> profiles_;
  size_t newest_ = 0;
  std::optional<int64_t> picture_ns_;
  size_t pairs_since_ = 0;
  RowShift rows_;
  std::array<uint8_t, 256> sparse_{};  // of the newest picture
  Eigen::Vector3d sparse_turned_b_ = Eigen::Vector3d::Zero();
  int pictures_ = 0, same_ = 0;  // that turned, since the last statement
};

}  // namespace odograph
