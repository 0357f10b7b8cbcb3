// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "plugins/fix/map/place_types.hpp"

namespace odograph::place_map {

struct AgreementParameters {
  double gate = 22.5;      ///< squared Mahalanobis distance: 99.9 % of six degrees of freedom
  double apart_s = 0.5;    ///< recognitions are independent if they are this far apart in time,
  double apart_m = 0.2;    ///< in place,
  double apart_rad = 0.2;  ///< or in direction
  double drift = 0.02;     ///< of the map between two key frames, relative to their distance
  double drift_rad_per_m = 0.003;
  double longest_m = 1;      ///< difference that never agrees, whatever the covariances,
  double largest_rad = 0.2;  ///< nor this one
};

enum class Agreement {
  no,         ///< at least one is wrong, or the motion is
  not_apart,  ///< the pictures are so near each other that an error would be common to them
  yes
};

/// Whether two recognitions fit the motion between their pictures. `T_m_ka`, `T_m_kb`: of their key frames; `T_ca_cb`:
/// from the second camera to the first, by odometry; `covariance`: of (rotation in ca, position in ca). The result is
/// the same for small errors with the recognitions exchanged.
Agreement agree(const Recognition& a, const Rigid& T_m_ka, const Recognition& b, const Rigid& T_m_kb,
                const Rigid& T_ca_cb, const Eigen::Matrix<double, 6, 6>& covariance,
                const AgreementParameters& parameters = {});

}  // namespace odograph::place_map
