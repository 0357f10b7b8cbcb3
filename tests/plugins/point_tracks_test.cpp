// SPDX-License-Identifier: Apache-2.0
//
// Landmarks of the front-ends (odo_points): triangulated from the motions that they report.
#include "plugins/shared/camera/point_tracks.hpp"

#include <random>

#include "plugins/shared/camera/points_event.hpp"
#include "plugins/shared/median.hpp"
#include "plugins/vo/antigny2019/odometry.hpp"
#include "plugins/vo/five_point/visual_odometry.hpp"
#include "plugins/vo/odograph/visual/odometry.hpp"
#include "sdk/host/messages/messages.hpp"
#include "tests/plugins/film.hpp"
#include "tests/support/support.hpp"

TEST_SUITE_BEGIN("point_tracks");

namespace {

using Eigen::Vector3d;

constexpr double kSigma_rad = 0.002;

/// Corners of points as seen from `p`, looking along z, with noise.
std::vector<TrackedCorner> seen_from(const Vector3d& p, const std::vector<Vector3d>& points, std::mt19937& random) {
  std::normal_distribution<double> noise(0, kSigma_rad);
  std::vector<TrackedCorner> corners;
  for (size_t i = 0; i < points.size(); ++i) {
    const Vector3d y = points[i] - p;
    TrackedCorner corner;
    corner.id = i;
    corner.ray_c = y / y.z();
    corner.ray_c.x() += noise(random);
    corner.ray_c.y() += noise(random);
    corners.push_back(corner);
  }
  return corners;
}

std::vector<Vector3d> room(std::mt19937& random) {
  std::uniform_real_distribution<double> side(-2, 2), depth(3, 8);
  std::vector<Vector3d> points;
  for (int i = 0; i < 200; ++i) {
    const double x = side(random), y = side(random);
    points.emplace_back(x, y, depth(random));
  }
  return points;
}

const Eigen::Quaterniond kStraight = Eigen::Quaterniond::Identity();

}  // namespace

TEST_CASE("points come with parallax, their errors match their covariances, and the unit is that of the motions") {
  std::mt19937 random(1);
  for (const double unit : {1.0, 0.02}) {  // m of a unit of the motions
    const auto points = room(random);
    PointTracks tracks;
    const Vector3d step(0.12, 0.01, 0.02);
    std::vector<double> squares;
    for (int k = 0; k < 16; ++k) {
      if (k > 0) tracks.move(kStraight, step / unit);
      const auto& found = tracks.see(seen_from(k * step, points, random), kSigma_rad);
      if (k == 0) CHECK(found.empty());  // no parallax yet
      if (k < 15) continue;
      CHECK(found.size() > 190);
      for (const TrackedPoint& point : found) {
        CHECK(point.age == 16);
        CHECK_FALSE(point.lost);
        const Vector3d error = point.p_c * unit - (points[point.id] - k * step);
        squares.push_back(error.dot((point.covariance * unit * unit).ldlt().solve(error)));
      }
    }
    double mean = 0;
    for (const double x : squares) mean += x / static_cast<double>(squares.size());
    CAPTURE(unit);
    CHECK(mean > 2);  // chi-square with three degrees of freedom; its mean over 190 has a sigma of 0.18
    CHECK(mean < 4);
  }
}

TEST_CASE("a rotation alone gives no point, a point of unknown distance says so, and a moving one is none") {
  std::mt19937 random(2);
  PointTracks tracks;
  for (int k = 0; k < 10; ++k) {
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.02, Vector3d::UnitY()));
    tracks.move(turn, Vector3d::Zero());
    TrackedCorner corner;
    const Eigen::Quaterniond to(Eigen::AngleAxisd(-0.02 * (k + 1), Vector3d::UnitY()));
    const Vector3d y = to * Vector3d(0.1, 0.1, 1);
    corner.ray_c = y / y.z();
    CHECK(tracks.see({corner}, kSigma_rad).empty());
  }
  tracks.clear();
  const std::vector<Vector3d> far{{0, 0, 20}, {0, 0, 4}};
  bool was_uncertain = false;
  for (int k = 0; k < 30; ++k) {
    const Vector3d p(0.02 * k, 0, 0);
    if (k > 0) tracks.move(kStraight, Vector3d(0.02, 0, 0));
    auto corners = seen_from(p, far, random);
    const Vector3d walker = Vector3d(0.5 - 0.15 * k, 0.3 * std::sin(k), 5) - p;  // another one
    corners.push_back({2, walker / walker.z()});
    for (const TrackedPoint& point : tracks.see(corners, 2 * kSigma_rad)) {  // of a poor lens
      was_uncertain = was_uncertain || (point.id == 0 && point.uncertain);
      if (point.id == 1 && k == 29) CHECK_FALSE(point.uncertain);
      CHECK(point.id != 2);
    }
  }
  CHECK(was_uncertain);
}

TEST_CASE("a track that ends is reported once as lost, where the motion has taken it, and its id is free again") {
  std::mt19937 random(3);
  const std::vector<Vector3d> points{{0.5, 0, 4}, {-0.5, 0, 4}};
  PointTracks tracks;
  for (int k = 0; k < 12; ++k) {
    if (k > 0) tracks.move(kStraight, Vector3d(0.1, 0, 0));
    tracks.see(seen_from(Vector3d(0.1 * k, 0, 0), points, random), kSigma_rad);
  }
  tracks.move(kStraight, Vector3d(0.1, 0, 0));
  auto corners = seen_from(Vector3d(1.2, 0, 0), points, random);
  corners.pop_back();
  const auto found = tracks.see(corners, kSigma_rad);
  REQUIRE(found.size() == 2);
  CHECK_FALSE(found[0].lost);
  CHECK(found[1].lost);
  CHECK(found[1].id == 1);
  CHECK((found[1].p_c - Vector3d(-1.7, 0, 4)).norm() < 0.2);
  tracks.move(kStraight, Vector3d(0.1, 0, 0));
  CHECK(tracks.see({}, kSigma_rad).size() == 1);  // the other one, lost too
  CHECK(tracks.see({}, kSigma_rad).empty());
}

TEST_CASE("a ray begins where the camera was at its row") {
  std::mt19937 random(4);
  const auto points = room(random);
  PointTracks tracks;
  const Vector3d step(0.12, 0.01, 0.02);
  double worst = 0;
  for (int k = 0; k < 12; ++k) {
    if (k > 0) tracks.move(kStraight, step);
    std::vector<TrackedCorner> corners;
    for (size_t i = 0; i < points.size(); ++i) {
      TrackedCorner corner;
      corner.id = i;
      corner.origin_c = (i % 10 / 10.0 - 0.45) * step;  // rows read over a whole frame
      const Vector3d y = points[i] - k * step - corner.origin_c;
      corner.ray_c = y / y.z();
      corners.push_back(corner);
    }
    for (const TrackedPoint& point : tracks.see(corners, kSigma_rad))
      if (k == 11) worst = std::max(worst, (point.p_c - (points[point.id] - k * step)).norm());
  }
  CHECK(worst < 1e-6);
}

TEST_CASE("landmarks that the camera has passed leave the message, whatever the lens, and the host takes it") {
  struct : odo_sink {
    mutable std::vector<AnyMessage> emitted;
  } sink{};
  sink.struct_size = sizeof(odo_sink);
  sink.emit = [](const odo_sink* to, const odo_header* event) -> int32_t {
    static_cast<const decltype(sink)*>(to)->emitted.emplace_back(*event);
    return message_fault(*event).empty() ? ODO_OK : ODO_E_ARGUMENT;
  };
  odo::Output output(nullptr, 1);
  output.connect(&sink);
  const CameraModel lens{CameraModel::Distortion::radial_tangential, 300, 300, 320, 240, {-0.3, 0.1, 0, 0, 0.05}};
  const std::vector<Vector3d> points{{0.4, 0.1, 1.98}, {-0.4, 0.1, 1.9}, {0.5, -0.2, 30}};
  std::mt19937 random(5);
  PointsEvent event;
  for (int k = 0; k < 12; ++k) {
    const Vector3d p(0, 0, 0.25 * k);  // forward, past the first two
    auto corners = seen_from(p, points, random);
    std::erase_if(corners, [&](const TrackedCorner& c) { return points[c.id].z() < p.z() + 0.2; });
    auto motion = make_message<odo_vo_motion>(ODO_TYPE_VO_MOTION, k + 1);
    motion.header.flags = ODO_VO_ROTATION | ODO_VO_TRANSLATION;
    motion.q_c0_c1[0] = 1, motion.p_c0_c1[2] = k > 0 ? 0.25 : 0;
    event.emit(motion, corners, kSigma_rad, lens, {640, 480}, output);
  }
  REQUIRE(!sink.emitted.empty());
  bool lost = false;
  for (const AnyMessage& message : sink.emitted) {
    CHECK(message_fault(message.header()) == "");
    for (const odo_point& point : odo::Points(as<odo_points>(message.header()))) {
      CHECK(point.p_c[2] > 0);
      lost = lost || (point.flags & ODO_POINT_LOST) != 0;
    }
  }
  CHECK(lost);
}

namespace {

/// Walks north along a street; the share of the points whose distance is within three sigma (and 3 % of it, for the
/// motions' own errors) of the scene's, and the median relative error.
template <class Step>
void check_distances(Film& film, double largest_median, Step&& step) {
  const CameraModel lens = film.model();
  PointTracks tracks;
  double walked_m = 0, moved = 0;
  std::vector<double> errors;
  size_t within = 0;
  for (size_t i = 0; i < 30; ++i) {
    const Vector3d p(0.13 * static_cast<double>(i), 0, -1.5);
    const auto [q, d, valid, corners, sigma_rad] = step(film.frame(p, i), i);
    if (!valid) {
      tracks.clear();
      continue;
    }
    tracks.move(q, d);
    if (i > 12) walked_m += 0.13, moved += d.norm();
    for (const TrackedPoint& point : tracks.see(corners, sigma_rad)) {
      if (i < 29 || point.lost || point.uncertain) continue;
      const Vector3d ray((point.pixel.x() - lens.cx) / lens.fx, (point.pixel.y() - lens.cy) / lens.fy, 1);
      CHECK((point.p_c / point.p_c.z() - ray).norm() < 0.02);  // the corner's own direction
      const double true_m = film.distance(p, ray);
      if (!(true_m < 40)) continue;
      const double unit = walked_m / moved, found_m = unit * point.p_c.norm();
      const Vector3d u = point.p_c.normalized();
      const double sigma_m = unit * std::sqrt(u.dot(point.covariance * u));
      errors.push_back(std::abs(found_m / true_m - 1));
      within += std::abs(found_m - true_m) < 3 * sigma_m + 0.03 * true_m;
    }
  }
  REQUIRE(errors.size() > 30);
  CAPTURE(median(errors));
  CHECK(median(errors) < largest_median);
  CHECK(static_cast<double>(within) > 0.85 * static_cast<double>(errors.size()));
}

struct Stepped {
  Eigen::Quaterniond q;
  Vector3d d;
  bool valid;
  std::vector<TrackedCorner> corners;
  double sigma_rad;
};

}  // namespace

TEST_CASE("the front-ends' points lie where the scene is, in the unit of their motions") {
  Film film(320, 240, 250, 3);
  const CameraModel lens = film.model();
  SUBCASE("vo/odograph up to scale") {
    vo::Odometry odometry({}, lens);
    check_distances(film, 0.05, [&](const cv::Mat& picture, size_t i) {
      const auto m = odometry.process({picture, {}, static_cast<int64_t>(i) * 100'000'000, 0});
      return Stepped{m.q_c0_c1, m.p_c0_c1, m.translation_valid, odometry.corners(), odometry.corner_sigma_rad()};
    });
  }
  SUBCASE("vo/antigny2019") {
    Film fine(640, 480, 500, 3);  // SURF needs a larger picture, and without a map the scale drifts
    antigny2019::Odometry odometry({}, fine.model(), {640, 480});
    check_distances(fine, 0.1, [&](const cv::Mat& picture, size_t) {
      const auto m = odometry.process(picture, {});
      return Stepped{Eigen::Quaterniond(m.T_c0_c1.linear()), m.T_c0_c1.translation(), m.translation_valid,
                     odometry.corners(), odometry.corner_sigma_rad()};
    });
  }
  SUBCASE("vo/five_point") {
    five_point::VisualOdometry odometry({}, lens);
    check_distances(film, 0.05, [&](const cv::Mat& picture, size_t) {
      const auto m = odometry.process(picture, {});
      return Stepped{m.q_c0_c1, m.p_c0_c1, m.translation_valid, odometry.corners(), odometry.corner_sigma_rad()};
    });
  }
}
