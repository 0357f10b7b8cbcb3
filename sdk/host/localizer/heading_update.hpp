// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "sdk/host/localizer/localizer.hpp"
#include "sdk/host/localizer/parameters.hpp"

namespace odograph {

/// The attitude source's heading against the track's. Without north it is a gyroscope's, and only learnt, so that steps
/// go on with it where the camera ends; with a compass it errs by a Gauss-Markov process and turns the track too.
class HeadingUpdate {
 public:
  explicit HeadingUpdate(const LocalizerParameters& parameters) : p_(parameters) {}
  void reset() { *this = HeadingUpdate(p_); }

  /// Of the attitude source's frame against n, as it is expected, rad.
  void set_mean(double rad) { mean_rad_ = rad; }
  double mean() const { return mean_rad_; }
  /// An attitude has come. Over a gap the source's frame may have turned.
  void note(Localizer& localizer, const odo_attitude& attitude);
  bool noted() const { return noted_ns_ != INT64_MIN; }
  bool north() const { return north_; }
  double north_sigma() const { return north_sigma_rad_; }

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

  LocalizerParameters p_;
  double mean_rad_ = 0, north_sigma_rad_ = 0;
  bool north_ = false;
  int64_t noted_ns_ = INT64_MIN, used_ns_ = INT64_MIN;
};

}  // namespace odograph
