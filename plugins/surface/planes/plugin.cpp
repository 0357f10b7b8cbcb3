// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <vector>

#include <odograph/plugin.hpp>

#include "plugins/surface/planes/plane_finder.hpp"
#include "sdk/math/frame_landmarks.hpp"
#include "sdk/math/rotation.hpp"

namespace {

using namespace odograph::planes;
using Eigen::Quaterniond;
using Eigen::Vector3d;

class Planes {
 public:
  double reach = PlaneFinder::Parameters().reach_m, interval = PlaneFinder::Parameters().interval_s;

  static constexpr odo::Description description{"surface/planes", "1.0.0",
                                                "Floor, tables and walls: horizontal and vertical planes of landmarks",
                                                ODO_INTERFACE_SURFACE_FINDER};
  static std::vector<odo::Parameter<Planes>> parameters() {
    return {odo::real("reach", "m", 1, 100, &Planes::reach, "landmarks farther away than this are not used"),
            odo::real("interval", "s", 0.05, 10, &Planes::interval, "between two searches")};
  }
  void configured() {
    PlaneFinder::Parameters parameters;
    parameters.reach_m = reach, parameters.interval_s = interval;
    finder_ = PlaneFinder(parameters);
  }

  /// They wait for the pose of their frame.
  void on(const odo_points& points, odo::Output&) { frame_.hold(points); }

  void on(const odo_correction& correction, odo::Output&) {
    const Quaterniond q = odograph::quaternion(correction.q_n);
    p_n_m_ = q * p_n_m_ + Vector3d(correction.p_n);
    q_n_m_ = (q * q_n_m_).normalized();
  }

  void on(const odo_pose& pose, odo::Output& output) {
    const Vector3d phone = q_n_m_.conjugate() * (Vector3d(pose.p_n) - p_n_m_);
    const Quaterniond q_m_c = q_n_m_.conjugate() * odograph::quaternion(pose.q_n);
    const auto add = [&](const odograph::MapPoint& point) { finder_.add(point); };
    if (!frame_.place(pose, q_m_c, phone, add)) return;
    const double scale_sigma = odograph::FrameLandmarks::scale_sigma(pose);
    for (const Change& change : finder_.search(pose.header.t_ns, phone, scale_sigma))
      emit(pose.header.t_ns, change, output);
  }

 private:
  void emit(int64_t t_ns, const Change& change, odo::Output& output) {
    const Plane& plane = change.plane;
    writer_.begin(t_ns, plane.id);
    odo_surface& surface = writer_.message();
    surface.kind = plane.kind == Kind::floor        ? ODO_SURFACE_FLOOR
                   : plane.kind == Kind::horizontal ? ODO_SURFACE_HORIZONTAL
                                                    : ODO_SURFACE_VERTICAL;
    odograph::put_quaternion((q_n_m_ * plane.q_m_s).normalized(), surface.q_n);
    Vector3d::Map(surface.p_n) = q_n_m_ * plane.p_m + p_n_m_;
    surface.sigma_m = plane.sigma_m, surface.tilt_sigma_rad = plane.tilt_sigma_rad;
    if (change.what == Change::What::present)
      for (const Eigen::Vector2d& vertex : plane.outline)
        writer_.add(static_cast<float>(vertex.x()), static_cast<float>(vertex.y()));
    else
      surface.state = change.what == Change::What::merged ? ODO_SURFACE_MERGED : ODO_SURFACE_WITHDRAWN;
    surface.merged_into = change.into;
    output.emit(writer_);
  }

  PlaneFinder finder_;
  Quaterniond q_n_m_ = Quaterniond::Identity();  // from m to n: what corrections have moved so far
  Vector3d p_n_m_ = Vector3d::Zero();
  odograph::FrameLandmarks frame_;
  odo::SurfaceWriter writer_;
};

}  // namespace

ODO_PLUGIN(Planes)
