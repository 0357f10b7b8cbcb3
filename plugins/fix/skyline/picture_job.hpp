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
#include "plugins/fix/skyline/photograph_matcher.hpp"

namespace odograph::skyline {

struct Picture {
  int64_t t_ns = 0;
  cv::Mat grey, mask;
  Chroma chroma;
  CameraModel lens;
};

/// A picture in processing: the worker reads the first group and writes the second; the caller writes the third.
struct PictureJob {
  Picture picture;
  Eigen::Vector3d p_n = Eigen::Vector3d::Zero();              ///< of the camera, by the odometry
  Eigen::Quaterniond q_n_c = Eigen::Quaterniond::Identity();  ///< the same; the prior may differ
  double path_m = 0;                                          ///< length of the path so far
  Prior prior{};
  bool global_search = false;  ///< the place is searched in all of the database
  bool may_join = false;       ///< a picture that sees too little is matched jointly with `older`
  std::vector<View> older;
  std::optional<PhotographPrior> survey;  ///< where no match succeeds, one with errors of the roofs is tried

  bool sky_seen = false;
  std::optional<View> view;  ///< this picture, where it must be matched jointly
  std::optional<Match> match, surveyed;

  Eigen::Quaterniond corrected_q = Eigen::Quaterniond::Identity();  ///< corrections of n since the start move x
  Eigen::Vector3d corrected_p = Eigen::Vector3d::Zero();            ///< to q x + p

  void correct(const Eigen::Quaterniond& q, const Eigen::Vector3d& p) {
    corrected_q = (q * corrected_q).normalized();
    corrected_p = q * corrected_p + p;
  }
  Eigen::Vector3d corrected(const Eigen::Vector3d& x_n) const { return corrected_q * x_n + corrected_p; }
  Eigen::Quaterniond corrected(const Eigen::Quaterniond& q) const { return (corrected_q * q).normalized(); }
  /// The match propagated by the odometry to the present pose; the odometry's error is `drift` times the path since.
  Match propagated_to(const Eigen::Vector3d& now_n, const Eigen::Quaterniond& q_n_c_now, double drift) const;
};

}  // namespace odograph::skyline
