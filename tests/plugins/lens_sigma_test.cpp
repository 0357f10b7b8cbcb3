// SPDX-License-Identifier: Apache-2.0
//
// Sigmas and residuals of a lens calibration against known noise.
#include <Eigen/Geometry>

#include "sdk/tools/calibration/calibrate_lens.hpp"
#include "sdk/tools/simulation/random.hpp"
#include "tests/support/support.hpp"

namespace {

constexpr double kNoise_px = 0.2, kTilt_rad = 0.55;

/// Eight views, tilted about axes in all directions, with noise on each coordinate of the corners.
std::vector<BoardView> noisy_views(uint64_t seed) {
  Random random(seed, 9);
  std::vector<BoardView> views;
  for (int i = 0; i < 8; ++i) {
    const double towards = 0.8 * i;
    const Eigen::Isometry3d T = Eigen::Translation3d(0.02 * (i % 3) - 0.02, 0.03 * (i % 2) - 0.02, 0.3 + 0.02 * i) *
                                Eigen::AngleAxisd(kTilt_rad, Eigen::Vector3d(std::cos(towards), std::sin(towards), 0)) *
                                Eigen::Translation3d(-0.125, -0.0875, 0);
    BoardView view{.name = std::to_string(i), .corners_m = {}, .pixels = {}};
    for (int y = 1; y < 7; ++y)
      for (int x = 1; x < 10; ++x) {
        view.corners_m.emplace_back(0.025F * static_cast<float>(x), 0.025F * static_cast<float>(y), 0);
        const Eigen::Vector3d p = T * Eigen::Vector3d(0.025 * x, 0.025 * y, 0);
        view.pixels.push_back({static_cast<float>(500 * p.x() / p.z() + 320 + kNoise_px * random.normal()),
                               static_cast<float>(505 * p.y() / p.z() + 240 + kNoise_px * random.normal())});
      }
    views.push_back(std::move(view));
  }
  return views;
}

}  // namespace

TEST_SUITE("calibration") {
  TEST_CASE("tilt and coverage are those of the boards, and residuals are measured minus modelled") {
    auto views = noisy_views(1);
    const auto found = required(calibrate_lens(views, {640, 480}, {.coefficients = 0}));
    CHECK(std::abs(found->widest_tilt_rad() - kTilt_rad) < 0.01);
    for (const auto& picture : found->pictures) CHECK(std::abs(picture.tilt_rad - kTilt_rad) < 0.02);
    views[3].pixels[17].x += 0.9F, views[3].pixels[17].y -= 0.7F;
    const auto moved = required(calibrate_lens(views, {640, 480}, {.coefficients = 0}));
    const auto change = moved->pictures[3].residuals_px[17] - found->pictures[3].residuals_px[17];
    CHECK(std::abs(change.x - 0.9) < 0.1);
    CHECK(std::abs(change.y + 0.7) < 0.1);
    LensCalibration c;
    c.size = {640, 480};
    c.pictures.push_back({.name = "", .pixels = {{10, 10}, {100, 10}, {10, 90}, {639, 479}}, .residuals_px = {}});
    c.pictures.push_back({.name = "", .used = false, .tilt_rad = 1, .pixels = {{300, 300}}, .residuals_px = {}});
    CHECK(c.covered() == doctest::Approx(4.0 / 48));
    CHECK(c.widest_tilt_rad() == 0);
  }
}
