// SPDX-License-Identifier: Apache-2.0
//
// The scenes of `odograph bench known-object`: what hangs on a wall, a camera before it, the plugin that looks.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <opencv2/core.hpp>

#include "sdk/host/base/temporary_folder.hpp"
#include "sdk/host/messages/messages.hpp"
#include "sdk/host/plugin_host/instance.hpp"
#include "sdk/tools/simulation/random.hpp"

namespace odograph::known_object_scene {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kPi = 3.14159265358979323846, kDegree = kPi / 180;

struct Target {
  std::string id;
  double width_m, height_m;
  int tag;
};
inline const Target kTargets[] = {{"board", 3.2, 2.4, -1}, {"poster", 1.2, 1.8, -1}, {"tag", 0.8, 0.8, 7}};

/// All targets hang with their middle in the same place of a wall that one reads looking north.
inline const Vector3d kMiddle(0, 0, -1.7);
inline Matrix3d wall_axes() {
  Matrix3d R_n_o;
  R_n_o << 0, 0, 1, 1, 0, 0, 0, 1, 0;  // right is east, down is down, into the wall is north
  return R_n_o;
}

/// One of three lenses, by the number of the scene.
odo_calibration lens_of(uint64_t number);

/// The plugin by itself, with an objects' file of its own.
class Fixer {
 public:
  static Result<std::unique_ptr<Fixer>> make(const std::vector<Target>& targets, uint64_t seed);

  /// The picture of a target; of a tag its black border and what is in it.
  static cv::Mat picture_of(const Target& t, uint64_t layout, uint64_t content);

  void begin(const odo_calibration& lens) {
    instance_->reset();
    instance_->process(lens.header);
  }
  std::vector<odo_fix> see(const odo_pose& prior, const cv::Mat& grey, int64_t line_time_ns);
  uint64_t faults() const { return instance_->faults(); }

 private:
  Fixer() = default;
  void take(const odo_header& message, std::vector<odo_fix>& fixes) {
    for (const AnyMessage& event : instance_->process(message))
      if (event.header().type == ODO_TYPE_FIX) fixes.push_back(as<odo_fix>(event.header()));
  }
  TemporaryFolder folder_;
  std::unique_ptr<HostServices> host_;
  std::unique_ptr<PluginInstance> instance_;
};

/// Where the camera is and looks, and how it moves.
struct Viewpoint {
  Vector3d p_n, velocity_n = Vector3d::Zero(), rate_c = Vector3d::Zero();
  Matrix3d R_n_c;
  Viewpoint after(double s) const {
    Viewpoint v = *this;
    v.p_n += s * velocity_n;
    const double angle = s * rate_c.norm();
    if (angle > 1e-12) v.R_n_c = R_n_c * Eigen::AngleAxisd(angle, rate_c.normalized()).toRotationMatrix();
    return v;
  }
  Eigen::Isometry3d to(const Vector3d& o_n) const {
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.linear() = R_n_c.transpose() * wall_axes();
    T.translation() = R_n_c.transpose() * (o_n - p_n);
    return T;
  }
};

Viewpoint viewpoint(Random& random, double distance_m, double oblique_rad, bool walking);

/// What hangs in a scene, in n, with its own side to the south.
struct Hung {
  cv::Mat grey;
  double width_m, height_m;
  Vector3d at_n;
};

/// One scene through the plugin: all fixes with the truth at their time.
struct Told {
  odo_fix fix;
  Viewpoint truth;
};
std::vector<Told> play(Fixer& fixer, const std::vector<Hung>& hung, const Viewpoint& start, int frames, uint64_t scene,
                       Random& random, double position_sigma_m, const std::string& keep);

}  // namespace odograph::known_object_scene
