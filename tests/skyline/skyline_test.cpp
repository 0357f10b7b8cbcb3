// SPDX-License-Identifier: Apache-2.0
#include <opencv2/imgproc.hpp>

#include "plugins/fix/skyline/matcher.hpp"
#include "plugins/fix/skyline/robust_sky.hpp"
#include "plugins/fix/skyline/sky_rays.hpp"
#include "sdk/tools/simulation/city_model.hpp"
#include "tests/support/support.hpp"

using namespace odograph::skyline;
using Eigen::Vector3d;

TEST_SUITE_BEGIN("skyline");

namespace {

constexpr double kDegree = std::numbers::pi / 180;

/// Edges of an upright box: its middle (north, east), its sides and its height.
void add_box(std::vector<Edge>& edges, double north, double east, double a, double b, double height) {
  Vector3d foot[4], roof[4];
  const double sign[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
  for (int i = 0; i < 4; ++i) {
    foot[i] = {north + 0.5 * a * sign[i][0], east + 0.5 * b * sign[i][1], 0};
    roof[i] = foot[i] - Vector3d(0, 0, height);
  }
  for (int i = 0; i < 4; ++i) {
    edges.push_back({foot[i], roof[i]});
    edges.push_back({roof[i], roof[(i + 1) % 4]});
  }
}

std::vector<Edge> a_street() {
  std::vector<Edge> edges;
  add_box(edges, 0, -25, 30, 20, 50), add_box(edges, 34, -27, 28, 22, 38), add_box(edges, -33, -26, 30, 20, 61);
  add_box(edges, 8, 24, 40, 18, 44), add_box(edges, 47, 26, 25, 20, 57), add_box(edges, -30, 25, 26, 20, 35);
  return edges;
}

/// The view of an upward camera at a place, with a border 45 degrees from the zenith.
std::vector<SkyEdge> seen_from(const City& city, const Vector3d& p_n, const Eigen::Quaterniond& q_n_c) {
  Horizon horizon;
  city.horizon(p_n, horizon);
  std::vector<SkyEdge> edges;
  for (int j = 0; j < Horizon::kDirections; ++j) {
    const double azimuth = (j + 0.5) * 0.5 * kDegree;
    const double elevation = static_cast<double>(horizon.elevation[static_cast<size_t>(j)]);
    const bool open = elevation < 45 * kDegree;
    const double e = open ? 45 * kDegree : elevation;
    const Vector3d u(std::cos(e) * std::cos(azimuth), std::cos(e) * std::sin(azimuth), -std::sin(e));
    edges.push_back({q_n_c.conjugate() * u, open});
  }
  return edges;
}

const Eigen::Quaterniond kUp(Eigen::AngleAxisd(0.3, Vector3d::UnitZ()) * Eigen::Quaterniond(0, 1, 0, 0));

}  // namespace

TEST_CASE("the skyline of a wall is where geometry puts it") {
  std::vector<Edge> edges;
  add_box(edges, 30, 0, 20, 40, 25);  // its near wall 20 m to the north, 40 m wide
  City city(edges);
  const Vector3d eye(0, 0, -1.5);
  city.select_edges(eye, 5, 0.05);
  Horizon horizon;
  city.horizon(eye, horizon);
  CHECK(horizon.height_m[0] == doctest::Approx(23.5));
  CHECK(horizon.elevation[0] == doctest::Approx(std::atan2(23.5, 20 / std::cos(0.25 * kDegree))).epsilon(1e-4));
  // 40 degrees to the east the ray meets the near wall 26.1 m away; 60 degrees is past the house.
  CHECK(std::tan(horizon.elevation[80]) == doctest::Approx(23.5 * std::cos(40.25 * kDegree) / 20).epsilon(1e-4));
  CHECK(horizon.elevation[120] == 0);
  CHECK(horizon.elevation[360] == 0);
}

TEST_CASE("an edge that two roofs share is raised with each of them") {
  const Vector3d a(0, 0, -9), b(0, 8, -9);
  const City city({{a, b, 0, 1}});
  const auto one = city.with_roof_offsets({{0, 2.0}}).edges();
  REQUIRE(one.size() == 2);
  CHECK(one[0].from.z() == -11);
  CHECK(one[0].object == 0);
  CHECK(one[1].to.z() == -9);
  CHECK(one[1].object == 1);
  const auto both = city.with_roof_offsets({{0, 1.0}, {1, 1.0}}).edges();
  REQUIRE(both.size() == 1);
  CHECK(both[0].to.z() == -10);
}

TEST_CASE("a place and a heading are found again, and an inclination is told from a place") {
  City city(a_street());
  const Vector3d place(3.2, -1.7, -1.5);
  city.select_edges(place, 60, 0.05);
  const auto edges = seen_from(city, place, kUp);
  Matcher matcher{City(a_street())};
  const Eigen::Quaterniond off(Eigen::AngleAxisd(2 * kDegree, Vector3d::UnitZ()));
  const auto match =
      required(matcher.match(edges, {place + Vector3d(-2.4, 1.9, 0), off * kUp, 2.0, 2 * kDegree, 0.5 * kDegree, 40}));
  CHECK((match->p_n - place).norm() < 0.3);
  CHECK(match->q_n_c.angularDistance(kUp) < 0.3 * kDegree);
  CHECK(match->agreement > 0.97);
  CHECK(match->second_best_ratio < 0.05);
  // Eq. (4): the slant distance is that of the highest point.
  CHECK((match->landmark_n - match->p_n).norm() == doctest::Approx(match->slant_distance_m));
  CHECK(match->slant_distance_m > 30);
}

TEST_CASE("houses that the model lacks cost agreement, not the place") {
  City city(a_street());
  auto with_new = a_street();
  add_box(with_new, 20, 22, 14, 12, 90);  // newer than the model
  City now(with_new);
  const Vector3d place(1.0, 0.5, -1.5);
  now.select_edges(place, 60, 0.05);
  Matcher matcher{City(a_street())};
  const auto match = required(
      matcher.match(seen_from(now, place, kUp), {place + Vector3d(1.5, -1, 0), kUp, 2.0, kDegree, 0.5 * kDegree, 40}));
  CHECK((match->p_n - place).norm() < 0.8);
  CHECK(match->agreement < 0.97);
}

TEST_CASE("one who is lost is placed when several pictures agree, by as much as the odometry slips meanwhile") {
  City city(a_street());
  Matcher matcher{City(a_street())};
  for (int picture = 0; picture < 6; ++picture) {
    const Vector3d place(-6.0 + 2 * picture, 0.5, -1.5), error(13.0 + 0.3 * picture, -9, 0);
    city.select_edges(place, 60, 0.05);
    const auto match = matcher.match(seen_from(city, place, kUp), {.p_n = place + error,
                                                                   .q_n_c = kUp,
                                                                   .position_sigma_m = 8,
                                                                   .yaw_sigma_rad = 3 * kDegree,
                                                                   .tilt_sigma_rad = 0.5 * kDegree,
                                                                   .farthest_m = 40,
                                                                   .lost = true});
    REQUIRE(match.has_value() == (picture >= 3));
    if (match) CHECK((match->p_n - place).norm() < 0.5);
  }
}

TEST_CASE("who knows the start but no heading is found on the circle around it, however far the track went astray") {
  const Vector3d place(1, 0.5, -1.5), start(-20, 3, -1.5);
  for (const double astray_deg : {-170.0, -60.0, 0.0, 35.0, 120.0}) {
    CAPTURE(astray_deg);
    Matcher matcher{City(a_street())};
    City city(a_street());
    city.select_edges(place, 5, 0.05);
    const Eigen::Quaterniond astray(Eigen::AngleAxisd(astray_deg * kDegree, Vector3d::UnitZ()));
    // The odometry's path is 4 % too long.
    const Prior prior{.p_n = start + astray * (1.04 * (place - start)),
                      .q_n_c = astray * kUp,
                      .position_sigma_m = 2,
                      .yaw_sigma_rad = 60 * kDegree,
                      .tilt_sigma_rad = 0.01,
                      .farthest_m = 40,
                      .lost = true,
                      .pivot_n = start,
                      .slack_m = 6};
    const auto match = required(matcher.match(seen_from(city, place, kUp), prior));
    CHECK((match->p_n - place).head<2>().norm() < 0.3);
    CHECK(match->q_n_c.angularDistance(kUp) < 1 * kDegree);
    CHECK(match->second_best_ratio < 0.01);
    CHECK(match->agreement > 0.9);
  }
}

TEST_CASE("a straight canyon without ends is a long cloud along the street") {
  std::vector<Edge> edges;
  add_box(edges, 0, -25, 2000, 20, 50), add_box(edges, 0, 25, 2000, 20, 50);
  City city(edges);
  city.select_edges({0, 0, -1.5}, 60, 0.05);
  Matcher matcher{City(edges)};
  const auto match =
      required(matcher.match(seen_from(city, {0, 0, -1.5}, kUp), {{0, 0, -1.5}, kUp, 3.0, kDegree, 0.3 * kDegree, 40}));
  CHECK(std::sqrt(match->covariance(0, 0)) > 4.0);
  CHECK(std::sqrt(match->covariance(1, 1)) < 1.5);
}

TEST_CASE("sky is told from walls in a picture, and where it leaves the picture") {
  CameraModel camera{.fx = 300, .fy = 300, .cx = 319.5, .cy = 239.5};
  cv::Mat picture(480, 640, CV_8UC1);
  cv::RNG(5).fill(picture, cv::RNG::NORMAL, 150, 2);
  cv::GaussianBlur(picture, picture, {3, 3}, 0);
  cv::Mat wall = picture(cv::Rect(0, 0, 200, 480));
  for (int y = 0; y < 480; y += 8)
    for (int x = 0; x < 200; x += 8) wall(cv::Rect(x, y, 8, 8)).setTo((x + y) / 8 % 2 ? 90 : 110);
  SkyFinder finder(camera, picture.size());
  const auto& edges = finder.find(picture, Vector3d::UnitZ(), Vector3d::UnitX());
  REQUIRE(edges.size() > 700);
  int wall_side = 0;
  for (const SkyEdge& e : edges) {
    const Eigen::Vector2d p = camera.project(e.ray_c.head<2>() / e.ray_c.z());
    if (e.open) {
      CHECK((p.x() < 6 || p.x() > 633 || p.y() < 6 || p.y() > 473));
      continue;
    }
    ++wall_side;
    CHECK(p.x() == doctest::Approx(199).epsilon(0.03));
  }
  CHECK(wall_side > 150);
  cv::Mat roof = picture.clone();
  for (int y = 0; y < 480; y += 8)
    for (int x = 0; x < 640; x += 8) roof(cv::Rect(x, y, 8, 8)).setTo((x + y) / 8 % 2 ? 60 : 140);
  CHECK(finder.find(roof, Vector3d::UnitZ(), Vector3d::UnitX()).empty());     // under a bridge
  CHECK(finder.find(picture, Vector3d::UnitX(), Vector3d::UnitZ()).empty());  // looking ahead
}

namespace {

/// Reference: elevation of the skyline in one direction, over all edges.
double elevation_by_all(const std::vector<Edge>& edges, const Vector3d& eye, double azimuth) {
  const double c = std::cos(azimuth), s = std::sin(azimuth);
  double highest = 0;
  for (const Edge& e : edges) {
    const Vector3d a = e.from - eye, d = e.to - e.from;
    const double det = c * d.y() - s * d.x();
    if (std::abs(det) < 1e-9) continue;
    const double t = (s * a.x() - c * a.y()) / det;
    const double r = c * (a.x() + t * d.x()) + s * (a.y() + t * d.y());
    if (t < 0 || t > 1 || r <= 0) continue;
    highest = std::max(highest, std::atan2(-(a.z() + t * d.z()), r));
  }
  return highest;
}

/// An upward fisheye view: clouds and sun over a ring of houses with roofs at `elevation(azimuth)`; walls with windows,
/// the sunlit half brighter than the sky; a grey rim of the lens.
template <class Elevation>
cv::Mat fisheye_view(const CameraModel& camera, Elevation&& elevation) {
  cv::Mat picture(480, 640, CV_8UC1), noise(480, 640, CV_32F), clouds(15, 20, CV_32F);
  cv::RNG random(11);
  random.fill(noise, cv::RNG::NORMAL, 0, 4), random.fill(clouds, cv::RNG::UNIFORM, -12, 25);
  cv::resize(clouds, clouds, picture.size(), 0, 0, cv::INTER_CUBIC);
  for (int y = 0; y < picture.rows; ++y)
    for (int x = 0; x < picture.cols; ++x) {
      Vector3d ray;
      double grey = 70;
      if (ray_of(camera, {double(x), double(y)}, 1.56, ray)) {
        const double azimuth = std::atan2(ray.y(), ray.x()), up = std::asin(ray.z());
        if (up > elevation(azimuth)) {
          grey = 190 + double(clouds.at<float>(y, x));
          if ((ray - Vector3d(0.3, 0.4, 0.87).normalized()).norm() < 0.06) grey = 255;  // the sun
        } else {
          const bool window = std::fmod(azimuth * 20 + 100, 2) < 1 && std::fmod(up * 20 + 100, 2) < 1;
          grey = window ? 50 : azimuth > 0 ? 215 : 110;
        }
      }
      picture.at<uint8_t>(y, x) = cv::saturate_cast<uint8_t>(grey + double(noise.at<float>(y, x)));
    }
  cv::GaussianBlur(picture, picture, {3, 3}, 0.6);
  return picture;
}

}  // namespace

TEST_CASE("the fast skyline is the plain one; the quick one, without hidden edges, nearly everywhere") {
  std::vector<Edge> edges;
  cv::RNG random(3);
  for (int k = 0; k < 90; ++k) {
    const double n = random.uniform(-200.0, 200.0), e = random.uniform(-200.0, 200.0);
    const double width = random.uniform(5.0, 25.0), depth = random.uniform(5.0, 25.0);
    add_box(edges, n, e, width, depth, random.uniform(4.0, 25.0));
  }
  City city(edges);
  city.select_edges({0, 0, -1.5}, 8, 0.05);
  Horizon horizon, quick;
  int quick_wrong = 0;
  for (const Vector3d& eye : {Vector3d(0, 0, -1.5), Vector3d(7, -6, -1.5), Vector3d(-8, 8, -1.5)}) {
    city.horizon(eye, horizon);
    city.quick_horizon(eye, quick);
    for (int j = 0; j < Horizon::kDirections; ++j) {
      const double plain = elevation_by_all(edges, eye, (j + 0.5) * 0.5 * kDegree);
      if (plain < 0.06) continue;
      CHECK(double(horizon.elevation[size_t(j)]) == doctest::Approx(plain).epsilon(1e-3));
      quick_wrong += std::abs(double(quick.elevation[size_t(j)]) - plain) > 1e-3;
    }
  }
  CHECK(quick_wrong < 0.02 * 3 * Horizon::kDirections);
}

TEST_CASE("roofs are found through a fisheye under clouds, a sun and walls brighter than the sky") {
  const CameraModel camera{
      .distortion = CameraModel::Distortion::kannala_brandt, .fx = 200, .fy = 200, .cx = 319.5, .cy = 239.5};
  const auto roofs = [](double azimuth) { return (std::sin(3 * azimuth) > 0 ? 38 : 28) * kDegree; };
  const cv::Mat picture = fisheye_view(camera, roofs);
  RobustSkyFinder finder({}, camera, picture.size());
  const auto& edges = finder.find(picture, {}, Vector3d::UnitZ(), Vector3d::UnitX());
  REQUIRE(edges.size() > 700);
  int closed = 0, right = 0;
  for (const SkyEdge& e : edges) {
    if (e.open) continue;
    ++closed;
    const double up = std::asin(e.ray_c.z());
    right += std::abs(up - roofs(std::atan2(e.ray_c.y(), e.ray_c.x()))) < kDegree;
  }
  CHECK(closed > 650);
  CHECK(right > 0.65 * closed);  // flood fill finds none because of the clouds and the sun
  // With the picture's bottom masked, no edge is reported in directions that are not visible.
  cv::Mat mask(picture.size(), CV_8UC1, cv::Scalar(255));
  mask.rowRange(300, 480).setTo(0);
  for (const SkyEdge& e : finder.find(picture, mask, Vector3d::UnitZ(), Vector3d::UnitX())) {
    Eigen::Vector2d pixel;
    REQUIRE(pixel_of(camera, e.ray_c, 1.6, pixel));
    CHECK(pixel.y() < 303);
  }
}

TEST_CASE("pixels and rays of a fisheye lens are inverse to each other, beyond 90 degrees too") {
  const CameraModel camera{.distortion = CameraModel::Distortion::kannala_brandt,
                           .fx = 200,
                           .fy = 201,
                           .cx = 319.5,
                           .cy = 239.5,
                           .coefficients = {0.01, -0.004, 0.001, 0}};
  for (const double theta : {0.0, 0.5, 1.2, 1.56, 1.6}) {
    const Vector3d ray(std::sin(theta) * 0.6, std::sin(theta) * -0.8, std::cos(theta));
    Eigen::Vector2d pixel;
    Vector3d back;
    REQUIRE(pixel_of(camera, ray, 1.7, pixel));
    REQUIRE(ray_of(camera, pixel, 1.7, back));
    CHECK((back - ray).norm() < 1e-6);
  }
  Eigen::Vector2d pixel;
  CHECK_FALSE(pixel_of(camera, Vector3d(1, 0, -0.1).normalized(), 1.52, pixel));
}

TEST_CASE("a refused picture says why") {
  City city(a_street());
  const Vector3d place(1, 0.5, -1.5);
  city.select_edges(place, 60, 0.05);
  auto edges = seen_from(city, place, kUp);
  Matcher matcher{City(a_street())};
  const Prior prior{place, kUp, 1.0, kDegree, 0.5 * kDegree, 40};
  for (SkyEdge& e : edges) e.open = true;
  CHECK_FALSE(matcher.match(edges, prior));
  CHECK(matcher.refusal() == Refusal::few_edges);
  Prior lost = prior;
  lost.lost = true;
  CHECK_FALSE(matcher.match(seen_from(city, place, kUp), lost));
  CHECK(matcher.refusal() == Refusal::gathering);
}

TEST_CASE("the height over the ground is found with the place") {
  City city(a_street());
  const Vector3d place(3.2, -1.7, -1.5);
  city.select_edges(place, 60, 0.05);
  const auto edges = seen_from(city, place, kUp);
  Matcher matcher{City(a_street())};
  Prior prior{place + Vector3d(1.0, -0.8, 1.2), kUp, 1.0, kDegree, 0.2 * kDegree, 40};
  prior.height_sigma_m = 2;
  const auto match = required(matcher.match(edges, prior));
  CHECK((match->p_n - place).head<2>().norm() < 0.4);
  CHECK(std::abs(match->p_n.z() - place.z()) < 0.5);
}
