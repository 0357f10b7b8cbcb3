// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/known_object/read_objects.hpp"
#include "plugins/fix/known_object/text_tree.hpp"
#include "tests/plugins/known_object_scene.hpp"
#include "tests/support/support.hpp"

using namespace odograph::known_object_tests;

TEST_SUITE_BEGIN("known_object");

TEST_CASE("the lens's derivative equals the numeric one with a rolling shutter") {
  for (int kind = 0; kind < 3; ++kind) {
    CAPTURE(kind);
    RollingLens lens = lens_of(calibration(kind));
    const Vector3d p(0.4, -0.3, 2.5);
    const auto seen = required(lens.project(p));
    for (int k = 0; k < 3; ++k) {
      const Vector3d step = 1e-5 * Vector3d::Unit(k);
      const Eigen::Vector2d numeric = (lens.project(p + step)->pixel - lens.project(p - step)->pixel) / 2e-5;
      CHECK((numeric - seen->by_point.col(k)).norm() < 1e-3);
    }
    // Rows above the middle are earlier: a camera moving to the right saw the point farther right then.
    lens.line_time_s = 30e-6, lens.velocity_c = {1, 0, 0};
    const auto rolling = lens.project(p);
    const double after_s = (rolling->pixel.y() - 239.5) * 30e-6;
    const double moved_px = -after_s * seen->by_point(0, 0);
    CHECK(std::abs(rolling->pixel.x() - seen->pixel.x() - moved_px) < 0.02 * std::abs(moved_px));
    CHECK_FALSE(lens.project({0.1, 0.1, -1}));
  }
}

TEST_CASE("alignment converges to a few millimetres from some pixels away, through every lens") {
  const PlaneObject o = poster();
  const Pyramid pyramid(o);
  const Aligner aligner{Aligner::Parameters{}};
  for (int kind = 0; kind < 3; ++kind)
    for (const double oblique : {0.0, 40.0, 60.0}) {
      CAPTURE(kind);
      CAPTURE(oblique);
      const odo_calibration c = calibration(kind);
      const Scene scene(o, 4, oblique * kDegree);
      const Pose truth = scene.pose(o);
      const cv::Mat grey = frame_of({flat(o, o.picture, truth)}, c);
      Eigen::Matrix<double, 6, 1> off;
      off << 0.004, -0.004, 0.005, 0.02, -0.02, 0.08;
      const auto a = required(aligner.align({grey, {}, aligner.parameters()}, lens_of(c), pyramid, truth.moved(off)));
      CHECK((scene.place_by(a->pose, o) - scene.p_n).norm() < 0.04);
      CHECK(Eigen::AngleAxisd(a->pose.R_c_o.transpose() * truth.R_c_o).angle() < 0.012);
      CHECK(a->correlation > 0.9);
      CHECK(a->agreeing_part > 0.9);
      CHECK(std::abs(a->oblique_rad - oblique * kDegree) < 0.05);
    }
}

TEST_CASE("a poster is found from the side, and mirrored, exchanged and doubled ones are not") {
  const PlaneObject o = poster();
  const odo_calibration c = calibration(1);
  const RollingLens lens = lens_of(c);
  Finder finder({}, {o});
  const auto look = [&](const std::vector<FlatPicture>& pictures) {
    finder.clear();
    return finder.find(1'000'000'000, frame_of(pictures, c), {}, lens, {});
  };
  for (const double oblique : {0.0, 30.0, 55.0}) {
    CAPTURE(oblique);
    const Scene scene(o, 4, oblique * kDegree);
    const auto seen = look({flat(o, o.picture, scene.pose(o))});
    REQUIRE(seen.size() == 1);
    CHECK((scene.place_by(seen[0].poses[0].pose, o) - scene.p_n).norm() < 0.05);
    cv::Mat mirrored;
    cv::flip(o.picture, mirrored, 1);
    CHECK(look({flat(o, mirrored, scene.pose(o))}).empty());
    CHECK(look({flat(o, poster(2).picture, scene.pose(o))}).empty());
    cv::Mat half = o.picture.clone();
    poster(3).picture.rowRange(0, half.rows / 2).copyTo(half.rowRange(0, half.rows / 2));
    CHECK(look({flat(o, half, scene.pose(o))}).empty());
  }
  const Scene scene(o, 6, 0.1);
  Pose left = scene.pose(o), right = left;
  left.t_c_o -= 0.8 * left.R_c_o.col(0), right.t_c_o += 0.8 * right.R_c_o.col(0);
  CHECK(look({flat(o, o.picture, left), flat(o, o.picture, right)}).empty());
  CHECK(look({flat(o, o.picture, left)}).size() == 1);
}

TEST_CASE("an object seen at two positions is rejected for half a minute") {
  const PlaneObject o = poster();
  const odo_calibration c = calibration(0);
  const RollingLens lens = lens_of(c);
  Finder finder({}, {o});
  const Scene scene(o, 6, 0.1);
  Pose left = scene.pose(o), right = left;
  left.t_c_o -= 0.8 * left.R_c_o.col(0), right.t_c_o += 0.8 * right.R_c_o.col(0);
  cv::Mat soiled = o.picture.clone();  // too damaged to be recognised by itself, but still a copy
  poster(3).picture.rowRange(0, soiled.rows * 2 / 5).copyTo(soiled.rowRange(0, soiled.rows * 2 / 5));
  const auto at = [&](double s, const std::vector<FlatPicture>& pictures) {
    return finder.find(static_cast<int64_t>(1e9 * s), frame_of(pictures, c), {}, lens, {}).size();
  };
  CHECK(at(1, {flat(o, o.picture, left)}) == 1);
  CHECK(at(2, {flat(o, soiled, right)}) == 0);
  CHECK(at(3, {flat(o, o.picture, left)}) == 1);
  CHECK(at(4, {flat(o, o.picture, left), flat(o, soiled, right)}) == 0);
  CHECK(at(5, {flat(o, o.picture, left)}) == 0);
  CHECK(at(33, {flat(o, o.picture, left)}) == 0);
  CHECK(at(35, {flat(o, o.picture, left)}) == 1);
}

TEST_CASE("a tag is found and tracked, another number is not") {
  PlaneObject o = poster();
  o.width_m = o.height_m = 0.8;
  o.tag = 7, o.family = "36h11";
  o.picture = tag_picture("36h11", 7);
  const odo_calibration c = calibration(2);
  Finder finder({}, {o});
  const Scene scene(o, 4, 0.5);
  PlaneObject board = o;  // with a white rim, as printed
  board.width_m = board.height_m = 1.0;
  cv::Mat rim;
  const auto on_board = [&](int tag) {
    cv::copyMakeBorder(tag_picture("36h11", tag), rim, 16, 16, 16, 16, cv::BORDER_CONSTANT, cv::Scalar(255));
    return frame_of({flat(board, rim, scene.pose(o))}, c);
  };
  const auto seen = finder.find(0, on_board(7), {}, lens_of(c), {});
  REQUIRE(seen.size() == 1);
  CHECK((scene.place_by(seen[0].poses[0].pose, o) - scene.p_n).norm() < 0.05);
  CHECK(finder.find(1'000'000'000, on_board(8), {}, lens_of(c), {}).empty());
  CHECK(finder.find(2'000'000'000, on_board(7), {}, lens_of(c), {0}).empty());  // not if it may not be in view
}

TEST_CASE("of a plane's two poses the better or the possible one is used, or none") {
  const PlaneObject o = poster();
  const Scene scene(o, 5, 0.6);
  SightingValidator validator({});
  const auto clear = required(after_frames(validator, scene, o, scene.prior(), 5, 30));
  CHECK((clear->p_n - scene.p_n).norm() < 0.04);
  // Equal by the picture: the other one is 5 m away, which the prior excludes.
  validator.clear();
  Prior prior = scene.prior();
  prior.horizontal_sigma_m = 0.3;
  CHECK(after_frames(validator, scene, o, prior, 5, 1));
  validator.clear();
  prior.placed = false;
  CHECK_FALSE(after_frames(validator, scene, o, prior, 20, 1));
  CHECK(validator.rejections().ambiguous > 0);
}

TEST_CASE("a tilted or misplaced object is rejected") {
  const PlaneObject o = poster();
  const Scene scene(o, 5, 0.3);
  SightingValidator validator({});
  Prior prior = scene.prior();
  prior.q_n_c = Eigen::Quaterniond(Eigen::AngleAxisd(10 * kDegree, Vector3d::UnitX())) * prior.q_n_c;
  CHECK_FALSE(after_frames(validator, scene, o, prior, 20));
  CHECK(validator.rejections().not_upright == 20);
  prior = scene.prior();
  prior.p_n += Vector3d(0, 12, 0);
  CHECK_FALSE(after_frames(validator, scene, o, prior, 20));
  CHECK(validator.rejections().implausible_position == 20);
  prior = scene.prior();
  prior.q_n_c = Eigen::Quaterniond(Eigen::AngleAxisd(60 * kDegree, Vector3d::UnitZ())) * prior.q_n_c;
  CHECK_FALSE(after_frames(validator, scene, o, prior, 20));
  for (const double off_m : {4.0, 6.0}) {  // 3.5 sigmas and a metre
    validator.clear();
    prior = scene.prior();
    prior.p_n += Vector3d(0, off_m, 0), prior.horizontal_sigma_m = 1;
    CHECK(after_frames(validator, scene, o, prior, 20).has_value() == (off_m < 4.5));
  }
  validator.clear();
  // 12 m off after a path of 300 m is drift, which the object corrects.
  prior = scene.prior();
  prior.p_n += Vector3d(0, 12, 0), prior.path_m = 300;
  CHECK(after_frames(validator, scene, o, prior, 5));
}

TEST_CASE("the drift allowance counts from the last fix, not from the start of the walk") {
  const PlaneObject o = poster();
  const Scene scene(o, 5, 0.3);
  SightingValidator validator({});
  Prior prior = scene.prior();
  prior.path_m = 300;
  REQUIRE(after_frames(validator, scene, o, prior, 5));
  prior.path_m = 320;  // 3.5 sigmas, a metre, and a metre of drift
  prior.p_n += Vector3d(0, 9, 0);
  CHECK_FALSE(after_frames(validator, scene, o, prior, 20, -1, 200));
  CHECK(validator.rejections().implausible_position == 20);
  prior.path_m = 600;
  CHECK(after_frames(validator, scene, o, prior, 20, -1, 400));
}

TEST_CASE("standing in front of the object gives a fix that later ones while walking do not replace") {
  const PlaneObject o = poster();
  const Scene scene(o, 3, 0.1), grazing(o, 3, 1.1);
  SightingValidator validator({});
  CHECK_FALSE(after_frames(validator, scene, o, scene.prior(), 2));  // not confirmed
  auto e = required(after_frames(validator, scene, o, scene.prior(), 3, -1, 2));
  CHECK_FALSE(e->standing);
  e = after_frames(validator, scene, o, scene.prior(), 40, -1, 5);
  REQUIRE(e);
  CHECK(e->standing);
  CHECK_FALSE(after_frames(validator, grazing, o, grazing.prior(), 20, -1, 45));
}

TEST_CASE("distant views have less weight than near ones") {
  const PlaneObject o = poster();
  const auto told = [&](const Scene& scene) {
    SightingValidator validator({});
    const auto e = required(after_frames(validator, scene, o, scene.prior(), 5));
    return e->covariance_n.trace();
  };
  const double near = told(Scene(o, 3, 0.5));
  CHECK(told(Scene(o, 12, 0.5)) > 10 * near);
}
