// SPDX-License-Identifier: Apache-2.0
#include <opencv2/imgproc.hpp>

#include "sdk/host/config/camera_yaml.hpp"
#include "sdk/host/messages/messages.hpp"
#include "sdk/tools/calibration/calibrate_lens.hpp"
#include "sdk/tools/simulation/board_pictures.hpp"
#include "sdk/tools/simulation/random.hpp"
#include "tests/support/support.hpp"

namespace {

odo_calibration lens(uint32_t model) {
  auto c = make_message<odo_calibration>(ODO_TYPE_CALIBRATION, 0);
  c.model = model;
  c.width = 640, c.height = 480;
  c.fx = 411, c.fy = 415, c.cx = 311, c.cy = 248;
  c.distortion_count = 4;
  const bool fisheye = model == ODO_CAMERA_KANNALA_BRANDT;
  const double k[] = {fisheye ? 0.02 : -0.12, fisheye ? -0.006 : 0.05, fisheye ? 0.002 : 0.0008, fisheye ? 0 : -0.0004};
  std::copy(std::begin(k), std::end(k), c.distortion);
  return c;
}

std::vector<BoardView> views_of(const Board& board, const odo_calibration& truth, uint64_t seed, uint64_t pictures) {
  const BoardCamera camera(board, truth);
  BoardFinder finder(board);
  std::vector<BoardView> views;
  for (uint64_t i = 0; i < pictures; ++i)
    if (auto view = finder.find(camera.picture(camera.pose(seed, i), seed, i))) {
      view->name = std::to_string(i);
      views.push_back(std::move(*view));
    }
  return views;
}

/// Six views of a board's corners by the pinhole equations, with normal errors of `noise_px` per coordinate.
std::vector<BoardView> exact_views(const odo_calibration& truth, double noise_px = 0, uint64_t seed = 1) {
  const Board board;
  Random random(seed, 5);
  std::vector<BoardView> views;
  for (int i = 0; i < 6; ++i) {
    const Eigen::Isometry3d T = Eigen::Translation3d(0.03 * i - 0.2, -0.08, 0.35) *
                                Eigen::AngleAxisd(0.2 * i - 0.5, Eigen::Vector3d(1, 0.4 * i, 0.1).normalized());
    BoardView view;
    for (int y = 1; y < board.rows; ++y)
      for (int x = 1; x < board.columns; ++x) {
        const Eigen::Vector3d p = T * Eigen::Vector3d(x * board.square_m, y * board.square_m, 0);
        const double u = p.x() / p.z(), v = p.y() / p.z(), r2 = u * u + v * v;
        const double* k = truth.distortion;
        const double radial = 1 + r2 * (k[0] + r2 * k[1]);
        view.corners_m.emplace_back(static_cast<float>(x * board.square_m), static_cast<float>(y * board.square_m), 0);
        const double px = truth.fx * (u * radial + 2 * k[2] * u * v + k[3] * (r2 + 2 * u * u)) + truth.cx;
        const double py = truth.fy * (v * radial + k[2] * (r2 + 2 * v * v) + 2 * k[3] * u * v) + truth.cy;
        view.pixels.push_back(
            {static_cast<float>(px + noise_px * random.normal()), static_cast<float>(py + noise_px * random.normal())});
      }
    views.push_back(view);
  }
  return views;
}

const LensOptions kFourCoefficients{.coefficients = 4};

}  // namespace

TEST_SUITE("calibration") {
  TEST_CASE("simulated boards give focal lengths within 0.1 % and the principal point within 0.5 px") {
    for (const auto kind : {Board::Kind::charuco, Board::Kind::checkerboard})
      for (const auto model : {ODO_CAMERA_PINHOLE, ODO_CAMERA_KANNALA_BRANDT}) {
        CAPTURE(static_cast<int>(kind));
        CAPTURE(model);
        const odo_calibration truth = lens(model);
        const auto views = views_of({.kind = kind}, truth, 71, 20);
        REQUIRE(views.size() > 14);
        const auto found = calibrate_lens(
            views, {640, 480},
            {.lens = model == ODO_CAMERA_PINHOLE ? Lens::pinhole : Lens::kannala_brandt, .coefficients = 5});
        REQUIRE(found);
        CHECK(std::abs(found->fx / truth.fx - 1) < 1e-3);
        CHECK(std::abs(found->fy / truth.fy - 1) < 1e-3);
        CHECK(std::abs(found->cx - truth.cx) < 0.5);
        CHECK(std::abs(found->cy - truth.cy) < 0.5);
        CHECK(found->rms_px < 0.3);
        // Its reported sigma is neither far too small nor far too large.
        CHECK(std::abs(found->fx - truth.fx) < 4 * found->sigma_fx);
        CHECK(std::abs(found->cx - truth.cx) < 4 * found->sigma_cx);
        CHECK(found->sigma_fx < 1e-3 * truth.fx);
      }
  }

  TEST_CASE("corners without noise give the lens exactly") {
    const odo_calibration truth = lens(ODO_CAMERA_PINHOLE);
    const auto views = exact_views(truth);
    const auto found = required(calibrate_lens(views, {640, 480}, kFourCoefficients));
    CHECK(found->rms_px < 1e-4);  // corners are single precision
    CHECK(found->fx == doctest::Approx(truth.fx).epsilon(1e-5));
    CHECK(found->cy == doctest::Approx(truth.cy).epsilon(1e-5));
    for (size_t i = 0; i < 4; ++i) CHECK(std::abs(found->distortion[i] - truth.distortion[i]) < 1e-4);
  }

  TEST_CASE("errors of focal length and principal point match their sigmas") {
    const odo_calibration truth = lens(ODO_CAMERA_PINHOLE);
    double squares[4] = {0, 0, 0, 0};
    constexpr int kTrials = 150;
    for (uint64_t seed = 1; seed <= kTrials; ++seed) {
      const auto found = required(calibrate_lens(exact_views(truth, 0.2, seed), {640, 480}, kFourCoefficients));
      const double off[] = {(found->fx - truth.fx) / found->sigma_fx, (found->fy - truth.fy) / found->sigma_fy,
                            (found->cx - truth.cx) / found->sigma_cx, (found->cy - truth.cy) / found->sigma_cy};
      for (int k = 0; k < 4; ++k) squares[k] += off[k] * off[k] / kTrials;
      CHECK(std::abs(found->rms_px - 0.2 * std::sqrt(2.0)) < 0.05);  // of a point: both coordinates; measured: 0.03
    }
    MESSAGE("squared error by variance: " << squares[0] << " " << squares[1] << " " << squares[2] << " " << squares[3]);
    for (const double square : squares) {  // of 150 normal errors: 0.88 to 1.12, one sigma
      CHECK(square == Between{0.7, 1.4});
    }
  }

  TEST_CASE("an old print, which starts with a white square, is distinguished from a new one") {
    const Board board{.columns = 11, .rows = 8};
    for (const bool first_is_white : {false, true}) {
      CAPTURE(first_is_white);
      cv::Mat picture = board_picture(board, 40, first_is_white);
      cv::GaussianBlur(picture, picture, {0, 0}, 0.8);
      const auto view = required(BoardFinder(board).find(picture));
      CHECK(view->pixels.size() == static_cast<size_t>(board.inner_corners()));
      for (size_t i = 0; i < view->pixels.size(); ++i) {
        const cv::Point2f expected(view->corners_m[i].x / 0.025F * 40 + 19.5F,
                                   view->corners_m[i].y / 0.025F * 40 + 19.5F);
        CHECK(cv::norm(view->pixels[i] - expected) < 0.05);
      }
    }
  }

  TEST_CASE("a picture that contradicts the others is rejected") {
    auto views = views_of({}, lens(ODO_CAMERA_PINHOLE), 5, 12);
    REQUIRE(views.size() > 8);
    const auto before = calibrate_lens(views, {640, 480}, {});
    for (auto& p : views[3].pixels) p.x += 0.02F * p.y;  // as from another camera
    const auto found = calibrate_lens(views, {640, 480}, {});
    REQUIRE(before);
    REQUIRE(found);
    CHECK(std::count_if(found->pictures.begin(), found->pictures.end(), [](const auto& p) { return !p.used; }) == 1);
    CHECK(found->pictures.back().name == views[3].name);
    CHECK(found->fx == doctest::Approx(before->fx).epsilon(2e-3));
  }

  TEST_CASE("insufficient data gives an error text or a large sigma, never an invented number") {
    CHECK(contains(calibrate_lens({}, {640, 480}, {}).failure().text, "at least 3"));
    const auto views = views_of({}, lens(ODO_CAMERA_PINHOLE), 6, 5);
    const auto few = required(calibrate_lens(views, {640, 480}, {}));
    CHECK(contains(warnings_about(*few).front(), "only"));
    // A board that differs from the pictures.
    const auto other = views_of({.columns = 8, .rows = 5, .family = "25h9"}, lens(ODO_CAMERA_PINHOLE), 6, 3);
    BoardFinder finder({.family = "16h5"});
    const BoardCamera camera({}, lens(ODO_CAMERA_PINHOLE));
    for (uint64_t i = 0; i < 3; ++i) CHECK_FALSE(finder.find(camera.picture(camera.pose(6, i), 6, i)));
    CHECK(other.size() == 3);
    CHECK(invalid_reason({.columns = 40, .rows = 40, .family = "16h5"})->find("16h5 has 30") != std::string::npos);
    CHECK(invalid_reason({.marker_m = 0.03})->find("0.95") != std::string::npos);
    CHECK(invalid_reason({.family = "4X4"})->find("36h11") != std::string::npos);
  }

  TEST_CASE("the written camera.yaml is read back") {
    const auto found = required(calibrate_lens(views_of({}, lens(ODO_CAMERA_KANNALA_BRANDT), 8, 8), {640, 480},
                                               {.lens = Lens::kannala_brandt}));
    const TemporaryFolder folder;
    const auto read = required(read_camera_yaml(write_text(folder / "camera.yaml", camera_yaml(*found)), nullptr));
    CHECK(read->model == ODO_CAMERA_KANNALA_BRANDT);
    CHECK(read->fx == doctest::Approx(found->fx).epsilon(1e-8));
    CHECK(read->distortion_count == 4);
    CHECK(read->distortion[0] == doctest::Approx(found->distortion[0]).epsilon(1e-6));
    CHECK((read->header.flags & ODO_CALIBRATION_EXTRINSICS) == 0);
  }
}
