// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "sdk/host/fusion/pose_filter.hpp"

namespace odograph {

/// Compares the attitude source's heading with the track's. Without north it is an integrated gyroscope heading, and
/// only estimated, so that steps can continue with it when the camera stops. With a compass, its error is a
/// Gauss-Markov process, and it corrects the track too.
class Heading {
 public:
  struct Parameters {
    double interval_s = 1.0;  ///< s between the attitudes used: closer ones have correlated errors
    double yaw_rad = 0.02;    ///< rad, of one attitude
    /// rad/sqrt(s), of a heading without north: a residual bias of 0.02 deg/s is 0.1 rad in five minutes. With 2e-4
    /// simulated walks with pockets were off by ten sigmas (docs/estimator.md).
    double walk = 3e-3;
    /// s, correlation time of the compass error: 20 to 60 s in streets (bench canyon).
    double north_correlation_s = 60;
    double gap_rotation = 0.7;  ///< rad/sqrt(s), of its frame in a gap: a hand rotates by 30 deg/s rms
  };

  /// `mean_rad`: expected heading of the attitude source's frame in n.
  void reset(double mean_rad) { *this = {}, mean_rad_ = mean_rad; }
  /// Initialises both headings; at the start, o has the attitude source's axes.
  void start(PoseFilter& filter) const;
  const Parameters& parameters() const { return p_; }
  /// Notes the arrival of an attitude. After a gap, the source's frame may have rotated.
  void on_attitude(PoseFilter& filter, const odo_attitude& attitude);
  bool has_attitude() const { return attitude_.has_value(); }
  bool north() const { return north_; }

  /// Propagates by dt. `with_attitude`: o rotates with the attitude source. Returns the heading drift, rad^2.
  double propagate(PoseFilter& filter, double dt_s, bool with_attitude) const;
  /// Whether an attitude of this time is independent enough to be used.
  bool due(int64_t t_ns) const;
  /// `q_o_a`: the attitude source's frame in o, from the two orientations of the body.
  UpdateResult use(PoseFilter& filter, int64_t t_ns, const Eigen::Quaterniond& q_o_a);
  /// From now on o rotates with the attitude source: both headings share one error.
  void join(PoseFilter& filter, const Eigen::Quaterniond& q_o_a) const;

 private:
  Innovation difference(const PoseFilter& filter, const Eigen::Quaterniond& q_o_a, double sigma_rad) const;

  Parameters p_;
  double mean_rad_ = 0, north_sigma_rad_ = 0;
  bool north_ = false;
  Instant attitude_, used_;  // the newest, and the newest that was used
};

}  // namespace odograph
