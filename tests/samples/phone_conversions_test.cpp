// SPDX-License-Identifier: Apache-2.0
//
// The conversions of samples/android and samples/ios, against the platforms' definitions.
#include "samples/android/app/src/main/cpp/conversions.hpp"
#include "samples/ios/Sources/OdographPhone/conversions.h"
#include "tests/support/support.hpp"

#include <random>

#include <Eigen/Geometry>
#include <opencv2/calib3d.hpp>

namespace {

Eigen::Quaterniond quaternion(const double* q) { return {q[0], q[1], q[2], q[3]}; }

phone::CameraFacts array_4_by_3() {
  phone::CameraFacts camera;
  camera.array_width = 4000;
  camera.array_height = 3000;
  camera.has_intrinsics = true;
  const float ideal[5] = {3100, 3100, 2000, 1500, 0};
  std::copy(ideal, ideal + 5, camera.intrinsics);
  return camera;
}

TEST_SUITE_BEGIN("phone_conversions");

TEST_CASE("a lens in the middle of Android's array is in the middle of the picture's pixels") {
  const phone::CameraFacts camera = array_4_by_3();
  for (const auto& [width, height] : {std::pair{640, 480}, {1280, 720}, {480, 480}}) {
    const odo_calibration lens = phone::calibration_of(camera, 0, width, height);
    CHECK(lens.cx == doctest::Approx((width - 1) / 2.0));
    CHECK(lens.cy == doctest::Approx((height - 1) / 2.0));
  }
  CHECK(phone::calibration_of(camera, 0, 1280, 720).fx == doctest::Approx(3100 * 0.32));
  CHECK(phone::calibration_of(camera, 0, 480, 480).fx == doctest::Approx(3100 * 0.16));
}

TEST_CASE("a wide picture has fewer rows of the array and thus less of its readout") {
  const phone::CameraFacts camera = array_4_by_3();
  const int64_t skew_ns = 24'000'000;
  CHECK(phone::line_time(skew_ns, camera, phone::crop_of(camera, 640, 480), 480) == 50'000);
  CHECK(phone::line_time(skew_ns, camera, phone::crop_of(camera, 1280, 720), 720) == 25'000);
  CHECK(phone::middle_of_frame(1000, 200, 100) == 1150);
}

TEST_CASE("Android's distortion in our order is OpenCV's") {
  phone::CameraFacts camera = array_4_by_3();
  camera.has_distortion = true;
  const float kappa[5] = {0.11F, -0.23F, 0.05F, 0.003F, -0.002F};
  std::copy(kappa, kappa + 5, camera.distortion);
  const odo_calibration lens = phone::calibration_of(camera, 0, 640, 480);
  REQUIRE(lens.distortion_count == 5);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> anywhere(-0.5, 0.5);
  for (int i = 0; i < 20; ++i) {
    const double x = anywhere(random), y = anywhere(random), r2 = x * x + y * y;
    const double radial = 1 + r2 * (kappa[0] + r2 * (kappa[1] + r2 * kappa[2]));  // Android's reference formula
    const double x_c = x * radial + kappa[3] * 2 * x * y + kappa[4] * (r2 + 2 * x * x);
    const double y_c = y * radial + kappa[4] * 2 * x * y + kappa[3] * (r2 + 2 * y * y);
    std::vector<cv::Point2d> pixels;
    cv::projectPoints(std::vector<cv::Point3d>{{x, y, 1}}, cv::Vec3d(), cv::Vec3d(), cv::Matx33d::eye(),
                      std::vector<double>(lens.distortion, lens.distortion + 5), pixels);
    CHECK(pixels[0].x == doctest::Approx(x_c).epsilon(1e-9));
    CHECK(pixels[0].y == doctest::Approx(y_c).epsilon(1e-9));
  }
}

TEST_CASE("the camera looks away from the screen, and its picture's right is the phone's bottom") {
  phone::CameraFacts camera = array_4_by_3();
  const auto mount = [&camera] { return quaternion(phone::calibration_of(camera, 0, 640, 480).q_b_c); };
  CHECK((mount() * Eigen::Vector3d::UnitZ() + Eigen::Vector3d::UnitZ()).norm() < 1e-9);
  CHECK((mount() * Eigen::Vector3d::UnitX() + Eigen::Vector3d::UnitY()).norm() < 1e-9);
  camera.orientation_deg = 270;
  CHECK((mount() * Eigen::Vector3d::UnitX() - Eigen::Vector3d::UnitY()).norm() < 1e-9);

  SUBCASE("the phone's own mount, from the sensors' axes to the camera's, inverted") {
    camera.orientation_deg = 90;
    const Eigen::Quaterniond own = mount() * Eigen::AngleAxisd(0.05, Eigen::Vector3d(1, 2, 3).normalized());
    const Eigen::Quaterniond to_camera = own.inverse();
    camera.has_rotation = true;
    camera.rotation[0] = float(to_camera.x()), camera.rotation[1] = float(to_camera.y());
    camera.rotation[2] = float(to_camera.z()), camera.rotation[3] = float(to_camera.w());
    CHECK(mount().angularDistance(own) < 1e-6);
  }
  SUBCASE("a mount that contradicts the sensor's orientation is ignored") {
    camera.orientation_deg = 90;
    const Eigen::Quaterniond expected = mount();
    camera.has_rotation = true;
    camera.rotation[3] = 1;
    CHECK(mount().angularDistance(expected) == 0);
    camera.rotation[3] = 0;  // all zero, as on some phones
    CHECK(mount().angularDistance(expected) == 0);
  }
}

TEST_CASE("a phone that lies on a table measures 9.8 m/s^2 out of its screen") {
  const float android[3] = {0, 0, 9.81F};
  odo_imu iphone;
  phone_accelerometer(&iphone, 12.5, 0, 0, -1);
  CHECK(phone::accelerometer(0, android, false).accel_b[2] == doctest::Approx(9.81));
  CHECK(iphone.accel_b[2] == doctest::Approx(9.80665));
  CHECK(iphone.header.t_ns == 12'500'000'000);
  CHECK(iphone.header.flags == ODO_IMU_ACCEL);
}

TEST_CASE("68 of 100 fixes with the stated covariance are within the accuracy's radius") {
  const odo_gnss fix = phone::gnss(0, 45, 5, 200, 6, 9);
  CHECK(fix.header.flags == (ODO_GNSS_POSITION | ODO_GNSS_HEIGHT | ODO_GNSS_COVARIANCE));
  CHECK(fix.covariance_n[8] == doctest::Approx(81));
  std::mt19937 random(2);
  std::normal_distribution<double> off(0, std::sqrt(fix.covariance_n[0]));
  int within = 0;
  for (int i = 0; i < 100'000; ++i) {
    const double off_n = off(random);
    within += std::hypot(off_n, off(random)) < 6;
  }
  CHECK(within == doctest::Approx(68'000).epsilon(0.01));
  odo_gnss iphone;
  CHECK(phone_gnss(&iphone, 100, 0.5, 45, 5, 200, 6, -1) == 1);
  CHECK(iphone.header.t_ns == 99'500'000'000);
  CHECK((iphone.header.flags & ODO_GNSS_HEIGHT) == 0);
  CHECK(phone_gnss(&iphone, 100, 0.5, 45, 5, 200, -1, -1) == 0);
}

TEST_CASE("an iPhone's matrix is read column by column") {
  const float columns[12] = {500, 0, 0, 0, 0, 510, 0, 0, 320, 240, 1, 0};
  odo_frame frame = phone::message<odo_frame>(ODO_TYPE_FRAME, 7, 0);
  frame.width = 640;
  frame.height = 480;
  phone_intrinsics(&frame, columns);
  CHECK(frame.fx == 500);
  CHECK(frame.fy == 510);
  CHECK(frame.cx == 319.5);
  CHECK(frame.cy == 239.5);
  odo_calibration lens;
  phone_calibration(&lens, &frame, 0.0096);
  CHECK(lens.cx == 319.5);
  CHECK(lens.line_time_ns == 20'000);
  CHECK((quaternion(lens.q_b_c) * Eigen::Vector3d::UnitX() + Eigen::Vector3d::UnitY()).norm() < 1e-9);
}

}  // namespace
