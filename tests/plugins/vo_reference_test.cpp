// SPDX-License-Identifier: Apache-2.0
#include "sdk/tools/evaluation/reference_poses.hpp"
#include "tests/support/messages.hpp"
#include "tests/support/support.hpp"

using Eigen::Quaterniond;
using Eigen::Vector3d;

TEST_SUITE_BEGIN("vo_reference");

namespace {

constexpr int64_t kReferenceFrame_ns = 50'000'000;

const Quaterniond kMount = Quaterniond(0.2, 0.9, -0.3, 0.1).normalized();  // from c to b
const Vector3d kLever(0.01, -0.02, 0.03);                                  // of c in b

StampedPose body_at(int64_t i) {
  const double s = 0.05 * static_cast<double>(i);
  return {i * kReferenceFrame_ns, Quaterniond(Eigen::AngleAxisd(0.8 * std::sin(s), Vector3d(0.3, 0.2, 1).normalized())),
          Vector3d(s, std::cos(s), 0)};
}

StampedPose camera_at(int64_t i) {
  const StampedPose b = body_at(i);
  return {b.t_ns, b.q * kMount, b.p + b.q * kLever};
}

/// The gyroscope of that body, and a camera with or without its mount.
Recording recording(bool mounted) {
  Recording r;
  auto c = make_message<odo_calibration>(ODO_TYPE_CALIBRATION, 0);
  c.model = ODO_CAMERA_PINHOLE, c.width = 640, c.height = 480, c.fx = c.fy = 500;
  if (mounted) c.header.flags = ODO_CALIBRATION_EXTRINSICS;
  c.q_b_c[0] = kMount.w(), c.q_b_c[1] = kMount.x(), c.q_b_c[2] = kMount.y(), c.q_b_c[3] = kMount.z();
  Vector3d::Map(c.p_b_c) = kLever;
  r.add(c.header);
  for (int64_t i = 0; i < 200; ++i) {
    const Eigen::AngleAxisd turned(body_at(i).q.conjugate() * body_at(i + 1).q);
    r.add(imu_at(i * kReferenceFrame_ns + kReferenceFrame_ns / 2, turned.angle() / 0.05 * turned.axis(), {0, 0, 0},
                 ODO_IMU_GYRO)
              .header);
  }
  return r;
}

template <class Pose>
std::filesystem::path written(const TemporaryFolder& folder, Pose pose) {
  StampedPoses poses;
  for (int64_t i = 0; i < 200; ++i) poses.push_back(pose(i));
  const auto file = folder / "reference.tum";
  REQUIRE(write_trajectory(file, poses, nullptr));
  return file;
}

}  // namespace

TEST_CASE("body poses are converted to the camera's with the lever arm, and the camera's are kept") {
  const TemporaryFolder folder;
  for (const bool body : {true, false}) {
    const auto file = body ? written(folder, body_at) : written(folder, camera_at);
    const auto poses = required(read_reference(file, body ? "body" : "camera", recording(true)));
    for (int64_t i = 0; i < 200; ++i) {
      CHECK(((*poses)[static_cast<size_t>(i)].p - camera_at(i).p).norm() < 1e-6);
      CHECK((*poses)[static_cast<size_t>(i)].q.angularDistance(camera_at(i).q) < 1e-5);
    }
  }
}

TEST_CASE("poses that rotate like the other frame are rejected, with the correct option") {
  const TemporaryFolder folder;
  const auto camera = read_reference(written(folder, camera_at), "body", recording(true));
  REQUIRE_FALSE(camera);
  CHECK(camera.failure().status == ODO_E_ARGUMENT);
  CHECK(contains(camera.failure().text, "--reference-frame camera"));
  const auto body = read_reference(written(folder, body_at), "camera", recording(true));
  REQUIRE_FALSE(body);
  CHECK(contains(body.failure().text, "--reference-frame body"));
}

TEST_CASE("body poses need the camera's mount") {
  const TemporaryFolder folder;
  CHECK_FALSE(read_reference(written(folder, body_at), "body", recording(false)));
  CHECK(read_reference(written(folder, camera_at), "camera", recording(false)));
}
