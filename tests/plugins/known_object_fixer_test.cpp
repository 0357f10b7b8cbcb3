// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include <doctest/doctest.h>

#include "plugins/fix/known_object/object_fixer.hpp"
#include "tests/plugins/known_object_scene.hpp"

using namespace odograph;
using namespace odograph::known_object_tests;

namespace {

constexpr int64_t kFrame = 100'000'000;

/// A camera that stands in front of the poster; the pipeline's origin is elsewhere, by an offset.
struct Walker {
  PlaneObject object = poster();
  Scene scene{object, 5, 20 * kDegree};
  odo_calibration camera = calibration(0);
  cv::Mat grey = frame_of({flat(object, object.picture, scene.pose(object))}, camera);

  std::unique_ptr<ObjectFixer> fixer() const {
    Finder::Parameters finder;
    finder.search_interval_s = 0;
    auto result = std::make_unique<ObjectFixer>(ObjectFixer::Parameters{}, finder, SightingValidator::Parameters{},
                                                std::vector{object});
    result->set_mount(Eigen::Quaterniond::Identity(), Vector3d::Zero());
    return result;
  }
  PipelinePose pose(int64_t t_ns, const Vector3d& offset_n = Vector3d::Zero()) const {
    PipelinePose p{t_ns, Eigen::Quaterniond(scene.R_n_c), scene.p_n + offset_n};
    p.is_of_camera = p.is_metric_position = true;
    p.tilt_sigma_rad = kDegree, p.yaw_sigma_rad = 3 * kDegree, p.horizontal_sigma_m = 1, p.vertical_sigma_m = 0.3;
    return p;
  }
  std::vector<Estimate> frame(ObjectFixer& fixer, int64_t t_ns) const {
    return fixer.add_frame(t_ns, grey, {}, lens_of(camera));
  }
};

}  // namespace

TEST_SUITE_BEGIN("known_object");

TEST_CASE("a sighting waits for the pose that follows its frame; one in a long gap between poses gives no fix") {
  const Walker walker;
  const auto made = walker.fixer();
  ObjectFixer& fixer = *made;
  size_t fixes = 0;
  for (int k = 0; k < 10; ++k) {
    CHECK(walker.frame(fixer, k * kFrame + kFrame / 2).empty());
    fixes += fixer.add_pose(walker.pose(k * kFrame)).size();
  }
  CHECK(fixes > 0);
  // The next pose is two seconds later: no pose is interpolated over that long.
  CHECK(walker.frame(fixer, 10 * kFrame).empty());
  CHECK(fixer.add_pose(walker.pose(30 * kFrame)).empty());
}

TEST_CASE("a fix is where the camera stands, to centimetres") {
  const Walker walker;
  const auto made = walker.fixer();
  ObjectFixer& fixer = *made;
  std::vector<Estimate> fixes;
  for (int k = 0; k < 10; ++k) {
    fixer.add_pose(walker.pose(k * kFrame));
    for (const Estimate& e : walker.frame(fixer, k * kFrame)) fixes.push_back(e);
  }
  REQUIRE_FALSE(fixes.empty());
  CHECK((fixes.back().p_n - walker.scene.p_n).norm() < 0.05);
}

TEST_CASE("the first fix aligns n with the objects, and from then on a pose elsewhere is rejected") {
  Walker walker;
  walker.object.place.geodetic = true;  // and n's origin is unknown
  walker.object.place.latitude_rad = 0.84, walker.object.place.longitude_rad = 0.04;
  const Vector3d offset_n(200, -80, 3);
  const auto run = [&](ObjectFixer& fixer, int first, const Vector3d& offset) {
    size_t fixes = 0;
    for (int k = first; k < first + 12; ++k) {
      fixer.add_pose(walker.pose(k * kFrame, offset));
      fixes += walker.frame(fixer, k * kFrame).size();
    }
    return fixes;
  };
  const auto made = walker.fixer();
  ObjectFixer& fixer = *made;
  CHECK(run(fixer, 0, offset_n) > 0);
  CHECK(run(fixer, 30, offset_n) > 0);
  CHECK(run(fixer, 60, offset_n + Vector3d(30, 0, 0)) == 0);
  fixer.reset();
  CHECK(run(fixer, 90, Vector3d(-5, 7, 0)) > 0);
}

TEST_CASE("objects in n and geodetic ones need n's origin") {
  const Walker walker;
  PlaneObject geodetic = walker.object;
  geodetic.id = "another", geodetic.place.geodetic = true;
  CHECK_THROWS_AS(ObjectFixer({}, {}, {}, {walker.object, geodetic}), std::runtime_error);
  ObjectFixer::Parameters parameters;
  parameters.origin = {0.84, 0.04, 100};
  CHECK_NOTHROW(ObjectFixer(parameters, {}, {}, {walker.object, geodetic}));
}

TEST_SUITE_END();
