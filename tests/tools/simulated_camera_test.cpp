// SPDX-License-Identifier: Apache-2.0
//
// The simulated camera: rays and pixels are inverse to each other, and its errors have the requested size.
#include "sdk/tools/evaluation/evaluation.hpp"
#include "sdk/tools/simulation/camera.hpp"
#include "sdk/tools/simulation/simulate.hpp"
#include "tests/support/support.hpp"

using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

Motion shaking() {
  std::vector<Vector3d> p;
  std::vector<Eigen::Quaterniond> q;
  for (double t = 0; t <= 3; t += 0.0025) {
    p.emplace_back(0.2 * t, 0.05 * std::sin(3 * t), 0);
    q.push_back(Eigen::AngleAxisd(0.02 * std::sin(11 * t), Vector3d::UnitX()) *
                Eigen::AngleAxisd(0.03 * std::cos(9 * t), Vector3d::UnitY()) * Eigen::Quaterniond::Identity());
  }
  return {400, std::move(p), std::move(q)};
}

Scenario::Camera plain() {
  Scenario::Camera c;
  c.width = 160, c.height = 120, c.focal_px = 130;
  return c;
}

std::vector<double> pixels_of(const cv::Mat& picture) {
  std::vector<double> values;
  for (int y = 0; y < picture.rows; ++y)
    for (int x = 0; x < picture.cols; ++x) values.push_back(picture.at<uint8_t>(y, x));
  return values;
}

}  // namespace

TEST_SUITE("phone_camera") {
  TEST_CASE("a point on a pixel's ray is projected to that pixel, for any lens, stabiliser, focus and shutter") {
    const Motion phone = shaking();
    for (int k = 0; k < 32; ++k) {
      CAPTURE(k);
      Scenario::Camera c = plain();
      if (k & 1) c.stabiliser.travel_rad = 0.03;
      if (k & 2) c.focus = {0.05, 0.2, 0.3};
      c.row_time_s = k & 4 ? 120e-6 : 0;
      if (k & 8) c.model = "kannala_brandt";
      if (k & 16) c.distortion = {-0.1, 0.03, 0.002, -0.001};
      const SimCamera camera(c, 1, 5, &phone);
      const double t = 1.37;
      double furthest_px = 0;
      for (int y = 4; y < c.height - 4; y += 13)
        for (int x = 4; x < c.width - 4; x += 17) {
          const double when = t + camera.row_offset_s(y);
          const SimLens::State lens = camera.lens().at(when);
          const Vector3d ray = (camera.lens().moves() ? camera.ray(x, y, lens) : camera.ray(x, y)).cast<double>();
          const auto seen = required(camera.project_rolling(phone, t, camera.pose(phone, when) * (6 * ray)));
          CHECK((*seen - Vector2d(x, y)).norm() < 0.02);
          furthest_px = std::max(furthest_px, (camera.project(ray) - Vector2d(x, y)).norm());
        }
      CHECK((furthest_px > 0.5) == ((k & 3) != 0));  // differs from the static lens
    }
  }

  TEST_CASE("a colour picture has the grey of the grey one; the sky is blue and the leaves are green") {
    Scenario scenario;
    scenario.camera = plain();
    scenario.camera.colour = true;
    const World world(scenario, 3);
    const SimCamera camera(scenario.camera, 1, 3);
    View view(world, camera, scenario);
    Eigen::Matrix3d upright;
    upright << 0, 0, -1, 1, 0, 0, 0, -1, 0;
    const cv::Mat light = view.render(Motion(1, {Vector3d(0, 0, -1.5)}, {Eigen::Quaterniond(upright)}), 0);
    const cv::Mat grey = camera.develop(light, 0), colour = coloured(grey, view.tint());
    double vivid = 0;
    for (int y = 0; y < grey.rows; ++y)
      for (int x = 0; x < grey.cols; ++x) {
        const auto [b, g, r] = colour.at<cv::Vec3b>(y, x).val;
        CHECK(std::abs(0.114 * b + 0.587 * g + 0.299 * r - grey.at<uint8_t>(y, x)) <= 1);
        vivid += std::abs(r - b) > 15;
      }
    CHECK(vivid / static_cast<double>(grey.total()) > 0.2);
    const Tint sky = sky_tint(0.5f, 190), leaves = surface_tint(TextureSet::kLeaves, 1);
    CHECK((sky[0] > 0.1 && sky[1] < -0.1));
    CHECK((leaves[0] < -0.1 && 0.114 * leaves[0] + 0.299 * leaves[1] < -0.02));  // less blue, more green than grey
    scenario.camera.colour = false;
    CHECK(View(world, camera, scenario).tint().empty());
  }

  TEST_CASE("rows are exposed with a delay downwards, about the middle row") {
    Scenario::Camera c = plain();
    c.row_time_s = 1e-4;
    const SimCamera camera(c, 1, 1);
    CHECK(camera.row_offset_s(59.5) == 0);
    CHECK(std::abs(camera.row_offset_s(119) - 59.5e-4) < 1e-12);
    CHECK(std::abs(camera.row_offset_s(0) + 59.5e-4) < 1e-12);
  }

  TEST_CASE("a pixel has shot and read noise, larger in the dark, and corners are darker") {
    for (const double shot : {0.0, 0.5})
      for (const double read : {0.0, 3.0})
        for (const double light : {1.0, 0.25}) {
          CAPTURE(shot);
          CAPTURE(read);
          CAPTURE(light);
          Scenario::Camera c = plain();
          c.shot_noise = shot, c.read_noise = read, c.exposure_steps = 0, c.vignetting = 0;
          const SimCamera camera(c, light, 3);
          const Statistics s = statistics_of(pixels_of(camera.develop(cv::Mat(120, 160, CV_32F, cv::Scalar(100)), 4)));
          const double gain = 1 / light, sigma = std::sqrt(shot * shot * gain * 100 + read * read * gain * gain);
          CHECK(std::abs(s.mean - 100) < 0.3);
          CHECK(std::abs(s.std - std::sqrt(sigma * sigma + (sigma > 0 ? 1.0 / 12 : 0))) < 0.03 * sigma + 1e-9);
        }
    Scenario::Camera c = plain();
    c.shot_noise = c.read_noise = c.exposure_steps = 0, c.vignetting = 0.4;
    const cv::Mat grey(120, 160, CV_32F, cv::Scalar(200));
    const cv::Mat seen = SimCamera(c, 1, 3).develop(grey, 0);
    CHECK(std::abs(seen.at<uint8_t>(60, 80) - 200) <= 1);
    CHECK(std::abs(seen.at<uint8_t>(0, 0) - 120) <= 1);
    CHECK(std::abs(seen.at<uint8_t>(60, 0) - 200 * (1 - 0.4 * std::pow(79.5 / std::hypot(79.5, 59.5), 2))) <= 1);
    // Gain compensates a twelfth of the light and no more.
    CHECK(std::abs(SimCamera(c, 1, 3).develop(grey, 0, 1 / 24.0).at<uint8_t>(60, 80) - 100) <= 1);
    CHECK(std::abs(SimCamera(c, 1, 3).develop(grey, 0, 1 / 6.0).at<uint8_t>(60, 80) - 200) <= 1);
  }

  TEST_CASE("the exposure's steps have the requested size and last seven frames") {
    Scenario::Camera c = plain();
    c.width = 8, c.height = 8, c.shot_noise = c.read_noise = c.vignetting = 0, c.exposure_steps = 0.1;
    std::vector<double> steps;
    for (size_t frame = 0; frame < 7 * 60; ++frame) {
      const SimCamera camera(c, 1, 3);
      const double grey = camera.develop(cv::Mat(8, 8, CV_32F, cv::Scalar(120)), frame).at<uint8_t>(4, 4);
      if (frame % 7 == 0) steps.push_back(std::log(grey / 120));
      REQUIRE(std::abs(std::log(grey / 120) - steps.back()) < 1e-9);
    }
    CHECK(std::abs(statistics_of(steps).std - 0.1) < 0.03);
  }

  TEST_CASE(
      "a camera whose clock is behind by its time offset stamps the same frames earlier, and its calibration has the "
      "offset") {
    const TemporaryFolder folder;
    const auto recorded = [&](double offset_s) {
      Scenario s;
      s.camera.width = 32, s.camera.height = 24, s.camera.focal_px = 25, s.camera.time_offset_s = offset_s;
      s.route = {{0, 0, 0}, {2, 0, 0}};
      REQUIRE(simulate(s, 3, folder / "walk.odo", {.threads = 1}));
      std::vector<int64_t> stamps_ns;
      int64_t told_ns = 0;
      const auto recording = required(read_recording(folder / "walk.odo"));
      for (const RecordedMessage& m : recording->messages) {
        if (m.message.header().type == ODO_TYPE_FRAME) stamps_ns.push_back(m.message.header().t_ns);
        if (m.message.header().type != ODO_TYPE_CALIBRATION) continue;
        told_ns = as<odo_calibration>(m.message.header()).time_offset_ns;
        CHECK(stamps_ns.empty());  // even where the camera's clock begins before the others'
      }
      return std::pair(stamps_ns, told_ns);
    };
    const auto [plain, none_ns] = recorded(0);
    const auto [early, told_ns] = recorded(0.05);
    CHECK(none_ns == 0);
    CHECK(told_ns == 50'000'000);
    REQUIRE(plain.size() > 10);
    REQUIRE(early.size() == plain.size());
    for (size_t i = 0; i < plain.size(); ++i) CHECK(std::abs(early[i] + told_ns - plain[i]) <= 1);
  }
}
