// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <odograph/samples.h>

#include "sdk/host/checks/input_fault.hpp"
#include "sdk/math/ring.hpp"
#include "sdk/math/timed_ring.hpp"

namespace odograph {

/// Row and column sums of a picture's brightness, without their slow part: enough for the shift between two pictures.
class Profiles {
 public:
  static constexpr size_t kMost = 256;
  struct Profile {
    std::array<float, kMost> value{};
    size_t count = 0;
    double pixels = 1;  ///< of one value
  };
  /// False without brightness in memory, or with hardly any contrast.
  bool take(const odo_frame& frame, double min_contrast);
  /// Shift of the content from an earlier picture to this one, pixels of the picture; nothing if they do not resemble
  /// each other.
  std::optional<Eigen::Vector2d> shift_since(const Profiles& earlier, double min_likeness) const;
  bool operator==(const Profiles& other) const { return x_.value == other.x_.value && y_.value == other.y_.value; }

 private:
  Profile x_, y_;
};

/// Checks a camera's mount, orientation and focal length by the gyroscope: while the phone turns, pictures shift
/// by the focal length times the angle. No allocation. Not thread-safe.
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
    double focal_rad2 = 0.02;     ///< rad^2, about both, for the focal length
    double agrees = 0.6;          ///< correlation of shift and rotation; below 0.2 it contradicts; judgement
    double contradicts = 0.2;
    double explains = 0.8;  ///< of another orientation
    /// Of measured over stated focal length: translation adds to the shift, 0.94 to 1.29 on real recordings.
    double focal_low = 0.6, focal_high = 1.6;
    double sure = 0.9;        ///< correlation for a statement about the focal length
    int frozen = 20;          ///< identical pictures in a row
    double frozen_rad = 0.3;  ///< rad turned meanwhile
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
    Eigen::Quaterniond q_e_b = Eigen::Quaterniond::Identity();
  };
  /// Two pictures, the shift from one to the other in focal lengths, and the rotation of the camera, in its axes.
  struct Pair {
    int64_t from_ns = 0, to_ns = 0;
    Eigen::Vector2d shift = Eigen::Vector2d::Zero();
    Eigen::Vector3d turned_c = Eigen::Vector3d::Zero();
  };
  /// Correlation of shift and predicted shift by component, and their ratio.
  struct Fit {
    double x = 0, y = 0, ratio = 1, energy_x = 0, energy_y = 0;
    size_t pairs = 0;
    double worse() const { return std::min(x, y); }
  };

  std::optional<Eigen::Vector3d> rotation_c(int64_t from_ns, int64_t to_ns) const;
  Fit fit(const SignedAxes& axes) const;
  void take_waiting();
  void check_frozen(bool same, int64_t t_ns);
  void check();

  Parameters p_;
  FaultFound found_;
  bool calibrated_ = false;
  double f_px_ = 0;
  Eigen::Quaterniond q_b_c_ = Eigen::Quaterniond::Identity();
  TimedRing<Turned, 1024> turned_;  // 5 s at 200 Hz
  Ring<Pair, 64> pairs_;
  std::optional<Pair> waiting_;  // for the gyroscope to reach it
  std::array<Profiles, 2> profiles_;
  size_t newest_ = 0;
  std::optional<int64_t> picture_ns_;
  size_t pairs_since_ = 0;
  int same_ = 0;
  int64_t same_since_ns_ = 0;
};

}  // namespace odograph
