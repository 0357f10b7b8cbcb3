// SPDX-License-Identifier: Apache-2.0
#include <array>

#include <Eigen/Geometry>
#include <doctest/doctest.h>

#include "plugins/fix/known_object/finder.hpp"
#include "plugins/fix/known_object/read_objects.hpp"
#include "sdk/host/base/geodesy.hpp"
#include "sdk/tools/recording/recording.hpp"
#include "sdk/tools/simulation/simulate.hpp"
#include "tests/plugins/known_object_scene.hpp"
#include "tests/support/support.hpp"

using namespace odograph;
using namespace odograph::known_object;
using Eigen::Vector3d;

TEST_SUITE_BEGIN("known_object");

TEST_CASE("a poster and a tag beside a simulated walk are at their surveyed positions") {
  const TemporaryFolder folder;
  Scenario s;
  s.route = {{0, 0, 0}, {5, 0, 0}};
  s.objects = {{9, 1.0, 1.6, 1.8, "poster", 0.6}, {9, -0.8, 1.6, 0.6}};
  s.world.pedestrians = 0, s.world.cars = 0;
  s.camera.rate_hz = 2, s.camera.row_time_s = 0;
  REQUIRE(simulate(s, 2, folder / "walk.odo").ok());
  REQUIRE(write_known_objects(s, 2, folder / "survey").ok());
  const auto recording = required(read_recording(folder / "walk.odo"));
  const std::vector<PlaneObject> objects = read_objects(folder / "survey" / "objects.yaml");
  REQUIRE(objects.size() == 2);
  CHECK(objects[0].id == "poster 0");
  CHECK(std::abs(objects[0].width_m - 1.08) < 1e-3);
  Geodesy geodesy;
  geodesy.set_origin(kSimulatedOrigin);
  RollingLens lens;
  lens.camera.fx = lens.camera.fy = s.camera.focal_px, lens.camera.cx = 319.5, lens.camera.cy = 239.5;
  lens.width = s.camera.width, lens.height = s.camera.height;
  Finder finder({}, objects);
  std::array<int, 2> seen{};
  size_t frame_index = 0;
  for (const auto& m : recording->messages) {
    if (m.message.header().type != ODO_TYPE_FRAME) continue;
    const StampedPose& truth = recording->truth[frame_index++];
    const auto frame = required(load_frame(m));
    const cv::Mat grey(480, 640, CV_8U, const_cast<uint8_t*>(frame->planes[0].data),
                       static_cast<size_t>(frame->planes[0].row_stride));
    for (const Sighting& sighting : finder.find(truth.t_ns, grey, {}, lens, {})) {
      const PlaneObject& o = objects[sighting.object];
      const auto middle = geodesy.from_geodetic({o.place.latitude_rad, o.place.longitude_rad, o.place.height_m});
      const Vector3d p_c = truth.q.conjugate() * (Vector3d(middle.data()) - truth.p);
      CAPTURE(o.id);
      CHECK((sighting.poses[0].pose.t_c_o - p_c).norm() < 0.02 * p_c.norm());
      ++seen[sighting.object];
    }
    frame->loan.release(frame->loan.owner);
  }
  CHECK(seen[0] >= 3);
  CHECK(seen[1] >= 3);
}

TEST_CASE("survey errors of the corners shift and rotate the camera as the covariance states") {
  using namespace known_object_tests;
  PlaneObject o = poster();
  o.sigma_m = 0.02;
  SightingValidator::Parameters p;
  p.confirmations = 1, p.focal_sigma = 0, p.pixel_sigma = 1e-3;
  for (const double oblique_rad : {-0.6, 0.0, 0.9}) {
    CAPTURE(oblique_rad);
    const known_object_tests::Scene scene(o, 4, oblique_rad);
    Sighting sighting = sighting_of(scene, o, 0, -1);
    sighting.poses[0].information *= 1e6;
    const auto told = SightingValidator(p).validate(sighting, o, lens_of(calibration(0)), scene.prior());
    REQUIRE(told);
    Random random(5, 1);
    Eigen::Matrix<double, 3, 4> stated, true_o;
    const auto corners = o.corners_o();
    for (int k = 0; k < 4; ++k) stated.col(k) = corners[static_cast<size_t>(k)];
    const Vector3d p_o = o.place.R_n_o.transpose() * (scene.p_n - o.place.p_n);
    Matrix3d position = Matrix3d::Zero(), rotation = Matrix3d::Zero();
    constexpr int kSurveys = 4000;
    for (int i = 0; i < kSurveys; ++i) {
      for (int k = 0; k < 12; ++k) true_o(k) = stated(k) + o.sigma_m * random.normal();
      const Eigen::Isometry3d T(Eigen::umeyama(stated, true_o, false));
      const Eigen::AngleAxisd turned(T.linear());
      const Vector3d off = o.place.R_n_o * (T * p_o - p_o), theta = o.place.R_n_o * (turned.angle() * turned.axis());
      position += off * off.transpose() / kSurveys, rotation += theta * theta.transpose() / kSurveys;
    }
    CHECK((told->covariance_n - position).norm() < 0.1 * position.norm());  // 4000 of them: 3 %
    CHECK((told->orientation_covariance_n - rotation).norm() < 0.1 * rotation.norm());
  }
}

TEST_SUITE_END();
