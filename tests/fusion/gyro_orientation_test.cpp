// SPDX-License-Identifier: Apache-2.0
#include "sdk/host/messages/messages.hpp"
#include "tests/fusion/paper_track.hpp"
#include "tests/support/messages.hpp"
#include "tests/support/support.hpp"

TEST_SUITE_BEGIN("coupling");

TEST_CASE("a front-end with inertia makes the gyroscope's bias observable in motion, a camera alone does not") {
  constexpr double bias_radps = 0.0054;  // 0.3 degrees/s
  for (const bool inertial : {false, true}) {
    CAPTURE(inertial);
    PaperTrack coupling({.orientation = Orientation::gyroscope}, {}, {.vo = true, .scale = false});
    coupling.on_attitude(attitude_at(0));
    coupling.on_first_frame(0);
    odo_pose pose{};
    int64_t t_ns = 0;
    const auto imu = [&] { coupling.on_imu(imu_at(t_ns, {0, 0, bias_radps}, {0, 0, -9.81})); };
    imu();
    for (int frame = 0; frame < 300; ++frame) {  // 30 s straight ahead
      const int64_t from_ns = t_ns;
      for (int k = 0; k < 20; ++k) t_ns += 5'000'000, imu();
      auto m = motion_between(from_ns, t_ns, {0.3, 0, 0});
      if (inertial) m.header.flags |= ODO_VO_METRIC | ODO_VO_INERTIAL, m.scale_sigma = 0.01;
      pose = coupling.on_vo_motion(m, nullptr);
    }
    const Eigen::Quaterniond camera(0, 1, 0, 0);  // its default mount
    const double off_rad =
        Eigen::Quaterniond(pose.q_n[0], pose.q_n[1], pose.q_n[2], pose.q_n[3]).angularDistance(camera);
    CHECK(off_rad < (inertial ? 0.01 : 1.01 * 30 * bias_radps));
    if (!inertial) CHECK(off_rad > 0.9 * 30 * bias_radps);
  }
}
