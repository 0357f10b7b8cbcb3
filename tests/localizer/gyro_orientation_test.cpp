// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include "sdk/host/messages/messages.hpp"
#include "tests/localizer/paper_track.hpp"

using namespace odograph;

TEST_SUITE_BEGIN("coupling");

TEST_CASE("a front-end with inertia makes the gyroscope's bias observable in motion, a camera alone does not") {
  constexpr double bias_radps = 0.0054;  // 0.3 degrees/s
  for (const bool inertial : {false, true}) {
    CAPTURE(inertial);
    PaperTrack coupling({.orientation = Orientation::gyroscope}, {}, {.vo = true, .scale = false});
    auto attitude = make_message<odo_attitude>(ODO_TYPE_ATTITUDE, 0);
    attitude.q_n_b[0] = 1;
    coupling.on_attitude(attitude);
    coupling.on_first_frame(0);
    odo_pose pose{};
    int64_t t_ns = 0;
    const auto imu = [&] {
      auto sample = make_message<odo_imu>(ODO_TYPE_IMU, t_ns);
      sample.header.flags = ODO_IMU_GYRO | ODO_IMU_ACCEL;
      sample.gyro_b[2] = bias_radps, sample.accel_b[2] = -9.81;
      coupling.on_imu(sample);
    };
    imu();
    for (int frame = 0; frame < 300; ++frame) {  // 30 s straight ahead
      const int64_t from_ns = t_ns;
      for (int k = 0; k < 20; ++k) t_ns += 5'000'000, imu();
      auto m = make_message<odo_vo_motion>(ODO_TYPE_VO_MOTION, t_ns);
      m.header.flags = ODO_VO_ROTATION | ODO_VO_TRANSLATION;
      m.t_from_ns = from_ns, m.state = ODO_TRACKING;
      m.q_c0_c1[0] = 1, m.p_c0_c1[0] = 0.3;
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

TEST_SUITE_END();
