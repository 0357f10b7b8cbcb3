// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/known_object/finder.hpp"
#include "tests/plugins/known_object_scene.hpp"
#include "tests/support/support.hpp"

using namespace odograph::known_object_tests;

TEST_SUITE_BEGIN("known_object");

namespace {

Pose beside(const Pose& pose, double right_m) {
  Pose p = pose;
  p.t_c_o += right_m * p.R_c_o.col(0);
  return p;
}

}  // namespace

TEST_CASE("a second copy in the plane is recognised from a part of it, through every lens and in shadow") {
  const PlaneObject o = poster();
  const CopySearch copy_search({}, {o});
  for (int kind = 0; kind < 3; ++kind)
    for (const double oblique : {0.0, 25.0, 50.0})
      for (const double right_m : {-1.45, -1.25, 1.25, 1.45}) {
        CAPTURE(kind);
        CAPTURE(oblique);
        CAPTURE(right_m);
        const odo_calibration c = calibration(kind);
        const Scene scene(o, 5, oblique * kDegree);
        const Pose pose = scene.pose(o), second = beside(pose, right_m);
        PosterCamera::Shot shot;
        shot.shadow = 0.6, shot.noise = 4;
        const auto both = copy_search.search(
            0, frame_of({flat(o, o.picture, pose), flat(o, o.picture, second)}, c, shot), {}, lens_of(c), pose);
        CHECK(both.has_copy);
        CHECK(both.offset_m.x() == doctest::Approx(right_m).epsilon(0.06));
        const auto single = copy_search.search(0, frame_of({flat(o, o.picture, pose)}, c, shot), {}, lens_of(c), pose);
        CHECK_FALSE(single.has_copy);
        CHECK(single.clear[0]);
        CHECK(single.clear[1]);
        // Another board of the same layout beside it is not a copy.
        const auto other = copy_search.search(
            0, frame_of({flat(o, o.picture, pose), flat(o, poster(2).picture, second)}, c, shot), {}, lens_of(c), pose);
        CHECK_FALSE(other.has_copy);
      }
  // A third of it in the picture, from the side.
  const odo_calibration c = calibration(0);
  Scene scene(o, 3, 0);
  const Pose pose = scene.pose(o);
  const PosterCamera camera(c);
  Pose second = beside(pose, 1.25);
  while (camera.project(second.t_c_o + 0.1 * second.R_c_o.col(0)).x() < 639) {
    scene.R_n_c = Eigen::AngleAxisd(-0.01, Vector3d::UnitZ()).toRotationMatrix() * scene.R_n_c;
    second = beside(scene.pose(o), 1.25);
  }
  CHECK(copy_search
            .search(0, frame_of({flat(o, o.picture, scene.pose(o)), flat(o, o.picture, second)}, c), {}, lens_of(c),
                    scene.pose(o))
            .has_copy);
}

TEST_CASE("a side that is outside the picture or masked is not clear") {
  const PlaneObject o = poster();
  const CopySearch copy_search({}, {o});
  const odo_calibration c = calibration(0);
  const Scene scene(o, 5, 0), aside(o, 2.2, 0, -0.8);  // the latter does not see its left rim
  const auto look = [&](const Scene& s, const cv::Mat& mask) {
    return copy_search.search(0, frame_of({flat(o, o.picture, s.pose(o))}, c), mask, lens_of(c), s.pose(o)).clear;
  };
  CHECK(look(scene, {})[0]);
  CHECK(look(scene, {})[1]);
  CHECK(look(aside, {})[0]);
  CHECK_FALSE(look(aside, {})[1]);
  cv::Mat mask(480, 640, CV_8U, cv::Scalar(255));
  mask.colRange(400, 640).setTo(0);
  CHECK(look(scene, mask)[0]);
  CHECK_FALSE(look(scene, mask)[1]);
}

TEST_CASE(
    "an object that may be a neighbouring copy gives a fix once both sides have been seen or the prior excludes the "
    "copy") {
  const PlaneObject o = poster();
  const Scene scene(o, 5, 0.3);
  SightingValidator validator({});
  const auto told = [&](const Prior& prior, std::array<bool, kSides> first, std::array<bool, kSides> then) {
    validator.clear();
    bool any = false;
    for (int k = 0; k < 12; ++k) {
      Sighting s = sighting_of(scene, o, k * 100'000'000LL, -1);
      s.clear = k < 6 ? first : then;
      any = any || validator.validate(s, o, lens_of(calibration(0)), prior);
    }
    return any;
  };
  const std::array<bool, kSides> left = {true, false, true, true}, right = {false, true, true, true};
  CHECK_FALSE(told(scene.prior(), left, left));
  CHECK_FALSE(told(scene.prior(), right, right));
  CHECK(validator.rejections().possible_copy > 0);
  CHECK(told(scene.prior(), left, right));  // one after the other
  Prior prior = scene.prior();
  prior.horizontal_sigma_m = 0.3;  // a copy 1.2 m to the side is four sigmas away
  CHECK(told(prior, left, left));
  CHECK(told(prior, right, right));
  prior.p_n.y() += 0.9;  // the camera is left of the prior, which a copy on the left explains better
  CHECK_FALSE(told(prior, right, right));
  CHECK(told(prior, left, left));
  prior.placed = false;  // then nothing excludes it
  CHECK_FALSE(told(prior, left, left));
}

TEST_CASE("passing the copy first, with the original out of the picture, gives no fix from the copy") {
  const PlaneObject o = poster();
  const odo_calibration c = calibration(0);
  const RollingLens lens = lens_of(c);
  const double spacing_m = 1.3;
  SightingValidator::Parameters without_copy_check;
  without_copy_check.unobserved_copy = -1e9;
  const auto pass = [&](bool alone, const SightingValidator::Parameters& parameters) {
    Finder finder({}, {o});
    SightingValidator validator(parameters);
    std::vector<double> error_m;
    // To the right along the wall at 2.5 m; the copy hangs on the left, or there is none.
    for (int k = 0; k < 30; ++k) {
      const int64_t t = k * 200'000'000LL;
      Scene scene(o, 2.5, 0, 0);
      const double along_m = -2.6 + 0.13 * k;
      scene.p_n.y() = along_m;
      scene.R_n_c = Scene(o, 2.5, 0, 0).R_n_c;
      const Pose pose = scene.pose(o);
      std::vector<FlatPicture> hung = {flat(o, o.picture, pose)};
      if (!alone) hung.push_back(flat(o, o.picture, beside(pose, -spacing_m)));
      for (const Sighting& s : finder.find(t, frame_of(hung, c), {}, lens, {}))
        if (const auto e = validator.validate(s, o, lens, scene.prior()))
          error_m.push_back((e->p_n - scene.p_n).norm());
    }
    return error_m;
  };
  CHECK(pass(false, {}).empty());
  const auto wrong = pass(false, without_copy_check);  // result without the check
  REQUIRE_FALSE(wrong.empty());
  CHECK(wrong.front() == doctest::Approx(spacing_m).epsilon(0.1));
  const auto right = pass(true, {});
  REQUIRE_FALSE(right.empty());
  CHECK(*std::max_element(right.begin(), right.end()) < 0.1);
}
