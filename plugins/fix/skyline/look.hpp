// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Geometry>
#include <opencv2/core.hpp>

#include "plugins/fix/skyline/matcher.hpp"
#include "plugins/fix/skyline/sky_network.hpp"
#include "plugins/shared/camera/camera_model.hpp"

namespace odograph::skyline {

struct Picture {
  int64_t t_ns = 0;
  cv::Mat grey, mask;
  Chroma chroma;
  CameraModel lens;
};

/// A picture that is being worked on: the worker reads the first part and writes the second, and whoever gave it the
/// picture the third.
struct Look {
  Picture picture;
  Eigen::Vector3d p_n = Eigen::Vector3d::Zero();              ///< of the camera, as the odometry has it
  Eigen::Quaterniond q_n_c = Eigen::Quaterniond::Identity();  ///< the same; the prior's may be another
  double path_m = 0;                                          ///< gone until then
  Prior prior{};
  bool anywhere = false;    ///< the place is looked for in all of the database
  bool may_join = false;    ///< a picture that sees too little alone is matched together with
  std::vector<View> older;  ///< these

  bool sky_seen = false;
  std::optional<View> view;  ///< this picture, where it must be joined
  std::optional<Match> match;

  Eigen::Quaterniond corrected_q = Eigen::Quaterniond::Identity();  ///< corrections of n since it began: what was at x
  Eigen::Vector3d corrected_p = Eigen::Vector3d::Zero();            ///< is at q x + p

  void correct(const Eigen::Quaterniond& q, const Eigen::Vector3d& p) {
    corrected_q = (q * corrected_q).normalized();
    corrected_p = q * corrected_p + p;
  }
  Eigen::Vector3d corrected(const Eigen::Vector3d& x_n) const { return corrected_q * x_n + corrected_p; }
  Eigen::Quaterniond corrected(const Eigen::Quaterniond& q) const { return (corrected_q * q).normalized(); }
  /// The match carried on to where the odometry has the camera by now: it errs by `drift` of the path since.
  Match carried_to(const Eigen::Vector3d& now_n, const Eigen::Quaterniond& q_n_c_now, double drift) const;
};

}  // namespace odograph::skyline
