// SPDX-License-Identifier: Apache-2.0
// A surface finder by script: two floors, 1 m and 3 m north of the first pose and a metre below it; after 20 poses the
// first is 0.1 m lower, after 40 the second is part of it, after 60 it is withdrawn.
#include <odograph/plugin.hpp>

class ScriptedSurfaces {
 public:
  static constexpr odo::Description description{"test/scripted_surfaces", "1.0.0", "For a test.",
                                                ODO_INTERFACE_SURFACE_FINDER};
  static std::vector<odo::Parameter<ScriptedSurfaces>> parameters() { return {}; }

  void on(const odo_pose& pose, odo::Output& output) {
    if ((pose.header.flags & ODO_POSE_POSITION) == 0) return;
    if (count_ == 0)
      for (int k = 0; k < 3; ++k) first_n_[k] = pose.p_n[k];
    switch (count_++) {
      case 0:
        emit(pose, 11, 1, 1.0, ODO_SURFACE_PRESENT, 0, output), emit(pose, 12, 3, 1.0, ODO_SURFACE_PRESENT, 0, output);
        break;
      case 20: emit(pose, 11, 1, 1.1, ODO_SURFACE_PRESENT, 0, output); break;
      case 40: emit(pose, 12, 3, 1.0, ODO_SURFACE_MERGED, 11, output); break;
      case 60: emit(pose, 11, 1, 1.1, ODO_SURFACE_WITHDRAWN, 0, output); break;
      default: break;
    }
  }

 private:
  void emit(const odo_pose& pose, uint64_t id, double north_m, double below_m, uint32_t state, uint64_t into,
            odo::Output& output) {
    writer_.begin(pose.header.t_ns, id);
    odo_surface& surface = writer_.message();
    surface.kind = ODO_SURFACE_FLOOR, surface.state = state, surface.merged_into = into;
    surface.q_n[1] = 1;  // z upwards
    surface.p_n[0] = first_n_[0] + north_m, surface.p_n[1] = first_n_[1], surface.p_n[2] = first_n_[2] + below_m;
    surface.sigma_m = 0.02, surface.tilt_sigma_rad = 0.01;
    if (state == ODO_SURFACE_PRESENT)
      for (const auto& corner : {std::pair(-0.5f, -0.5f), {0.5f, -0.5f}, {0.5f, 0.5f}, {-0.5f, 0.5f}})
        writer_.add(corner.first, corner.second);
    output.emit(writer_);
  }

  odo::SurfaceWriter writer_;
  int count_ = 0;
  double first_n_[3] = {};
};

ODO_PLUGIN(ScriptedSurfaces)
