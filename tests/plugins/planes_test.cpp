// SPDX-License-Identifier: Apache-2.0
//
// surface/planes on landmarks that are placed by the test. z points down; the phone is 1.4 m above the floor.
#include "plugins/surface/planes/plane_finder.hpp"

#include <random>

#include "tests/support/support.hpp"

using Eigen::Vector3d;
using namespace odograph::planes;

TEST_SUITE_BEGIN("planes");

namespace {

constexpr int64_t kSecond_ns = 1'000'000'000;

class Room {
 public:
  explicit Room(unsigned seed = 1) : random_(seed) {}
  /// Landmarks on a rectangle, with noise of that sigma, which is stated.
  void add(const Vector3d& corner, const Vector3d& u, const Vector3d& v, int count, double sigma_m = 0.01) {
    for (int i = 0; i < count; ++i) {
      const Vector3d along = uniform() * u;
      add(corner + along + uniform() * v, sigma_m);
    }
  }
  /// A landmark anywhere in a box.
  void fill(const Vector3d& corner, const Vector3d& size, double sigma_m) {
    Vector3d p = corner;
    for (int k = 0; k < 3; ++k) p[k] += uniform() * size[k];
    add(p, sigma_m);
  }
  void add(const Vector3d& p, double sigma_m) {
    odograph::MapPoint point;
    point.p = p;
    for (double& x : point.p) x += sigma_m * normal_(random_);
    point.covariance = Eigen::Matrix3f::Identity() * static_cast<float>(sigma_m * sigma_m);
    point.t_ns = now_ns, point.scale_sigma = static_cast<float>(scale_sigma);
    point.eye = phone.cast<float>();
    finder.add(point);
  }
  std::vector<Change> search() {
    now_ns += kSecond_ns;
    return finder.search(now_ns, phone, scale_sigma);
  }
  double uniform() { return std::uniform_real_distribution<double>()(random_); }
  size_t count(Kind kind) const {
    return static_cast<size_t>(std::count_if(finder.planes().begin(), finder.planes().end(),
                                             [kind](const Plane& plane) { return plane.kind == kind; }));
  }

  PlaneFinder finder;
  Vector3d phone = Vector3d(0, 0, -1.4);
  int64_t now_ns = kSecond_ns;
  double scale_sigma = 0.02;

 private:
  std::mt19937 random_;
  std::normal_distribution<double> normal_;
};

}  // namespace

TEST_CASE("floor, table and wall are found with their heights, kinds, normals and outlines") {
  Room room;
  room.add({-1, -2, 0}, {3, 0, 0}, {0, 4, 0}, 250);         // floor
  room.add({1, 0.3, -0.75}, {0.8, 0, 0}, {0, 0.6, 0}, 60);  // table
  room.add({2.5, -2, -2.5}, {0, 4, 0}, {0, 0, 2.4}, 250);   // wall in the north
  const auto changes = room.search();
  REQUIRE(room.finder.planes().size() == 3);
  CHECK(changes.size() == 3);
  CHECK(room.count(Kind::floor) == 1);
  CHECK(room.count(Kind::vertical) == 1);
  for (const Plane& plane : room.finder.planes()) {
    CHECK(plane.normal_m().dot(room.phone - plane.p_m) > 0);  // on the side that was seen
    CHECK(plane.sigma_m < 0.02);
    if (plane.kind == Kind::floor) CHECK(std::abs(plane.p_m.z()) < 3 * plane.sigma_m);
    if (plane.kind == Kind::horizontal) CHECK(std::abs(plane.p_m.z() + 0.75) < 3 * plane.sigma_m);
    if (plane.kind == Kind::vertical) {
      CHECK(plane.normal_m().x() < -0.99);
      CHECK(std::abs(plane.distance({2.5, 0, -1})) < 3 * plane.sigma_m);
    }
    double twice = 0;  // counterclockwise
    for (size_t i = 0; i < plane.outline.size(); ++i) {
      const auto &a = plane.outline[i], &b = plane.outline[(i + 1) % plane.outline.size()];
      twice += a.x() * b.y() - a.y() * b.x();
    }
    CHECK(twice > 0);
    CHECK(plane.outline.size() <= 32);
  }
  CHECK(room.search().empty());  // nothing new
}

TEST_CASE("where landmarks fill a room or lie on a line there is no plane") {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    CAPTURE(seed);
    Room room(seed);
    for (int i = 0; i < 600; ++i) room.fill({-1, -2, -3}, {4, 4, 3}, 0.02);
    room.add({2, -2, -1}, {0, 4, 0}, {0, 0, 0}, 60, 0.03);  // a window sill
    room.search();
    CHECK(room.finder.planes().empty());
  }
}

TEST_CASE("each step of a stair is a plane of its own, or none") {
  Room room;
  for (int step = 0; step < 6; ++step) room.add({1 + 0.3 * step, -0.6, -0.17 * step}, {0.3, 0, 0}, {0, 1.2, 0}, 60);
  for (int i = 0; i < 4; ++i) room.search();
  for (const Plane& plane : room.finder.planes()) {
    if (plane.kind == Kind::vertical) continue;
    const double steps = -plane.p_m.z() / 0.17;
    CHECK(std::abs(steps - std::round(steps)) < 0.12);
  }
  CHECK(room.finder.planes().size() >= 3);
}

TEST_CASE("two parts of a floor that grow together become the older one") {
  Room room;
  room.add({0, -3, 0}, {2, 0, 0}, {0, 2, 0}, 120);
  room.search();
  REQUIRE(room.finder.planes().size() == 1);
  const uint64_t older = room.finder.planes()[0].id;
  room.add({0, 1, 0}, {2, 0, 0}, {0, 2, 0}, 120);
  room.search();
  REQUIRE(room.finder.planes().size() == 2);
  room.add({0, -1.2, 0}, {2, 0, 0}, {0, 2.4, 0}, 150);
  std::vector<Change> changes;
  for (int i = 0; i < 3; ++i)
    for (const Change& change : room.search()) changes.push_back(change);
  REQUIRE(room.finder.planes().size() == 1);
  CHECK(room.finder.planes()[0].id == older);
  CHECK(std::any_of(changes.begin(), changes.end(), [older](const Change& change) {
    return change.what == Change::What::merged && change.into == older;
  }));
}

TEST_CASE("a plane that grows slowly is told of again, however small each step") {
  Room room;
  room.add({0, -1, 0}, {2, 0, 0}, {0, 2, 0}, 200);
  room.search();
  size_t told = 0;
  for (int step = 0; step < 20; ++step) {
    room.add({2 + 0.05 * step, -1, 0}, {0.05, 0, 0}, {0, 2, 0}, 12);  // 2 % of the area
    told += room.search().size();
  }
  CHECK(room.finder.planes().size() == 1);
  CHECK(told >= 4);
}

TEST_CASE("an outline stays inside of what its landmarks may be off") {
  Room room;
  room.add({1, 1, 0}, {1, 0, 0}, {0, 1, 0}, 200);
  for (int i = 0; i < 12; ++i) room.add({2.15, 1 + 0.08 * i, 0}, 0.06);  // scattered beyond the edge
  room.search();
  REQUIRE(room.finder.planes().size() == 1);
  const Plane& plane = room.finder.planes()[0];
  double farthest = 0;
  for (const Eigen::Vector2d& vertex : plane.outline)
    farthest = std::max(farthest, (plane.p_m + plane.q_m_s * Vector3d(vertex.x(), vertex.y(), 0)).x());
  CHECK(farthest > 1.95);
  CHECK(farthest < 2.12);
}

TEST_CASE("what was measured with a worse scale gives way once the scale is known") {
  Room room;
  room.scale_sigma = 0.1;
  room.add({0, -1, 0.15}, {2, 0, 0}, {0, 2, 0}, 120);  // a tenth too far
  room.add({0, 4, 0.15}, {2, 0, 0}, {0, 2, 0}, 120);   // not seen again
  room.search();
  REQUIRE(room.finder.planes().size() == 2);
  room.scale_sigma = 0.02;
  room.add({0, -1, 0}, {2, 0, 0}, {0, 2, 0}, 120);
  room.search();
  REQUIRE(room.finder.planes().size() == 1);
  CHECK(std::abs(room.finder.planes()[0].p_m.z()) < 0.02);
}

TEST_CASE("parts of one floor that were measured with two scales are one, where the better scale puts it") {
  Room room;
  room.scale_sigma = 0.05;
  room.add({-1, -2, 0.07}, {2, 0, 0}, {0, 2, 0}, 120);  // a twentieth too far
  room.search();
  REQUIRE(room.finder.planes().size() == 1);
  room.scale_sigma = 0.035;
  room.add({-1, 0, 0}, {2, 0, 0}, {0, 2, 0}, 120);
  const auto changes = room.search();
  REQUIRE(room.finder.planes().size() == 1);
  CHECK(std::abs(room.finder.planes()[0].p_m.z()) < 0.02);
  CHECK(room.finder.planes()[0].scale_sigma == doctest::Approx(0.035));
}

TEST_CASE("a plane whose landmarks turn out to fill its surroundings is withdrawn; one out of view is kept") {
  Room room;
  room.add({1, -1, -0.7}, {1, 0, 0}, {0, 1, 0}, 60);
  room.add({-1, -2, 0}, {3, 0, 0}, {0, 4, 0}, 250);
  room.search();
  REQUIRE(room.finder.planes().size() == 2);
  for (int i = 0; i < 400; ++i)  // a bush
    room.fill({1, -1, -0.95}, {1, 1, 0.5}, 0.01);
  bool withdrawn = false;
  for (int i = 0; i < 5; ++i)
    for (const Change& change : room.search()) withdrawn = withdrawn || change.what == Change::What::withdrawn;
  CHECK(withdrawn);
  CHECK(room.count(Kind::floor) == 1);
  room.now_ns += 60 * kSecond_ns;  // the landmarks are too old
  CHECK(room.search().empty());
  CHECK(room.count(Kind::floor) == 1);
}
