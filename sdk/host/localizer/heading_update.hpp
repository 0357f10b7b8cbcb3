// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "sdk/host/localizer/localizer.hpp"

namespace odograph {

/// The attitude source's heading against the track's. Without north it is a gyroscope's, and only learnt, so that steps
/// go on with it where the camera ends; with a compass it errs by a Gauss-Markov process and turns the track too.
class HeadingUpdate {
 public:
  struct Parameters {
    double interval_s = 1.0;          ///< s between attitudes that are used: nearer ones have the same error
    double yaw_rad = 0.02;            ///< rad of one
    double walk = 2e-4;               ///< rad/sqrt(s) of a heading without north
    double north_correlation_s = 60;  ///< s for which a compass errs alike: 20 to 60 s in streets (bench canyon)
    double gap_s = 0.25;              ///< s without an attitude, after which its frame may have turned; by hand
    double gap_rotation = 0.7;        ///< rad/sqrt(s) by which: a hand turns by 30 deg/s rms
  };

  /// `mean_rad`: the attitude source's heading against n as it is expected.
  void reset(double mean_rad) { *this = {}, mean_rad_ = mean_rad; }
  /// Both headings at the start, where o has the attitude source's axes.
  void start(Localizer& localizer) const;
  const Parameters& parameters() const { return p_; }
  /// An attitude has come. Over a gap the source's frame may have turned.
  void note(Localizer& localizer, const odo_attitude& attitude);
  bool noted() const { return noted_ns_ != INT64_MIN; }
  bool north() const { return north_; }

  /// Time goes on by dt. `carried`: o turns with the attitude source. Returns what the heading has drifted by, rad^2.
  double go_on(Localizer& localizer, double dt_s, bool carried) const;
  /// Whether an attitude of this time says anything new.
  bool due(int64_t t_ns) const;
  /// `q_o_a`: the attitude source's frame against o, as both have the body.
  UpdateResult use(Localizer& localizer, int64_t t_ns, const Eigen::Quaterniond& q_o_a);
  /// From now on o turns with the attitude source: both headings err alike.
  void join(Localizer& localizer, const Eigen::Quaterniond& q_o_a) const;

 private:
  Innovation<1> difference(const Localizer& localizer, const Eigen::Quaterniond& q_o_a, double sigma_rad) const;

  Parameters p_;
  double mean_rad_ = 0, north_sigma_rad_ = 0;
  bool north_ = false;
  int64_t noted_ns_ = INT64_MIN, used_ns_ = INT64_MIN;
};

}  // namespace odograph
